"""Arguments and options that several commands share, and what the texts of a mesh's options mean."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Container
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any, TypeVar

import typer

from fabrics import units
from fabrics.errors import InputError

RESULTS = Path("results")
RUNS = "runs"  # folder of finished runs, from which --resume goes on
Function = TypeVar("Function", bound=Callable[..., Any])
CORES = os.cpu_count() or 1
SIZES = ("coarse", "medium", "fine", "auto")
_LENGTHS = {"gap": "--yarn-gap", "end_shells": "--end-shells"}


class Size(StrEnum):
    """Mesh sizes of a crossover."""

    coarse = "coarse"
    medium = "medium"
    fine = "fine"


class Section(StrEnum):
    """Yarn sections."""

    sine = "sine"
    ellipse = "ellipse"
    conforming = "conforming"


FabricArgument = Annotated[
    str, typer.Argument(metavar="FABRIC", help="A name of the catalogue, or the path of a fabric file.")
]
OutOption = Annotated[
    Path | None,
    typer.Option(
        "--out", "-o", help="Folder for what is written; by default one of its own in results/.", metavar="FOLDER"
    ),
]
ResumeOption = Annotated[
    bool,
    typer.Option(
        "--resume",
        help="Continue an interrupted run. Finished results of another version of the code are "
        "computed again; the state of an unfinished run (checkpoint.h5, partial.h5) of another version is refused.",
    ),
]
JobsOption = Annotated[int, typer.Option("--jobs", min=1, help="Number of runs in parallel.", metavar="N")]
ExecutorOption = Annotated[
    str,
    typer.Option(
        "--executor",
        help="Where runs are executed: processes of this machine; the ranks of mpiexec -n RANKS python -m "
        "mpi4py.futures -m weavecell ...; or the workers of the Dask scheduler at DASK_SCHEDULER_ADDRESS.",
        metavar="local|mpi|dask",
    ),
]
MeshOption = Annotated[Size, typer.Option("--mesh", help="Mesh of the 3D crossover.")]
FinenessOption = Annotated[
    str,
    typer.Option(
        "--mesh",
        help="Mesh: a name, the numbers of hexahedra along, across and through a quarter yarn, or an edge length.",
        metavar="auto|coarse|medium|fine|NX,NY,NZ|LENGTH",
    ),
]
SectionOption = Annotated[Section | None, typer.Option(help="Yarn section; the fabric's own if not given.")]
GapOption = Annotated[str, typer.Option("--yarn-gap", help="Gap between parallel yarns.", metavar="LENGTH")]
FrictionOption = Annotated[float, typer.Option(min=0, help="Coulomb's coefficient between the yarns.")]
ListOption = Annotated[Path | None, typer.Option("--out", "-o", help="Also write it as CSV.", metavar="FILE.csv")]


def example(words: str) -> Callable[[Function], Function]:
    """Give a command the example that its help ends with."""

    def mark(command):
        command.epilog = f"Example: [bold]{words}[/bold]"
        return command

    return mark


def refuse_others(context: typer.Context, allowed: Container[str], where: str) -> None:
    """InputError for the first option on the command line, by the name of its parameter, that is not in `allowed`."""
    for entry in context.command.params:
        source = context.get_parameter_source(entry.name)
        if source is not None and source.name == "COMMANDLINE" and entry.name not in allowed:
            raise InputError(key=entry.opts[0], allowed=f"left out {where}")


def mesh_choices(*, size: str, crimp: str = "hand", width: str | None = None, **others: Any) -> dict[str, Any]:
    """Keywords of `meshing.crossover.build` and `meshing.patch.build`.

    Parameters
    ----------
    size, crimp, width : texts, as of `weavecell mesh`; width None where it is not given
    others : of `meshing.inputs.MeshOptions`; gap and end_shells as texts, the rest as it is

    Raises
    ------
    InputError : a text that is none of these, with the option of the command line
    """
    found = {"size": parse_size(size), **others}
    given = {name: key for name, key in _LENGTHS.items() if others.get(name) is not None}
    found |= {name: units.si(others[name], "m", key=key) for name, key in given.items()}
    found["crimp"] = crimp if crimp in ("hand", "micrograph") else pair(crimp, "", "--crimp")
    found["width"] = None if width is None else pair(width, "m", "--width")
    return found


def parse_size(text: str) -> Any:
    """A name, three numbers, or an edge length [m], as `meshing.inputs.size` takes it."""
    if re.fullmatch(r"\s*\d+\s*(,\s*\d+\s*)*", text):
        return tuple(map(int, text.split(",")))
    if text in SIZES:
        return text
    if re.fullmatch(r"\s*[\d.+-][^,]*", text):
        return units.si(text, "m", key="--mesh")
    raise InputError(key="--mesh", value=text, allowed=f"{', '.join(SIZES)}, nx,ny,nz or a length such as 60um")


def parse_count(text: str) -> Any:
    """(n, m) numbers of warp and weft yarns of a text such as "3x4"."""
    found = re.fullmatch(r"\s*(\d+)\s*[xX×]\s*(\d+)\s*", text)
    if found is None:
        raise InputError(key="--patch", value=text, allowed="numbers of warp and weft yarns, such as 3x4")
    return int(found[1]), int(found[2])


def pair(text: str, unit: str, key: str, what: str = "of warp and weft") -> tuple[float, float]:
    """Two values [SI] of a text with one, or with two separated by a comma; `unit` "" for plain numbers."""
    parts = [part.strip() for part in text.split(",")]
    if len(parts) > 2:
        raise InputError(key=key, value=text, allowed=f"one value, or two separated by a comma, {what}")
    values = [units.si(part, unit, key=key) for part in parts]
    return values[0], values[-1]
