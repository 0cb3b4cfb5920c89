"""The printed law d = a - b / F^(1/3) beside the regularised one, d = a - b / (F + F0)^(1/3), near F = 0."""

from __future__ import annotations

from functools import cache

from fabrics import catalogue
from fabrics.variants import with_law_form
from shellfabric.cell.model import CellModel
from shellfabric.panel import quality
from validation.verification.stability.core import STABLE, WRONG, Axis, Map, Outcome, guarded
from validation.verification.stability.newton import FABRIC

PLACES = tuple(round(i * 2e-6, 9) for i in range(-10, 11))
ALLOWED = 0.01  # of the strength


@cache
def _table():
    """Table of the cell with the printed law."""
    fabric = catalogue.load(FABRIC)
    return CellModel(with_law_form(fabric, "printed")).table(51)


def point(d1: float, d2: float) -> Outcome:
    """WRONG where the printed law has contact although the free yarns clear each other, or another tension."""

    def run():
        fabric = catalogue.load(FABRIC)
        w, strength = fabric.weave.w, fabric.weave.warp.strength
        printed = with_law_form(fabric, "printed")
        ours, theirs = (CellModel(one).solve(1 + d1 / w[0], 1 + d2 / w[1]) for one in (fabric, printed))
        off = max(abs(float(ours[T] - theirs[T])) for T in ("T1", "T2")) / strength
        lost = float(ours["F"]) == 0.0 and float(theirs["F"]) > 0.0
        message = f"contact of {float(theirs['F']):.2g} N where there is none" if lost else ""
        found = quality.of_cell(_table(), [float(theirs[T]) for T in ("T1", "T2")])
        return Outcome(WRONG if lost or off > ALLOWED else STABLE, 100 * off, message, found)

    return guarded(run)


def chart(quick: bool = False) -> Map:
    """The map."""
    places = PLACES[::10] if quick else PLACES
    labels = tuple(f"{1e6 * d:g}" for d in places)
    return Map(
        "printed-law", "The printed law of compression where forces are small",
        f"The cell of {FABRIC} with d = a - b / F^(1/3), whose d is minus infinity at F = 0: a yarn would swell "
        "without bound, so that contact is never lost (erratum E-05). The regularised law, the default, is zero at no "
        "force. Both by the bracket, which finds a root with either.",
        Axis("end displacement d1 of the warp [µm]", places, labels), Axis("d2 of the weft [µm]", places, labels),
        point,
        "difference in tension [% of the strength]",
        f"contact where the free yarns clear each other, or tension off by more than {100 * ALLOWED:g} % of the "
        "strength",
        "the law itself: the default has no such force",
    )  # fmt: skip
