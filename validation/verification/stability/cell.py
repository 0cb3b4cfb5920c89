"""The cell over the displacements (d1, d2) of its yarns' ends: the thesis's iteration, the bracket, the printed law."""

from __future__ import annotations

from functools import cache
from math import inf, sqrt

from fabrics import catalogue
from shellfabric.cell import crossover_kernels as kernels
from shellfabric.cell.model import FORMS, CellModel, CellTable
from shellfabric.panel import quality
from shellfabric.panel.quality import Indicator
from validation.claims.checks import newton as thesis
from validation.models.variants import with_law_form
from validation.verification.stability.core import FAILED, STABLE, WRONG, Outcome

FABRIC = "S-720"


def root(d1: float, d2: float) -> float:
    """[N] contact force of the monotone equation, with the law and the form that the thesis prints."""
    from validation.claims.checks.cell import printed

    w = catalogue.load(FABRIC).weave.w
    return float(printed(FABRIC).solve(1 + d1 / w[0], 1 + d2 / w[1])["F"])


def closing(F: float, d1: float, d2: float) -> tuple[Indicator, ...]:
    """Tuple of Indicator: by how much the yarns miss closing the cell [heights at rest] with their force F [N].

    One evaluation of the monotone equation: no root of it is looked for. Without a positive force the printed law has
    no compression, and the yarns close nothing. The limit is what the iteration itself is to reach.
    """
    from validation.claims.checks.cell import printed

    model, w = printed(FABRIC), catalogue.load(FABRIC).weave.w
    warp, weft = model.yarn_tuples
    miss = inf
    if F > 0:
        w1, w2 = w[0] + d1, w[1] + d2
        free = [kernels.free_height(half, yarn[1], yarn[-1]) for half, yarn in ((w1, warp), (w2, weft))]
        form = FORMS[model.form]
        miss = abs(kernels.residual(F, w1, w2, *free, warp, weft, model.gap, form)[0]) / sum(model.h0)
    meaning = "gap that is left where the yarns should close the cell, over their heights"
    return (Indicator("closing residual", miss, thesis.TOLERANCE, "", meaning),)


def newton(*, d1: float, d2: float, allowed: float, floor: float) -> Outcome:
    """How the thesis's Newton iteration on two heights (App. B.3) with its printed law ends, and in how many steps.

    `validation.claims.checks.newton` holds the iteration; WRONG where its force is not the root of the monotone
    equation, within `allowed` and `floor` [N].
    """
    found, right = thesis.iterate(FABRIC, d1, d2), root(d1, d2)
    if not found.converged:
        many = found.steps >= thesis.MOST
        return Outcome(FAILED, found.steps, f"no convergence in {thesis.MOST} steps" if many else "ran off")
    if abs(found.F - right) > max(allowed * abs(right), floor):
        message = f"{found.F:.4g} N instead of {right:.4g} N"
        return Outcome(WRONG, found.steps, message, closing(found.F, d1, d2))
    return Outcome(STABLE, found.steps, checks=closing(found.F, d1, d2))


def steps(d1: float, d2: float) -> tuple[float, float, int]:
    """(F [N], r over a half length, evaluations of r) by the steps that `closing_force` makes, counted."""
    model = CellModel(catalogue.load(FABRIC))
    warp, weft, gap, form, _ = model._arguments()
    w1, w2 = warp[0] + d1, weft[0] + d2
    free = [kernels.free_height(w, yarn[1], yarn[8]) for w, yarn in ((w1, warp), (w2, weft))]
    count = 0

    def r(F):
        nonlocal count
        count += 1
        return kernels.residual(F, w1, w2, *free, warp, weft, gap, form)

    if free[0] + free[1] + gap >= warp[3] + weft[3]:
        return 0.0, 0.0, 1
    low, high = 0.0, 1.0
    while r(high)[0] < 0.0:
        low, high = high, 4.0 * high
    F = high
    while count < 200:
        value, slope = r(F)
        low, high = (low, F) if value > 0.0 else (F, high)
        if abs(value) <= 1e-14 * (warp[0] + weft[0]):
            break
        step = value / slope
        F -= step
        if not low < F < high:
            F = sqrt(low * high) if low > 0.0 else 0.125 * high
        if abs(step) <= 1e-14 * F or high - low <= 1e-15 * high or high < 1e-14:
            break
    return F, abs(r(F)[0]) / warp[0], count - 1


def bracket(*, d1: float, d2: float, allowed: float) -> Outcome:
    """Whether the force found by one monotone equation in a bracket, r(F) = 0, closes the cell and is that of the
    kernel (`shellfabric.cell.crossover_kernels`), and in how many evaluations."""
    F, off, count = steps(d1, d2)
    w = catalogue.load(FABRIC).weave.w
    ours = float(CellModel(catalogue.load(FABRIC)).solve(1 + d1 / w[0], 1 + d2 / w[1])["F"])
    if count >= 200:
        return Outcome(FAILED, count, "no root found")
    same = abs(F - ours) <= 1e-9 * max(ours, 1e-3)
    return Outcome(STABLE if off <= allowed and same else WRONG, count, "" if same else f"{F:.6g} and {ours:.6g} N")


@cache
def _printed_table() -> CellTable:
    """Table of the cell with the printed law."""
    return CellModel(with_law_form(catalogue.load(FABRIC), "printed")).table(51)


def printed_law(*, d1: float, d2: float, allowed: float) -> Outcome:
    """The printed law d = a - b / F^(1/3) beside the regularised one, d = a - b / (F + F0)^(1/3), near F = 0.

    WRONG where the printed law has contact although the free yarns clear each other, or another tension.
    """
    fabric = catalogue.load(FABRIC)
    w, strength = fabric.weave.w, fabric.weave.warp.strength
    laws = fabric, with_law_form(fabric, "printed")
    ours, theirs = (CellModel(one).solve(1 + d1 / w[0], 1 + d2 / w[1]) for one in laws)
    off = max(abs(float(ours[T] - theirs[T])) for T in ("T1", "T2")) / strength
    lost = float(ours["F"]) == 0.0 and float(theirs["F"]) > 0.0
    message = f"contact of {float(theirs['F']):.2g} N where there is none" if lost else ""
    found = quality.of_cell(_printed_table(), [float(theirs[T]) for T in ("T1", "T2")])
    return Outcome(WRONG if lost or off > allowed else STABLE, 100 * off, message, found)
