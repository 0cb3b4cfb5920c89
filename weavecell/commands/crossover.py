"""Cases of the 3D crossover from the command line.

Folder of `weavecell crossover`
    case.h5     every converged state: columns with their meanings (`fabrics.record`)
    case.json   settings, results, provenance
    pictures/   curve.svg, deformed.png

A yarn pulled out adds its slip threshold to the law.json of a calibration, where one is named.
"""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from fabrics import compression, files, units
from fabrics.errors import InputError, UnstableError
from fabrics.friction import pull_out as friction_pull_out
from weavecell.commands import mesh, options
from weavecell.report import checks, crossover_cases, pictures, pictures_crossover
from weavecell.results import json_file, out_folder, progress, provenance

DOMAINS = {
    "yarn": ("quarter", "whole"),
    "platens": ("quarter",),
    "stack": ("quarter", "periodic"),
    "biaxial": ("whole", "periodic"),
    "path": ("quarter", "whole"),
    "shear": ("whole", "periodic"),
    "pull-out": ("whole",),
}


class Case(StrEnum):
    """What is done to the yarns."""

    yarn = "yarn"
    platens = "platens"
    stack = "stack"
    biaxial = "biaxial"
    path = "path"
    shear = "shear"
    pull_out = "pull-out"


class Part(StrEnum):
    """How much of the weave is meshed."""

    quarter = "quarter"
    whole = "whole"
    periodic = "periodic"


class Family(StrEnum):
    """Yarn families."""

    warp = "warp"
    weft = "weft"


_OF_ALL = ("name", "case", "size", "domain", "section", "gap", "out")
_OF_CASE = {
    Case.yarn: ("failure", "yarn", "bars", "one_point"),
    Case.platens: ("friction", "pressure"),
    Case.stack: ("friction", "plies", "shift", "pressure"),
    Case.biaxial: ("failure", "friction", "stretch"),
    Case.path: ("failure", "friction", "path"),
    Case.shear: ("failure", "friction", "stretch", "gamma"),
    Case.pull_out: ("friction", "yarn", "stretch", "pressure", "pull", "law"),
}


CaseOption = Annotated[
    Case,
    typer.Option(
        help="Load case: one yarn in tension, plies between platens, biaxial tension, a path, shear, or the pull-out "
        "of one yarn."
    ),
]
PartOption = Annotated[
    Part | None,
    typer.Option(
        help="yarn, path: a quarter (default) or whole; biaxial, shear: whole (default) or periodic (2 x 2); "
        "pull-out: whole."
    ),
]
FailureOption = Annotated[bool, typer.Option("--failure", help="Let fibres fail at their failure strain.")]
FamilyOption = Annotated[Family, typer.Option(help="yarn, pull-out: family of the yarn that is pulled.")]
BarsOption = Annotated[
    int | None, typer.Option(help="yarn: fibre lines that carry bars; all if not given.", metavar="N")
]
ReducedOption = Annotated[
    bool,
    typer.Option("--reduced-integration", help="yarn: one integration point, to see the zero-energy modes."),
]
PliesOption = Annotated[int, typer.Option(help="stack: number of plies.")]
ShiftOption = Annotated[
    str, typer.Option(help="stack: offset of each ply from the one below, in crossovers along x and y.", metavar="X,Y")
]
PressureOption = Annotated[
    str | None,
    typer.Option(
        help="platens, stack: pressure at the end; by default the highest of the thesis. pull-out: of platens that "
        "press the yarns together in place of --end-displacement, one for each transverse load.",
        metavar="PRESSURE[,PRESSURE]",
    ),
]
StretchOption = Annotated[
    str,
    typer.Option(
        "--end-displacement",
        help="biaxial, shear: displacement of each yarn end, of both or of warp and weft; pull-out: of the crossing "
        "yarn's ends, one for each transverse load; four shares of its crimp if not given.",
        metavar="LENGTH[,LENGTH]",
    ),
]
AngleOption = Annotated[str, typer.Option("--shear-angle", help="shear: angle at the end.", metavar="ANGLE")]
PathOption = Annotated[
    Path | None, typer.Option(help='path: CSV file of corners, headed "d1 \\[um], d2 \\[um]".', metavar="FILE.csv")
]

CoefficientOption = Annotated[
    float | None,
    typer.Option(
        "--friction", "--mu", min=0, help="Coulomb's coefficient between the yarns; if not given 0, pull-out: 0.2."
    ),
]
PullOption = Annotated[
    str | None, typer.Option(help="pull-out: displacement of the yarn along its axis.", metavar="LENGTH")
]
LawOption = Annotated[
    Path | None,
    typer.Option(help="pull-out: law.json of a calibration, to which the slip threshold is added.", metavar="FILE"),
]


@options.example("weavecell crossover S-720 --case shear --shear-angle '50 deg' --mesh coarse")
def crossover(
    context: typer.Context,
    name: options.FabricArgument,
    case: CaseOption,
    size: options.FinenessOption = "coarse",
    domain: PartOption = None,
    section: options.SectionOption = None,
    gap: options.GapOption = "0 mm",
    failure: FailureOption = False,
    friction: CoefficientOption = None,
    yarn: FamilyOption = Family.warp,
    bars: BarsOption = None,
    one_point: ReducedOption = False,
    plies: PliesOption = 2,
    shift: ShiftOption = "0,0",
    pressure: PressureOption = None,
    stretch: StretchOption = "0 mm",
    gamma: AngleOption = "0.6 rad",
    path: PathOption = None,
    pull: PullOption = None,
    law: LawOption = None,
    out: options.OutOption = None,
) -> None:
    """Load the 3D crossover: one yarn pulled straight, platens, biaxial stretch, any path, shear, or yarn pull-out.

    The folder then holds case.h5 (every converged state), case.json and pictures/. A case that finds no equilibrium
    keeps what it has computed and ends with exit code 3.
    """
    options.refuse_others(context, (*_OF_ALL, *_OF_CASE[case]), f"with --case {case.value}")
    choices: dict[str, Any] = {
        "failure": failure, "friction": friction, "family": list(Family).index(yarn), "bars": bars,
        "one_point": one_point, "plies": plies, "shift": shift, "pressure": pressure, "stretch": stretch,
        "gamma": gamma, "path": path, "pull": pull, "law": law,
    }  # fmt: skip
    out = out or options.RESULTS / f"crossover-{case.value}-{Path(name).stem}"
    chosen = options.mesh_choices(size=size, section=section and section.value, gap=gap)
    _run(name, case.value, out, domain and domain.value, size, chosen, choices)


def _run(name, case, out, domain, size, chosen, choices):
    """Run a case of a fabric, write it and print what it found; `choices` are texts of the command line."""
    fabric = mesh.with_3d_data(name)
    if choices["law"] is not None:
        held = compression.CompressionLaw.from_json(choices["law"])  # refused before anything is computed
        held.require_fabric(fabric.name, key="--law", value=str(choices["law"]))
    run = CASES[case](fabric, choices)
    shifted = case == "stack" and any(options.pair(choices["shift"], "", "--shift", "along x and y"))
    allowed = ("periodic",) if shifted else ("quarter",) if case == "stack" else DOMAINS[case]
    domain = allowed[0] if domain is None else domain
    if domain not in allowed:
        raise InputError(key="--domain", value=domain, allowed=f"{' or '.join(allowed)} for this case")
    out_folder.claim(out)
    built = mesh.build(fabric, domain=domain, **chosen)
    with progress.bar(f"{fabric.name}, {case}") as advance:
        record = run(built, hooks=[lambda share, row: advance(share)])
    found = crossover_cases.SUMMARIES[case](fabric, record)
    indicators = _indicators(fabric, record)
    record.write(out / "case.h5")
    content = {
        "fabric": fabric.name, "case": record.facts["case"], "domain": domain, "size": size,
        "rows": len(record["path"]), "failed": record.failed, "facts": record.facts, "found": found,
        **checks.summary(indicators),
        "provenance": provenance.stamp("", fabric),
    }  # fmt: skip
    json_file.write(out / "case.json", content)
    files.write(out / "pictures" / "curve.svg", pictures.render(pictures_crossover.CURVES[case], fabric, record, found))
    pictures_crossover.deformed(built, record, out / "pictures" / "deformed.png")
    if choices["law"] is not None and not record.failed:
        from unitcell3d.cases import pull_out

        pull_out.fit(record, size).add_to(choices["law"])
    for key, value in found.items():
        print(f"{key:<44}{crossover_cases.as_text(value)}")
    print(f"written to {out}")
    if record.failed:
        raise UnstableError(record.failed)
    checks.report(indicators, strict=False)


def _indicators(fabric, record):
    """Quality indicators of a case: of a yarn alone, nodes that alternate along it."""
    from shellfabric.panel import quality

    if "astray" not in record.columns:
        return ()
    weave = fabric.weave
    return quality.of_yarn(record["astray"], 2 * (weave.h01, weave.h02)[record.facts["yarn"]])


def _yarn(fabric, choices):
    from unitcell3d.cases import single_yarn as cases_single_yarn
    from unitcell3d.material import solid_law

    integration = solid_law.ONE_POINT if choices["one_point"] else solid_law.FULL
    keys = {key: choices[key] for key in ("bars", "failure")}
    return lambda built, hooks: cases_single_yarn.pull(
        built, fabric, choices["family"], integration=integration, hooks=hooks, **keys
    )


def _platens(fabric, choices):
    return _stack(fabric, choices | {"plies": 1, "shift": "0,0"})


def _stack(fabric, choices):
    from unitcell3d.cases import stack

    pressure = choices["pressure"]
    pressure = stack.PLATEN_PRESSURE if pressure is None else units.si(pressure, "Pa", key="--pressure")
    shift = options.pair(choices["shift"], "", "--shift", "along x and y")
    if choices["plies"] < 1:
        raise InputError(key="--plies", value=choices["plies"], allowed="a whole number from 1 on")
    return lambda built, hooks: stack.stack_compression(
        built, fabric, choices["plies"], shift=shift, pressure=pressure, numerics=_numerics(choices), hooks=hooks
    )


def _biaxial(fabric, choices):
    from unitcell3d.cases import periodic_cell

    d = options.pair(choices["stretch"], "m", "--end-displacement")
    if not any(d):
        raise InputError(key="--end-displacement", value=choices["stretch"], allowed="a length that is not 0")
    return lambda built, hooks: periodic_cell.biaxial(
        built, fabric, d, failure=choices["failure"], numerics=_numerics(choices), hooks=hooks
    )


def _path(fabric, choices):
    from unitcell3d.cases import load_path

    if choices["path"] is None:
        raise InputError(key="--path", allowed="given: a CSV file of corners d1, d2")
    corners = load_path.read(choices["path"])
    return lambda built, hooks: load_path.along(
        built, fabric, corners, failure=choices["failure"], numerics=_numerics(choices), hooks=hooks
    )


def _shear(fabric, choices):
    from unitcell3d.cases import periodic_cell

    gamma, stretch = (
        units.si(choices["gamma"], "rad", key="--shear-angle"),
        options.pair(choices["stretch"], "m", "--end-displacement"),
    )
    if not 0 < gamma <= periodic_cell.STEEPEST:
        raise InputError(
            key="--shear-angle", value=choices["gamma"], allowed=f"above 0 and at most {periodic_cell.STEEPEST} rad"
        )
    return lambda built, hooks: periodic_cell.shear(
        built, fabric, gamma, stretch=stretch, failure=choices["failure"], numerics=_numerics(choices), hooks=hooks
    )


def _pull_out(fabric, choices):
    from unitcell3d.cases import pull_out

    pulled = choices["family"]
    given = [text for text in choices["stretch"].split(",") if text.strip() not in ("", "0 mm")]
    lengths = [units.si(text, "m", key="--end-displacement") for text in given]
    pressures = [
        units.si(text, "Pa", key="--pressure") for text in (choices["pressure"] or "").split(",") if text.strip()
    ]
    if pressures and lengths:
        raise InputError(key="--pressure", value=choices["pressure"], allowed="left out with --end-displacement")
    if pressures and not min(pressures) > 0:
        raise InputError(key="--pressure", value=choices["pressure"], allowed="pressures above 0")
    lengths = lengths or ([] if pressures else list(pull_out.displacements(fabric, pulled)))
    pull = None if choices["pull"] is None else units.si(choices["pull"], "m", key="--pull")
    friction = friction_pull_out.FRICTION if choices["friction"] is None else choices["friction"]
    numerics = _numerics(choices | {"friction": friction})
    return lambda built, hooks: pull_out.pull_out(
        built, fabric, lengths, pressures=pressures, pulled=pulled, pull=pull, numerics=numerics, hooks=hooks
    )


def _numerics(choices):
    from unitcell3d.model.crossover import Numerics

    return Numerics(friction=choices["friction"] or 0.0)


CASES = {
    "yarn": _yarn,
    "platens": _platens,
    "stack": _stack,
    "biaxial": _biaxial,
    "path": _path,
    "shear": _shear,
    "pull-out": _pull_out,
}
