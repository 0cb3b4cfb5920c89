"""The 3D crossover under a load: a function, and a command, for each case (`CasePlan`). All need
dolfinx and PETSc. A case that finds no equilibrium keeps what it has and ends with exit code 3.

The folder of `weavecell crossover`
    case.h5     every converged state: columns with their meanings (`fabrics.base.record`)
    case.csv    the same as a table
    case.json   settings, results, provenance
    pictures/   curve.svg, deformed.png

>>> sheared = wc.crossover.shear("S-720", shear_angle="50 deg", mesh="coarse")  # doctest: +SKIP
>>> sheared.record["tau"].max()  # [Pa]  # doctest: +SKIP
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, Unpack

from fabrics import assumed, plausible
from fabrics.base.checks import FilePath
from fabrics.base.door import option
from fabrics.base.errors import InputError, UnstableError
from fabrics.fabric import Fabric
from weavecell.answers.crossover_result import CASES, NAMES, CrossoverResult
from weavecell.api import meshes, quantities
from weavecell.api.command import Plan, Running, command
from weavecell.api.keywords import explain_keywords
from weavecell.api.meshes import Sections
from weavecell.api.run_size import WorkSize
from weavecell.results import progress

FAMILIES = ("warp", "weft")


class CaseKeywords(Sections, total=False):
    """Keywords that all cases share.

    Parameters
    ----------
    mesh : auto, coarse (default), medium or fine, the numbers of hexahedra along, across and
        through a quarter yarn, such as 8,6,2, or an edge length
    out : folder of the results; in Python None writes nothing
    section : sine, ellipse or conforming; the fabric's own if not given
    yarn_gap : gap between parallel yarns [m]; none if not given
    """

    mesh: str | float | tuple[int, int, int]
    out: FilePath | None


@dataclass(frozen=True)
class CasePlan(Plan["CrossoverResult"]):
    """A case that is about to be solved.

    Parameters
    ----------
    fabric : Fabric, with what a 3D crossover needs
    case : one of `CASES`
    solve : function of `unitcell3d.cases`: (mesh, fabric, hooks=, and the options) -> Record
    options : of `solve`
    domain : "quarter", "whole" or "periodic"
    mesh : as it was given
    shape : options of `meshes.build`
    """

    files = NAMES
    runs = ""

    fabric: Fabric
    case: str
    solve: Callable[..., Any]
    options: dict[str, Any]
    domain: str
    mesh: Any
    shape: dict[str, Any]

    def forecast(self) -> WorkSize:
        """Count hexahedra and nodes; what cannot be meshed is refused."""
        built = meshes.build(self.fabric, self.domain, **self.shape)
        return meshes.size_of_mesh(f"{self.fabric.name}, {self.case}", built)

    def run(self, running: Running) -> CrossoverResult:
        """Mesh the crossover and solve the case on it; what it had computed is kept of one that finds no
        equilibrium."""
        built = meshes.build(self.fabric, self.domain, **self.shape)
        with progress.bar(f"{self.fabric.name}, {self.case}") as advance:
            hooks = [lambda share, row: advance(share)]
            record = self.solve(built, fabric=self.fabric, hooks=hooks, **self.options)
        numbers = CASES[self.case].summary(self.fabric, record)
        size = str(self.mesh).strip("()")
        result = CrossoverResult(self.fabric, self.case, built, record, self.domain, size, numbers)
        if record.failed:
            running.failure = UnstableError(record.failed, result=result)
        return running.save(result)


@command(CasePlan)
@explain_keywords(CaseKeywords)
def yarn(
    fabric: Fabric | FilePath,
    *,
    yarn: Literal["warp", "weft"] = "warp",
    bars: int | None = None,
    failure: bool = False,
    reduced_integration: bool = False,
    domain: Literal["quarter", "whole"] = "quarter",
    check: bool = False,
    **shared: Unpack[CaseKeywords],
) -> CasePlan:
    """Pull one yarn straight.

    Parameters
    ----------
    fabric : name of the catalogue, or path of a fabric file; in Python also a Fabric
    yarn : family of the yarn
    bars : fibre lines that carry bars; all if not given
    failure : let fibres fail at their failure strain
    reduced_integration : one integration point, to see the zero-energy modes
    domain : a quarter of the crossover, by symmetry, or the whole
    check : solve nothing and write nothing: count hexahedra and nodes
    **shared : mesh, out, section and yarn_gap

    Raises
    ------
    InputError : an option that is not allowed, or a fabric that cannot be meshed
    UnstableError : no equilibrium; its attribute `result` has the states up to then, which are
        written
    """
    from unitcell3d.cases import single_yarn
    from unitcell3d.material import solid_law

    options = {"family": _family(yarn), "bars": bars, "failure": failure}
    if reduced_integration:
        options["integration"] = solid_law.ONE_POINT
    _check(domain, "quarter", "whole")
    return _plan("yarn", single_yarn.pull, options, fabric, domain, shared)


@command(CasePlan)
@explain_keywords(CaseKeywords)
def platens(
    fabric: Fabric | FilePath,
    *,
    plies: int = 1,
    pressure: float | str | None = None,
    friction: float = 0.0,
    check: bool = False,
    **shared: Unpack[CaseKeywords],
) -> CasePlan:
    """Press one ply, or several, between platens.

    Parameters
    ----------
    fabric : name of the catalogue, or path of a fabric file; in Python also a Fabric
    plies : number of plies
    pressure : pressure at the end [Pa]; the highest of the thesis if not given
    friction : Coulomb's coefficient between the yarns
    check : solve nothing and write nothing: count hexahedra and nodes
    **shared : mesh, out, section and yarn_gap

    Raises
    ------
    InputError : an option that is not allowed, or a fabric that cannot be meshed
    UnstableError : no equilibrium; its attribute `result` has the states up to then, which are
        written
    """
    if plies < 1:
        raise InputError(key="plies", value=plies, allowed="a whole number from 1 on")
    from unitcell3d.cases import stack

    options = {"plies": plies, "numerics": _numerics(friction)}
    if pressure is not None:
        options["pressure"] = quantities.number(pressure, "Pa", "pressure")
    return _plan("platens", stack.stack_compression, options, fabric, "quarter", shared)


@command(CasePlan)
@explain_keywords(CaseKeywords)
def biaxial(
    fabric: Fabric | FilePath,
    *,
    end_displacement: float | str | list[float],
    failure: bool = False,
    friction: float = 0.0,
    domain: Literal["whole", "periodic"] = "whole",
    check: bool = False,
    **shared: Unpack[CaseKeywords],
) -> CasePlan:
    """Stretch warp and weft.

    Parameters
    ----------
    fabric : name of the catalogue, or path of a fabric file; in Python also a Fabric
    end_displacement : displacement of each yarn end, of both yarns or of warp and weft [m]
    failure : let fibres fail at their failure strain
    friction : Coulomb's coefficient between the yarns
    domain : the whole crossover, or a periodic cell: 2 x 2 yarns of plain weave, the least that
        repeats of a weave with floats
    check : solve nothing and write nothing: count hexahedra and nodes
    **shared : mesh, out, section and yarn_gap

    Raises
    ------
    InputError : an option that is not allowed, or a fabric that cannot be meshed
    UnstableError : no equilibrium; its attribute `result` has the states up to then, which are
        written
    """
    from unitcell3d.cases import periodic_cell

    ends = quantities.pair(end_displacement, "m", "end_displacement")
    if not any(ends):
        allowed = "a length that is not 0"
        raise InputError(key="end_displacement", value=end_displacement, allowed=allowed)
    options = {"d": ends, "failure": failure, "numerics": _numerics(friction)}
    _check(domain, "whole", "periodic")
    return _plan("biaxial", periodic_cell.biaxial, options, fabric, domain, shared)


@command(CasePlan)
@explain_keywords(CaseKeywords)
def path(
    fabric: Fabric | FilePath,
    *,
    path: FilePath,
    failure: bool = False,
    friction: float = 0.0,
    domain: Literal["quarter", "whole"] = "quarter",
    check: bool = False,
    **shared: Unpack[CaseKeywords],
) -> CasePlan:
    """Take the yarn ends along a path.

    Parameters
    ----------
    fabric : name of the catalogue, or path of a fabric file; in Python also a Fabric
    path : CSV file of the corners of the path, headed "d1 [um], d2 [um]"
    failure : let fibres fail at their failure strain
    friction : Coulomb's coefficient between the yarns
    domain : a quarter of the crossover, by symmetry, or the whole
    check : solve nothing and write nothing: count hexahedra and nodes
    **shared : mesh, out, section and yarn_gap

    Raises
    ------
    InputError : an option that is not allowed, or a fabric that cannot be meshed
    UnstableError : no equilibrium; its attribute `result` has the states up to then, which are
        written
    """
    from unitcell3d.cases import load_path

    corners = load_path.read(path)
    options = {"corners": corners, "failure": failure, "numerics": _numerics(friction)}
    _check(domain, "quarter", "whole")
    return _plan("path", load_path.along, options, fabric, domain, shared)


@command(CasePlan)
@explain_keywords(CaseKeywords)
def shear(
    fabric: Fabric | FilePath,
    *,
    shear_angle: float | str = "0.6 rad",
    end_displacement: float | str | list[float] = "0 mm",
    failure: bool = False,
    friction: float = 0.0,
    domain: Literal["whole", "periodic"] = "whole",
    check: bool = False,
    **shared: Unpack[CaseKeywords],
) -> CasePlan:
    """Shear the weave, which may be stretched before.

    Parameters
    ----------
    fabric : name of the catalogue, or path of a fabric file; in Python also a Fabric
    shear_angle : angle at the end [rad]
    end_displacement : displacement of each yarn end before the shear, of both yarns or of warp and
        weft [m]
    failure : let fibres fail at their failure strain
    friction : Coulomb's coefficient between the yarns
    domain : the whole crossover, or a periodic cell of 2 x 2 yarns
    check : solve nothing and write nothing: count hexahedra and nodes
    **shared : mesh, out, section and yarn_gap

    Raises
    ------
    InputError : an option that is not allowed, or a fabric that cannot be meshed
    UnstableError : no equilibrium; its attribute `result` has the states up to then, which are
        written
    """
    from unitcell3d.cases import periodic_cell

    gamma = quantities.number(shear_angle, "rad", "shear_angle")
    if not 0 < gamma <= periodic_cell.STEEPEST:
        allowed = f"above 0 and at most {periodic_cell.STEEPEST} rad"
        raise InputError(key="shear_angle", value=shear_angle, allowed=allowed)
    options = {
        "gamma": gamma,
        "stretch": quantities.pair(end_displacement, "m", "end_displacement"),
        "failure": failure,
        "numerics": _numerics(friction),
    }
    _check(domain, "whole", "periodic")
    return _plan("shear", periodic_cell.shear, options, fabric, domain, shared)


@command(CasePlan)
@explain_keywords(CaseKeywords)
def pull_out(
    fabric: Fabric | FilePath,
    *,
    yarn: Literal["warp", "weft"] = "warp",
    end_displacement: float | str | list[float] | None = None,
    pressure: float | str | list[float] | None = None,
    pull: float | str | None = None,
    friction: float | None = None,
    check: bool = False,
    **shared: Unpack[CaseKeywords],
) -> CasePlan:
    """Pull one yarn along its axis until it slides.

    The yarns are pressed together by end displacements of the crossing yarn, or by platens.

    Parameters
    ----------
    fabric : name of the catalogue, or path of a fabric file; in Python also a Fabric
    yarn : family of the yarn that is pulled
    end_displacement : displacements of the crossing yarn's ends, one for each transverse load [m];
        four shares of its crimp if neither these nor pressures are given
    pressure : pressures of platens in their place, one for each transverse load [Pa]
    pull : displacement of the yarn along its axis [m]; as far as it takes to slide if not given
    friction : Coulomb's coefficient between the yarns; assumed by fibre family if not given, 0.2 of
        para-aramid
    check : solve nothing and write nothing: count hexahedra and nodes
    **shared : mesh, out, section and yarn_gap

    Raises
    ------
    InputError : an option that is not allowed, or a fabric that cannot be meshed
    UnstableError : no equilibrium; its attribute `result` has the states up to then, which are
        written
    """
    from unitcell3d.cases import pull_out as case

    if friction is None:
        friction = assumed.friction_between_yarns(meshes.resolve_fabric_for_3d(fabric)).value
    family = _family(yarn)
    lengths = []
    if end_displacement is not None:
        lengths = quantities.numbers(end_displacement, "m", "end_displacement")
    pressures = []
    if pressure is not None:
        pressures = quantities.numbers(pressure, "Pa", "pressure")
    if pressures and lengths:
        raise InputError(
            key="pressure",
            value=pressure,
            allowed=f"left out with {option('end_displacement', '')}",
        )
    if pressures and not min(pressures) > 0:
        raise InputError(key="pressure", value=pressure, allowed="pressures above 0")
    if lengths and min(lengths) < 0:
        allowed = "displacements of 0 or more, which press the yarns together"
        raise InputError(key="end_displacement", value=end_displacement, allowed=allowed)
    if not lengths and not pressures:
        lengths = list(case.displacements(meshes.resolve_fabric_for_3d(fabric), family))
    options = {
        "displacements": lengths,
        "pressures": pressures,
        "pulled": family,
        "numerics": _numerics(friction),
    }
    if pull is not None:
        options["pull"] = quantities.number(pull, "m", "pull")
    return _plan("pull-out", case.pull_out, options, fabric, "whole", shared)


def _family(yarn: str) -> int:
    """Number of a yarn family."""
    if yarn not in FAMILIES:
        raise InputError(key="yarn", value=yarn, allowed="warp or weft")
    return FAMILIES.index(yarn)


def _check(domain: str, *allowed: str) -> None:
    """Refuse a part of the weave that a load case does not have."""
    if domain not in allowed:
        words = f"{' or '.join(allowed)} for this load"
        raise InputError(key="domain", value=domain, allowed=words)


def _numerics(friction: float) -> Any:
    from unitcell3d.model.crossover import Numerics

    return Numerics(friction=friction)


def _list_numbers(options, fabric):
    """The numbers of a case that are compared with plausible ranges."""
    if "numerics" in options:
        yield plausible.Number("friction", "friction", options["numerics"].friction)
    pressures = (options.get("pressure"), *(options.get("pressures") or ()))
    for value in filter(None, pressures):
        yield plausible.Number("pressure", "crossover_pressure", value)
    for ends in (options.get("d"), options.get("stretch")):
        for end, half in zip(ends or (), fabric.weave.w):
            yield plausible.Number("end_displacement", "end_displacement", abs(end) / half)
    crossing = 1 - options.get("pulled", 0)
    for end in options.get("displacements", ()):
        ratio = end / fabric.weave.w[crossing]
        yield plausible.Number("end_displacement", "end_displacement", ratio)


def _plan(
    case: str,
    solve: Callable[..., Any],
    options: dict[str, Any],
    fabric: Fabric | FilePath,
    domain: str,
    shared: Mapping[str, Any],
) -> CasePlan:
    """Return the plan of a case, with what all cases share."""
    sections = dict(shared)
    mesh = sections.pop("mesh", "coarse")
    shape = meshes.options_of(sections, Sections)
    fabric = meshes.resolve_fabric_for_3d(fabric)
    _check_weave(fabric, case, domain)
    quantities.note(_list_numbers(options, fabric))
    return CasePlan(
        fabric, case, solve, options, domain, mesh, {"size": meshes.size(mesh), **shape}
    )


def _check_weave(fabric, case, domain):
    """Return the InputError of a weave with floats whose cell is not solved, or not in this case or
    domain."""
    pattern = fabric.weave.pattern
    if pattern.is_plain:
        return
    if case != "biaxial":
        line = f"is a {pattern.name}, whose cell is solved in biaxial tension alone"
        raise InputError(line, key="fabric", value=fabric.name)
    if not pattern.holds_yarns:
        line = (
            f"is a {pattern.name}, no symmetry of which turns each yarn round, so nothing holds its yarns along in "
            "their cell: must be a weave that has one, such as plain, basket 2x2, twill 2/2 or satin 5"
        )
        raise InputError(line, key="fabric", value=fabric.name)
    if domain != "periodic":
        allowed = f"periodic: one crossover of a {pattern.name} is no cell of it"
        raise InputError(key="domain", value=domain, allowed=allowed)
