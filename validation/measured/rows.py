"""The table of what was measured, and what its rows compute to.

Columns of rows.csv. `measure` is one of `compute`, `input` a file of inputs/; a row without them is not
computed, and `assumed` says why. `changes` are keys of the input file, and options of the measure (without a dot), of
this row; `coarse` those of its cheap run as well, "-" where there is none. `value` and `sigma`, the standard
uncertainty of the test, are in `unit`; `u_input` is that of the computed value by the uncertainty of the input,
relative to it. `cloth` names what numbers share that are predicted, `ranges` keys of the input file that drawn shots
have a range of. The quantity of an outcome that no text states, but the caption of a simulation beside the test, begins
with "inferred".
"""

from __future__ import annotations

import csv
import tomllib
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from pandas import to_numeric

import weavecell as wc
from fabrics import metals
from fabrics.base import run_cache
from fabrics.base.units import si
from fabrics.fabric import Fabric
from fabrics.plate_curve import PlateCurve
from fabrics.variants import with_solids
from meshing import crossover as mesher
from shellfabric.projectile.turned import Turned
from unitcell3d.identify.platen_misfit import closures
from unitcell3d.model.crossover import Numerics
from validation import csv_file
from validation.cases.solid import PACKING, pressed
from validation.measured import statistics
from validation.models.bare_impact import Strike, strike
from validation.models.taylor_bar import Taylor, strike_wall
from validation.values import Values, largest
from weavecell.api import target
from weavecell.studies import ballistic_limit, pack_limit

HERE = Path(__file__).parent
SOLIDS = (
    csv_file.DATA / "calibration-chain.csv"
)  # of six fabrics, each fitted to its own platen curve
OF_SOLIDS = "E_c [GPa], 95 %", "V_c, 95 %", "K_r, 95 %"  # its columns
CLOSURES = "closure_below", "closure_above"  # measures: what platens close below PACKING, and above
DRAWN = "v50"  # measure of a number that shots are drawn for (`validation.measured.scored`)


@dataclass(frozen=True)
class Case:
    """What a row computes.

    Parameters
    ----------
    measure : of `compute`, or DRAWN
    input : name of a file of inputs/
    text : of that file and of the fabrics, since a kept result depends on them
    changes : ((key, value), ...) of the input file, or without a dot options of the measure
    ranges : ((key, value), ...) of the input file that drawn shots have in place of one number
    """

    measure: str
    input: str
    text: str
    changes: tuple[tuple[str, str], ...] = ()
    ranges: tuple[tuple[str, str], ...] = field(default=(), metadata=run_cache.ADDED_LATER)

    @property
    def options(self) -> dict[str, str]:
        """Options of the measure."""
        return {key: value for key, value in self.changes if "." not in key}

    @property
    def keys(self) -> Values:
        """{dotted key: value} of the input file that this row changes."""
        return {key: _value(text) for key, text in self.changes if "." in key}

    @property
    def scene(self) -> Values:
        """The tables of the input file with these changes."""
        return target.change_keys(tomllib.loads(self.text.partition("\f")[0]), self.keys)

    def setup(self, **more: Any) -> Any:
        """Build the ImpactSetup of an impact, with `more` values of dotted keys."""
        return self._read(more).setup

    def resolved(self, **more: Any) -> Any:
        """Build the ImpactSetup of drawn shots: of resolved yarns where `v50` has them, with the ranges of the row."""
        ranges = {key: _value(text) for key, text in self.ranges}
        return self._read(ranges | more).resolved().setup

    def _read(self, more):
        file = HERE / "inputs" / f"{self.input}.toml"
        changes = {"numerics.threads": 1} | self.keys | more
        return target.read_target(str(file), HERE, "shot", changes=changes)


@dataclass(frozen=True)
class Row:
    """A row of rows.csv, its columns as texts; `case` and `coarse_case` are None where there is no such run."""

    id: str
    level: str
    quantity: str
    value: str
    unit: str
    sigma: str
    u_input: str
    source: str
    assumed: str
    cloth: str = ""
    case: Case | None = None
    coarse_case: Case | None = None


def number(text: str) -> float:
    """Read the number in a text; NaN of an outcome, or if there is none."""
    return float(to_numeric(text, errors="coerce"))


def read() -> list[Row]:
    """Read all rows."""
    with open(HERE / "rows.csv", encoding="utf-8", newline="") as file:
        return [_row(**columns) for columns in csv.DictReader(file)]


def _row(measure, input, changes, coarse, ranges, **columns):
    if not measure:
        return Row(**columns)
    own = _changes(changes)
    cheap = None
    if coarse != "-":
        cheap = case_of(measure, input, own + _changes(coarse))
    case = replace(case_of(measure, input, own), ranges=_changes(ranges))
    return Row(**columns, case=case, coarse_case=cheap)


def _changes(text):
    """((key, value), ...) of "key = value; key = value"."""
    pairs = []
    for part in text.split(";"):
        key, _, value = part.partition("=")
        if value:
            pairs.append((key.strip(), value))
    return tuple(pairs)


def case_of(measure: str, name: str, changes: tuple[tuple[str, str], ...]) -> Case:
    """Make the Case of a measure of an input file, with its changes."""
    files = [HERE / "inputs" / f"{name}.toml", *sorted((HERE / "inputs" / "fabrics").iterdir())]
    if measure in CLOSURES:
        files.append(SOLIDS)
    return Case(measure, name, "\f".join(file.read_text("utf-8") for file in files), changes)


def _value(text):
    """A value as TOML has it; what is none is a text."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text


# {measure: value in the unit of the row} of a wc.ShotResult, of a Strike at a bare block, of a Taylor bar, of a Fabric
OF_SHOTS: dict[str, Callable[[Any], Any]] = {
    "outcome": lambda shot: shot.outcome,
    # the largest displacement of a yarn's end out of its clamp
    "slip": lambda shot: 1e3 * float(shot.plies["pull_in"].max()),
    "torn_plies": lambda shot: float(np.count_nonzero(shot.plies["cut_yarns"][-1])),
}
OF_BLOCKS: dict[str, Callable[[Strike], float]] = {
    "depth": lambda found: 1e3 * float(found.z.max()),
    # a test measures the dent at rest: one that still moves is none
    "dent": lambda found: 1e3 * float(found.block.back_face_signature or np.nan),
}
OF_BARS: dict[str, Callable[[Taylor], float]] = {
    "bar_length": lambda bar: 1e3 * bar.length,
    "bar_width": lambda bar: 1e3 * bar.width,
}
OF_FABRICS: dict[str, Callable[[Fabric], float]] = {
    "areal_density": lambda fabric: 1e3 * fabric.weave.areal_density,
    "thickness": lambda fabric: 1e3 * fabric.weave.thickness,
}


def compute(case: Case) -> tuple[Any, float, float]:
    """Compute a case: (value in the unit of the row, or an outcome; its standard error; error of
    the energy balance [-])."""
    if case.measure in OF_SHOTS:
        shot = wc.impact(case.setup())
        return OF_SHOTS[case.measure](shot), 0.0, shot.energy_error_max
    if case.measure in OF_BLOCKS:
        found = _strike(case)
        error = largest(found.energies["error"]) / found.energies["projectile"][0]
        return OF_BLOCKS[case.measure](found), 0.0, error
    if case.measure in OF_BARS:
        bar = _taylor(case)
        return OF_BARS[case.measure](bar), 0.0, bar.energy_error
    if case.measure == "limit":
        return _limit(case)
    if case.measure == "growth":
        return _growth(case)
    table = case.scene["fabric"]
    fabric = wc.fabric(table["name"], linear_density=table["linear_density"])
    if case.measure in OF_FABRICS:
        return OF_FABRICS[case.measure](fabric), 0.0, 0.0
    part = CLOSURES.index(case.measure)
    middle, error = statistics.of_one_more(_closures(case, fabric))
    return middle[part], error[part], 0.0


def _limit(case, **more):
    """[m/s] velocity between a stop and a perforation of a pack, looked for from the measured V50; its standard error,
    of the bracket and of the scatter of single shots."""
    setup = case.setup(**more)
    width = float(case.options.get("tolerance", 0.03))
    guess = setup.strike_velocity
    found = ballistic_limit.critical_velocity(
        setup.target(), tolerance=width * guess, guess=guess, step=1 + width
    )
    error = float(np.hypot(found.half_width, pack_limit.SCATTER * found.velocity))
    return found.velocity, error, max(shot.balance for shot in found.shots)


def _growth(case):
    """[-] limit of the pack over that of two plies."""
    many = _limit(case)
    few = _limit(case, **{"panel.plies": 2, "projectile.strike_velocity": "240 m/s"})
    ratio = many[0] / few[0]
    return ratio, ratio * float(np.hypot(many[1] / many[0], few[1] / few[0])), max(many[2], few[2])


def _strike(case):
    """What a projectile does to the bare block of a file with the tables [projectile] and [backing] alone."""
    shot = dict(case.scene["projectile"])
    backing = case.scene["backing"]
    setup = wc.setup(
        "S-728", shot.pop("strike_velocity"), opening="200 mm", projectile=shot, backing=backing
    )
    return strike(
        setup.backing, setup.projectile, setup.strike_velocity, 0.03, after=setup.backing.after_stop
    )


def _taylor(case):
    """The Taylor bar of a file with the table [bar] alone."""
    table = case.scene["bar"]
    size = {key: si(table[key], "m") for key in ("diameter", "length", "element_size")}
    bar = Turned(
        size["diameter"] / 2,
        size["length"],
        metals.load(table["metal"]),
        element_size=size["element_size"],
    )
    return strike_wall(bar, si(table["velocity"], "m/s"))


def _closures(case, fabric):
    """(n, 2) [um] what the 3D crossover closes between platens up to PACKING, and from there to the highest
    pressure, by each of the n solids that platens of the other fabrics give."""
    law = PlateCurve.pressure_law(fabric.areal_density_measured)  # pressures of the test
    ends = np.array([law.pressure[0], PACKING, law.pressure[-1]])
    mesh = mesher.build(fabric, size=tuple(map(int, case.options.get("size", "6 4 2").split())))
    found = []
    for constants in _solids_of_others(fabric.name):
        # V_c of a fit belongs to the fibre fraction of its mesh: what it leaves to close is taken over
        V_c = constants["V_c"] + max(mesh.Vf0)
        solid = with_solids(fabric, E_c=constants["E_c"], K_r=constants["K_r"], V_c=V_c)
        history = pressed(mesh, solid, Numerics(fibre_fraction="mesh"))
        found.append(np.diff(closures(history, fabric.weave.cell_area, ends, law.at(ends))))
    return 1e6 * np.array(found)


def _solids_of_others(name):
    """[{E_c [Pa], K_r, V_c less the fibre fraction at rest}] of SOLIDS, without the fabric that is computed."""
    found = []
    for row in csv_file.read(SOLIDS)[1]:
        if row["fabric"] != name:
            mesh = mesher.build(wc.fabric(row["fabric"]), size=(4, 3, 1))
            E_c, V_c, K_r = (number(row[key].partition("/")[0]) for key in OF_SOLIDS)
            found.append({"E_c": 1e9 * E_c, "K_r": K_r, "V_c": V_c - max(mesh.Vf0)})
    return found
