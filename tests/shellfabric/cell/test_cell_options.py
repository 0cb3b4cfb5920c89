"""The crossover's cell with its options: plain twin, gradient, both forms, straight segments, fibres with slack."""

import numpy as np
import pytest
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
OPTIONS = {
    "toe": {"fibre_slack": 1e-3},
    "toes": {"fibre_slack": (5e-4, 2e-3)},
    "straight": {"cell_profile": "straight"},
    "both": {"cell_profile": "straight", "fibre_slack": (5e-4, 2e-3)},
}
BALANCED, UNBALANCED = (catalogue.load(name) for name in ("glass-balanced", "glass-unbalanced"))
S720 = catalogue.load("S-720").with_effective_density()
PRINTED = with_law_form(S720, "printed")
# the load of a cosine is spread as its curvature is; its work has the same shape in it once more
SPREAD = quad(np.cos, 0, np.pi / 2)[0] / quad(lambda x: np.cos(x) ** 2, 0, np.pi / 2)[0]


def length(profile, w, h):
    return float(arc_length(w, h)) if profile == "cosine" else 2 * float(np.hypot(w, h))


def bundle(e, EA, toe):
    """Tension of fibres with exponentially distributed slack, by quadrature over the slack."""
    if toe == 0:
        return EA * e
    return EA * quad(lambda s: (e - s) * np.exp(-s / toe) / toe, 0, e, epsabs=0, epsrel=1e-12)[0]


def plain_cell(model, *stretches):
    """The crossover by nested bisection: (T1, T2, F)."""
    weave = model.fabric.weave
    w = [stretch * half for stretch, half in zip(stretches, weave.w)]

    def bisect_length(m, S, least):
        return brentq(
            lambda h: length(model.cell_profile, w[m], h) - S,
            least,
            2 * w[m],
            xtol=1e-16,
            rtol=1e-14,
        )

    lowest = [
        bisect_length(m, weave.S0[m], 0.0) if weave.S0[m] > 2 * w[m] else 0.0 for m in range(2)
    ]
    rest = [
        brentq(
            lambda h, m=m: length(model.cell_profile, weave.w[m], h) - weave.S0[m], 0, weave.w[m]
        )
        for m in range(2)
    ]

    def tension(m, h):
        e = max(length(model.cell_profile, w[m], h) / weave.S0[m] - 1, 0.0)
        return bundle(e, weave.yarns[m].EA, model.toes[m])

    def force(m, h):
        if model.cell_formulation == "variational":
            step = 1e-6 * w[m]
            slope = (
                length(model.cell_profile, w[m], h + step)
                - length(model.cell_profile, w[m], h - step)
            ) / (2 * step)
            return tension(m, h) * slope * (SPREAD if model.cell_profile == "cosine" else 1.0)
        tangent = h / w[m] if model.cell_profile == "straight" else np.pi * h / (2 * w[m])
        return 2 * tension(m, h) * np.sin(np.arctan(tangent))

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


CELLS = {name: (UNBALANCED, options, PAIRS) for name, options in OPTIONS.items()} | {
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
    for pair in pairs if fabric is not UNBALANCED else pairs[::2]:
        got = [float(model.solve(*pair)[name]) for name in ("T1", "T2", "F")]
        np.testing.assert_allclose(
            got, plain_cell(model, *pair), rtol=close, atol=close, err_msg=str(pair)
        )


@pytest.mark.parametrize("name", [*CELLS, *(f"balanced, {name}" for name in OPTIONS)])
def test_variational_forces_are_the_gradient(name):
    fabric, options, pairs = (
        CELLS[name] if name in CELLS else (BALANCED, OPTIONS[name.split()[1]], PAIRS)
    )
    model = CellModel(fabric, **options)
    step = 1e-6
    for x, y in pairs:
        here = model.solve(x, y)
        slope1 = (model.solve(x + step, y)["W"] - model.solve(x - step, y)["W"]) / (
            4 * step * fabric.weave.w1
        )
        slope2 = (model.solve(x, y + step)["W"] - model.solve(x, y - step)["W"]) / (
            4 * step * fabric.weave.w2
        )
        assert float(here["N1"]) == pytest.approx(slope1, rel=2e-6, abs=2e-4)
        assert float(here["N2"]) == pytest.approx(slope2, rel=2e-6, abs=2e-4)


@pytest.mark.parametrize("toe", [0.0, 1e-3])
def test_incompressible_balanced_weave_in_closed_form(toe):
    """k = 1: neither yarn can give way, so that both keep their height and S = 2 sqrt(w^2 + h0^2)."""
    weave = BALANCED.weave
    stretch = 1.006
    h0 = weave.w1 * np.sqrt((1 + weave.warp.crimp) ** 2 - 1)
    state = CellModel(
        BALANCED, cell_model="incompressible", cell_profile="straight", fibre_slack=toe
    ).solve(stretch, stretch)
    S = 2 * np.hypot(stretch * weave.w1, h0)
    T = bundle(S / weave.S01 - 1, weave.warp.EA, toe)
    assert float(state["h1"]) == pytest.approx(h0, rel=1e-9)
    assert float(state["T1"]) == pytest.approx(T, rel=1e-7)
    assert float(state["F"]) == pytest.approx(2 * T * 2 * h0 / S, rel=1e-7)


def test_kawabata_free_edge():
    """A straightened warp yarn leaves the whole height to the weft, which draws in its cell in closed form."""
    model = CellModel(UNBALANCED, cell_profile="straight")
    weave = UNBALANCED.weave
    heights = [w * np.sqrt((1 + yarn.crimp) ** 2 - 1) for w, yarn in zip(weave.w, weave.yarns)]
    assert model.h0 == pytest.approx(heights, rel=1e-12)
    drawn_in = np.sqrt((weave.S02 / 2) ** 2 - sum(heights) ** 2) / weave.w2
    assert model.range()[1][0] == pytest.approx(drawn_in, rel=1e-12)
    stretch = (1 + weave.warp.crimp) * 1.005
    lost, kept = (model.solve(stretch, drawn_in * (1 + off)) for off in (-1e-9, 1e-6))
    assert lost["F"] == 0.0
    assert lost["h1"] == 0.0
    assert float(lost["T1"]) == pytest.approx(0.005 * weave.warp.EA, rel=1e-9)
    assert 0.0 < kept["F"] < 1.0


def test_strength_lies_beyond_the_toe():
    model = CellModel(UNBALANCED, fibre_slack=(1e-3, 5e-4))
    for m, (yarn, ultimate) in enumerate(zip(UNBALANCED.weave.yarns, model.ultimate_strains)):
        assert bundle(ultimate, yarn.EA, model.toes[m]) == pytest.approx(yarn.strength, rel=1e-9)
        assert float(model.alone(m, (1 + yarn.crimp) * (1 + ultimate))) == pytest.approx(
            yarn.strength, rel=1e-9
        )
        assert model.range()[m][1] > (1 + yarn.crimp) * (1 + ultimate)
    assert CellModel(UNBALANCED).ultimate_strains == tuple(
        yarn.failure_strain for yarn in UNBALANCED.weave.yarns
    )
