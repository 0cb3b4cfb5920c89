"""The crossover's cell with its options: plain twin, gradient, both forms."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from scipy.optimize import brentq

from fabrics import catalogue
from fabrics.weave import arc_length
from shellfabric.cell.model import CellModel
from validation.models.variants import with_law_form

PAIRS = [(1.004, 1.0), (1.0, 1.006), (1.008, 1.008), (1.012, 0.997), (0.998, 1.012), (1.012, 1.01)]
# of aramid; at rest only the printed law has forces
WIDER = [
    (1.0, 1.0),
    (1.01, 1.0),
    (1.0, 1.01),
    (1.02, 1.02),
    (1.03, 0.985),
    (0.98, 1.03),
    (1.04, 1.03),
]
BALANCED, UNBALANCED = (catalogue.load(name) for name in ("glass-balanced", "glass-unbalanced"))
S720 = catalogue.load("S-720").with_effective_density()
PRINTED = with_law_form(S720, "printed")
# the load of a cosine is spread as its curvature is; its work has the same shape in it once more
SPREAD = quad(np.cos, 0, np.pi / 2)[0] / quad(lambda x: np.cos(x) ** 2, 0, np.pi / 2)[0]


def plain_cell(model, *stretches):
    """The crossover by nested bisection: (T1, T2, F)."""
    weave = model.fabric.weave
    w = [stretch * half for stretch, half in zip(stretches, weave.w)]

    def bisect_length(m, S, least):
        return brentq(lambda h: arc_length(w[m], h) - S, least, 2 * w[m], xtol=1e-16, rtol=1e-14)

    lowest = [
        bisect_length(m, weave.S0[m], 0.0) if weave.S0[m] > 2 * w[m] else 0.0 for m in range(2)
    ]
    rest = [
        brentq(lambda h, m=m: arc_length(weave.w[m], h) - weave.S0[m], 0, weave.w[m])
        for m in range(2)
    ]

    def tension(m, h):
        e = max(arc_length(w[m], h) / weave.S0[m] - 1, 0.0)
        return weave.yarns[m].EA * e

    def force(m, h):
        if model.cell_formulation == "variational":
            step = 1e-6 * w[m]
            slope = (arc_length(w[m], h + step) - arc_length(w[m], h - step)) / (2 * step)
            return tension(m, h) * slope * SPREAD
        return 2 * tension(m, h) * np.sin(np.arctan(np.pi * h / (2 * w[m])))

    def height(m, F):
        return brentq(lambda h: force(m, h) - F, lowest[m], 2 * w[m], xtol=1e-16, rtol=1e-14)

    def gap(F):
        squeezed = sum(float(law.d(F)) for law in model.used_laws)
        return height(0, F) + height(1, F) + squeezed + model.crossover_gap - sum(rest)

    printed = model.used_laws[0].form == "printed"
    if not printed and sum(lowest) + model.crossover_gap >= sum(rest):
        return *(tension(m, 0.0) for m in range(2)), 0.0
    F = brentq(gap, 1e-9, 1e4, rtol=1e-13)
    return tension(0, height(0, F)), tension(1, height(1, F)), F


CELLS = {"unbalanced": (UNBALANCED, {}, PAIRS), "balanced": (BALANCED, {}, PAIRS)} | {
    f"{law}, gap {gap:g}": (fabric, {"crossover_gap": gap}, pairs)
    for law, fabric, pairs in (("regularised", S720, WIDER[1:]), ("printed", PRINTED, WIDER))
    for gap in (0.0, 2e-5)
}


@pytest.mark.parametrize("form", ["equilibrium", "variational"])
@pytest.mark.parametrize("name", CELLS)
def test_against_plain_twin(name, form):
    fabric, options, pairs = CELLS[name]
    model = CellModel(fabric, cell_formulation=form, **options)
    close = 2e-6 if form == "variational" else 1e-7
    for pair in pairs if fabric not in (BALANCED, UNBALANCED) else pairs[::2]:
        got = [float(model.solve(*pair)[name]) for name in ("T1", "T2", "F")]
        assert_allclose(got, plain_cell(model, *pair), rtol=close, atol=close, err_msg=str(pair))
