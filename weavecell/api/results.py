"""Results of impacts: shots, sweeps of shots, critical velocities."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast, overload

from fabrics.checks import FilePath, FloatArray
from weavecell.api.result import Result, figure, plain

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fabrics.fabric import Fabric
    from shellfabric.panel.quality import Indicator
    from weavecell.analysis.assumed_range import AssumedRange
    from weavecell.results.impact import ImpactRecord
    from weavecell.results.impact_shapes import Shape

__all__ = ["ShotResult", "SweepResult"]

Outcome = Literal["stopped", "perforated", "in flight", "unstable"]


@dataclass(frozen=True, repr=False)
class ShotResult(Result):
    """One impact on one ply or on a pack.

    Parameters
    ----------
    record : `weavecell.results.impact.ImpactRecord`
    shapes : of each instant of `snapshot_interval` the tuple of the plies' Shape
    fabric : Fabric, with the linear densities of the run
    assumed : lines that name the laws that are assumed
    range : AssumedRange of the residual velocity over the assumed laws, or None

    Examples
    --------
    >>> shot = wc.shoot("S-720", "150 m/s", opening="20 mm", end_time="10 us")
    >>> shot
    ShotResult(S-720, 150 m/s: in flight, residual velocity 148.1 m/s, checks ok)
    >>> f"{1e3 * shot.deflection[-1]:.1f} mm"
    '1.6 mm'
    >>> shot.to_vtk("shot").name
    'panel.pvd'
    """

    record: ImpactRecord
    shapes: tuple[tuple[Shape, ...], ...] = ()
    fabric: Fabric | None = None
    assumed: tuple[str, ...] = ()
    range: AssumedRange | None = None

    @property
    def outcome(self) -> Outcome:
        """ "stopped", "perforated", "in flight" (the end time came first) or "unstable"."""
        return cast("Outcome", self.record.outcome)

    @property
    def checks(self) -> tuple[Indicator, ...]:
        """Quality checks of the shot."""
        return self.record.checks

    @property
    def strike_velocity(self) -> float:
        """[m/s]"""
        return float(self.record.strike_velocity)

    @property
    def residual_velocity(self) -> float:
        """[m/s] at the end, along the panel's normal; 0 of a projectile that has stopped."""
        return float(self.record.residual_velocity)

    @property
    def time(self) -> FloatArray:
        """(n,) [s] of the histories `deflection` and `contact_force`."""
        return self.record.time

    @property
    def deflection(self) -> FloatArray:
        """(n,) [m] of the back face: largest displacement along the normal, of a pack that of its last ply."""
        return self.record.deflection

    @property
    def contact_force(self) -> FloatArray:
        """(n,) [N] on the projectile along the panel's normal, against its flight; the mean since the time before."""
        return self.record.contact_force

    def summary(self) -> dict[str, Any]:
        """The entries of summary.json (docs/reference/input.md), the checks in words, the areal density of the first
        ply, and what is assumed."""
        found = self.record.summary() | {"checks": self.checks_text}
        if self.fabric is not None:
            found["areal_density_kg_m2"] = float(self.fabric.weave.areal_density)
        return found | self._what_is_assumed()

    def __repr__(self) -> str:
        more = f", assumed: {len(self.assumed)} laws" if self.assumed else ""
        velocity = f"residual velocity {self.residual_velocity:.4g} m/s"
        return f"ShotResult({self._what()}, {velocity}{more}, checks {self.checks_text})"

    def _what(self):
        return f"{self.record.fabric}, {self.strike_velocity:g} m/s: {self.outcome}"

    def _columns(self):
        record = self.record
        columns = {
            "time_s": record.time, "velocity_m_s": record.velocity, "nose_position_m": record.nose_position,
            "deflection_m": record.deflection, "contact_force_N": record.contact_force,
            "failed_yarn_segments": record.failed_segments,
        }  # fmt: skip
        columns |= {f"energy_{name}_J": values for name, values in record.energies.items()}
        columns |= {f"reaction_{name}_N": record.plies[f"reaction_{name}"].sum(axis=1) for name in ("warp", "weft")}
        return columns | {"checks": [self.checks_text] * len(record.time)}

    def plot(self) -> Figure:
        """A matplotlib figure: velocity of the projectile [m/s] against time [us]."""
        from weavecell.report import pictures

        label = f"{self.record.fabric}, {self.strike_velocity:g} m/s"
        return figure(pictures.velocity, {label: (self.record.time, self.record.velocity)})

    def plot_panel(self) -> Figure:
        """A matplotlib figure: the whole panel or pack and the projectile at the end, seen from behind.

        Colours are the higher of warp and weft tension over the strength [%].
        """
        from weavecell.report.shot import view

        return figure(view.end, self.record)

    def to_vtk(self, folder: FilePath) -> Path:
        """Write the panel for ParaView: panel.pvd with ``panel/*.vtu``, all plies in each.

        Parameters
        ----------
        folder : to write to; it is made

        Returns
        -------
        path : of panel.pvd
        """
        from weavecell.results import paraview

        folder, final = Path(folder), self.record.final
        before = [plies for plies in self.shapes if plies[0].t < final[0].t]
        paraview.write_panel(folder, [*before, final], self.record.quads)
        return folder / "panel.pvd"

    def write(self, path: FilePath) -> None:
        """Write the histories as HDF5, as `weavecell impact` writes histories.h5."""
        self.record.write(path)


@dataclass(frozen=True, repr=False)
class SweepResult(Result, Sequence):
    """Results of several shots, in their order; an unstable one has the outcome "unstable".

    Parameters
    ----------
    shots : tuple of ShotResult

    Examples
    --------
    >>> shots = wc.sweep([wc.setup("S-720", 150, opening="20 mm", end_time="10 us")])
    >>> len(shots), shots[0].outcome
    (1, 'in flight')
    """

    shots: tuple[ShotResult, ...]

    def __len__(self) -> int:
        return len(self.shots)

    @overload
    def __getitem__(self, index: int) -> ShotResult: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[ShotResult, ...]: ...

    def __getitem__(self, index: int | slice) -> ShotResult | tuple[ShotResult, ...]:
        return self.shots[index]

    def __iter__(self) -> Iterator[ShotResult]:
        return iter(self.shots)

    @property
    def checks(self) -> tuple[Indicator, ...]:
        """Each quality check of the shot in which it is worst, without unstable shots."""
        from shellfabric.panel import quality

        return quality.worst(shot.checks for shot in self.shots if shot.outcome != "unstable")

    def _what(self):
        some = [f"{shot.strike_velocity:g} m/s" for shot in self.shots if shot.doubtful and shot.outcome != "unstable"]
        return f"sweep of {len(self.shots)} shots, doubtful at {', '.join(some)}; worst"

    def summary(self) -> dict[str, Any]:
        """Number of shots of each outcome and of doubtful ones, and the worst checks in words."""
        outcomes: list[str] = [shot.outcome for shot in self.shots]
        found: dict[str, Any] = {"shots": len(self.shots)}
        found |= {name: outcomes.count(name) for name in dict.fromkeys(outcomes)}
        return found | {"doubtful": sum(shot.doubtful for shot in self.shots), "checks": self.checks_text}

    def _columns(self):
        rows = [{key: value for key, value in shot.summary().items() if plain(value)} for shot in self.shots]
        names = dict.fromkeys(name for row in rows for name in row)
        return {name: [row.get(name) for row in rows] for name in names}

    def plot(self) -> Figure:
        """A matplotlib figure: residual against strike velocity [m/s]."""

        def draw(pyplot):
            figure, axes = pyplot.subplots(figsize=(7.2, 4.4))
            for outcome in dict.fromkeys(shot.outcome for shot in self.shots):
                some = [shot for shot in self.shots if shot.outcome == outcome]
                axes.plot(
                    [shot.strike_velocity for shot in some],
                    [shot.residual_velocity for shot in some],
                    "o",
                    label=outcome,
                )
            axes.set(xlabel="strike velocity [m/s]", ylabel="residual velocity [m/s]")
            axes.legend()
            return figure

        return figure(draw)
