"""`weavecell crossover`: its options, as texts and numbers for `weavecell.commands.crossover`."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from weavecell.cli.options import (
    RESULTS,
    FabricArgument,
    FinenessOption,
    GapOption,
    OutOption,
    SectionOption,
    refuse_others,
)

EPILOG = "Example: [bold]weavecell crossover S-720 --case shear --shear-angle '50 deg' --mesh coarse[/bold]"


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


_OF_ALL = ("fabric", "case", "size", "domain", "section", "gap", "out")
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


def crossover(
    context: typer.Context,
    fabric: FabricArgument,
    case: CaseOption,
    size: FinenessOption = "coarse",
    domain: PartOption = None,
    section: SectionOption = None,
    gap: GapOption = "0 mm",
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
    out: OutOption = None,
) -> None:
    """Load the 3D crossover: one yarn pulled straight, platens, biaxial stretch, any path, shear, or yarn pull-out.

    The folder then holds case.h5 (every converged state), case.json and pictures/. A case that finds no equilibrium
    keeps what it has computed and ends with exit code 3.
    """
    from weavecell.commands import crossover as commands_crossover

    refuse_others(context, (*_OF_ALL, *_OF_CASE[case]), f"with --case {case.value}")
    commands_crossover.command(
        fabric,
        case.value,
        out or RESULTS / f"crossover-{case.value}-{Path(fabric).stem}",
        domain=domain and domain.value,
        size=size,
        section=section and section.value,
        gap=gap,
        failure=failure,
        friction=friction,
        family=("warp", "weft").index(yarn.value),
        bars=bars,
        one_point=one_point,
        plies=plies,
        shift=shift,
        pressure=pressure,
        stretch=stretch,
        gamma=gamma,
        path=path,
        pull=pull,
        law=law,
    )
