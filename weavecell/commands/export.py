"""A panel or pack as a deck for another code (`report.deck_folder`).

The folder of `weavecell export`
    NAME.k                       the deck for LS-DYNA
    NAME_0000.rad, NAME_0001.rad the decks of OpenRadioss's starter and engine
    mapping.svg                  the law less the cell over the biaxial plane
    summary.json                 the mapping's error, provenance
    report.html                  the error in a table and the plot, and what the law does not hold
"""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from fabrics import lazy
from fabrics.errors import InputError
from weavecell.commands.options import RESULTS, OutOption, TargetArgument, example

with lazy.imports():
    from weavecell.report import deck_folder
    from weavecell.results import out_folder
    from weavecell.scenes import target


class Target(StrEnum):
    """Codes that decks are written for."""

    lsdyna = "lsdyna"
    radioss = "radioss"


class Unit(StrEnum):
    """Consistent units of a deck."""

    si = "kg-m-s"
    small = "g-mm-ms"


class Match(StrEnum):
    """What a law is to be nearest to."""

    plane = "plane"
    uniaxial = "uniaxial"


@example("weavecell export examples/S-720-stops.toml --to lsdyna --units g-mm-ms")
def export(
    name: TargetArgument,
    to: Annotated[Target, typer.Option(help="Code that the deck is for.")],
    units: Annotated[Unit, typer.Option(help="Consistent units of the deck.")] = Unit.si,
    match: Annotated[
        Match,
        typer.Option(help="What the law is nearest to: the cell over the biaxial plane, or in uniaxial tension."),
    ] = Match.plane,
    out: OutOption = None,
) -> None:
    """A panel or pack as a deck for another code: mesh, material card, boundary, rigid projectile, contact, output.

    The error of the material card against the unit cell is in the deck's header, printed, and in report.html. Of the
    input file, the tables history and numerics, the contact law of plies, and what a run records mean nothing here.
    Nothing breaks in a deck. OpenRadioss was run with earlier decks, LS-DYNA was not: see docs/reports/cards.md.
    """
    out = out or RESULTS / f"export-{Path(name).stem}-{to.value}"
    this = target.read(name, out, deck_folder.SUPPORT)
    out_folder.claim(out)
    try:
        made = deck_folder.made_of(
            this.setup, to.value, units.value, match.value, title=_title(this), source=this.law_name
        )
    except InputError as problem:
        raise this.in_file(problem) from None
    deck_folder.write(made, out, to.value, Path(name).stem, match.value, this.text, this.setup.fabric)
    for card in made.cards:
        numbers = card.mismatch.numbers().items()
        print(f"{card.name}: " + ", ".join(f"{deck_folder.ROWS[k]} {deck_folder.percent(v)}" for k, v in numbers))
    print(f"of the strength; the deck has not been run in {deck_folder.CODES[to].name}")
    print(f"written to {out}", flush=True)


def _title(this):
    scene = this.case.scene
    return scene.title or f"{this.title}, {scene.projectile.strike_velocity:g} m/s"
