"""The crossover's cell with its options: plain twin, gradient, both forms, straight segments, fibres with slack."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from fabrics import catalogue
from fabrics.errors import InputError
from fabrics.weave import arc_length
from shellfabric.cell import crossover_kernels as kernels
from shellfabric.cell import yarn_kernels
from shellfabric.cell.model import CellModel
from shellfabric.coupon import quasistatic
from shellfabric.panel.model import Panel
from validation.models.variants import with_law_form

PAIRS = [(1.004, 1.0), (1.0, 1.006), (1.008, 1.008), (1.012, 0.997), (0.998, 1.012), (1.012, 1.01)]
# of aramid; at rest only the printed law has forces
WIDER = [(1.0, 1.0), (1.01, 1.0), (1.0, 1.01), (1.02, 1.02), (1.03, 0.985), (0.98, 1.03), (1.04, 1.03)]
OPTIONS = {
    "toe": {"toe": 1e-3},
    "toes": {"toe": (5e-4, 2e-3)},
    "straight": {"profile": "straight"},
    "both": {"profile": "straight", "toe": (5e-4, 2e-3)},
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
        return brentq(lambda h: length(model.profile, w[m], h) - S, least, 2 * w[m], xtol=1e-16, rtol=1e-14)

    lowest = [bisect_length(m, weave.S0[m], 0.0) if weave.S0[m] > 2 * w[m] else 0.0 for m in range(2)]
    rest = [brentq(lambda h, m=m: length(model.profile, weave.w[m], h) - weave.S0[m], 0, weave.w[m]) for m in range(2)]

    def tension(m, h):
        e = max(length(model.profile, w[m], h) / weave.S0[m] - 1, 0.0)
        return bundle(e, weave.yarns[m].EA, model.toes[m])

    def force(m, h):
        if model.form == "variational":
            step = 1e-6 * w[m]
            slope = (length(model.profile, w[m], h + step) - length(model.profile, w[m], h - step)) / (2 * step)
            return tension(m, h) * slope * (SPREAD if model.profile == "cosine" else 1.0)
        tangent = h / w[m] if model.profile == "straight" else np.pi * h / (2 * w[m])
        return 2 * tension(m, h) * np.sin(np.arctan(tangent))

    def height(m, F):
        return brentq(lambda h: force(m, h) - F, lowest[m], 2 * w[m], xtol=1e-16, rtol=1e-14)

    def gap(F):
        squeezed = sum(float(law.d(F)) for law in model.used_laws)
        return height(0, F) + height(1, F) + squeezed + model.gap - sum(rest)

    printed = model.used_laws[0].form == "printed"
    if not printed and sum(lowest) + model.gap >= sum(rest):
        return *(tension(m, 0.0) for m in range(2)), 0.0
    F = brentq(gap, 1e-9, 1e4, rtol=1e-13)
    return tension(0, height(0, F)), tension(1, height(1, F)), F


CELLS = {name: (UNBALANCED, options, PAIRS) for name, options in OPTIONS.items()} | {
    f"{law}, gap {gap:g}": (fabric, {"gap": gap}, pairs)
    for law, fabric, pairs in (("regularised", S720, WIDER[1:]), ("printed", PRINTED, WIDER)) for gap in (0.0, 2e-5)
}  # fmt: skip


@pytest.mark.parametrize("form", ["equilibrium", "variational"])
@pytest.mark.parametrize("name", CELLS)
def test_against_plain_twin(name, form):
    fabric, options, pairs = CELLS[name]
    model, close = CellModel(fabric, form=form, **options), 2e-6 if form == "variational" else 1e-7
    for pair in pairs if fabric is not UNBALANCED else pairs[::2]:
        got = [float(model.solve(*pair)[name]) for name in ("T1", "T2", "F")]
        np.testing.assert_allclose(got, plain_cell(model, *pair), rtol=close, atol=close, err_msg=str(pair))


@pytest.mark.parametrize("name", [*CELLS, *(f"balanced, {name}" for name in OPTIONS)])
def test_variational_forces_are_the_gradient(name):
    fabric, options, pairs = CELLS[name] if name in CELLS else (BALANCED, OPTIONS[name.split()[1]], PAIRS)
    model, step = CellModel(fabric, **options), 1e-6
    for x, y in pairs:
        here = model.solve(x, y)
        slope1 = (model.solve(x + step, y)["W"] - model.solve(x - step, y)["W"]) / (4 * step * fabric.weave.w1)
        slope2 = (model.solve(x, y + step)["W"] - model.solve(x, y - step)["W"]) / (4 * step * fabric.weave.w2)
        assert float(here["N1"]) == pytest.approx(slope1, rel=2e-6, abs=2e-4)
        assert float(here["N2"]) == pytest.approx(slope2, rel=2e-6, abs=2e-4)


def test_both_forms_agree_on_straight_segments():
    """F = 2 T sin(alpha) is the gradient there: one state, with N = T cos(alpha) for its forces."""
    for fabric, toe in product((BALANCED, UNBALANCED), (0.0, 1e-3)):
        for pair in PAIRS:
            one, other = (
                CellModel(fabric, form=form, profile="straight", toe=toe).solve(*pair)
                for form in ("equilibrium", "variational")
            )
            for name in ("T1", "T2", "F", "h1", "h2", "W"):
                assert float(one[name]) == float(other[name])
            for m in (1, 2):
                w, h = pair[m - 1] * fabric.weave.w[m - 1], float(one[f"h{m}"])
                if one["F"] > 0:
                    cosine = w / np.hypot(w, h)
                    assert float(other[f"N{m}"]) == pytest.approx(cosine * float(one[f"T{m}"]), rel=1e-12)


@pytest.mark.parametrize(
    ("name", "off"), [("S-720", 0.5), ("S-726", 0.5), ("S-727", 0.5), ("S-728", 0.5), ("S-731", 0.6)]
)
def test_both_forms_agree_on_the_cosine_but_for_the_square_of_its_slope(name, off):
    """F = 2 T sin(alpha) of both yarns, at most k^2 / 8 above it; tensions within 0.5 N (warp crimp of 8 %: 0.6)."""
    fabric = catalogue.load(name)
    stretches = np.array([[1 + d / w for d in (1e-5, 2e-5, 3e-5)] for w in fabric.weave.w])
    thesis, state = (CellModel(fabric, form=form).solve(*stretches) for form in ("equilibrium", "variational"))
    for w, T, h in zip(stretches * np.array(fabric.weave.w)[:, None], ("T1", "T2"), ("h1", "h2")):
        np.testing.assert_allclose(state[T], thesis[T], atol=off, rtol=0)
        k = np.pi * state[h] / (2 * w)
        excess = state["F"] / (2 * state[T] * k / np.hypot(1, k)) - 1
        assert np.all((excess > 0) & (excess < k**2 / 8))


@pytest.mark.parametrize("toe", [0.0, 1e-3])
def test_incompressible_balanced_weave_in_closed_form(toe):
    """k = 1: neither yarn can give way, so that both keep their height and S = 2 sqrt(w^2 + h0^2)."""
    weave, stretch = BALANCED.weave, 1.006
    h0 = weave.w1 * np.sqrt((1 + weave.warp.crimp) ** 2 - 1)
    state = CellModel(BALANCED, model="incompressible", profile="straight", toe=toe).solve(stretch, stretch)
    S = 2 * np.hypot(stretch * weave.w1, h0)
    T = bundle(S / weave.S01 - 1, weave.warp.EA, toe)
    assert float(state["h1"]) == pytest.approx(h0, rel=1e-9)
    assert float(state["T1"]) == pytest.approx(T, rel=1e-7)
    assert float(state["F"]) == pytest.approx(2 * T * 2 * h0 / S, rel=1e-7)


def test_kawabata_free_edge():
    """A straightened warp yarn leaves the whole height to the weft, which draws in its cell in closed form."""
    model, weave = CellModel(UNBALANCED, profile="straight"), UNBALANCED.weave
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


@pytest.mark.parametrize("profile", ["cosine", "straight"])
def test_length_slope_curvature_and_free_height(profile):
    kind, w = {"cosine": kernels.COSINE, "straight": kernels.STRAIGHT}[profile], 2.3e-3
    for h in (1e-5, 2e-4, 1e-3):
        step = 1e-3 * h
        S, slope = yarn_kernels.arc(w, h, kind)
        assert S == pytest.approx(length(profile, w, h), rel=1e-14)
        below, above = (length(profile, w, h + sign * step) for sign in (-1, 1))
        assert slope == pytest.approx((above - below) / (2 * step), rel=1e-5)
        ahead, behind = (yarn_kernels.arc(w, h + sign * step, kind)[1] for sign in (1, -1))
        assert yarn_kernels.arc_curvature(w, h, kind) == pytest.approx((ahead - behind) / (2 * step), rel=1e-5)
        assert yarn_kernels.free_height(w, S, kind) == pytest.approx(h, rel=1e-9)
    assert yarn_kernels.free_height(w, 1.99 * w, kind) == 0.0


def test_toe_is_a_bundle_of_slack_fibres():
    S0, EA, toe = 4.6e-3, 38000.0, 1e-3
    slack = -toe * np.log1p(-(np.arange(200000) + 0.5) / 200000)  # quantiles of the exponential distribution
    for e in (1e-5, 3e-4, 1e-3, 9e-3):
        T, slope = yarn_kernels.tension(S0 * (1 + e), 1.0, S0, EA, toe)
        assert T == pytest.approx(EA * np.mean(np.maximum(e - slack, 0)), rel=1e-4)
        assert T == pytest.approx(bundle(e, EA, toe), rel=1e-9)
        assert slope == pytest.approx(EA * np.mean(slack < e) / S0, rel=1e-3)
        stored = S0 * quad(lambda x: bundle(x, EA, toe), 0, e)[0]
        assert yarn_kernels.energy(S0 * (1 + e), S0, EA, toe, T) == pytest.approx(stored, rel=1e-8)
    assert T == pytest.approx(EA * (e - toe), rel=1e-3), "its asymptote is shifted by the mean slack"


def test_toe_goes_to_the_linear_yarn():
    linear = CellModel(BALANCED).solve(1.008, 1.004)
    off = [
        abs(float(CellModel(BALANCED, toe=toe).solve(1.008, 1.004)["T1"] - linear["T1"])) for toe in (1e-4, 1e-5, 1e-6)
    ]
    assert off[0] > 5 * off[1] > 25 * off[2] > 0


def test_strength_lies_beyond_the_toe():
    model = CellModel(UNBALANCED, toe=(1e-3, 5e-4))
    for m, (yarn, ultimate) in enumerate(zip(UNBALANCED.weave.yarns, model.ultimate_strains)):
        assert bundle(ultimate, yarn.EA, model.toes[m]) == pytest.approx(yarn.strength, rel=1e-9)
        assert float(model.alone(m, (1 + yarn.crimp) * (1 + ultimate))) == pytest.approx(yarn.strength, rel=1e-9)
        assert model.range()[m][1] > (1 + yarn.crimp) * (1 + ultimate)
    assert CellModel(UNBALANCED).ultimate_strains == tuple(yarn.failure_strain for yarn in UNBALANCED.weave.yarns)


@pytest.mark.parametrize("option", OPTIONS)
@pytest.mark.parametrize("name", ["glass-balanced", "glass-unbalanced", "S-731"])
def test_table(name, option):
    """It fills, rests without force, keeps T >= 0, and its nodes are the cell's."""
    for form in ("equilibrium", "variational"):
        model = CellModel(catalogue.load(name), form=form, **OPTIONS[option])
        table = model.table(41)
        i, j = np.argmin(np.abs(table.stretch1 - 1)), np.argmin(np.abs(table.stretch2 - 1))
        assert max(table.values[key][i, j] for key in ("F", "T1", "T2", "W")) < 1e-12
        assert min(table.values[key].min() for key in ("T1", "T2", "F", "h1", "h2")) >= 0
        alone = model.solve(table.stretch1[30], table.stretch2[35])
        assert table.values["F"][30, 35] == pytest.approx(float(alone["F"]), rel=1e-9)


def test_coupon_carries_the_options():
    """The cross-shaped specimen whose arms are single yarns with a toe measures the cell that it is made of."""
    table = CellModel(BALANCED, profile="straight", toe=1e-3).table(101)
    run = quasistatic.biaxial(table, strain=(0.008, 0.008), centre=4, arm=3, steps=2)
    strain = quasistatic.middle_strain(run, [2 * w for w in BALANCED.weave.w])[-1]
    load = run.force(1, 0)[-1] / 4
    assert load == pytest.approx(float(table.model.solve(*(1 + strain))["N1"]), rel=0.01)
    linear = CellModel(BALANCED, profile="straight").solve(*(1 + strain))["N1"]
    assert load < 0.95 * float(linear)
    single = (run.coupon.across[0] < 0).all(axis=1)
    arms = run.coupon.tensions(run.states[-1].x)[0][single]
    assert arms.mean() == pytest.approx(load, rel=0.01)


def test_bad_options():
    for bad in ({"profile": "sawtooth"}, {"toe": -1e-4}, {"toe": 0.2}, {"toe": (1e-3,)}, {"toe": (0, np.nan)}):
        with pytest.raises(InputError, match=next(iter(bad))):
            CellModel(BALANCED, **bad)


def test_a_panel_that_fails_has_linear_yarns():
    table = CellModel(catalogue.load("S-720"), toe=1e-3).table(21)
    with pytest.raises(InputError, match="toe"):
        Panel(table)
    assert Panel(table, failure=False).table is table
    straight = replace(CellModel(catalogue.load("S-720")), profile="straight").table(21)
    assert Panel(straight).time_step > 0
