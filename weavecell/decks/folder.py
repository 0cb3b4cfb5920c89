"""The folder of a deck: a panel or pack for LS-DYNA or OpenRadioss, with the error of its material card.

What runs in OpenRadioss gave is in docs/reports/cards.md; LS-DYNA has not been run.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from fabrics import files
from fabrics.errors import InputError
from shellfabric.impact.simulation import ImpactSetup
from weavecell.decks import ls_dyna, model, picture, radioss
from weavecell.decks.cloth import MATCHES
from weavecell.decks.laws import CrimpExchange, UncoupledCurves
from weavecell.decks.mismatch import LIMIT
from weavecell.report import page as report_page
from weavecell.report import pictures
from weavecell.report.page import Card, Figure, Report, Section, Table
from weavecell.results import json_file, provenance
from weavecell.scenes import honoured
from weavecell.scenes.impact import SlipTable


@dataclass(frozen=True)
class Code:
    """A code that decks are written for, with its law: the class here, the keyword there."""

    name: str
    write: Callable[[model.Deck, str], dict[str, str]]
    kind: Any
    keyword: str


CODES = {
    "lsdyna": Code("LS-DYNA", ls_dyna.write, UncoupledCurves, "*MAT_FABRIC (034), FORM 14"),
    "radioss": Code("OpenRadioss", radioss.write, CrimpExchange, "/MAT/LAW58 (FABR_A)"),
}
ROWS = {
    "rms": "rms over the biaxial plane", "largest": "largest over the biaxial plane",
    "uniaxial": "largest in uniaxial tension", "shear": "largest in trellis shear until locking",
}  # fmt: skip
_NEAREST = {"plane": "nearest to the cell over the biaxial plane", "uniaxial": "nearest to it in uniaxial tension"}
_SIDES = [f"panel.boundary.{side}{key}" for side in ("", "warp.", "weft.") for key in SlipTable.model_fields]
_IN_PART = "panel.boundary", "panel.ply.angle"  # refused for some of their values, the angle by `model.build`
NOT_HONOURED = (
    honoured.SHOTS
    | {"history": None}
    | {key: allowed for key, (allowed, _) in model.REFUSED.items() if key not in _IN_PART}
    | dict.fromkeys(_SIDES, model.REFUSED["panel.boundary"][0])
)


def check(to: str, units: str, match: str) -> None:
    """Check the choices of a deck.

    Raises
    ------
    InputError : a code that is none of CODES, or unknown units or match
    """
    for key, value, names in (("to", to, CODES), ("units", units, model.UNITS), ("match", match, MATCHES)):
        if value not in names:
            raise InputError(key=key, value=value, allowed=" or ".join(names))


def made_of(setup: ImpactSetup, to: str, units: str, match: str, *, title: str, source: str) -> model.Deck:
    """The deck of a set-up, by choices that `check` accepts; other parameters and exceptions as `model.build`."""
    code = CODES[to]
    return model.build(
        setup, partial(code.kind.of, match=match), units, title=title, source=source,
        law=f"{code.keyword}, {_NEAREST[match]}", code=code.name,
    )  # fmt: skip


def write(made: model.Deck, out: Path, to: str, stem: str, match: str, text: str, fabric: Any) -> None:
    """Write the files of the folder, each whole or not at all."""
    texts = CODES[to].write(made, stem)
    section = chapter(made)
    stamp = provenance.stamp(text, fabric)
    for name, content in texts.items():
        files.write(out / name, content)
    report_page.write_pictures([section], out)
    numbers = [{"material": card.name} | card.mismatch.numbers() for card in made.cards]
    entries = {
        "code": to,
        "match": match,
        "run_in_the_code": False,
        "error_over_strength": numbers,
        "provenance": stamp,
    }
    json_file.write(out / "summary.json", entries | {"provenance": stamp})
    worst = max(card.mismatch.worst for card in made.cards)
    headline = f"{percent(worst)} of the strength at most"
    head = Card("Error of the material card", headline, (), "unstable" if worst > LIMIT else "plain")
    page = Report(made.title, f"Deck for {CODES[to].name}, not run in it", ((head,),), (section, _text(made.header)))
    report_page.write(page, out / "report.html")


def chapter(made: model.Deck) -> Section:
    """Error of the cards in a table and a plot."""
    first = made.cards[0]
    rows = tuple(
        (words, *(percent(card.mismatch.numbers()[key]) for card in made.cards)) for key, words in ROWS.items()
    )
    figure = Figure(
        pictures.render(picture.plane, first.mismatch), "svg",
        f"Law less cell of {first.name}, where both yarns are below their strength.", "mapping",
    )  # fmt: skip
    columns = ("over the strength", *(card.name for card in made.cards))
    lead = (
        f"The law is evaluated here by its own equations, and held against the unit cell. Not held: {first.law.lost}."
    )
    return Section("mapping", "Error of the mapping", lead, (figure,), (Table(columns, rows, "", columns[1:]),))


def _text(lines):
    return Section("header", "Header of the deck", details=(("as in the file", "\n".join(lines)),))


def percent(value: float) -> str:
    """A share as a text."""
    return f"{100 * value:.1f} %"
