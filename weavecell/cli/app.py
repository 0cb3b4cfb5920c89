"""The `weavecell` command, of functions of the Python interface (`from_signature`) and of `weavecell.commands`.

A function of `weavecell.commands` has its arguments and options as its signature, its help as its docstring, and its
example (`options.example`). A call imports the module of its command alone: help comes at once.

Exit codes: 0 done; 2 bad input, or a path that cannot be written to (a line on stderr for each problem, nothing
written); 3 a run became unstable (what it had computed is kept); 130 interrupted.
"""

from __future__ import annotations

import errno
import gc
import logging
import re
import sys
from collections.abc import Iterable
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer

from fabrics.errors import InputError, WeavecellError, marked
from weavecell.results import out_folder, progress

INTERRUPTED = 130
UNWRITABLE = {errno.EACCES, errno.EPERM, errno.EROFS, errno.ENOTDIR, errno.EISDIR, errno.EEXIST}  # bad input
# objects from one collection of cyclic garbage to the next (Python: 700): modules, kernels and pictures are hundreds of
# thousands that live to the end of a command, and going through them again and again took a twentieth of its time
COLLECT_EVERY = 10_000

# name: module and function, of weavecell.commands or of the Python interface (weavecell.api), in the order of the help
COMMANDS = {
    "mesh": "mesh.mesh",
    "calibrate": "calibrate.calibrate",
    "surface": "response_surface.surface",
    "impact": "api.shots.shoot",
    "draws": "api.scatter.draws",
    "biaxial": "biaxial.biaxial",
    "coupon": "api.coupons.coupon",
    "compare": "api.comparison.compare",
    "critical-velocity": "api.limits.critical_velocity",
    "crossover": "crossover.crossover",
    "sensitivity": "api.scatter.sensitivity",
    "v50": "api.scatter.v50",
    "sweep": "api.sweeps.sweep",
    "export": "api.exports.export",
    "view": "view.view",
}
# of commands that are functions of the Python interface: the arguments that their help ends with, and which keywords
# of `weavecell.setup` are options
EXAMPLES: dict[str, tuple[str, ...]] = {
    "critical-velocity": ("S-720 --tolerance '1 m/s'",),
    "compare": ("tests.csv examples/S-728-pack.toml",),
    "coupon": ("examples/coupons/S-728-bias.toml",),
    "draws": ("examples/S-720-perforates.toml --count 20",),
    "export": ("examples/S-720-stops.toml --to lsdyna --units g-mm-ms",),
    "impact": ("examples/S-720-stops.toml",),
    "sensitivity": ("S-720 --samples 64", "opening"),
    "sweep": ("pack.toml --over panel.plies=2,4,8 --quantity critical-velocity",),
    "v50": ("S-720 --shots 200 --weibull-shape 14.3", "opening", "grading"),
}
GROUPS = {
    "fabrics": (
        "The fabrics of the catalogue.",
        {"list": "fabrics.show_all", "show": "fabrics.show", "new": "fabrics.new"},
    ),
    "projectiles": ("The projectiles by name.", {"list": "fabrics.projectiles", "show": "fabrics.projectile"}),
    "backings": ("The backings by name.", {"list": "fabrics.backings", "show": "fabrics.backing"}),
}


def program(word: str = "") -> typer.Typer:
    """The command line; of all commands, or of the one that `word` names. With --help they are listed, not loaded."""
    listed = word in ("-h", "--help")
    known = word in COMMANDS or word in GROUPS or word == "--version"
    app = typer.Typer(
        name="weavecell",
        no_args_is_help=True,
        add_completion=False,
        rich_markup_mode="rich",
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
        help="Woven ballistic fabrics: unit cell, calibration, impact.",
        epilog="Example: [bold]weavecell impact examples/S-720-stops.toml[/bold]",
    )
    app.callback()(_root)
    _fill(app, {name: place for name, place in COMMANDS.items() if not known or name == word}, listed)
    for name, (text, commands) in GROUPS.items():
        if not known or name == word:
            group = typer.Typer(no_args_is_help=True, help=text, rich_markup_mode="rich")
            _fill(group, {} if listed else commands)
            app.add_typer(group, name=name, epilog=f"Example: [bold]weavecell {name} list[/bold]")
    return app


def _fill(group, commands, listed=False):
    """Add commands to a group by their names and places; where they are only listed, without importing them."""
    for name, place in commands.items():
        module, function = (place if name in EXAMPLES else f"commands.{place}").rsplit(".", 1)
        if listed:
            group.command(name, help=_summary(module, function))(lambda: None)
            continue
        command = getattr(import_module(f"weavecell.{module}"), function)
        if name in EXAMPLES:
            from weavecell.cli import from_signature

            command = from_signature.command(command, name, *EXAMPLES[name])
        group.command(name, epilog=command.epilog)(command)


def _summary(module, function):
    """The first paragraph of a command's docstring, from the text of its file."""
    text = (Path(__file__).parents[1] / f"{module.replace('.', '/')}.py").read_text("utf-8")
    return re.search(rf'^def {function}\(.*?"""(.*?)(\n\n|""")', text, re.DOTALL | re.MULTILINE)[1]


def _version(wanted: bool) -> None:
    if wanted:
        import weavecell

        typer.echo(f"weavecell {weavecell.__version__}")
        raise typer.Exit


def _root(
    version: Annotated[
        bool | None, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = None,
) -> None:
    pass


class _Lines(logging.Handler):
    """What is assumed goes to stdout with the results, each line once; warnings go to stderr."""

    def __init__(self) -> None:
        super().__init__()
        self.printed: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        if record.levelno == logging.INFO and record.getMessage() in self.printed:
            return
        self.printed.add(record.getMessage())
        print(self.format(record), file=sys.stderr if record.levelno > logging.INFO else sys.stdout, flush=True)


def main(arguments: Iterable[str] | None = None) -> NoReturn:
    """Run the command line; never returns."""
    gc.set_threshold(COLLECT_EVERY)
    progress.shown = True
    log = logging.getLogger("weavecell")
    log.propagate = False  # plain lines, whatever an imported library sets up for all loggers (ffcx does)
    log.setLevel(logging.INFO)
    log.addHandler(lines := _Lines())
    # click's own class, wherever this typer keeps its click
    usage_error: Any = next(base for base in typer.BadParameter.__mro__ if base.__name__ == "ClickException")
    try:
        words = sys.argv[1:] if arguments is None else list(arguments)
        code = program(words[0] if words else "")(args=words, standalone_mode=False)
    except WeavecellError as problem:
        _fail(str(problem), problem.exit_code)
    except usage_error as problem:
        _fail(" ".join(problem.format_message().split()), InputError.exit_code)
    except ModuleNotFoundError as problem:
        _fail(f"this command needs the Python package {problem.name}, which is not installed{_hint(problem.name)}", 1)
    except OSError as problem:  # a full disk, a folder that may not be written to
        code = InputError.exit_code if problem.errno in UNWRITABLE else 1
        _fail(f"{problem.filename}: {problem.strerror}" if problem.filename else str(problem), code)
    except (typer.Abort, KeyboardInterrupt):
        code = INTERRUPTED
    finally:
        out_folder.release()
        progress.shown = False
        log.removeHandler(lines)
        log.propagate = True
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
