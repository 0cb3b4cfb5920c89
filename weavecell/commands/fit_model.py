"""What `weavecell fit` fits: a table of measured points, and the runs of an input file that give the same points."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext, redirect_stdout
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from fabrics import run_cache
from fabrics.checks import FilePath, FloatArray
from fabrics.errors import InputError, UndecidedError, UnstableError
from fabrics.files import read_columns, read_csv
from fabrics.units import si
from weavecell.analysis import fired_tests
from weavecell.analysis import fit as analysis
from weavecell.analysis.fit import Fit, Parameter
from weavecell.analysis.uncertainty import inputs
from weavecell.results import coupon_measures
from weavecell.scenes import build, of_commands, supported, target
from weavecell.scenes import coupon as scenes_coupon
from weavecell.scenes import impact as scenes
from weavecell.scenes.schema import unit_of

RANGE = 0.5, 2.0  # of what the file has, where a parameter is sought if nothing else is given
# columns of a coupon's table: what is prescribed, then loads, with their SI units
COLUMNS = {
    "bias_extension": {"elongation": "m", "load": "N"},
    "picture_frame": {"shear angle": "rad", "shear stress": "Pa"},
    "uniaxial": {"strain of the strip": "", "load": "N"},
    "biaxial": {"strain of the cross": "", "load of a warp yarn": "N", "load of a weft yarn": "N"},
    "pull_out": {"displacement of the crosshead": "m", "load": "N"},
}
# of the factors on a fabric, the numbers of its file that they change: key, attribute of a yarn or law, unit
YARNS = ("warp", "weft")
NUMBERS = {
    "modulus": tuple((f"{yarn}.modulus", k, "E", "Pa") for k, yarn in enumerate(YARNS)),
    "failure_strain": tuple((f"{yarn}.failure_strain", k, "failure_strain", "") for k, yarn in enumerate(YARNS)),
    "crimp_warp": (("warp.crimp", 0, "crimp", ""),),
    "crimp_weft": (("weft.crimp", 1, "crimp", ""),),
    "compression_a": (("compression.a", None, "a", "m"),),
    "compression_b": (("compression.b", None, "b", "m * N**(1/3)"),),
    "trellis_stiffness": (("shear.G1", None, "G1", "Pa"), ("shear.G2", None, "G2", "Pa")),
    "trellis_angles": (("shear.gamma1", None, "gamma1", ""), ("shear.gamma2", None, "gamma2", "")),
}


@dataclass(frozen=True)
class Data:
    """Measured points.

    Parameters
    ----------
    kind : "velocity", "tests", or a test on a coupon
    x : (name, unit, (n,)) of the abscissa
    columns : {name: (n,)} of the ordinates, all in `unit`
    source : name of the file
    """

    kind: str
    x: tuple[str, str, FloatArray]
    columns: dict[str, FloatArray]
    unit: str
    source: str

    @property
    def measured(self) -> FloatArray:
        """The points of all columns, one column after the other."""
        return np.concatenate(list(self.columns.values()))

    @property
    def scale(self) -> FloatArray:
        """The largest of each column, at each of `measured`."""
        return np.concatenate([np.full(len(y), np.abs(y).max()) for y in self.columns.values()])


def solve(
    model: Model, free: Sequence[str], report: Callable[[int, float], object] = lambda trials, rms: None, **runs: Any
) -> Fit:  # fmt: skip
    """The Fit of what `free` names to the points of a Model.

    Parameters
    ----------
    free : as of `fit`
    report : as of `weavecell.analysis.fit.solve`
    runs : folder, executor and jobs of `fabrics.run_cache.results`
    """
    parameters = [model.parameter(text) for text in free]
    names = [one.name for one in parameters]
    if not names or len(set(names)) < len(names):
        allowed = f"given, each once: {', '.join(NUMBERS)}, or a key of the input file"
        raise InputError(key="--free", value=", ".join(free) or "none", allowed=allowed)
    model.at({one.name: one.start for one in parameters})  # what does not fit together is refused before a run
    points = model.points

    def evaluate(many):
        settings = [model.at(dict(zip(names, map(float, values)))) for values in many]
        asked = [(points.kind, one, points.x[2], *points.columns) for one in settings]
        return run_cache.results(computed, asked, **runs)

    return analysis.solve(evaluate, parameters, points.measured, points.scale, report)


def computed(kind: str, given: Any, x: FloatArray, *names: str) -> FloatArray:
    """Computed points of a run, as `Data.measured`; NaN of one that became unstable or was left undecided."""
    from shellfabric.impact import ballistic_limit, simulation

    try:
        if kind == "velocity":
            result = simulation.run(given)
            return np.interp(x, result.t, result.v)
        if kind == "tests":
            strikes, where = np.unique(x, return_inverse=True)
            shots = ballistic_limit.shoot(given.target(), strikes)
            return np.array([shot.residual_velocity for shot in shots])[where]
        moved, loads = _pulled(kind, **given)
        return np.concatenate([np.interp(x, moved, loads[name]) for name in names])
    except (UnstableError, UndecidedError):
        return np.full(len(x) * len(names), np.nan)


def _pulled(test, fabric, laws, cell, inputs, run, bending):
    """(what is prescribed, {name: load}) of a test on a coupon."""
    from shellfabric.cell.model import CellModel
    from weavecell.results import pull_out
    from weavecell.results.coupon_measures import measures

    table = CellModel(fabric, laws, *cell).table(coupon_measures.TABLE_SIZE)
    if test == "pull_out":
        curve = pull_out.run(table, SimpleNamespace(**inputs), bending=bending)
        return curve.displacement, {"load": curve.load}
    result = coupon_measures.relaxed(table, test, inputs, **run)
    return result.prescribed, {key: y for key, (_, y) in measures(test, SimpleNamespace(**inputs), result).items()}


class Model:
    """An input file with some of its numbers open; of a fabric, whose name or file may be given, the standard one.

    Parameters
    ----------
    name, out : as of `fit`
    points : Data
    """

    def __init__(self, name: str, points: Data, out: Path) -> None:
        self.name, self.points, self.out = name, points, out
        self.test = points.kind if points.kind in COLUMNS else ""
        self.case, self.setup, self.text = self._read({}, quiet=False)
        self.fabric, self.title = self.case.fabric, self.case.fabric.name
        x, unit, at = points.x
        if self.test and self.test != "pull_out":
            most = {"bias_extension": "elongation", "picture_frame": "shear_angle"}.get(self.test, "strain")
            self._within(x, unit, at, f"{self.test}.{most}", float(np.max(getattr(self.case.scene.test_table, most))))
        elif self.test:
            self._within(x, unit, at, "pull_out.displacement", self.case.scene.pull_out.displacement)
        elif points.kind == "velocity":
            self._within(x, unit, at, "run.end_time", self.setup.end_time)

    def _within(self, x, unit, at, key, most):
        """InputError where the data go further than the run."""
        if at.max() > most * (1 + 1e-9):
            allowed = f"at most {most:g} {unit}, {key} of {self.name}".replace("  ", " ")
            raise InputError(file=self.points.source, key=x, value=f"{at.max():g} {unit}".strip(), allowed=allowed)

    def parameter(self, text: str) -> Parameter:
        """The Parameter of a text NAME or NAME=LOW..HIGH."""
        name, mark, ends = (part.strip() for part in text.partition("="))
        if name in NUMBERS:
            self._may_scale(name)
            start, unit, convert = 1.0, "", float
        else:
            start, unit, convert = self._key(name)
        low, dots, high = (part.strip() for part in ends.partition(".."))
        if not mark and not (start is not None and start > 0):
            raise InputError(
                key="--free", value=text, allowed=f"{name}=LOW..HIGH: {self.name} has no number above 0 there"
            )
        if mark and not (dots and low and high):
            raise InputError(key="--free", value=text, allowed='NAME or NAME=LOW..HIGH, such as "modulus=0.8..1.2"')
        try:
            first, last = (convert(end) for end in (low, high)) if mark else (share * start for share in RANGE)
        except ValueError:
            raise InputError(key="--free", value=text, allowed=f"{name}=LOW..HIGH, two numbers") from None
        if start is None:
            start = 0.5 * (first + last)
        return Parameter(name, unit, first, last, start)

    def _may_scale(self, name):
        """InputError where a factor on the fabric has nothing to act on."""
        if self.setup is not None and self.setup.lay_up:
            raise InputError(
                key="--free", value=name, allowed="a key of the input file: its plies are of several fabrics"
            )
        law = self.case.scene.fabric.law
        if name.startswith("compression") and law != "published":
            raise InputError(
                key="--free", value=name, allowed="fabric.law.a, fabric.law.b: the input file has its own law"
            )
        if name.startswith("trellis") and self.fabric.shear is None:
            raise InputError(key="--free", value=name, allowed="left out: the fabric has no trellis law")
        if name.startswith("compression") and self.case.scene.fabric.cell_model != "compressible":
            raise InputError(key="--free", value=name, allowed="left out: the yarns are not compressed")

    def _key(self, name):
        """(value or None, unit, conversion from text) of a numeric key of the input file."""
        entry = supported.entries(type(self.case.scene)).get(name)
        value, unit = self.case.scene, unit_of(entry)
        for part in name.split("."):
            value = getattr(value, part, None)
        wrong = isinstance(value, (bool, str, tuple)) or (
            unit is None and value is not None and not isinstance(value, float)
        )
        if entry is None or wrong:
            allowed = f"{', '.join(NUMBERS)}, or a key of the input file that holds a number"
            raise InputError(key="--free", value=name, allowed=allowed)
        unit = {"1": "", None: ""}.get(unit, unit)
        return value, unit, lambda text: si(text, unit, key="--free")

    def at(self, values: Mapping[str, float]) -> Any:
        """The argument `given` of `computed` with values of the parameters."""
        factors = {name: value for name, value in values.items() if name in NUMBERS}
        case, setup, _ = self._read(self.changes(values))
        if not self.test:
            setup = inputs.alone(inputs.changed_setup(setup, **factors) if factors else setup)
            if self.points.kind == "velocity":
                setup = replace(setup, end_time=float(self.points.x[2].max()) * 1.001)
            return setup
        scene, cloth = case.scene, case.scene.fabric
        fabric, laws = inputs.changed_with_laws(case.fabric, case.laws, **factors)
        return {
            "fabric": fabric, "laws": laws, "cell": build.cell_of(cloth), "inputs": dict(scene.test_table),
            "run": scene.run.model_dump(exclude={"outputs"}), "bending": cloth.bending,
        }  # fmt: skip

    def changes(self, values: Mapping[str, float]) -> dict[str, Any]:
        """{key: value as it is written} of the parameters that are keys of the input file."""
        entries, found = supported.entries(type(self.case.scene)) if values else {}, {}
        for name, value in values.items():
            if name not in NUMBERS:
                unit = unit_of(entries[name])
                found[name] = value if unit is None else f"{value:.9g} {'' if unit == '1' else unit}".strip()
        return found

    def _read(self, changes, quiet=True):
        """(Case, ImpactSetup or None, text) of the input file with other values of keys."""
        with redirect_stdout(io.StringIO()) if quiet else nullcontext():
            if not self.test:
                check = of_commands.FIT if self.points.kind == "velocity" else of_commands.LIMITS
                one = target.read(self.name, self.out, check, changes=changes)
                self.from_file = one.from_file
                return one.case, one.setup, one.text
            self.from_file = True
            text, table = scenes.read_toml(self.name, what="scene")
            scene = scenes_coupon.check(target.changed(table, changes), self.name, of_commands.FIT_COUPON)
            return build.build(scene, Path(self.name), Path(self.name).stem), None, text


def heading_of(data: FilePath) -> list[str]:
    """The cells of the first line of a CSV file that is no comment; none of a file that cannot be read."""
    try:
        return next((cells for _, cells in read_csv(data, "measured data")), [])
    except InputError:
        return []


def read(name: str, data: FilePath) -> Data:
    """The Data of a table, of the kind that the input file and the heading say."""
    test = None
    if name.endswith(".toml"):
        table = scenes.read_toml(name, what="scene or fabric")[1]
        test = next((one for one in scenes_coupon.TESTS if one in table), None)
    if test is not None:
        return _columns(data, test, COLUMNS[test])
    if any(cell.partition("[")[0].strip() == "time" for cell in heading_of(data)):
        return _columns(data, "velocity", {"time": "s", "velocity": "m/s"})
    tests = fired_tests.FiredTests.read(data)
    known = np.isfinite(tests.residual)
    if not tests.residual[known].any():
        allowed = "measured, of one perforation at least"
        raise InputError(file=data, key=fired_tests.RESIDUAL, value="none", allowed=allowed)
    x, columns = ("velocity", "m/s", tests.velocity[known]), {fired_tests.RESIDUAL: tests.residual[known]}
    return Data("tests", x, columns, "m/s", Path(data).name)


def _columns(data, kind, units):
    """The Data of a curve: the first of `units` {name: unit} over which one at least of the others stands."""
    first, *others = units
    shown = " and ".join((first, " or ".join(others)))
    table = read_columns(
        data, units, what="a measured curve", content=f"a curve: {shown}",
        heading=f"{shown}, each with its unit, such as {first} [{units[first] or '%'}]",
        accepts=lambda names: first in names and len(set(names)) == len(names) > 1, columns=shown,
    )  # fmt: skip
    x = table.pop(first)
    for name, column in {first: x, **table}.items():
        if not (len(column) and np.isfinite(column).all() and (column.any() if name != first else column.min() >= 0)):
            allowed = "finite, at least 0" if name == first else "finite, and not all 0"
            raise InputError(file=data, key=name, value="its column", allowed=allowed)
    return Data(kind, (first, units[first], x), table, units[others[0]], Path(data).name)
