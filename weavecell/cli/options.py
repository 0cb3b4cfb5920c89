"""Arguments and options that several commands of the command line share."""

from __future__ import annotations

import os
from collections.abc import Container
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from fabrics.errors import InputError

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


FabricArgument = Annotated[
    str, typer.Argument(metavar="FABRIC", help="A name of the catalogue, or the path of a fabric file.")
]
TargetArgument = Annotated[
    str,
    typer.Argument(metavar="FILE|FABRIC", help="An input file of one ply or a pack, a fabric's name, or its file."),
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
StrictOption = Annotated[
    bool, typer.Option("--strict", help="Exit code 3 if a quality indicator is beyond its limit; results are written.")
]
JobsOption = Annotated[int, typer.Option("--jobs", min=1, help="Number of runs in parallel.", metavar="N")]
ExecutorOption = Annotated[
    str,
    typer.Option(
        "--executor",
        help="Where runs are executed: processes of this machine; the ranks of mpiexec -n RANKS python -m "
        "mpi4py.futures -m weavecell ...; Parsl; Dask; or the concurrent.futures.Executor that your function returns.",
        metavar="local|mpi|parsl|dask|MODULE:FUNCTION",
    ),
]
SeedOption = Annotated[int, typer.Option(min=0, help="Seed of the random numbers.")]
WeibullOption = Annotated[
    float | None, typer.Option("--weibull-shape", help="Weibull shape of the yarns' strength; inf for none.", min=1.0)
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


def refuse_others(context: typer.Context, allowed: Container[str], where: str) -> None:
    """InputError for the first option on the command line, by the name of its parameter, that is not in `allowed`."""
    for entry in context.command.params:
        source = context.get_parameter_source(entry.name)
        if source is not None and source.name == "COMMANDLINE" and entry.name not in allowed:
            raise InputError(key=entry.opts[0], allowed=f"left out {where}")
