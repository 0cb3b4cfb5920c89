"""The folder of a deck: a panel or pack for LS-DYNA, OpenRadioss or Abaqus, with the error of its material card.

No deck has been run in the code that it is for.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from fabrics import files
from fabrics.errors import InputError
from shellfabric.impact.simulation import ImpactSetup
from weavecell.analysis.material_card.cloth import MATCHES, Cloth
from weavecell.analysis.material_card.laws import CrimpExchange, Linear, UncoupledCurves
from weavecell.analysis.material_card.mismatch import LIMIT
from weavecell.report import page as report_page
from weavecell.report import pictures, pictures_card
from weavecell.report.page import Card, Figure, Report, Section, Table
from weavecell.results import deck, deck_abaqus, deck_ls_dyna, deck_radioss, json_file, provenance
from weavecell.scenes import target
from weavecell.scenes.impact import SlipTable


@dataclass(frozen=True)
class Form:
    """A law that a code has: its class here, its keyword there."""

    kind: Any
    keyword: str


@dataclass(frozen=True)
class Code:
    """A code that decks are written for; the first of its laws is the default."""

    name: str
    write: Callable[[deck.Deck, str], dict[str, str]]
    laws: Mapping[str, Form]


CODES = {
    "lsdyna": Code(
        "LS-DYNA", deck_ls_dyna.write, {"fabric34": Form(UncoupledCurves, "*MAT_FABRIC (034), FORM 14")}
    ),
    "radioss": Code(
        "OpenRadioss", deck_radioss.write,
        {"law58": Form(CrimpExchange, "/MAT/LAW58 (FABR_A)"), "law19": Form(Linear, "/MAT/LAW19 (FABRI)")},
    ),
    "abaqus": Code("Abaqus/Explicit", deck_abaqus.write, {"fabric": Form(UncoupledCurves, "*FABRIC, test data")}),
}  # fmt: skip
ROWS = {
    "rms": "rms over the biaxial plane", "largest": "largest over the biaxial plane",
    "uniaxial": "largest in uniaxial tension", "shear": "largest in trellis shear until locking",
}  # fmt: skip
_NEAREST = {"plane": "nearest to the cell over the biaxial plane", "uniaxial": "nearest to it in uniaxial tension"}
_SIDES = [f"panel.boundary.{side}{key}" for side in ("", "warp.", "weft.") for key in SlipTable.model_fields]
_IN_PART = "panel.boundary", "panel.ply.angle"  # refused for some of their values, the angle by `deck.build`
SUPPORT = target.support(
    ignored=(*target.UNWRITTEN, "history"),
    rejected={key: allowed for key, (allowed, _) in deck.REFUSED.items() if key not in _IN_PART}
    | dict.fromkeys(_SIDES, deck.REFUSED["panel.boundary"][0]),
)  # fmt: skip


def chosen(to: str, law: str | None) -> str:
    """The name of a law of a code, or of its first one.

    Raises
    ------
    InputError : an unknown code, or a law that it does not have here
    """
    if to not in CODES:
        raise InputError(key="--to", value=to, allowed=" or ".join(CODES))
    laws = CODES[to].laws
    if law is not None and law not in laws:
        raise InputError(key="--law", value=law, allowed=f"{' or '.join(laws)} of {to}")
    return law or next(iter(laws))


def made_of(setup: ImpactSetup, to: str, law: str, units: str, match: str, *, title: str, source: str) -> deck.Deck:
    """The deck of a set-up; parameters and exceptions as `deck.build`, with names of code and law, and of MATCHES."""
    if match not in MATCHES:
        raise InputError(key="--match", value=match, allowed=" or ".join(MATCHES))
    form = CODES[to].laws[law]
    make: Callable[[Cloth], Any] = partial(_law, form.kind, match)
    return deck.build(
        setup, make, units, title=title, source=source, law=f"{form.keyword}, {_NEAREST[match]}",
        code=CODES[to].name,
    )  # fmt: skip


def _law(kind, match, cloth):
    return kind.of(cloth, match)


def write(made: deck.Deck, out: Path, to: str, stem: str, match: str, text: str, fabric: Any) -> None:
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


def chapter(made: deck.Deck) -> Section:
    """Error of the cards in a table and a plot."""
    first = made.cards[0]
    rows = tuple(
        (words, *(percent(card.mismatch.numbers()[key]) for card in made.cards)) for key, words in ROWS.items()
    )
    figure = Figure(
        pictures.render(pictures_card.plane, first.mismatch), "svg",
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
