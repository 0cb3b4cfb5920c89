"""The convergence study: extrapolation in closed form, and the machinery on a small panel."""

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.errors import InputError
from shellfabric.impact.simulation import ImpactSetup
from validation.verification.mesh_convergence import __main__ as command
from validation.verification.mesh_convergence import study as module
from validation.verification.mesh_convergence.study import FINE, Strikes, mesh, quantity, velocities
from validation.verification.richardson import extrapolate, observed_order, uncertainty

SIZES = (1.0, 1 / 2, 1 / 3)


@pytest.mark.parametrize("p", [0.6, 1.0, 1.5, 2.0])
@pytest.mark.parametrize("sizes", [SIZES, (1.0, 0.5, 0.25), (0.9, 0.4, 0.35)])
def test_exact_order(p, sizes):
    values = [120.0 - 7.0 * h**p for h in sizes]
    assert observed_order(sizes, values) == pytest.approx(p, rel=1e-9)
    found = extrapolate(sizes, values)
    assert found.limit == pytest.approx(120.0, rel=1e-10)
    assert (found.basis, found.remark, found.scatter) == ("Richardson", "", 0.0)


def test_finest_three_of_more():
    sizes = (1.0, 1 / 2, 1 / 3, 1 / 4)
    found = extrapolate(sizes, [0.0, *(120.0 - 7.0 * h for h in sizes[1:])])
    assert (found.limit, found.order) == pytest.approx((120.0, 1.0))


@pytest.mark.parametrize(
    ("values", "order", "told"),
    [
        ([114.0, 119.0, 118.5], None, "not monotone"),
        ([114.0, 116.0, 119.0], None, "steps do not shrink"),
        ([114.0, 116.0, 117.9], None, "steps do not shrink"),
        ([110.0, 119.0, 119.1], 6.3, "above the formal 2"),
        ([114.0, 116.0, 117.1], 0.16, "below 0.5"),
    ],
)
def test_irregular_values_are_reported(values, order, told):
    """No order is claimed where there is none, and the limit comes from a fit with its scatter."""
    found = extrapolate(SIZES, values)
    assert told in found.remark
    assert found.basis in ("first order", "second order")
    assert found.scatter > 0
    assert found.order == (None if order is None else pytest.approx(order, abs=0.1))
    A = np.column_stack([np.ones(3), np.array(SIZES) ** (1 if found.basis == "first order" else 2)])
    assert found.limit == pytest.approx(np.linalg.solve(A.T @ A, A.T @ values)[0], rel=1e-12)


def test_changes_within_the_noise_are_none():
    found = extrapolate(SIZES, [118.0, 118.2, 118.1], noise=0.125)
    assert (found.limit, found.order, found.basis) == (118.1, None, "no change")
    assert extrapolate(SIZES, [118.0, 118.2, 118.1]).basis != "no change"


@pytest.mark.parametrize("bad", [((1.0, 0.5), (1, 2)), ((0.5, 1.0, 2.0), (1, 2, 3)), (SIZES, (1, np.nan, 2))])
def test_bad_meshes(bad):
    with pytest.raises(InputError):
        extrapolate(*bad)


@pytest.mark.parametrize("p", [0.7, 1.0, 2.0])
def test_uncertainty_of_an_observed_order_is_the_grid_convergence_index(p):
    """1.25 times the difference that Richardson's extrapolation leaves, and what the value is known to."""
    values = [120.0 - 7.0 * h**p for h in SIZES]
    found = uncertainty(SIZES, values, extrapolate(SIZES, values))
    gci = 1.25 * abs(values[2] - values[1]) / (1.5**p - 1)
    assert found == pytest.approx(gci, rel=1e-9)
    assert uncertainty(SIZES, values, extrapolate(SIZES, values), 0.2) == pytest.approx(gci + 0.2)


def test_uncertainty_of_a_fit_has_the_larger_factor():
    values = [114.0, 119.0, 118.5]
    found = extrapolate(SIZES, values)
    power = 1 if found.basis == "first order" else 2
    A = np.column_stack([np.ones(3), np.array(SIZES) ** power])
    fitted = A @ np.linalg.lstsq(A, np.array(values), rcond=None)[0]
    scatter = float(np.sqrt(np.mean((fitted - values) ** 2)))
    assert scatter < 2.5  # half the range: regular enough for the factor 3
    expected = 3 * abs(values[-1] - found.limit) + scatter + abs(values[-1] - fitted[-1])
    assert uncertainty(SIZES, values, found) == pytest.approx(expected, rel=1e-9)


def test_uncertainty_of_scatter_grows_with_it():
    """Values without any trend: the residual of the fit is no less than a step of the data."""
    sizes = (1.0, 1 / 2, 1 / 3, 1 / 4)
    found = extrapolate(sizes, values := [100.0, 104.0, 100.0, 104.0])
    assert found.scatter > 4 / 3
    assert uncertainty(sizes, values, found) > 3 * (abs(values[-1] - found.limit) + found.scatter)
    flat = [118.0, 118.2, 118.1]
    assert uncertainty(SIZES, flat, extrapolate(SIZES, flat, 0.125), 0.125) == pytest.approx(0.2 + 0.125)


def test_targets():
    """1 % of velocities and 3 % of energies and tensions, of the uncertainty on the finest mesh."""
    values = [120 - 6 * h for h in SIZES]  # 2 at the finest, times 1.25: 2.1 % of 118
    found = quantity("S", "q", "N", (1, 2, 3), values)
    assert found.deviations == pytest.approx((-0.05, -0.025, -0.05 / 3))
    assert found.share == pytest.approx(2.5 / 118)
    assert found.met
    assert not quantity("S", "q", "m/s", (1, 2, 3), values).met
    assert quantity("S", "q", "m/s", (1, 2, 3), [120 - 2 * h for h in SIZES]).met


def test_velocities_are_those_of_the_catalogue():
    assert set(velocities()) == {name for name in catalogue.list_names() if name.startswith("S-")}
    assert velocities()["S-720"].stops == 92.5
    for one in velocities().values():
        assert one.stops < one.critical
        assert one.perforate == pytest.approx((1.1 * one.critical, 1.5 * one.critical))


def test_meshes_refine_the_cloth_about_the_impact_point():
    coarse = ImpactSetup(catalogue.load("S-720"), 20.0, opening=0.1, table_size=31).panel()
    assert mesh(coarse, 1).grading is None
    fine = mesh(coarse, 3)
    assert fine.elements_per_crossover == 1
    for sides, w in zip(fine.sides, fine.weave.w):
        at = np.concatenate([[0.0], np.cumsum(sides)])
        assert np.allclose(sides[at[1:] <= FINE], 2 * w / 3)
        assert sides[-1] == pytest.approx(2 * w)
    uniform = mesh(coarse, 3, uniform=True)
    assert (uniform.elements_per_crossover, uniform.grading) == (3, None)
    assert uniform.elements > fine.elements > mesh(coarse, 1).elements


def test_what_is_refused(monkeypatch):
    small = ImpactSetup(catalogue.load("S-720"), 20.0, opening=0.0254, table_size=31).panel()
    monkeypatch.setattr(module, "coarse", lambda name: small)
    with pytest.raises(InputError, match="perforated"):
        module.point("S-720", Strikes(200.0, 100.0), 1)
    with pytest.raises(InputError, match="at least three"):
        module.study({}, None, elements=(1, 2))
    with pytest.raises(InputError, match="S-999"):
        command.main(["S-999"])
