"""The thesis's Newton iteration on two heights (App. B.3) with its printed law, over the displacements (d1, d2).

`validation.claims.checks.newton` holds the iteration; the root of the monotone equation stands beside it.
"""

from __future__ import annotations

from math import inf

from fabrics import catalogue
from shellfabric.cell import crossover_kernels
from shellfabric.cell.model import FORMS
from shellfabric.panel.quality import Indicator
from validation.claims.checks import newton
from validation.verification.stability.core import FAILED, STABLE, WRONG, Axis, Map, Outcome

FABRIC = "S-720"
PLACES = tuple(round(i * 2e-6, 9) for i in range(-6, 11))
CLOSED = newton.TOLERANCE  # of the heights, what the iteration itself is to reach
ALLOWED, FLOOR = 0.02, 0.01  # of the force; [N] below which two forces are alike


def root(d1: float, d2: float) -> float:
    """[N] contact force of the monotone equation, with the law and the form that the thesis prints."""
    from validation.claims.checks.cell import printed

    w = catalogue.load(FABRIC).weave.w
    return float(printed(FABRIC).solve(1 + d1 / w[0], 1 + d2 / w[1])["F"])


def closing(F: float, d1: float, d2: float) -> tuple[Indicator, ...]:
    """Tuple of Indicator: by how much the yarns miss closing the cell [heights at rest] with their force F [N].

    One evaluation of the monotone equation: no root of it is looked for. Without a positive force the printed law has
    no compression, and the yarns close nothing.
    """
    from validation.claims.checks.cell import printed

    model, w = printed(FABRIC), catalogue.load(FABRIC).weave.w
    warp, weft = model.yarn_tuples
    miss = inf
    if F > 0:
        w1, w2 = w[0] + d1, w[1] + d2
        free = [crossover_kernels.free_height(half, yarn[1], yarn[-1]) for half, yarn in ((w1, warp), (w2, weft))]
        form = FORMS[model.form]
        miss = abs(crossover_kernels.residual(F, w1, w2, *free, warp, weft, model.gap, form)[0]) / sum(model.h0)
    meaning = "gap that is left where the yarns should close the cell, over their heights"
    return (Indicator("closing residual", miss, CLOSED, "", meaning),)


def point(d1: float, d2: float) -> Outcome:
    """How the iteration ends, and in how many steps."""
    found, right = newton.iterate(FABRIC, d1, d2), root(d1, d2)
    if not found.converged:
        return Outcome(
            FAILED, found.steps, f"no convergence in {newton.MOST} steps" if found.steps >= newton.MOST else "ran off"
        )
    if abs(found.F - right) > max(ALLOWED * abs(right), FLOOR):
        message = f"{found.F:.4g} N instead of {right:.4g} N"
        return Outcome(WRONG, found.steps, message, closing(found.F, d1, d2))
    return Outcome(STABLE, found.steps, checks=closing(found.F, d1, d2))


def axes(quick: bool) -> tuple[Axis, Axis]:
    """Axes of both maps of the cell."""
    places = PLACES[::8] if quick else PLACES
    labels = tuple(f"{1e6 * d:g}" for d in places)
    return Axis("end displacement d1 of the warp [µm]", places, labels), Axis("d2 of the weft [µm]", places, labels)


def chart(quick: bool = False) -> Map:
    """The map."""
    return Map(
        "newton", "Newton's method on two heights, as the thesis prints it",
        f"The cell of {FABRIC} solved as in the thesis's App. B.3: two unknown heights, the printed law of "
        "compression, from the heights at rest. Nothing of this project uses it; it stands here for what it does where "
        "contact is light or lost.",
        *axes(quick), point, "steps", "a false root: its force is not that of the monotone equation",
        "none in the thesis; here the method is not used", failed="no convergence, or ran off",
    )  # fmt: skip
