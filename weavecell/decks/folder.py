"""The folder of a deck: a panel or pack for LS-DYNA or OpenRadioss, with the error of its material
card.

What runs in OpenRadioss gave is in docs/reports/cards.md; LS-DYNA has not been run.
"""

from __future__ import annotations

from functools import cache
from glob import escape
from pathlib import Path
from typing import Any

from fabrics.base import files, plugs
from fabrics.base.errors import InputError
from weavecell.decks import ls_dyna, mismatch, model, radioss
from weavecell.decks.homogenised import MATCHES
from weavecell.decks.mismatch import LIMIT
from weavecell.report import page, pictures
from weavecell.results import json_file, provenance
from weavecell.results.finding import Answer

CODES = {"lsdyna": ls_dyna, "radioss": radioss}
# what a module of a code has
NEEDS = ("NAME", "LAW", "KEYWORD", "names", "write")
ROWS = {
    "rms": "rms over the biaxial plane",
    "largest": "largest over the biaxial plane",
    "uniaxial": "largest in uniaxial tension",
    "shear": "largest in trellis shear until locking",
}


@cache
def codes() -> dict[str, Any]:
    """Return the modules that write decks, {name of the code: module}: CODES, and those of installed
    packages (`fabrics.base.plugs`).

    Raises
    ------
    InputError : as `plugs.objects`
    """
    return CODES | plugs.objects("weavecell.decks", CODES, NEEDS)


def check(to: str, units: str, match: str) -> None:
    """Check the choices of a deck.

    Raises
    ------
    InputError : a code that is none of `codes`, or unknown units or match
    """
    for key, value, names in (
        ("to", to, codes()),
        ("units", units, model.UNITS),
        ("match", match, MATCHES),
    ):
        if value not in names:
            raise InputError(key=key, value=value, allowed=" or ".join(names))


def names(to: str, stem: str) -> list[str]:
    """Return the names of the files of the folder, for `out_folder.claim`."""
    own = [escape(name) for name in codes()[to].names(stem)]
    return [*own, "mapping.svg", "summary.json", "report.html"]


def write(
    deck: model.Deck, out: Path, to: str, stem: str, match: str, text: str, fabric: Any
) -> None:
    """Write the files of the folder, each whole or not at all.

    Parameters
    ----------
    to : of `codes`
    stem : of the name of the deck's files
    match : as in `check`
    text, fabric : of the input, for the provenance
    """
    code = codes()[to]
    error = error_section(deck)
    for name, content in code.write(deck, stem).items():
        files.write(out / name, content)
    page.write_pictures([error], out)
    errors = [{"material": card.name} | card.mismatch.numbers() for card in deck.cards]
    summary = {"code": to, "match": match, "run_in_the_code": False, "error_over_strength": errors}
    json_file.write(out / "summary.json", summary | {"provenance": provenance.stamp(text, fabric)})
    worst = max(card.mismatch.worst for card in deck.cards)
    value = f"the material card errs by {percent(worst)} of the strength at most"
    # red, as what is no result: nothing of the deck itself is doubtful
    tone = "unstable" if worst > LIMIT else "plain"
    header = page.Section(
        "header", "Header of the deck", details=(("as in the file", "\n".join(deck.header)),)
    )
    report = page.Report(
        Answer(deck.title, value, outcome=tone),
        f"Deck for {code.NAME}, not run in it",
        (error, header),
    )
    page.write(report, out / "report.html")


def error_section(deck: model.Deck) -> page.Section:
    """Show the error of the cards in a table and a plot."""
    first = deck.cards[0]
    names = tuple(card.name for card in deck.cards)
    errors = [card.mismatch.numbers() for card in deck.cards]
    rows = []
    for key, words in ROWS.items():
        rows.append((words, *(percent(numbers[key]) for numbers in errors)))
    caption = f"Law less cell of {first.name}, where both yarns are below their strength."
    figure = pictures.draw_figure("mapping", caption, mismatch.plot, first.mismatch)
    lead = (
        "The law is evaluated by its own equations and compared with the unit cell. "
        f"Not represented: {first.law.lost}."
    )
    table = page.Table(("over the strength", *names), tuple(rows), "", names)
    return page.Section("mapping", "Error of the mapping", lead, (figure,), (table,))


def percent(value: float) -> str:
    """Format a share as a text in %."""
    return f"{100 * value:.1f} %"
