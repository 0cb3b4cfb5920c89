"""Cases of the 3D crossover.

The folder of `weavecell crossover`
    case.h5     every converged state: columns with their meanings (`fabrics.base.record`)
    case.json   settings, results, provenance
    pictures/   curve.svg, deformed.png
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from fabrics.base import files
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError, UnstableError
from fabrics.base.record import Record
from fabrics.fabric import Fabric
from fabrics.friction.pull_out import FRICTION
from weavecell.api import meshes, quantities
from weavecell.api.result import Result, figure, saved
from weavecell.report import crossover_cases, pictures_crossover
from weavecell.results import json_file, out_folder, progress

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from shellfabric.panel.quality import Indicator

__all__ = ["CrossoverResult", "crossover"]

FAMILIES = ("warp", "weft")


def crossover(
    fabric: Fabric | FilePath,
    case: Literal["yarn", "platens", "stack", "biaxial", "path", "shear", "pull-out"],
    *,
    mesh: str | float | tuple[int, int, int] = "coarse",
    domain: Literal["quarter", "whole", "periodic"] | None = None,
    section: Literal["sine", "ellipse", "conforming"] | None = None,
    yarn_gap: float | str = "0 mm",
    failure: bool = False,
    friction: float | None = None,
    yarn: Literal["warp", "weft"] | None = None,
    bars: int | None = None,
    reduced_integration: bool = False,
    plies: int | None = None,
    pressure: float | str | list[float] | None = None,
    end_displacement: float | str | list[float] | None = None,
    shear_angle: float | str | None = None,
    path: FilePath | None = None,
    pull: float | str | None = None,
    out: FilePath | None = None,
) -> CrossoverResult:
    """Load the 3D crossover: one yarn pulled straight, platens, biaxial stretch, any path, shear, or yarn pull-out.

    The fabric has the linear density of its data sheet. The folder then holds case.h5 (every converged state),
    case.json and pictures/. A case that finds no equilibrium keeps what it has computed and ends with exit code 3.
    Needs dolfinx and PETSc.

    Parameters
    ----------
    fabric : as of `mesh`
    case : what is done to the yarns: one yarn in tension, plies between platens, biaxial tension, a path, shear, or the
        pull-out of one yarn
    mesh : as of `mesh`
    domain : yarn, path: a quarter (default) or whole; biaxial, shear: whole (default) or periodic (2 x 2); pull-out:
        whole
    section, yarn_gap : as of `mesh`
    failure : let fibres fail at their failure strain
    friction : Coulomb's coefficient between the yarns; if not given 0, pull-out: 0.2
    yarn : yarn, pull-out: family of the yarn that is pulled; warp if not given
    bars : yarn: fibre lines that carry bars; all if not given
    reduced_integration : yarn: one integration point, to see the zero-energy modes
    plies : stack: number of plies; 2 if not given
    pressure : platens, stack: pressure at the end [Pa]; by default the highest of the thesis. pull-out: of platens that
        press the yarns together in place of end_displacement, one for each transverse load
    end_displacement : biaxial, shear: displacement of each yarn end, of both or of warp and weft [m]; pull-out: of the
        crossing yarn's ends, one for each transverse load; four shares of its crimp if not given
    shear_angle : shear: angle at the end [rad]; 0.6 rad if not given
    path : path: CSV file of corners, headed "d1 [um], d2 [um]"
    pull : pull-out: displacement of the yarn along its axis [m]
    out : folder of the results; in Python None writes nothing

    Returns
    -------
    CrossoverResult

    Raises
    ------
    InputError : an option that is not of this case or not allowed, or a fabric that cannot be meshed
    UnstableError : no equilibrium; its attribute `result` is the CrossoverResult up to then, which is written

    Examples
    --------
    >>> sheared = wc.crossover("S-720", "shear", shear_angle="50 deg", mesh="coarse")  # doctest: +SKIP
    >>> sheared.record["tau"].max()  # [Pa]  # doctest: +SKIP
    """
    kind, options = _checked(case, locals())
    gap, text = (
        quantities.number(yarn_gap, "m", "yarn_gap"),
        mesh if isinstance(mesh, str) else str(mesh).strip("()"),
    )
    fabric = meshes.of_3d(fabric)
    run = kind.run(fabric, **options)
    part = _domain(case, domain)
    with out_folder.held(out) as folder:
        built = meshes.build(fabric, part, size=meshes.size(mesh), section=section, gap=gap)
        with progress.bar(f"{fabric.name}, {case}") as advance:
            record = run(built, hooks=[lambda share, row: advance(share)])
        result = CrossoverResult(
            fabric, case, built, record, part, text, kind.summary(fabric, record)
        )
        saved(result, folder)
    if record.failed:
        raise UnstableError(record.failed, result=result)
    result.warn()
    return result


def _checked(case, options):
    """The Case of a name, and the options that were given, which are all of this case.

    Parameters
    ----------
    options : {name: value} of `crossover`, with what is for all cases; None and False where it was not given
    """
    if case not in CASES:
        raise InputError(key="case", value=case, allowed=f"one of {', '.join(CASES)}")
    of_cases = dict.fromkeys(key for kind in CASES.values() for key in kind.options)
    options = {
        key: options[key]
        for key in of_cases
        if options[key] is not None and options[key] is not False
    }
    for key in options:
        if key not in CASES[case].options:
            raise InputError(key=key, allowed=f"left out with --case {case}")
    if options.get("yarn", "warp") not in FAMILIES:
        raise InputError(key="yarn", value=options["yarn"], allowed="warp or weft")
    return CASES[case], options


def _domain(case, domain):
    """The part of the weave that is meshed: the one that was given, or the first that the case allows."""
    domains = CASES[case].domains
    if domain not in (None, *domains):
        raise InputError(
            key="domain", value=domain, allowed=f"{' or '.join(domains)} for this case"
        )
    return domain or domains[0]


@dataclass(frozen=True, repr=False)
class CrossoverResult(Result):
    """A case of the 3D crossover.

    Parameters
    ----------
    fabric : Fabric whose crossover it is
    case : "yarn", "platens", "stack", "biaxial", "path", "shear" or "pull-out"
    mesh : `meshing.crossover.Crossover` or `meshing.patch.Patch`
    record : `fabrics.base.record.Record`, a row a converged state
    domain : "quarter", "whole" or "periodic"
    size : of the mesh, as it was given
    found : {quantity [unit]: value} that the case comes to

    Examples
    --------
    >>> pulled = wc.crossover("S-720", "yarn", mesh="coarse")  # doctest: +SKIP
    >>> pulled.summary()["greatest tension [N]"], pulled.record["strain"][-1]  # doctest: +SKIP
    """

    fabric: Fabric
    case: str
    mesh: Any
    record: Record
    domain: str
    size: str
    found: dict[str, Any] = field(default_factory=dict)

    @property
    def checks(self) -> tuple[Indicator, ...]:
        """Quality checks: of a yarn alone, nodes that alternate along it."""
        from shellfabric.panel import quality

        if "astray" not in self.record.columns:
            return ()
        height = self.fabric.weave.h0[self.record.facts["yarn"]]
        return quality.of_yarn(self.record["astray"], 2 * height)

    def _what(self):
        return f"{self.fabric.name}, {self.case}"

    def summary(self) -> dict[str, Any]:
        """{quantity [unit]: value} that the case comes to, and what is assumed."""
        return self.found | self._what_is_assumed()

    def _columns(self):
        return dict(self.record.to_dataframe())

    def plot(self) -> Figure:
        """A matplotlib figure: the curve of the case."""
        return figure(CASES[self.case].curve, self.fabric, self.record)

    def save(self, out: FilePath) -> None:
        """Write the files that stand at the top of this module to a folder."""
        from weavecell.report import checks, pictures
        from weavecell.results import provenance

        out, record = Path(out), self.record
        record.write(out / "case.h5")
        content = {
            "fabric": self.fabric.name,
            "case": record.facts["case"],
            "domain": self.domain,
            "size": self.size,
            "rows": len(record["path"]),
            "failed": record.failed,
            "facts": record.facts,
            "found": self.found,
            **checks.summary(self.checks),
            "provenance": provenance.stamp("", self.fabric),
        }
        json_file.write(out / "case.json", content)
        curve = pictures.render(CASES[self.case].curve, self.fabric, record)
        files.write(out / "pictures" / "curve.svg", curve)
        pictures_crossover.deformed(self.mesh, record, out / "pictures" / "deformed.png")

    def __str__(self) -> str:
        rows = [f"{key:<44}{_text(value)}" for key, value in self.found.items()]
        return "\n".join(rows + self._assumed_laws())


def _text(value):
    """A number, some of them or a word, as it is printed."""
    if isinstance(value, list | tuple):
        return ", ".join(map(_text, value))
    if value is None:
        return "-"
    return f"{value:.5g}" if isinstance(value, float | np.floating) else str(value)


# what solves a case, as a function of the mesh and of `hooks`, from the options of `crossover` that were given


def _numerics(friction=0.0):
    from unitcell3d.model.crossover import Numerics

    return Numerics(friction=friction)


def _yarn(fabric, yarn="warp", bars=None, failure=False, reduced_integration=False):
    from unitcell3d.cases import single_yarn
    from unitcell3d.material import solid_law

    points = solid_law.ONE_POINT if reduced_integration else solid_law.FULL
    options = {"bars": bars, "failure": failure, "integration": points}
    return partial(single_yarn.pull, fabric=fabric, family=FAMILIES.index(yarn), **options)


def _stack(fabric, plies=2, pressure=None, friction=0.0):
    from unitcell3d.cases import stack

    end = (
        stack.PLATEN_PRESSURE if pressure is None else quantities.number(pressure, "Pa", "pressure")
    )
    if plies < 1:
        raise InputError(key="plies", value=plies, allowed="a whole number from 1 on")
    options = {"plies": plies, "pressure": end, "numerics": _numerics(friction)}
    return partial(stack.stack_compression, fabric=fabric, **options)


def _biaxial(fabric, end_displacement="0 mm", failure=False, friction=0.0):
    from unitcell3d.cases import periodic_cell

    d = quantities.pair(end_displacement, "m", "end_displacement")
    if not any(d):
        raise InputError(
            key="end_displacement", value=end_displacement, allowed="a length that is not 0"
        )
    return partial(
        periodic_cell.biaxial, fabric=fabric, d=d, failure=failure, numerics=_numerics(friction)
    )


def _path(fabric, path=None, failure=False, friction=0.0):
    from unitcell3d.cases import load_path

    if path is None:
        raise InputError(key="path", allowed="given: a CSV file of corners d1, d2")
    options = {"corners": load_path.read(path), "failure": failure, "numerics": _numerics(friction)}
    return partial(load_path.along, fabric=fabric, **options)


def _shear(fabric, shear_angle=0.6, end_displacement=0.0, failure=False, friction=0.0):
    from unitcell3d.cases import periodic_cell

    gamma = quantities.number(shear_angle, "rad", "shear_angle")
    stretch = quantities.pair(end_displacement, "m", "end_displacement")
    if not 0 < gamma <= periodic_cell.STEEPEST:
        allowed = f"above 0 and at most {periodic_cell.STEEPEST} rad"
        raise InputError(key="shear_angle", value=shear_angle, allowed=allowed)
    options = {
        "gamma": gamma,
        "stretch": stretch,
        "failure": failure,
        "numerics": _numerics(friction),
    }
    return partial(periodic_cell.shear, fabric=fabric, **options)


def _pull_out(fabric, yarn="warp", end_displacement=(), pressure=(), pull=None, friction=FRICTION):
    from unitcell3d.cases import pull_out

    family = FAMILIES.index(yarn)
    lengths = quantities.numbers(end_displacement, "m", "end_displacement")
    pressures = quantities.numbers(pressure, "Pa", "pressure")
    if pressures and lengths:
        raise InputError(key="pressure", value=pressure, allowed="left out with --end-displacement")
    if pressures and not min(pressures) > 0:
        raise InputError(key="pressure", value=pressure, allowed="pressures above 0")
    options = {
        "displacements": lengths
        or ([] if pressures else list(pull_out.displacements(fabric, family))),
        "pressures": pressures,
        "pulled": family,
        "pull": None if pull is None else quantities.number(pull, "m", "pull"),
        "numerics": _numerics(friction),
    }
    return partial(pull_out.pull_out, fabric=fabric, **options)


class Case(NamedTuple):
    """One of the cases: what solves it, on which domains, with which options, what it comes to and its picture."""

    run: Callable[..., Callable[..., Record]]
    domains: tuple[str, ...]
    options: tuple[str, ...]
    summary: Callable[[Fabric, Record], dict[str, Any]]
    curve: Callable[..., Any]


_TENSIONS = crossover_cases.tensions, pictures_crossover.tensions
_STACK = crossover_cases.stack, pictures_crossover.stack
_YARN = crossover_cases.yarn, pictures_crossover.yarn
_SHEAR = crossover_cases.shear, pictures_crossover.shear
_PULL_OUT = crossover_cases.pull_out, pictures_crossover.pull_out
CASES = {
    "yarn": Case(
        _yarn, ("quarter", "whole"), ("failure", "yarn", "bars", "reduced_integration"), *_YARN
    ),
    "platens": Case(partial(_stack, plies=1), ("quarter",), ("friction", "pressure"), *_STACK),
    "stack": Case(_stack, ("quarter",), ("friction", "plies", "pressure"), *_STACK),
    "biaxial": Case(
        _biaxial, ("whole", "periodic"), ("failure", "friction", "end_displacement"), *_TENSIONS
    ),
    "path": Case(_path, ("quarter", "whole"), ("failure", "friction", "path"), *_TENSIONS),
    "shear": Case(
        _shear,
        ("whole", "periodic"),
        ("failure", "friction", "end_displacement", "shear_angle"),
        *_SHEAR,
    ),
    "pull-out": Case(
        _pull_out,
        ("whole",),
        ("friction", "yarn", "end_displacement", "pressure", "pull"),
        *_PULL_OUT,
    ),
}
