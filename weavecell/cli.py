"""The `weavecell` command. Nothing heavy is imported before a command needs it, so that help comes at once.

Exit codes: 0 done; 2 bad input (one line on stderr, nothing written); 3 a run became unstable (what it had computed is
kept); 130 interrupted.
"""

from __future__ import annotations

import os
import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from fabrics.errors import InputError, WeavecellError
from weavecell import cli_cases, cli_charts, cli_scatter

app = typer.Typer(
    name="weavecell",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Woven ballistic fabric, from data sheet to impact.",
    epilog="Example: [bold]weavecell demo[/bold], then open results/demo/report.html",
)
fabrics_app = typer.Typer(no_args_is_help=True, help="The fabrics of the catalogue.", rich_markup_mode="rich")
app.add_typer(fabrics_app, name="fabrics", epilog="Example: [bold]weavecell fabrics list[/bold]")

FabricArgument = Annotated[
    str, typer.Argument(metavar="FABRIC", help="A name of the catalogue, or the path of a fabric file.")
]
OutOption = Annotated[
    Path | None,
    typer.Option(
        "--out", "-o", help="Folder for what is written; by default one of its own in results/.", metavar="FOLDER"
    ),
]
ProcessesOption = Annotated[int, typer.Option(min=1, help="Loading paths that are computed beside each other.")]
RESULTS = Path("results")
CORES = os.cpu_count() or 1
INTERRUPTED = 130


class Size(StrEnum):
    """Mesh sizes of a crossover."""

    coarse = "coarse"
    medium = "medium"
    fine = "fine"


class Profile(StrEnum):
    """Profiles of the yarns of the shell's cell."""

    cosine = "cosine"
    straight = "straight"


class Domain(StrEnum):
    """How much of a crossover is meshed."""

    quarter = "quarter"
    whole = "whole"
    four = "four"


class Overlap(StrEnum):
    """What to do with sections that overlap."""

    solve = "solve"
    refuse = "refuse"


class Section(StrEnum):
    """Yarn sections."""

    sine = "sine"
    ellipse = "ellipse"
    conforming = "conforming"


def _version(wanted: bool):
    if wanted:
        import weavecell

        typer.echo(f"weavecell {weavecell.__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool | None, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = None,
):
    pass


@app.command(epilog="Example: [bold]weavecell demo --out results/demo[/bold]")
def demo(
    out: OutOption = None,
    size: Annotated[Size, typer.Option(help="Mesh of the 3D crossover.")] = Size.medium,
    processes: ProcessesOption = CORES,
):
    """S-720 from data sheet to report: mesh, calibration, and four impacts, with a summary and one HTML page."""
    from weavecell.demo import demonstrate

    demonstrate(out or RESULTS / "demo", size=size.value, processes=processes)


@app.command(epilog="Example: [bold]weavecell mesh S-720 --patch 3x4 --size coarse --format vtu,k[/bold]")
def mesh(
    fabric: FabricArgument,
    size: Annotated[
        str,
        typer.Option(
            help="How fine: a name, hexahedra along, across and through a quarter yarn, or an edge length.",
            metavar="auto|coarse|medium|fine|NX,NY,NZ|LENGTH",
        ),
    ] = "medium",
    domain: Annotated[
        Domain | None,
        typer.Option(help="A quarter by symmetry (unless told otherwise), one whole, or the four that repeat."),
    ] = None,
    patch: Annotated[
        str | None, typer.Option(help="A woven patch of N warp and M weft yarns instead.", metavar="NxM")
    ] = None,
    section: Annotated[Section | None, typer.Option(help="Yarn section; the fabric's own if not given.")] = None,
    gap: Annotated[str, typer.Option(help="Gap between parallel yarns.", metavar="LENGTH")] = "0 mm",
    width: Annotated[
        str | None,
        typer.Option(help="Width of the yarns instead, of both or warp and weft.", metavar="LENGTH[,LENGTH]"),
    ] = None,
    crimp: Annotated[
        str,
        typer.Option(
            help="Measured by hand, from micrographs, or of both yarns or warp and weft.",
            metavar="hand|micrograph|CRIMP[,CRIMP]",
        ),
    ] = "hand",
    bluntness: Annotated[float, typer.Option(help="Height of the cut tips over that of the middle.")] = 0.075,
    overlap: Annotated[
        Overlap, typer.Option(help="What to do where the two sections overlap by more than a shift removes.")
    ] = Overlap.solve,
    end_shells: Annotated[
        str | None, typer.Option(help="Close the yarn ends with shells of this thickness.", metavar="LENGTH")
    ] = None,
    format: Annotated[
        str, typer.Option(help="Files to write, separated by commas.", metavar="msh|vtu|k|inp|rad,...")
    ] = "msh,vtu",
    out: OutOption = None,
):
    """Mesh a crossover or a woven patch in hexahedra, with a picture of it and one of its quality.

    A gmsh mesh (msh), ParaView (vtu), LS-DYNA (k), Abaqus (inp), OpenRadioss (rad).
    """
    from weavecell import mesh as module

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
        bluntness=bluntness,
        overlap=overlap.value,
    )


@app.command(epilog="Example: [bold]weavecell calibrate S-720 --size coarse[/bold]")
def calibrate(
    fabric: Annotated[
        str | None, typer.Argument(metavar="[FABRIC]", help="A name of the catalogue, or the path of a fabric file.")
    ] = None,
    all: Annotated[
        bool, typer.Option("--all", help="Every fabric of the catalogue, side by side in one table.")
    ] = False,
    size: Annotated[Size, typer.Option(help="Mesh of the 3D crossover.")] = Size.medium,
    processes: ProcessesOption = CORES,
    plates: Annotated[
        Path | None,
        typer.Option(help="First fit E_c, V_c and K_r to this curve: pressure and thickness.", metavar="CURVE.csv"),
    ] = None,
    fit_solid: Annotated[
        bool, typer.Option("--fit-solid", help="The same, to the built-in pressure law of Kevlar plain weaves.")
    ] = False,
    out: OutOption = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on from the paths of an interrupted run.")] = False,
):
    """Solve the 3D crossover and fit its compression law: law.json, histories and a report.

    The curve of --plates is a CSV file headed, for example, "pressure [MPa], thickness [mm]": one ply between flat
    plates, loading only, at least five rows. A finished path is kept at once, for --resume.
    """
    from weavecell import crossover

    if all == (fabric is not None):
        raise InputError("give either a fabric or --all")
    if all:
        if plates is not None or fit_solid:
            raise InputError("--plates and --fit-solid go with one fabric")
        from weavecell import calibrate_all

        calibrate_all.command(out or RESULTS / "calibrate-all", size=size.value, processes=processes, resume=resume)
        return
    crossover.calibrate_command(
        fabric,
        out or RESULTS / f"calibrate-{Path(fabric).stem}",
        size=size.value,
        processes=processes,
        plates=plates,
        fit_solid=fit_solid,
        resume=resume,
    )


@app.command(epilog="Example: [bold]weavecell surface S-720 --size coarse --points 11[/bold]")
def surface(
    fabric: FabricArgument,
    size: Annotated[Size, typer.Option(help="Mesh of the 3D crossover.")] = Size.medium,
    d1: Annotated[
        str, typer.Option("--d1", help="End displacements of the warp, per end.", metavar="'LOW .. HIGH'")
    ] = "0 mm .. 0.03 mm",
    d2: Annotated[str, typer.Option("--d2", help="The same of the weft.", metavar="'LOW .. HIGH'")] = "0 mm .. 0.03 mm",
    points: Annotated[int, typer.Option(help="Lines in each direction, to begin with.")] = 21,
    tolerance: Annotated[
        float | None,
        typer.Option(
            help="Add lines until none is missed by more, of the largest force, when left out.", metavar="SHARE"
        ),
    ] = None,
    processes: ProcessesOption = CORES,
    out: OutOption = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on from the lines of an interrupted run.")] = False,
):
    """Sample the response surface of the 3D crossover: tensions, contact force and heights over (d1, d2).

    The folder then holds surface.h5, surface.json, pictures/ and report.html; while the run goes on, partial.h5.
    """
    from weavecell import surface as module

    folder = out or RESULTS / f"surface-{Path(fabric).stem}"
    module.surface_command(
        fabric, folder, d1=d1, d2=d2, points=points, tolerance=tolerance, size=size.value, processes=processes,
        resume=resume,
    )  # fmt: skip


@app.command(epilog="Example: [bold]weavecell impact examples/S-720-stops.toml[/bold]")
def impact(
    scene: Annotated[Path, typer.Argument(metavar="SCENE", help="A scene file (*.toml).")],
    out: OutOption = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on from the checkpoint of an interrupted run.")] = False,
    explain: Annotated[
        bool, typer.Option("--explain", help="Run nothing: show the models that would do for the scene's \\[accuracy].")
    ] = False,
):
    """Fire the projectile of a scene at its panel: histories, ParaView series, pictures and a report.

    The folder then holds report.html, summary.json, histories.h5, panel.pvd with panel/*.vtu, pictures/ and scene.toml;
    while the run goes on, checkpoint.h5. A scene with a table [accuracy] says how well it wants to know something: the
    cheapest model that will do is chosen and checked.
    """
    from weavecell import fidelity, run

    if explain:
        fidelity.explain(scene)
        return

    run.impact(scene, out or RESULTS / scene.stem, resume=resume)


@app.command(epilog="Example: [bold]weavecell biaxial S-720 --ratio 1:1 --ratio 2:1 --crossover coarse[/bold]")
def biaxial(
    fabric: FabricArgument,
    ratio: Annotated[
        list[str] | None,
        typer.Option(help="Warp strain to weft strain; may be given again. 0 holds a yarn.", metavar="WARP:WEFT"),
    ] = None,
    crossover: Annotated[
        Size | None, typer.Option(help="Solve the 3D crossover too, with this mesh, and compare.")
    ] = None,
    profile: Annotated[
        Profile, typer.Option(help="Of the yarns: the source's cosine, or Kawabata's straight segments.")
    ] = Profile.cosine,
    toe: Annotated[
        str,
        typer.Option(help="Strain that the fibres' straightening takes, of both or of each.", metavar="WARP[,WEFT]"),
    ] = "0",
    out: OutOption = None,
):
    """Stretch a crossover at fixed ratios of strains to the strength of a yarn: 1:1, 1:0 and 0:1 if none is given.

    The folder then holds biaxial.csv, biaxial.json, pictures/ and report.html. A whole specimen: `weavecell coupon`.
    """
    from weavecell import biaxial as module

    module.biaxial_command(
        fabric,
        out or RESULTS / f"biaxial-{Path(fabric).stem}",
        ratios=ratio or ("1:1", "1:0", "0:1"),
        size=crossover and crossover.value,
        profile=profile.value,
        toe=module.toes(toe),
    )


@app.command(epilog="Example: [bold]weavecell coupon examples/coupons/S-728-bias.toml[/bold]")
def coupon(
    scene: Annotated[Path, typer.Argument(metavar="SCENE", help="The scene file of a coupon (*.toml).")],
    out: OutOption = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on from the last step of an interrupted run.")] = False,
):
    """Test a piece of cloth quasi-statically: bias extension, picture frame, uniaxial or biaxial tension.

    The folder then holds report.html, summary.json, histories.h5, pictures/ and scene.toml; while the run goes on,
    checkpoint.h5.
    """
    from weavecell import coupon as module

    module.coupon(scene, out or RESULTS / scene.stem, resume=resume)


@app.command("critical-velocity", epilog="Example: [bold]weavecell critical-velocity S-720 --tolerance '1 m/s'[/bold]")
def critical_velocity(
    target: Annotated[
        str, typer.Argument(metavar="SCENE|FABRIC", help="A scene, a fabric of the catalogue, or a fabric file.")
    ],
    tolerance: Annotated[
        str, typer.Option(help="At most between a stop and a perforation.", metavar="VELOCITY")
    ] = "1 m/s",
    curve: Annotated[int, typer.Option(min=0, max=100, help="Shots above the limit, for residual velocities.")] = 8,
    workers: Annotated[int, typer.Option(min=1, help="Shots that are fired beside each other.")] = CORES,
    out: OutOption = None,
):
    """Bisect for the velocity between stop and perforation, and fit residual velocities (Lambert-Jonas).

    A scene's own strike velocity and end time do not matter; a fabric is shot at as in the source's tests.

    The folder then holds critical-velocity.json, shots.csv, residual-velocity.svg and scene.toml.
    """
    from fabrics.units import si
    from weavecell import critical_velocity as command

    width = si(tolerance, "m/s", key="--tolerance")
    if not width > 0:
        raise InputError(key="--tolerance", value=tolerance, allowed="above 0")
    command.critical_velocity(
        target,
        out or RESULTS / f"critical-velocity-{Path(target).stem}",
        tolerance=width,
        curve=curve,
        workers=workers,
    )


@app.command(epilog="Example: [bold]weavecell validate --topic impact1 --topic cell[/bold]")
def validate(
    topic: Annotated[
        list[str] | None, typer.Option(help="Only the claims of this topic; may be given again.", metavar="TOPIC")
    ] = None,
    slow: Annotated[bool, typer.Option("--slow", help="Also the checks that take minutes each.")] = False,
    jobs: Annotated[int, typer.Option(min=1, help="Processes that work beside each other.")] = CORES,
    resume: Annotated[bool, typer.Option("--resume", help="Go on from what an interrupted run has left.")] = False,
    out: OutOption = None,
):
    """Put the claims of the source thesis to the test: each with our number, its verdict and, if missed, the cause.

    A missed claim is a result, not an error. The folder then holds ledger.html, ledger.csv and ledger.json.

    Topics: geom, compr, yarn, cell, shear, wave, impact1, impactN, gap, biaxial, bias, sens, slip, pencil, cost,
    failmode, future.
    """
    from weavecell import validate as module

    return module.validate(out or RESULTS / "validate", topics=topic or (), slow=slow, jobs=jobs, resume=resume)


app.command(epilog=cli_charts.CHART)(cli_charts.chart)
app.command(epilog=cli_charts.STABILITY)(cli_charts.stability)
app.command(epilog=cli_cases.EPILOG)(cli_cases.crossover)
app.command(epilog=cli_scatter.SENSITIVITY)(cli_scatter.sensitivity)
app.command(epilog=cli_scatter.V50)(cli_scatter.v50)


@app.command(epilog="Example: [bold]weavecell view results/S-720-stops --screenshot panel.png[/bold]")
def view(
    path: Annotated[
        Path, typer.Argument(metavar="PATH", help="A folder of results, or a .vtu, .pvd or .msh file.", exists=False)
    ],
    screenshot: Annotated[
        Path | None, typer.Option(help="Write a picture instead of opening a window.", metavar="FILE.png")
    ] = None,
):
    """Look at a mesh or a result in a window, or write a picture of it."""
    from weavecell import viewer

    viewer.view(path, screenshot)


@fabrics_app.command("list", epilog="Example: [bold]weavecell fabrics list[/bold]")
def fabrics_list(
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Also write it as CSV.", metavar="FILE.csv")] = None,
):
    """The catalogue, one line a fabric."""
    from weavecell import listing

    listing.show_all(out)


@fabrics_app.command("show", epilog="Example: [bold]weavecell fabrics show S-720 --out .[/bold]")
def fabrics_show(
    fabric: FabricArgument,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="Also copy its data file here, to start your own from.", metavar="FOLDER"),
    ] = None,
):
    """One fabric: what follows from its data, and where each number comes from."""
    from weavecell import listing

    listing.show(fabric, out)


def main(arguments=None):
    """Run the command line; never returns."""
    # click's own class, wherever this typer keeps its click
    usage_error = next(base for base in typer.BadParameter.__mro__ if base.__name__ == "ClickException")
    try:
        code = app(args=arguments, standalone_mode=False)
    except WeavecellError as problem:
        _fail(str(problem), problem.exit_code)
    except usage_error as problem:
        _fail(" ".join(problem.format_message().split()), InputError.exit_code)
    except ModuleNotFoundError as problem:
        _fail(f"this command needs the Python package {problem.name}, which is not installed", 1)
    except OSError as problem:  # a full disk, a folder that may not be written to
        _fail(f"{problem.filename}: {problem.strerror}" if problem.filename else str(problem), 1)
    except (typer.Abort, KeyboardInterrupt):
        code = INTERRUPTED
    if code == INTERRUPTED:
        _fail("interrupted", INTERRUPTED)
    sys.exit(code if isinstance(code, int) else 0)


def _fail(line, code):
    if line:  # a command without its sub-command has printed its help and has nothing to add
        print(f"error: {line}", file=sys.stderr)
    sys.exit(code)
