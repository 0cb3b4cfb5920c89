"""Arguments and options that several commands of the command line share."""

from __future__ import annotations

import os
import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

# options by names that they had before; accepted for one release
RENAMED = {"--processes": "--jobs", "--workers": "--jobs", "--pool": "--executor"}
RESULTS = Path("results")
CORES = os.cpu_count() or 1


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


def with_new_names(arguments):
    """The arguments of a command line, options by old names under their new ones, with a warning for each."""
    found = []
    for word in arguments:
        name, equals, value = word.partition("=")
        if name in RENAMED:
            print(f"warning: {name} is now {RENAMED[name]}; the next release has {name} no more", file=sys.stderr)
            word = RENAMED[name] + equals + value
        found.append("local" if found[-1:] == ["--executor"] and word == "processes" else word)
    return found


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
        help="Go on from what an interrupted run has left. Finished results of another version of the code are "
        "computed again; the state of an unfinished run (checkpoint.h5, partial.h5) of another version is refused.",
    ),
]
StrictOption = Annotated[
    bool, typer.Option("--strict", help="Exit code 3 if a quality indicator is beyond its limit; results are written.")
]
JobsOption = Annotated[int, typer.Option("--jobs", min=1, help="Runs that are under way at once.", metavar="N")]
ExecutorOption = Annotated[
    str,
    typer.Option(
        "--executor",
        help="Where they are run: processes of this machine; the ranks of mpiexec -n RANKS python -m mpi4py.futures "
        "-m weavecell ...; Parsl; Dask; or the concurrent.futures.Executor that your function returns.",
        metavar="local|mpi|parsl|dask|MODULE:FUNCTION",
    ),
]
MeshOption = Annotated[Size, typer.Option(help="Mesh of the 3D crossover.")]
FinenessOption = Annotated[
    str,
    typer.Option(
        help="How fine: a name, hexahedra along, across and through a quarter yarn, or an edge length.",
        metavar="auto|coarse|medium|fine|NX,NY,NZ|LENGTH",
    ),
]
SectionOption = Annotated[Section | None, typer.Option(help="Yarn section; the fabric's own if not given.")]
GapOption = Annotated[str, typer.Option(help="Gap between parallel yarns.", metavar="LENGTH")]
FrictionOption = Annotated[float, typer.Option(min=0, help="Coulomb's coefficient between the yarns.")]
