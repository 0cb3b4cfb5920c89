"""Tables and printed cards of docs/reports/cards.md: errors of the cards of all fabrics, and one card of each code.

python tools/material_cards.py [docs/reports/cards.md]
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

import weavecell as wc  # noqa: E402
from validation.marked_page import markdown, put  # noqa: E402
from weavecell.decks import folder, model  # noqa: E402
from weavecell.decks.cloth import MATCHES, Cloth  # noqa: E402
from weavecell.decks.laws import CrimpExchange, UncoupledCurves  # noqa: E402
from weavecell.decks.mismatch import Mismatch  # noqa: E402

LAWS = {"curves (FORM 14)": UncoupledCurves, "LAW58": CrimpExchange}
CARDS = {  # code: what a card begins and ends with
    "lsdyna": ("*MAT_FABRIC_TITLE", "*MAT_RIGID_TITLE"),
    "radioss": ("/MAT/LAW58/", "/MAT/LAW1/"),
}
_POINT = re.compile(r"^ *-?\d\.\d{12}E[+-]\d+[ ,]*-?\d\.\d{12}E[+-]\d+$")
_SHOWN = 3  # points of a curve that are printed


def marks(name: str) -> tuple[str, str]:
    """What stands before and after a part of the page."""
    return f"<!-- {name} of tools/material_cards.py -->", f"<!-- end of {name} -->"


def row(fabric: str, match: str) -> list[str]:
    """A fabric's errors in percent of the strength: rms, largest, uniaxial, shear of each law."""
    cloth = Cloth(wc.setup(fabric, "100 m/s").cell())
    found = [Mismatch.of(cloth, law.of(cloth, match)).numbers().values() for law in LAWS.values()]
    return [fabric, *(" / ".join(f"{100 * value:.0f}" for value in numbers) for numbers in found)]


def errors(match: str) -> str:
    """The table of all fabrics."""
    return markdown([["fabric", *LAWS], *(row(fabric, match) for fabric in wc.fabrics())])


def card(to: str) -> str:
    """The card of S-720 in a deck, with the first points of each curve."""
    given = wc.setup("S-720", "100 m/s", opening="40 mm", elements_per_crossover=1)
    code = folder.CODES[to]
    made = model.build(given, code, "kg-m-s", "plane", title="S-720", source="published")
    text = next(iter(code.write(made, "S-720").values()))
    begin, end = CARDS[to]
    lines, points = [], 0
    for line in text[text.index(begin) : text.index(end)].splitlines():
        points = points + 1 if _POINT.match(line) else 0
        if points <= _SHOWN:
            lines.append(line)
        elif points == _SHOWN + 1:
            lines.append("...")
    return "```\n" + "\n".join(lines) + "\n```\n"


def main() -> None:
    page = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "reports" / "cards.md"
    for match in MATCHES:
        put(page, *marks(match), f"\n\n{errors(match)}\n")
    for to in CARDS:
        put(page, *marks(to), f"\n\n{card(to)}\n")


if __name__ == "__main__":
    main()
