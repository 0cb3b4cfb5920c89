"""Which contact law the plies of a fabric have (`fabrics.ply_law`).

`default` takes the first that there is:

1. the fabric's own law ([ply_contact] of its file), such as the platen curve of its 3D crossover, "computed";
2. solid fibre alone, "assumed".

The pressure law of packs of the thesis (`of_packs`, "fitted") is used where it is named.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fabrics import law_file
from fabrics.assumed import family_of, transverse_moduli, with_solid_laws
from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.errors import InputError, placed
from fabrics.base.tables import read_columns
from fabrics.base.units import si
from fabrics.fabric import Fabric
from fabrics.fabric_tables import STATUSES
from fabrics.plate_curve import PlateCurve
from fabrics.ply_law import SOLID_TRAVEL, PlyLaw

# the thesis takes the contact of plies from packs of so many plies (section 5.2.2)
TESTED = 4
_TABLE = ("closure", "pressure", "source", "status")
UNITS = {"closure": "m", "pressure": "Pa"}


def default(fabric: Fabric) -> PlyLaw:
    """Choose the law of a fabric: the first source of the list above that it has.

    Raises
    ------
    InputError : as `solid_fibre`
    """
    if fabric.ply_contact is None:
        return solid_fibre(fabric)
    return fabric.ply_contact


def choose(choice: PlyLaw | FilePath, fabric: Fabric) -> PlyLaw:
    """Return the law that a user names: "solid", "pressure_law", or a file (see `read`); a PlyLaw
    is returned as it is.

    Raises
    ------
    InputError : as `solid_fibre`, `of_packs` and `read`
    """
    if isinstance(choice, PlyLaw):
        return choice
    if choice in NAMED:
        return NAMED[str(choice)](fabric)
    return read(choice, fabric)


def fitted_data(choice: PlyLaw | FilePath) -> str:
    """Digest the data that a law.json was fitted to; empty of any other choice, and if it is not
    known."""
    if isinstance(choice, PlyLaw) or choice in NAMED or Path(choice).suffix == ".csv":
        return ""
    return str(law_file.read(choice).get("fitted_data", ""))


def of_packs(fabric: Fabric) -> PlyLaw:
    """Compute the pressure law of packs (thesis eqs. 5-1 to 5-4), "fitted" to tests of Kevlar 129
    plain weaves.

    Its closure counts from the 10 N on the platen at which the records begin (erratum E-02), and so
    does its pressure here: 28 kPa less than that of the test, 0.1 % at its end.

    Raises
    ------
    InputError : other than para-aramid yarns or plain weave, no measured areal density, or one too low
        for the law
    """
    fabric.weave.require_plain("the pressure law of packs, which plain weaves were tested for")
    family = family_of(fabric)
    if family is None or family.of_others or family.name != "para-aramid":
        raise InputError(
            key="ply_contact",
            value="pressure_law",
            allowed="of para-aramid yarns, which were tested",
        )
    if fabric.areal_density_measured is None:
        raise InputError(
            f"fabric {fabric.name} has no areal_density_measured, which the pressure law needs"
        )
    pressure, closure = between_plies(fabric.areal_density_measured)
    source = f"pressure law of packs, thesis eqs. 5-1 to 5-4, at {1e3 * fabric.areal_density_measured:.1f} g/m2"
    return PlyLaw(closure, pressure - pressure[0], solid_fibre(fabric).stiffness, source, "fitted")


def read(path: FilePath, fabric: Fabric) -> PlyLaw:
    """Read the law of a file; beyond its last row it continues as solid fibre of the fabric.

    Parameters
    ----------
    path : law.json of `weavecell calibrate`, or a CSV file of two columns whose first line names
        them with their units, such as closure [um], pressure [MPa], and whose first row is 0, 0

    Raises
    ------
    InputError : one line naming the file, the key, the value and what is allowed
    """
    path = Path(path)
    if path.suffix == ".csv":
        columns = read_columns(
            path,
            UNITS,
            what="a contact law of plies",
            example="closure [um]",
        )
        return _checked(columns, path.name, "user", fabric, path, "")
    content = law_file.read(path)
    table = content.get("ply_contact")
    stated = content.get("fabric", "")
    if table is None:
        raise InputError("has no ply_contact", file=path, allowed="a law of `weavecell calibrate`")
    if stated not in ("", fabric.name):
        raise InputError(
            file=path,
            key="fabric",
            value=stated,
            allowed=f"{fabric.name}, or a CSV file of its curve",
        )
    return from_table(table, fabric, path)


def stands_in(path: FilePath) -> bool:
    """Tell whether a law.json holds a contact law of plies too; False also if it cannot be read."""
    try:
        return law_file.read(path).get("ply_contact") is not None
    except InputError:
        return False


def from_table(table: Any, fabric: Fabric, file: FilePath) -> PlyLaw:
    """Read the law of a table `ply_contact`: closure and pressure as lists of texts with units,
    source and status.

    A table { file = "curve.csv" } names a file beside it (`read`).

    Raises
    ------
    InputError : as `read`
    """
    if not isinstance(table, Mapping) or not (set(table) <= set(_TABLE) or set(table) == {"file"}):
        wrong = table
        if isinstance(table, Mapping):
            wrong = ", ".join(table)
        raise InputError(
            file=file, key="ply_contact", value=wrong, allowed=f"file, or {', '.join(_TABLE)}"
        )
    if set(table) == {"file"}:
        return read(Path(file).parent / str(table["file"]), fabric)
    columns = {}
    for key, unit in UNITS.items():
        texts = table.get(key)
        name = f"ply_contact.{key}"
        if not isinstance(texts, list):
            raise InputError(
                file=file, key=name, value=texts, allowed=f'a list of texts such as "1 {unit}"'
            )
        columns[key] = np.array([si(text, unit, file=file, key=name) for text in texts])
    return _checked(
        columns, table.get("source", Path(file).name), table.get("status", "user"), fabric, file
    )


def _checked(columns, source, status, fabric, file, where="ply_contact."):
    """A law whose errors name the file."""
    if status not in STATUSES:
        raise InputError(
            file=file, key=f"{where}status", value=status, allowed=f"one of {', '.join(STATUSES)}"
        )
    stiffness = solid_fibre(fabric).stiffness
    with placed(file, where):
        return PlyLaw(columns["closure"], columns["pressure"], stiffness, source, status)


def solid_fibre(fabric: Fabric) -> PlyLaw:
    """Compute the law of solid fibre from the first touch on, for a fabric of which no travel is
    known; its status is "assumed".

    Between the two faces of a ply lie its warp and its weft, each as a solid sheet of its mass, in
    series:

        1 / K = sum over both of A / (rho_f E_c)

    with A = areal density of one yarn family.

    Raises
    ------
    InputError : no transverse modulus, given or of a known family of fibres (`fabrics.assumed`)
    """
    laws = with_solid_laws(fabric).solid_laws
    assert laws is not None
    give = _give(fabric, [law.E_c for law in laws])
    samples = np.array([0.0, SOLID_TRAVEL])
    return PlyLaw(
        samples, samples / give, 1 / give, "solid fibre, E_c rho_f / areal density", "assumed"
    )


def half_a_ply(fabric: Fabric) -> float:
    """Compute the stiffness [Pa/m] of half a ply of solid fibre, which a nose presses on: twice that
    of `solid_fibre`; of yarns of no known family with the lowest modulus of all families."""
    return 2 / _give(fabric, transverse_moduli(fabric))


def _give(fabric, moduli):
    """[m/Pa] closure of a ply of solid fibre by the pressure, with transverse moduli (warp, weft)
    [Pa]."""
    weave = fabric.weave
    return sum(
        length * yarn.linear_density / weave.cell_area / (yarn.fibre_density * modulus)
        for length, yarn, modulus in zip(weave.S0, weave.yarns, moduli)
    )


def between_plies(areal_density: float, plies: int = TESTED) -> tuple[FloatArray, FloatArray]:
    """Compute pressure [Pa] and closure [m] of two neighbouring plies of a pack (thesis eqs. 5-1 to
    5-4, erratum E-02).

    A pack of N plies closes d_N = 2 d_m + (N - 1) d_f between platens, one ply d_1 = 2 d_m, with
    d_m between a middle surface and a platen and d_f between two middle surfaces: d_f = (d_N - d_1)
    / (N - 1).

    Parameters
    ----------
    areal_density : [kg/m2] of one ply, measured
    plies : of the pack that was pressed: 4, 8 or 16

    Raises
    ------
    InputError : as PlateCurve.pressure_law
    """
    pack, single = (PlateCurve.pressure_law(areal_density, count) for count in (plies, 1))
    return single.pressure, (pack.closure - single.closure) / (plies - 1)


NAMED = {"solid": solid_fibre, "pressure_law": of_packs}


def packing_stiffness(fabric: Fabric) -> float:
    """Compute the stiffness [N/m] of a ply, in its plane, as solid fibre: the sum over both yarns
    of E_c A / rho_f

    with A = areal density of one yarn family, rho_f the density of its fibre and E_c its transverse
    modulus.
    """
    weave = fabric.weave
    return sum(
        E_c * length * yarn.linear_density / (weave.cell_area * yarn.fibre_density)
        for E_c, length, yarn in zip(transverse_moduli(fabric), weave.S0, weave.yarns)
    )
