"""`weavecell mesh`, `calibrate` and `surface`: their options, as texts and numbers for the modules of these names."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from fabrics.errors import InputError
from weavecell.cli.options import (
    CORES,
    RESULTS,
    ExecutorOption,
    FabricArgument,
    FinenessOption,
    FrictionOption,
    GapOption,
    JobsOption,
    MeshOption,
    OutOption,
    ResumeOption,
    SectionOption,
    Size,
)

MESH = "Example: [bold]weavecell mesh S-720 --patch 3x4 --mesh coarse --format vtu,k[/bold]"
CALIBRATE = "Example: [bold]weavecell calibrate S-720 --mesh coarse[/bold]"
SURFACE = "Example: [bold]weavecell surface S-720 --mesh coarse --points 11[/bold]"


class Domain(StrEnum):
    """How much of a crossover is meshed."""

    quarter = "quarter"
    whole = "whole"
    periodic = "periodic"


class Overlap(StrEnum):
    """What to do with sections that overlap."""

    solve = "solve"
    refuse = "refuse"


TipOption = Annotated[
    float,
    typer.Option("--tip-thickness-ratio", "--bluntness", help="Thickness of the cut tips over that of the middle."),
]
TexGenOption = Annotated[
    Path | None,
    typer.Option(
        help="Compare sections and paths with those of the TexGen file that the fabric is from.", metavar="FILE.tg3"
    ),
]


def mesh(
    fabric: FabricArgument,
    size: FinenessOption = "medium",
    domain: Annotated[
        Domain | None,
        typer.Option(help="A quarter by symmetry (default), one whole crossover, or a periodic cell of 2 x 2."),
    ] = None,
    patch: Annotated[
        str | None, typer.Option(help="A woven patch of N warp and M weft yarns instead.", metavar="NxM")
    ] = None,
    section: SectionOption = None,
    gap: GapOption = "0 mm",
    width: Annotated[
        str | None,
        typer.Option(help="Width of both yarns, or of warp and weft; else the fabric's.", metavar="LENGTH[,LENGTH]"),
    ] = None,
    crimp: Annotated[
        str,
        typer.Option(
            help="Crimp: measured by hand, from micrographs, or values for both yarns or warp and weft.",
            metavar="hand|micrograph|CRIMP[,CRIMP]",
        ),
    ] = "hand",
    tip_thickness_ratio: TipOption = 0.075,
    overlap: Annotated[
        Overlap, typer.Option(help="Treatment of sections that overlap by more than a shift removes.")
    ] = Overlap.solve,
    end_shells: Annotated[
        str | None, typer.Option(help="Close the yarn ends with shells of this thickness.", metavar="LENGTH")
    ] = None,
    texgen: TexGenOption = None,
    format: Annotated[
        str, typer.Option(help="Files to write, separated by commas.", metavar="msh|vtu|k|inp|rad,...")
    ] = "msh,vtu",
    out: OutOption = None,
) -> None:
    """Mesh a crossover or a woven patch in hexahedra, with a picture of it and one of its quality.

    A gmsh mesh (msh), ParaView (vtu), LS-DYNA (k), Abaqus (inp), OpenRadioss (rad).
    """
    from weavecell.commands import mesh as module

    module.mesh_command(
        fabric,
        out or RESULTS / f"mesh-{Path(fabric).stem}",
        domain=domain and domain.value,
        patch=patch,
        formats=format,
        size=size,
        crimp=crimp,
        width=width,
        end_shells=end_shells,
        gap=gap,
        section=section and section.value,
        tip_thickness_ratio=tip_thickness_ratio,
        overlap=overlap.value,
        texgen=texgen,
    )


PlatenCurveOption = Annotated[
    Path | None,
    typer.Option(
        "--platen-curve",
        help="First fit E_c, V_c and K_r to this platen curve (pressure and thickness).",
        metavar="CURVE.csv",
    ),
]


def calibrate(
    fabric: Annotated[
        str | None, typer.Argument(metavar="[FABRIC]", help="A name of the catalogue, or the path of a fabric file.")
    ] = None,
    all: Annotated[
        bool, typer.Option("--all", help="Every fabric of the catalogue, side by side in one table.")
    ] = False,
    size: MeshOption = Size.medium,
    jobs: JobsOption = CORES,
    executor: ExecutorOption = "local",
    plates: PlatenCurveOption = None,
    fit_solid: Annotated[
        bool,
        typer.Option(
            "--fit-solid", help="First fit E_c, V_c and K_r to the built-in pressure law of Kevlar plain weaves."
        ),
    ] = False,
    page: Annotated[
        Path | None,
        typer.Option(help="With --all --fit-solid: put tables and pictures into this page too.", metavar="PAGE.md"),
    ] = None,
    friction: FrictionOption = 0.0,
    out: OutOption = None,
    resume: ResumeOption = False,
) -> None:
    """Solve the 3D crossover and fit its compression law: law.json, histories and a report.

    The curve of --platen-curve is a CSV file headed, for example, "pressure \\[MPa], thickness \\[mm]": one ply between
    flat platens, loading only, at least five rows. A finished path is kept at once, for --resume.
    """
    from weavecell.commands import calibrate as commands_calibrate

    if all == (fabric is not None):
        raise InputError("give either a fabric or --all")
    if page is not None and not (all and fit_solid):
        raise InputError("--page goes with --all --fit-solid")
    if all:
        if plates is not None:
            raise InputError("--platen-curve goes with one fabric")
        from weavecell.commands import calibrate_all, calibrate_chain

        if fit_solid:
            calibrate_chain.command(
                out or RESULTS / "calibrate-chain", size=size.value, jobs=jobs, executor=executor, resume=resume,
                friction=friction, page=page,
            )  # fmt: skip
            return
        calibrate_all.command(
            out or RESULTS / "calibrate-all", size=size.value, jobs=jobs, executor=executor, resume=resume,
            friction=friction,
        )  # fmt: skip
        return
    assert fabric is not None
    commands_calibrate.calibrate_command(
        fabric, out or RESULTS / f"calibrate-{Path(fabric).stem}", size=size.value, jobs=jobs, executor=executor,
        friction=friction, plates=plates, fit_solid=fit_solid, resume=resume,
    )  # fmt: skip


def surface(
    fabric: FabricArgument,
    size: MeshOption = Size.medium,
    d1: Annotated[
        str, typer.Option("--d1", help="End displacements of the warp, per end.", metavar="'LOW .. HIGH'")
    ] = "0 mm .. 0.03 mm",
    d2: Annotated[
        str, typer.Option("--d2", help="End displacements of the weft, per end.", metavar="'LOW .. HIGH'")
    ] = "0 mm .. 0.03 mm",
    points: Annotated[int, typer.Option(help="Initial number of lines in each direction.")] = 21,
    tolerance: Annotated[
        float | None,
        typer.Option(
            help="Refine until every line is interpolated from the others within this share of the largest force.",
            metavar="SHARE",
        ),
    ] = None,
    friction: FrictionOption = 0.0,
    jobs: JobsOption = CORES,
    executor: ExecutorOption = "local",
    out: OutOption = None,
    resume: ResumeOption = False,
) -> None:
    """Sample the response surface of the 3D crossover: tensions, contact force and heights over (d1, d2).

    The folder then holds surface.h5, surface.json, pictures/ and report.html; while the run goes on, partial.h5. With
    friction the response depends on the path: the surface is that of stretching the weft first and the warp then.
    """
    from weavecell.commands import response_surface as module

    folder = out or RESULTS / f"surface-{Path(fabric).stem}"
    module.surface_command(
        fabric, folder, d1=d1, d2=d2, points=points, tolerance=tolerance, size=size.value, jobs=jobs,
        executor=executor, resume=resume, friction=friction,
    )  # fmt: skip
