"""Records of a laboratory, reduced: compression between platens, and the flight of a projectile."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fabrics import catalogue, plausible
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.fabric import Fabric
from weavecell.answers.records import OF_COMPRESSION, OF_SHOT, CompressionRecords, ShotRecord
from weavecell.answers.result import save_to
from weavecell.api import quantities
from weavecell.api.entrance import public
from weavecell.results import out_folder
from weavecell.scenes import result_keys

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
