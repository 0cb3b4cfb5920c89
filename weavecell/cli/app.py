"""The `weavecell` command. Nothing heavy is imported before a command needs it, so that help comes at once.

Exit codes: 0 done; 2 bad input (a line on stderr for each problem, nothing written); 3 a run became unstable (what it
had computed is kept); 130 interrupted.
"""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer

from fabrics.errors import InputError, WeavecellError, marked
from weavecell.cli import (
    crossover,
    export,
    fit,
    mesh_calibrate_surface,
    new_fabric,
    shell,
    uncertainty,
    validation,
)
from weavecell.cli.options import (
    CORES,
    RESULTS,
    ExecutorOption,
    FabricArgument,
    JobsOption,
    MeshOption,
    OutOption,
    Size,
)

app = typer.Typer(
    name="weavecell",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Woven ballistic fabrics: unit cell, calibration, impact.",
    epilog="Example: [bold]weavecell demo[/bold], then open results/demo/report.html",
)
fabrics_app = typer.Typer(no_args_is_help=True, help="The fabrics of the catalogue.", rich_markup_mode="rich")
app.add_typer(fabrics_app, name="fabrics", epilog="Example: [bold]weavecell fabrics list[/bold]")
projectiles_app = typer.Typer(no_args_is_help=True, help="The projectiles by name.", rich_markup_mode="rich")
app.add_typer(projectiles_app, name="projectiles", epilog="Example: [bold]weavecell projectiles list[/bold]")
backings_app = typer.Typer(no_args_is_help=True, help="The backings by name.", rich_markup_mode="rich")
app.add_typer(backings_app, name="backings", epilog="Example: [bold]weavecell backings list[/bold]")

INTERRUPTED = 130
# objects from one collection of cyclic garbage to the next (Python: 700): modules, kernels and pictures are hundreds of
# thousands that live to the end of a command, and going through them again and again took a twentieth of its time
COLLECT_EVERY = 10_000


def _version(wanted: bool) -> None:
    if wanted:
        import weavecell

        typer.echo(f"weavecell {weavecell.__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool | None, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = None,
) -> None:
    pass


@app.command(epilog="Example: [bold]weavecell demo --out results/demo[/bold]")
def demo(
    out: OutOption = None,
    size: MeshOption = Size.medium,
    jobs: JobsOption = CORES,
    executor: ExecutorOption = "local",
) -> None:
    """S-720 of the catalogue: mesh, calibration, and four impacts, with a summary and one HTML page."""
    from weavecell.commands.demo import demonstrate

    demonstrate(out or RESULTS / "demo", size=size.value, jobs=jobs, executor=executor)


app.command(epilog=mesh_calibrate_surface.MESH)(mesh_calibrate_surface.mesh)
app.command(epilog=mesh_calibrate_surface.CALIBRATE)(mesh_calibrate_surface.calibrate)
app.command(epilog=mesh_calibrate_surface.SURFACE)(mesh_calibrate_surface.surface)
app.command(epilog=shell.IMPACT)(shell.impact)
app.command(epilog=shell.BIAXIAL)(shell.biaxial)
app.command(epilog=shell.COUPON)(shell.coupon)
app.command(epilog=shell.COMPARE)(shell.compare)
app.command("critical-velocity", epilog=shell.CRITICAL_VELOCITY)(shell.critical_velocity)


app.command(epilog=validation.VALIDATE)(validation.validate)
app.command("cost-accuracy", epilog=validation.COST_ACCURACY)(validation.cost_accuracy)
app.command(epilog=validation.STABILITY)(validation.stability)
app.command(epilog=crossover.EPILOG)(crossover.crossover)
app.command(epilog=uncertainty.SENSITIVITY)(uncertainty.sensitivity)
app.command(epilog=uncertainty.V50)(uncertainty.v50)
app.command(epilog=uncertainty.SWEEP)(uncertainty.sweep)
app.command(epilog=export.EPILOG)(export.export)
app.command(epilog=export.CONVERT)(export.convert)
app.command(epilog=fit.EPILOG)(fit.fit)


@app.command(epilog="Example: [bold]weavecell view results/S-720-stops --screenshot panel.png[/bold]")
def view(
    path: Annotated[
        Path, typer.Argument(metavar="PATH", help="A folder of results, or a .vtu, .pvd or .msh file.", exists=False)
    ],
    screenshot: Annotated[
        Path | None, typer.Option(help="Write a picture instead of opening a window.", metavar="FILE.png")
    ] = None,
    movie: Annotated[
        Path | None,
        typer.Option(
            help="Write the snapshots of a panel or pack as a movie (MP4 needs imageio).", metavar="FILE.gif|mp4"
        ),
    ] = None,
    cut: Annotated[
        bool, typer.Option("--cut", help="The section through the impact point in place of the whole panel or pack.")
    ] = False,
) -> None:
    """Look at a mesh or a result in a window, or write a picture or a movie of it.

    A picture or movie of a panel or pack shows all of it, its projectile, a scale of the tensions and the outcome; with
    --cut its section along the warp through the impact point.
    """
    from weavecell.commands import view as commands_view

    commands_view.view(path, screenshot, movie, cut)


@fabrics_app.command("list", epilog="Example: [bold]weavecell fabrics list[/bold]")
def fabrics_list(
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Also write it as CSV.", metavar="FILE.csv")] = None,
) -> None:
    """The catalogue, one line a fabric."""
    from weavecell.commands import fabrics as commands_fabrics

    commands_fabrics.show_all(out)


@fabrics_app.command("show", epilog="Example: [bold]weavecell fabrics show S-720 --out .[/bold]")
def fabrics_show(
    fabric: FabricArgument,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="Also copy its data file here, to start your own from.", metavar="FOLDER"),
    ] = None,
) -> None:
    """One fabric: what follows from its data, and where each number comes from."""
    from weavecell.commands import fabrics as commands_fabrics

    commands_fabrics.show(fabric, out)


fabrics_app.command("new", epilog=new_fabric.EPILOG)(new_fabric.new)


@projectiles_app.command("list", epilog="Example: [bold]weavecell projectiles list[/bold]")
def projectiles_list(
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Also write it as CSV.", metavar="FILE.csv")] = None,
) -> None:
    """Fragment simulators, cylinders and spheres that an input file may name, one line each."""
    from weavecell.commands import lists

    lists.projectiles(out)


@projectiles_app.command("show", epilog='Example: [bold]weavecell projectiles show "FSP 1.10 g"[/bold]')
def projectiles_show(
    projectile: Annotated[str, typer.Argument(metavar="PROJECTILE", help="A name of the list.")],
) -> None:
    """One projectile: where each number comes from."""
    from weavecell.commands import lists

    lists.projectile(projectile)


@backings_app.command("list", epilog="Example: [bold]weavecell backings list[/bold]")
def backings_list(
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Also write it as CSV.", metavar="FILE.csv")] = None,
) -> None:
    """Clay and gelatine that an input file may name behind a panel, one line each."""
    from weavecell.commands import lists

    lists.backings(out)


@backings_app.command("show", epilog='Example: [bold]weavecell backings show "gelatine 10 %"[/bold]')
def backings_show(
    backing: Annotated[str, typer.Argument(metavar="BACKING", help="A name of the list.")],
) -> None:
    """One backing: where each number comes from."""
    from weavecell.commands import lists

    lists.backing(backing)


def main(arguments: Iterable[str] | None = None) -> NoReturn:
    """Run the command line; never returns."""
    gc.set_threshold(COLLECT_EVERY)
    # click's own class, wherever this typer keeps its click
    usage_error: Any = next(base for base in typer.BadParameter.__mro__ if base.__name__ == "ClickException")
    try:
        words = sys.argv[1:] if arguments is None else list(arguments)
        code = app(args=words, standalone_mode=False)
    except WeavecellError as problem:
        _fail(str(problem), problem.exit_code)
    except usage_error as problem:
        _fail(" ".join(problem.format_message().split()), InputError.exit_code)
    except ModuleNotFoundError as problem:
        _fail(f"this command needs the Python package {problem.name}, which is not installed{_hint(problem.name)}", 1)
    except OSError as problem:  # a full disk, a folder that may not be written to
        _fail(f"{problem.filename}: {problem.strerror}" if problem.filename else str(problem), 1)
    except (typer.Abort, KeyboardInterrupt):
        code = INTERRUPTED
    if code == INTERRUPTED:
        _fail("interrupted", INTERRUPTED)
    sys.exit(code if isinstance(code, int) else 0)


def _hint(package):
    """What to install for the packages of the 3D part, which pip does not bring."""
    if (package or "").partition(".")[0] not in ("dolfinx", "petsc4py", "mpi4py", "ufl", "basix", "gmsh", "meshio"):
        return ""
    debian = "python3-dolfinx python3-petsc4py python3-gmsh python3-meshio"
    return f"; the 3D part needs: apt install {debian} (Debian), or conda-forge's fenics-dolfinx, python-gmsh, meshio"


def _fail(line, code):
    if line:  # a command without its sub-command has printed its help and has nothing to add
        print(marked(line), file=sys.stderr)
    sys.exit(code)
