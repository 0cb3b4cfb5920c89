"""The critical velocity of a panel or pack: what was found, its files, and what is printed of it.

The folder of `weavecell critical-velocity`
    scene.toml               the input file; that of a fabric is the standard one, and can be run again or changed
    critical-velocity.json   bracket, scan, zone of mixed outcomes if there is one, fit, shots, provenance
    shots.csv                one row a shot, by strike velocity
    residual-velocity.svg    residual against strike velocity
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import files
from fabrics.checks import FilePath
from weavecell.api.result import Result, figure
from weavecell.report import chapters_assumed, checks
from weavecell.results import json_file, provenance

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fabrics.fabric import Fabric
    from shellfabric.impact.ballistic_limit import Limit, Shot
    from shellfabric.impact.lambert_jonas import LambertJonas
    from shellfabric.impact.limit_scan import ScanRange
    from shellfabric.panel.quality import Indicator
    from weavecell.scenes.target import Target
    from weavecell.studies.assumed_range import AssumedRange

__all__ = ["CriticalVelocityResult"]

_COLUMNS = {
    "strike velocity [m/s]": lambda shot: f"{shot.strike_velocity:.4f}",
    "outcome": lambda shot: shot.outcome,
    "residual velocity [m/s]": lambda shot: f"{shot.residual_velocity:.4f}",
    "time [s]": lambda shot: f"{shot.time:.6e}",
    "failed yarn segments": lambda shot: f"{shot.failed}",
    "peak warp tension [N]": lambda shot: f"{shot.peak_tension[0]:.3f}",
    "peak weft tension [N]": lambda shot: f"{shot.peak_tension[1]:.3f}",
    "energy error [-]": lambda shot: f"{shot.balance:.3e}",
    "checks": lambda shot: checks.status(shot.checks),
}


@dataclass(frozen=True, repr=False)
class CriticalVelocityResult(Result):
    """The critical velocity of a panel (ballistic limit).

    Parameters
    ----------
    target : `weavecell.scenes.target.Target` that was shot at
    limit : `shellfabric.impact.ballistic_limit.Limit`
    fit : Lambert-Jonas fit to the perforations, or None where they are too few
    assumed : lines that name the laws that are assumed
    range : AssumedRange of the critical velocity over the assumed laws, or None
    scan : ScanRange about the bracket, or None
    wall_time : [s]

    Examples
    --------
    >>> found = wc.critical_velocity("S-720", tolerance="20 m/s", scan=False, residual_shots=0, opening="100 mm")
    >>> low, high = found.bracket
    >>> low < found.velocity < high
    True
    """

    target: Target
    limit: Limit
    fit: LambertJonas | None = None
    assumed: tuple[str, ...] = ()
    range: AssumedRange | None = None
    scan: ScanRange | None = None
    wall_time: float = 0.0

    @property
    def fabric(self) -> Fabric:
        """The Fabric of the first ply."""
        return self.target.setup.fabric

    @property
    def shots(self) -> tuple[Shot, ...]:
        """All shots, by strike velocity."""
        return tuple(sorted(self.limit.shots, key=lambda shot: shot.strike_velocity))

    @property
    def velocity(self) -> float | None:
        """[m/s] middle of the bracket; None where stops and perforations are mixed (see `mixed_zone`)."""
        return float(self.limit.velocity) if self.limit.single else None

    @property
    def bracket(self) -> tuple[float, float]:
        """[m/s] the stop and the perforation that enclose it."""
        return float(self.limit.low), float(self.limit.high)

    @property
    def mixed_zone(self) -> tuple[float, float] | None:
        """(lowest perforation, highest stop) [m/s] where the outcomes are mixed, or None."""
        return self.limit.mixed_zone

    @property
    def checks(self) -> tuple[Indicator, ...]:
        """Each quality check of the shot in which it is worst, and the width of the zone of mixed outcomes."""
        from shellfabric.impact import limit_scan
        from shellfabric.panel import quality

        return *quality.worst(shot.checks for shot in self.limit.shots), limit_scan.indicator(self.limit)

    @property
    def bracket_checks(self) -> str:
        """ "ok", or which end of the bracket, or of the zone of mixed outcomes, is a doubtful shot, and why."""
        return checks.of_bracket(self.limit)

    def _what(self):
        name = f"{self.target.title}, critical velocity"
        return name if self.bracket_checks == checks.OK else f"{name}: the limit rests on a {self.bracket_checks}"

    def summary(self) -> dict[str, Any]:
        """Velocity, bracket, number of shots; doubtful shots that the limit rests on, and the worst checks of all."""
        low, high = self.bracket
        entries: dict[str, Any] = {
            "fabric": self.target.setup.name,
            "plies": self.target.setup.plies,
            "critical_velocity_m_s": self.velocity,
            "stop_m_s": low,
            "perforation_m_s": high,
            "shots": len(self.limit.shots),
            "bracket_checks": self.bracket_checks,
            "checks": self.checks_text,
        }
        if self.mixed_zone is not None:
            entries |= dict(zip(("lowest_perforation_m_s", "highest_stop_m_s"), self.mixed_zone))
        return entries | self._what_is_assumed()

    def _columns(self):
        units = {"strike_velocity": "m_s", "residual_velocity": "m_s", "time": "s"}
        columns = {f"{name}_{unit}": [getattr(shot, name) for shot in self.shots] for name, unit in units.items()}
        outcomes = [shot.outcome for shot in self.shots]
        return columns | {"outcome": outcomes, "checks": [checks.words(shot.checks) for shot in self.shots]}

    def plot(self) -> Figure:
        """A matplotlib figure: residual against strike velocity [m/s], the bracket and the Lambert-Jonas curve."""
        from weavecell.report import pictures

        return figure(pictures.residual_velocity, self.target.title, self.limit, self.fit, self.shots)

    def save(self, out: FilePath) -> None:
        """Write the files that stand at the top of this module to a folder."""
        from weavecell.report import pictures

        out, found = Path(out), self.limit
        write_shots(out, self.target, self.shots)
        content = {
            "format": "weavecell critical velocity 3",
            "fabric": self.target.setup.name,
            "plies": self.target.setup.plies,
            "projectile": self.target.projectile,
            "law_name": self.target.law_name,
            "critical_velocity_m_s": self.velocity,
            "bracket_m_s": [found.low, found.high],
            "single_limit": found.single,
            "highest_stop_m_s": found.highest_stop,
            "lowest_perforation_m_s": found.lowest_perforation,
            "mixed_zone_m_s": found.mixed_zone,
            "scan": self.scan and asdict(self.scan),
            "lambert_jonas": self.fit and asdict(self.fit),
            "shots": [_entry(shot) for shot in self.shots],
            "bracket_checks": self.bracket_checks,
            **checks.summary(self.checks),
            **chapters_assumed.summary(self.range),
            "wall_time_s": self.wall_time,
            "provenance": provenance.stamp(self.target.text, setup=self.target.setup),
        }
        json_file.write(out / "critical-velocity.json", content)
        picture = pictures.render(pictures.residual_velocity, self.target.title, found, self.fit, self.shots)
        files.write(out / "residual-velocity.svg", picture)

    def __str__(self) -> str:
        title, found, count = self.target.title, self.limit, len(self.limit.shots)
        if found.single:
            lines = [f"{title}: critical velocity {found.velocity:.1f} m/s"]
            lines.append(f"stops at {found.low:.2f} m/s, perforates at {found.high:.2f} m/s; {count} shots")
        else:
            low, high = found.lowest_perforation, found.highest_stop
            inside = [shot.perforated for shot in found.shots if low <= shot.strike_velocity <= high]
            lines = [f"{title}: no single critical velocity, mixed outcomes from {low:.1f} to {high:.1f} m/s"]
            lines.append(f"lowest perforation {low:.2f} m/s, highest stop {high:.2f} m/s; {count} shots")
            through = sum(inside)
            lines.append(f"{len(inside)} shots in this zone: {through} perforate, {len(inside) - through} stop")
        if self.bracket_checks != checks.OK:
            lines.append(f"the limit rests on a {self.bracket_checks}")
        if self.fit is not None:
            lines.append(f"Lambert-Jonas: {self.fit.words()}, rms {self.fit.residual_rms:.1f} m/s")
        if self.range is not None:
            lines.append(f"assumed laws: {self.range.words()}")
        return "\n".join(lines)


def write_shots(out: Path, target: Target, shots: Iterable[Shot]) -> None:
    """Write shots.csv, and scene.toml where the target has a text; of a search that did not end too."""
    if target.text:
        files.write(out / "scene.toml", target.text)
    files.write_csv(out / "shots.csv", [_COLUMNS, *([text(shot) for text in _COLUMNS.values()] for shot in shots)])


def _entry(shot):
    """A shot for critical-velocity.json."""
    return {
        "strike_velocity_m_s": shot.strike_velocity,
        "residual_velocity_m_s": shot.residual_velocity,
        "outcome": shot.outcome,
        "end_time_s": shot.time,
        "failed_yarn_segments": shot.failed,
        "peak_tension_N": shot.peak_tension,
        "energy_error_max": shot.balance,
        "wall_time_s": shot.wall_time,
        "checks": checks.status(shot.checks),
    }
