"""Records of a laboratory, reduced: compression between platens, and the flight of a projectile.

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
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import catalogue, plausible
from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.errors import InputError
from fabrics.base.frozen import explain_frozen
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from weavecell.answers.result import save_to
from weavecell.answers.study_result import DrawnResult
from weavecell.api import quantities
from weavecell.api.entrance import public
from weavecell.results import out_folder
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
# [-] of the strike energy that the noise of a record may seem to add
_GAIN = 0.05


@public
@out_folder.reading
def reduce_compression(
    record: FilePath,
    *,
    platen_area: float | str,
    pack: list[str] | None = None,
    rig: FilePath | None = None,
    cell_of: Fabric | FilePath | None = None,
    out: FilePath | None = None,
) -> CompressionRecords:
    """Reduce compression tests between platens: the rig taken off, the pressure law fitted, the gap
    between plies.

    RECORD has the columns "force [N]" and "displacement [mm]", or other units of these, of one ply;
    rows after the largest force are unloading and are left out. The law is P = K'' / (t - t_min)^n
    (thesis eq. 2-5), fitted with n free and with n = 3. Of a fabric the law of one cell follows,
    d = a - b / F^(1/3) (eqs. 2-7 to 2-9), and half of it for each of its two yarns. Packs give the
    gap between plies (eq. 5-4).

    Parameters
    ----------
    record : compression record of one ply (``*.csv``)
    platen_area : area of the platen [m2], such as "361 mm^2"
    pack : record of a pack, PLIES=FILE, such as 4=four.csv; may be given again, in Python a list
    rig : record of the test rig without fabric, whose closure is taken off at each load
    cell_of : name of the catalogue, or path of a fabric file, whose cell a and b are for; in Python
        also a Fabric
    out : folder of the results; in Python None writes nothing

    Returns
    -------
    CompressionRecords

    Raises
    ------
    InputError : a wrong record, or one that does not determine the law

    Examples
    --------
    >>> import numpy as np
    >>> from pathlib import Path
    >>> force = np.geomspace(10, 7000, 40)
    >>> closed = 1e3 * (1.1e-7 / 361e-6**-1) ** (1 / 3) * (10 ** (-1 / 3) - force ** (-1 / 3))
    >>> rows = "\\n".join(f"{F}, {d}" for F, d in zip(force, closed))
    >>> _ = Path("ply.csv").write_text("force [N], displacement [mm]\\n" + rows)
    >>> reduced = wc.reduce_compression("ply.csv", platen_area="361 mm^2")
    >>> round(reduced.free[0].exponent, 3)
    3.0
    """
    from weavecell.studies import compression_records as studies

    area = quantities.read_positive(platen_area, "m^2", "platen_area")
    quantities.note([plausible.Number("platen_area", "platen_area", area)])
    read = studies.CompressionRecord.read
    plies = [1]
    records = [read(record)]
    for text in pack or ():
        count, file = quantities.numbered_file("pack", text, "plies", least=2)
        plies.append(count)
        records.append(read(file))
    taken_off = None if rig is None else read(rig)
    _refuse_alike([*records, taken_off] if taken_off else records)
    if taken_off:
        records = [one.without(taken_off) for one in records]
    fabric = None
    if isinstance(cell_of, Fabric):
        fabric = cell_of
    elif cell_of is not None:
        fabric = catalogue.load(cell_of)
    with out_folder.hold(out, OF_COMPRESSION) as folder:
        free = studies.laws_of(records, plies, area, None)
        cubic = studies.laws_of(records, plies, area, studies.CUBE)
        gaps = {law.plies: studies.gap_between(free[0], law) for law in free[1:]}
        cell = {}
        if fabric is not None:
            cell = studies.force_law(cubic[0], fabric.weave.cell_area)
        reduced = CompressionRecords(tuple(free), tuple(cubic), gaps, cell, fabric, str(record))
        # refuses what no fabric file could hold, before anything is written
        reduced.fabric_keys()
        if fabric is not None:
            result_keys.check_fabric(reduced.fabric_of_keys(fabric), fabric, record)
        return save_to(reduced, folder)


def _refuse_alike(records):
    """Refuse a test that is given twice, under one name or another."""
    seen: dict[tuple[bytes, bytes], str] = {}
    for one in records:
        numbers = one.load.tobytes(), one.closed.tobytes()
        if numbers in seen:
            message = f"holds the same numbers as {seen[numbers]}"
            raise InputError(message, file=one.source, allowed="a record of its own")
        seen[numbers] = one.source


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

    def save(self, out: FilePath) -> None:
        """Write the files that stand at the top of the module to a folder."""
        from weavecell.results import provenance

        with out_folder.hold(out, OF_COMPRESSION):
            self._write_files(Path(out), provenance.stamp())

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


@public
@out_folder.reading
def reduce_shot(
    record: FilePath,
    *,
    mass: float | str,
    bandwidth: float | str | None = None,
    computed: FilePath | None = None,
    out: FilePath | None = None,
) -> ShotRecord:
    """Reduce the displacement record of a projectile to velocity, energy and force, with errors.

    RECORD has the columns "time [us]" and "displacement [mm]", or other units of these, along the
    flight, of a high-speed camera or a light curtain. It is smoothed by a spline with a stated
    bandwidth. The errors have what noise of the record leaves and what the spline takes off.

    Parameters
    ----------
    record : displacement record of a shot (``*.csv``)
    mass : of the projectile [kg], such as "3 g"
    bandwidth : frequency of which half is left [Hz], such as "20 kHz"; by cross-validation if it is
        not given
    computed : folder of `weavecell impact`, whose velocity and force are drawn beside
    out : folder of the results; in Python None writes nothing

    Returns
    -------
    ShotRecord

    Raises
    ------
    InputError : a wrong record, a bandwidth that it does not resolve, or no computed shot

    Examples
    --------
    >>> import numpy as np
    >>> from pathlib import Path
    >>> t = np.arange(0, 200, 2.0)  # [us]
    >>> rows = "\\n".join(f"{t}, {0.1 * t - 1e-4 * t**2}" for t in t)
    >>> _ = Path("flight.csv").write_text("time [us], displacement [mm]\\n" + rows)
    >>> shot = wc.reduce_shot("flight.csv", mass="3 g", bandwidth="20 kHz")
    >>> round(float(shot.motion.velocity[0]), 3), round(float(shot.motion.force[0]), 2)
    (100.0, 600.0)
    """
    from weavecell.studies import displacement_record as studies

    weight = quantities.read_positive(mass, "kg", "mass")
    quantities.note([plausible.Number("mass", "projectile_mass", weight)])
    highest = None
    if bandwidth is not None:
        highest = quantities.read_positive(bandwidth, "Hz", "bandwidth")
    beside = None
    if computed is not None:
        beside = _histories(computed)
    time, displacement = studies.read(record)
    with out_folder.hold(out, OF_SHOT) as folder:
        if not np.ptp(displacement) > 0:
            allowed = "that of a projectile which moves"
            value = f"{displacement[0]:g} m throughout"
            raise InputError(file=record, key="displacement", value=value, allowed=allowed)
        motion = studies.reduce(time, displacement, weight, highest)
        advice = "the record: check its columns and the sign of the displacement"
        strike = motion.velocity[0]
        if not strike > 0:
            message = f"gives a strike velocity of {strike:.4g} m/s, of {advice}"
            raise InputError(message, file=record, allowed="above 0")
        if motion.velocity[-1] ** 2 > (1 + _GAIN) * strike**2:
            message = f"is faster at its end, {motion.velocity[-1]:.4g} m/s than at the strike, {strike:.4g} m/s"
            allowed = "a flight that fabric does not speed up: check its columns"
            raise InputError(message, file=record, allowed=allowed)
        fastest = float(np.abs(motion.velocity).max())
        quantities.note([plausible.Number("velocity", "record_speed", fastest)], record)
        return save_to(ShotRecord(motion, str(record), beside), folder)


def _histories(folder):
    """{"time", "velocity", "contact_force": (n,)} of the folder of a shot."""
    from weavecell.results.result_folder import HISTORIES, open_folder

    allowed = "a folder of weavecell impact, with its histories.h5"
    if not (Path(folder) / HISTORIES).is_file():
        raise InputError(key="computed", value=str(folder), allowed=allowed)
    return open_folder(folder).read_histories("time", "velocity", "contact_force")


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

    def save(self, out: FilePath) -> None:
        """Write the files that stand at the top of the module to a folder."""
        from weavecell.results import provenance

        with out_folder.hold(out, OF_SHOT):
            self._write_files(Path(out), provenance.stamp())

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
