"""The `weavecell` command: each of its commands is a function of the Python interface
(`from_signature`).

Exit codes: 0 done; 2 bad input (a line on stderr for each problem, nothing written), or a path that
cannot be written to, as on a full disk (what had been computed before is kept); 3 a run became
unstable (what it had computed is kept); 130 interrupted, by Ctrl-C or SIGTERM.
"""

from __future__ import annotations

import gc
import logging
import sys
from collections.abc import Callable, Iterable
from operator import attrgetter
from typing import Annotated, Any, NoReturn

import typer

import weavecell
from fabrics.base import door, extras
from fabrics.base.errors import InputError, WeavecellError, marked
from weavecell import api
from weavecell.results import out_folder, progress, termination

INTERRUPTED = 130
# objects from one collection of cyclic garbage to the next (Python: 700): modules, kernels and
# pictures are hundreds of thousands that live to the end of a command, and going through them again
# and again took a twentieth of its time
COLLECT_EVERY = 10_000

# command: name of its function in the Python interface, which is loaded when the command is called,
# arguments that its help ends with, and which keywords of `weavecell.setup` are options; in the
# order of the help
COMMANDS: dict[str, tuple[str, ...]] = {
    "mesh": ("mesh", "S-720 --patch 3x4 --mesh coarse --format vtu,k"),
    "calibrate": ("calibrate", "S-720 --mesh coarse"),
    "surface": ("surface", "S-720 --mesh coarse --points 11"),
    "impact": ("impact", "examples/S-720-stops.toml"),
    "biaxial": ("biaxial", "S-720 --ratio 1:1 --ratio 2:1 --compare-3d coarse"),
    "coupon": ("coupon", "examples/coupons/S-728-bias.toml"),
    "compare": ("compare", "A.toml B.toml --shots 40", "opening", "plies", "areal_density"),
    "plies": (
        "plies",
        "S-728 S-720 --stop 'FSP 1.10 g' --at '250 m/s' --opening '100 mm'",
        "opening",
        "stacking",
    ),
    "reduce tests": ("reduce_tests", "tests.csv"),
    "reduce compression": (
        "reduce_compression",
        "one.csv --pack 4=four.csv --rig rig.csv --platen-area '361 mm^2' --cell-of S-728",
    ),
    "reduce pull-out": ("reduce_pull_out", "S-728 peaks.csv --tension '2 N'"),
    "reduce shot": ("reduce_shot", "flight.csv --mass '3 g' --bandwidth '20 kHz'"),
    "critical-velocity": ("critical_velocity", "S-720 --tolerance '1 m/s'"),
    "crossover yarn": ("crossover.yarn", "S-720 --yarn weft"),
    "crossover platens": ("crossover.platens", "S-720 --pressure '20 MPa' --plies 4"),
    "crossover biaxial": ("crossover.biaxial", "S-720 --end-displacement '0.02 mm'"),
    "crossover path": ("crossover.path", "S-720 --path examples/crossover-path.csv"),
    "crossover shear": ("crossover.shear", "S-720 --shear-angle '50 deg' --mesh coarse"),
    "crossover pull-out": ("crossover.pull_out", "S-720 --friction 0.2"),
    "v50": ("v50", "S-720 --shots 200", "opening", "grading"),
    "next": ("measure_first", "results/v50-S-720"),
    "sweep": ("sweep", "pack.toml --over panel.plies=2,4,8 --quantity critical-velocity"),
    "export": ("export", "examples/S-720-stops.toml --to lsdyna --units g-mm-ms"),
    "show": ("show", "S-720"),
    "cite": ("cite", "results/S-720-stops"),
    "view": ("view", "results/S-720-stops --screenshot panel.png"),
    "new": ("new_shot", "shot.toml"),
    "fabrics list": ("fabrics", ""),
    "fabrics new": ("new_fabric", "mine.toml --from mine.csv"),
    "projectiles list": ("projectiles", ""),
    "metals list": ("metals", ""),
    "backings list": ("backings", ""),
}
# group: what it is, and the command that its help ends with
GROUPS = {
    "crossover": ("The 3D crossover under a load.", "shear S-720"),
    "reduce": ("Records of a laboratory, reduced.", "shot flight.csv --mass '3 g'"),
    "fabrics": ("The fabrics of the catalogue.", "list"),
    "projectiles": ("The projectiles by name.", "list"),
    "metals": ("The metals of projectiles by name.", "list"),
    "backings": ("The backings by name.", "list"),
}


def find_function(name: str) -> Callable[..., Any]:
    """Load a function of the Python interface by its name, such as `impact` or `crossover.yarn`."""
    return attrgetter(name)(api)


def program(word: str | None = None) -> typer.Typer:
    """Build the command line.

    Parameters
    ----------
    word : command or group that is called, which alone gets its options, from the functions that it
        loads; of another word the commands are names, as the list of commands has them. None gives
        all of them their options.
    """
    called = [name for name in COMMANDS if word in (None, name.partition(" ")[0])]
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
    groups = {"": app}
    for name, (text, example) in GROUPS.items():
        groups[name] = typer.Typer(no_args_is_help=True, help=text, rich_markup_mode="rich")
        epilog = f"Example: [bold]weavecell {name} {example}[/bold]"
        app.add_typer(groups[name], name=name, epilog=epilog)
    for name in called:
        _add_command(groups, name)
    if not called:
        _add_names(groups)
    return app


def _add_command(groups, name):
    """Add a command with its options."""
    from weavecell.cli import from_signature

    function, *rest = COMMANDS[name]
    command, epilog = from_signature.command(find_function(function), name, *rest)
    group, _, word = name.rpartition(" ")
    groups[group].command(word, epilog=epilog)(command)


def _add_names(groups):
    """Add all commands as the list of commands has them, for which nothing is loaded."""
    for name, (function, *_) in COMMANDS.items():
        group, _, word = name.rpartition(" ")
        text = ""
        if not group:
            text = " ".join(api.read_docstring(function).partition("\n\n")[0].split())
        groups[group].command(word, help=text)(_do_nothing)


def _do_nothing() -> None:
    pass


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"weavecell {weavecell.__version__}")
        raise typer.Exit


def _root(
    version: Annotated[
        bool | None,
        typer.Option("--version", callback=_version, is_eager=True, help="Print the version."),
    ] = None,
) -> None:
    pass


class _Lines(logging.Handler):
    """What is assumed goes to stdout with the results, warnings go to stderr, each line once."""

    def __init__(self) -> None:
        super().__init__()
        self.printed: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        message = record.getMessage()
        told = progress.told or record.levelno > logging.INFO or message.startswith("note: ")
        if message in self.printed or not told:
            return
        self.printed.add(record.getMessage())
        progress.write(
            self.format(record), sys.stderr if record.levelno > logging.INFO else sys.stdout
        )


def main(arguments: Iterable[str] | None = None) -> NoReturn:
    """Run the command line; never returns."""
    gc.set_threshold(COLLECT_EVERY)
    for stream in (sys.stdout, sys.stderr):
        # a terminal or a pipe that has no ² prints ?
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")
    progress.shown = True
    log = logging.getLogger("weavecell")
    # plain lines, even if an imported library configures all loggers (ffcx does)
    log.propagate = False
    log.setLevel(logging.INFO)
    log.addHandler(lines := _Lines())
    # click's own class, wherever this typer keeps its click
    usage_error: Any = next(
        base for base in typer.BadParameter.__mro__ if base.__name__ == "ClickException"
    )
    try:
        if arguments is None:
            words = sys.argv[1:]
        else:
            words = list(arguments)
        # "projectile list" is a slip of a command that there is
        plural = bool(words) and any(name.startswith(f"{words[0]}s ") for name in COMMANDS)
        if words and words[0] in weavecell.REMOVED and not (plural and words[1:]):
            raise InputError(f"the command {words[0]} was removed: {weavecell.REMOVED[words[0]]}")
        with termination.interrupt_on_sigterm(), door.open_terminal():
            code = program(" ".join(words[:1]))(args=words, standalone_mode=False)
    except WeavecellError as problem:
        _fail(str(problem), problem.exit_code)
    except usage_error as problem:
        _fail(_explain(problem, words), InputError.exit_code)
    except ModuleNotFoundError as problem:
        _fail(str(extras.MissingPackage(problem.name or str(problem))), 1)
    except OSError as problem:
        # for example a full disk, or a folder without permission to write
        if problem.filename:
            line = f"{problem.filename}: {problem.strerror}"
        else:
            line = str(problem)
        _fail(line, InputError.exit_code)
    except typer.Abort as problem:
        # click makes one of the end of a file, too
        if isinstance(problem.__cause__, EOFError):
            raise problem.__cause__ from None
        if isinstance(problem.__context__, EOFError):
            _fail("standard input ended before all was answered", InputError.exit_code)
        code = INTERRUPTED
    except KeyboardInterrupt:
        code = INTERRUPTED
    finally:
        out_folder.release()
        progress.shown = False
        log.removeHandler(lines)
        log.propagate = True
    if code == INTERRUPTED:
        _fail("interrupted", INTERRUPTED)
    sys.exit(code if isinstance(code, int) else 0)


def _explain(problem, words):
    """Return the line of a problem with options; one of earlier versions says what took its
    place."""
    name = getattr(problem, "option_name", "").removeprefix("--").removeprefix("no-")
    if not name:
        return " ".join(problem.format_message().split())
    from weavecell.api import gone

    called = next((word for word in words if word in COMMANDS), "")
    try:
        with door.open_terminal():
            gone.refuse_gone(called.replace("-", "_"), [name.replace("-", "_")])
    except InputError as removed:
        return str(removed)
    return " ".join(problem.format_message().split())


def _fail(line, code):
    # a group without a command has printed its help, and has nothing to add
    if line:
        print(marked(line), file=sys.stderr)
    sys.exit(code)
