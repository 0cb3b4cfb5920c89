"""What follows from records of a laboratory.

The folder of `weavecell reduce compression` and `reduce shot`
    compression.json     K'', n, room left of each pack, a, b, gap between plies, intervals, provenance
    packs.csv            the laws of each record, n free and n = 3
    platen-curve.csv     one ply without the rig, for `weavecell calibrate --platen-curve`
    fabric-keys.toml     what of it a fabric file takes
    compression.svg      records and fitted laws
    shot.json            strike and last velocity, absorbed energy, greatest force, noise, provenance
    motion.csv           displacement, velocity, energy and force at each instant, with errors
    motion.svg           the same
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from fabrics.base.counted import counted
from fabrics.base.frozen import explain_frozen
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from weavecell.answers.study_result import DrawnResult
from weavecell.scenes import result_keys

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from weavecell.studies.compression_records import Estimate, PressureLaw
    from weavecell.studies.displacement_record import Motion

OF_COMPRESSION = (
    *("compression.json", "packs.csv", "platen-curve.csv", "fabric-keys.toml"),
    "compression.svg",
)
OF_SHOT = ("shot.json", "motion.csv", "motion.svg")


@explain_frozen
@dataclass(frozen=True, repr=False)
class CompressionRecords(DrawnResult):
    """Reduced compression records; the table has a row a pack.

    Parameters
    ----------
    free, cubic : `weavecell.studies.compression_records.PressureLaw` of each record, one ply first,
        with n fitted and with n = 3
    gaps : {number of plies: Estimate [m] of the gap}
    cell : {"a" [m], "b" [m N^(1/3)]: Estimate} of one ply over a cell of the fabric, or {}
    fabric : Fabric of that cell, or None
    record : name of the file of one ply

    Examples
    --------
    >>> import numpy as np
    >>> from pathlib import Path
    >>> F = np.geomspace(10, 7000, 40)
    >>> rows = "\\n".join(f"{x}, {0.33 * (10 ** (-1 / 3) - x ** (-1 / 3))}" for x in F)
    >>> _ = Path("ply.csv").write_text("force [N], displacement [mm]\\n" + rows)
    >>> reduced = wc.reduce_compression("ply.csv", platen_area="361 mm^2", cell_of="S-728")
    >>> 1e3 * reduced.cell["a"].value  # [mm] closed from 10 N on  # doctest: +ELLIPSIS
    0.153...
    """

    kind = "compression"

    free: tuple[PressureLaw, ...]
    cubic: tuple[PressureLaw, ...]
    gaps: dict[int, Estimate]
    cell: dict[str, Estimate]
    fabric: Fabric | None
    record: str

    def summary(self) -> dict[str, Any]:
        """Return K'' and n of one ply, a and b of a cell, and the gap of each pack, with
        intervals."""
        one = self.free[0]
        numbers: dict[str, Any] = {
            "exponent": one.exponent,
            "exponent_interval": list(one.intervals()["exponent"]),
            "K_with_n_3_Pa_m3": self.cubic[0].stiffness,
            "K_with_n_3_interval_Pa_m3": list(self.cubic[0].intervals()["stiffness"]),
            "rms_m": one.rms,
        }
        for name, unit in (("a", "m"), ("b", "m_N^(1/3)")):
            if name in self.cell:
                found = self.cell[name]
                numbers[f"{name}_of_a_ply_{unit}"] = found.value
                numbers[f"{name}_of_a_ply_interval_{unit}"] = [found.low, found.high]
        for plies, gap in self.gaps.items():
            numbers[f"gap_of_{plies}_plies_m"] = gap.value
            numbers[f"gap_of_{plies}_plies_interval_m"] = [gap.low, gap.high]
        return numbers

    def _items(self):
        return list(zip(self.free, self.cubic))

    def draw(self, pyplot: Any) -> Figure:
        """Draw closure [um] against pressure [MPa]: records and fitted laws."""
        from weavecell.report import pictures_records

        return pictures_records.draw_compression(pyplot, self.free, f"Compression: {self.record}")

    def files(self) -> dict[str, Any]:
        """Return {file: what it holds} that stands at the top of the module."""
        pressure, closed = self.free[0].curve()
        curve = "".join(f"{1e-6 * P:.6g}, {1e6 * d:.6g}\n" for P, d in zip(pressure, closed))
        return {
            "compression.json": {"format": "weavecell compression 2", **self.summary()},
            "packs.csv": self.to_csv(),
            "platen-curve.csv": f"# {self.record}, smoothed by its law\npressure [MPa], closure [um]\n{curve}",
            "fabric-keys.toml": self.fabric_keys(),
            "compression.svg": None,
        }

    def fabric_keys(self) -> str:
        """Write the keys of a fabric file that follow.

        Raises
        ------
        InputError : one that the reader of fabric files refuses
        """
        lines = [f"# from {self.record} by `weavecell reduce compression`"]
        if self.gaps:
            plies, gap = next(iter(self.gaps.items()))
            lines.append(
                _entry(
                    "interlayer_gap",
                    gap,
                    1e3,
                    "mm",
                    f"packs of 1 and {counted(plies, 'ply')}",
                    self.record,
                )
            )
        if self.cell:
            lines += [
                "",
                "# half of the ply, for each of its two yarns: between platens, at rest in the plane",
            ]
            lines.append("[compression]")
            for name, unit in (("a", "mm"), ("b", "mm * N^(1/3)")):
                lines.append(
                    _entry(
                        f"compression.{name}",
                        self.cell[name],
                        0.5e3,
                        unit,
                        "one ply between platens",
                        self.record,
                    )
                )
        return "\n".join(lines) + "\n"

    def fabric_of_keys(self, fabric: Fabric) -> Fabric:
        """Return a fabric with these keys in place of its own."""
        a, b = (0.5 * self.cell[name].value for name in ("a", "b"))
        law = CompressionLaw(a, b)
        changed = replace(fabric, laws=(law, law))
        if not self.gaps:
            return changed
        return replace(changed, interlayer_gap=next(iter(self.gaps.values())).value)

    _written = OF_COMPRESSION

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        lines = [f"compression of {self.record}"]
        for law, cubic in zip(self.free, self.cubic):
            low, high = law.intervals()["exponent"]
            name = "1 ply"
            if law.plies > 1:
                name = counted(law.plies, "ply")
            lines.append(
                f"{name:<12}n {law.exponent:.2f} ({low:.2f} to {high:.2f}), rms {1e6 * law.rms:.2g} um; "
                f"with n = 3 K'' {cubic.stiffness:.4g} Pa m3, rms {1e6 * cubic.rms:.2g} um"
            )
        for name, factor, unit in (("a", 1e3, "mm"), ("b", 1e3, "mm N^(1/3)")):
            if name in self.cell:
                lines.append(f"{name + ' of a ply':<12}{_spread(self.cell[name], factor)} {unit}")
        for plies, gap in self.gaps.items():
            lines.append(
                f"{'gap':<12}{_spread(gap, 1e3)} mm between plies, of {counted(plies, 'ply')} and one"
            )
        return lines


def _entry(key, found, factor, unit, source, record):
    """A line of a fabric file."""
    value, low, high = (f"{factor * each:.4g}" for each in (found.value, found.low, found.high))
    origin = f"{source}, 95 %: {low} to {high} {unit}"
    return result_keys.entry(
        key, f"{value} {unit}", origin, record, f"{source}: check which file is which"
    )


def _spread(found, factor):
    """A value with its interval, as text."""
    return f"{factor * found.value:.4g} ({factor * found.low:.4g} to {factor * found.high:.4g})"


@explain_frozen
@dataclass(frozen=True, repr=False)
class ShotRecord(DrawnResult):
    """A reduced displacement record; the table has a row an instant.

    Parameters
    ----------
    motion : `weavecell.studies.displacement_record.Motion`
    record : name of its file
    computed : {"time", "velocity", "contact_force": (n,) [SI]} of a shot drawn beside, or None

    Examples
    --------
    >>> from pathlib import Path
    >>> rows = "\\n".join(f"{t}, {0.1 * t - 1e-4 * t**2}" for t in range(0, 200, 2))
    >>> _ = Path("flight.csv").write_text("time [us], displacement [mm]\\n" + rows)
    >>> shot = wc.reduce_shot("flight.csv", mass="3 g", bandwidth="20 kHz")
    >>> len(shot.to_dataframe()), round(shot.summary()["absorbed_energy_J"], 2)
    (100, 9.53)
    """

    kind = "shot"

    motion: Motion
    record: str
    computed: dict[str, Any] | None = None

    def _items(self):
        return self.motion

    def draw(self, pyplot: Any) -> Figure:
        """Draw velocity [m/s] and force [N] in time, with their errors."""
        from weavecell.report import pictures_records

        return pictures_records.draw_motion(
            pyplot, self.motion, f"Flight: {self.record}", self.computed
        )

    def files(self) -> dict[str, Any]:
        """Return {file: what it holds} that stands at the top of the module."""
        return {
            "shot.json": {"format": "weavecell record of a shot 1", **self.summary()},
            "motion.csv": self.to_csv(),
            "motion.svg": None,
        }

    _written = OF_SHOT

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        found = self.summary()
        lines = [f"flight of {self.record}"]
        for name, key, unit, factor in (
            ("first velocity", "first_velocity", "m_s", 1.0),
            ("last velocity", "last_velocity", "m_s", 1.0),
            ("absorbed energy", "absorbed_energy", "J", 1.0),
            ("greatest force", "greatest_force", "N", 1e-3),
        ):
            value = factor * found[f"{key}_{unit}"]
            error = factor * found[f"{key}_error_{unit}"]
            shown = {"m_s": "m/s", "J": "J", "N": "kN"}[unit]
            lines.append(f"{name:<17}{value:.4g} +- {error:.2g} {shown}")
        lines.append(
            f"noise {1e6 * self.motion.noise:.3g} um; bandwidth {1e-3 * self.motion.bandwidth:.3g} kHz, "
            f"{self.motion.chosen}"
        )
        return lines
