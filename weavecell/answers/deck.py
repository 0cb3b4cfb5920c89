"""A deck that was written for another code.

The folder of `weavecell export`
    NAME.k                       the deck for LS-DYNA
    NAME_0000.rad, NAME_0001.rad the decks of OpenRadioss's starter and engine
    mapping.svg                  the law less the cell over the biaxial plane
    summary.json                 the mapping's error, provenance
    report.html                  the error in a table and the plot, and what the law does not hold
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fabrics.base.frozen import explain_frozen
from weavecell.answers.result import Result


@explain_frozen
@dataclass(frozen=True, repr=False)
class DeckResult(Result):
    """The error of the material cards of a deck.

    Parameters
    ----------
    code : that the deck is for
    errors : {material: law less the cell over the strength [-]}: "rms" and "largest" over the
        biaxial plane, largest in "uniaxial" tension and in "shear" until locking
    keys_left_out : keys of the scene that the deck leaves out, with what follows

    Examples
    --------
    >>> shot = wc.setup("S-720", "150 m/s", opening="20 mm", end_time="10 us")
    >>> list(wc.export(shot, "radioss", "deck").errors)
    ['S-720']
    """

    code: str
    errors: dict[str, dict[str, float]]
    keys_left_out: tuple[str, ...] = ()

    def summary(self) -> dict[str, Any]:
        """Return the errors of the first material."""
        return next(iter(self.errors.values()))

    def _columns(self):
        rows = list(self.errors.values())
        return {"material": list(self.errors)} | {
            name: [row[name] for row in rows] for name in rows[0]
        }

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        from weavecell.decks.folder import percent

        lines = []
        for name, numbers in self.errors.items():
            errors = ", ".join(f"{key} {percent(value)}" for key, value in numbers.items())
            lines.append(f"{name}: {errors}")
        lines.append(f"of the strength; the deck has not been run in {self.code}")
        if self.keys_left_out:
            lines.append(f"left out of the input file: {', '.join(self.keys_left_out)}")
        return lines
