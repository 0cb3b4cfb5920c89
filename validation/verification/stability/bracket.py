"""The cell as one monotone equation in a bracket, r(F) = 0 (`shellfabric.cell.crossover_kernels`), over the same "
"displacements."""

from __future__ import annotations

from math import sqrt

from fabrics import catalogue
from shellfabric.cell import crossover_kernels as kernels
from shellfabric.cell.model import CellModel
from validation.verification.stability.core import FAILED, STABLE, WRONG, Map, Outcome
from validation.verification.stability.newton import FABRIC, axes

ALLOWED = 1e-9  # of a half length: what r may be off at the root


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


def point(d1: float, d2: float) -> Outcome:
    """Whether the force found closes the cell and is that of the kernel, and in how many evaluations."""
    F, off, count = steps(d1, d2)
    w = catalogue.load(FABRIC).weave.w
    ours = float(CellModel(catalogue.load(FABRIC)).solve(1 + d1 / w[0], 1 + d2 / w[1])["F"])
    if count >= 200:
        return Outcome(FAILED, count, "no root found")
    same = abs(F - ours) <= 1e-9 * max(ours, 1e-3)
    return Outcome(STABLE if off <= ALLOWED and same else WRONG, count, "" if same else f"{F:.6g} and {ours:.6g} N")


def chart(quick: bool = False) -> Map:
    """The map."""
    return Map(
        "bracket", "The same cell as one monotone equation in a bracket",
        "What `shellfabric` solves instead: h1(F) + h2(F) + d_c(F) grows with F, so that there is one root at most and "
        "bracketed Newton finds it; contact is lost exactly where the free heights fill the cell (one evaluation).",
        *axes(quick), point, "evaluations", "a force that does not close the cell to 1e-9 of its half length",
        "UnstableError \"the crossover did not close\", should a root ever not be found",
    )  # fmt: skip
