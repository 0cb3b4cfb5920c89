"""`weavecell export` and `weavecell convert`: their options, as texts for the commands."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from weavecell.cli.options import RESULTS, OutOption, TargetArgument

EPILOG = "Example: [bold]weavecell export examples/S-720-stops.toml --to lsdyna --units g-mm-ms[/bold]"
CONVERT = "Example: [bold]weavecell convert results/S-720-stops --to vtkhdf[/bold]"


class Code(StrEnum):
    """Codes that decks are written for."""

    lsdyna = "lsdyna"
    radioss = "radioss"
    abaqus = "abaqus"


class Unit(StrEnum):
    """Consistent units of a deck."""

    si = "kg-m-s"
    small = "g-mm-ms"


class Format(StrEnum):
    """Formats of results."""

    vtkhdf = "vtkhdf"
    parquet = "parquet"


class Match(StrEnum):
    """What a law is to be nearest to."""

    plane = "plane"
    uniaxial = "uniaxial"


def export(
    target: TargetArgument,
    to: Annotated[Code, typer.Option(help="Code that the deck is for.")],
    law: Annotated[
        str | None,
        typer.Option(
            help="Material: fabric34 of lsdyna, law58 (default) or law19 of radioss, fabric of abaqus.",
            metavar="fabric34|law58|law19|fabric",
        ),
    ] = None,
    units: Annotated[Unit, typer.Option(help="Consistent units of the deck.")] = Unit.si,
    match: Annotated[
        Match,
        typer.Option(help="What the law is nearest to: the cell over the biaxial plane, or in uniaxial tension."),
    ] = Match.plane,
    out: OutOption = None,
) -> None:
    """A panel or pack as a deck for another code: mesh, material card, boundary, rigid projectile, contact, output.

    The error of the material card against the unit cell is in the deck's header, printed, and in report.html. Of the
    input file, the tables history and numerics, the contact law of plies, and what a run records mean nothing here. No
    deck has been run in the code that it is for.
    """
    from weavecell.commands import export as command

    folder = out or RESULTS / f"export-{Path(target).stem}-{to}"
    command.export(target, folder, to=str(to), law=law, units=str(units), match=str(match))


def convert(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="Folder of a finished impact, or of a coupon.")],
    to: Annotated[Format, typer.Option(help="Format that is written.")],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", help="File to write; by default panel.vtkhdf or histories.parquet in FOLDER.", metavar="FILE"
        ),
    ] = None,
) -> None:
    """Results of a finished run in a standard format.

    vtkhdf: all snapshots of an impact in one file for ParaView, with the fields of panel.pvd, which the run must have
    written. parquet: the histories of an impact or a coupon, a row a sample, with units in the schema; needs pyarrow.
    """
    from weavecell.results import convert as command

    print(f"written to {command.convert(folder, str(to), out)}")
