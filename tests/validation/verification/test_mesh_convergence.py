"""Extrapolation to the limit of fine meshes and its uncertainty, against closed forms."""

import numpy as np
import pytest

from fabrics.errors import InputError
from validation.verification.richardson import extrapolate, observed_order, uncertainty

SIZES = (1.0, 1 / 2, 1 / 3)
FOUR = (*SIZES, 1 / 4)


@pytest.mark.parametrize("p", [0.6, 1.0, 1.5, 2.0])
@pytest.mark.parametrize("sizes", [SIZES, (1.0, 0.5, 0.25), (0.9, 0.4, 0.35)])
def test_values_of_an_exact_order(p, sizes):
    """The uncertainty is the grid convergence index, 1.25 of the step to the limit, and what the values are known to;
    of more than three meshes the finest count."""
    values = [120.0 - 7.0 * h**p for h in sizes]
    found = extrapolate(sizes, values)
    assert observed_order(sizes, values) == pytest.approx(p, rel=1e-9)
    assert found.limit == pytest.approx(120.0, rel=1e-10)
    assert (found.basis, found.remark, found.scatter) == ("Richardson", "", 0.0)
    gci = 1.25 * (120.0 - values[-1])
    assert uncertainty(sizes, values, found) == pytest.approx(gci, rel=1e-9)
    assert uncertainty(sizes, values, found, 0.2) == pytest.approx(gci + 0.2)
    assert extrapolate((2.0, *sizes), [0.0, *values]).limit == pytest.approx(120.0, rel=1e-10)


@pytest.mark.parametrize(
    ("values", "order", "remark"),
    [
        ([114.0, 119.0, 118.5], None, "not monotone"),
        ([114.0, 116.0, 119.0], None, "steps do not shrink"),
        ([114.0, 116.0, 117.9], None, "steps do not shrink"),
        ([110.0, 119.0, 119.1], 6.3, "above the formal 2"),
        ([114.0, 116.0, 117.1], 0.16, "below 0.5"),
        ([100.0, 104.0, 100.0, 104.0], None, "not monotone"),
    ],
)
def test_irregular_values_are_fitted(values, order, remark):
    """By least squares of first or second order; the uncertainty has the factor 3, and grows with the residual where
    that is no less than a step of the data."""
    sizes = FOUR[: len(values)]
    found = extrapolate(sizes, values)
    assert remark in found.remark
    assert found.order == (None if order is None else pytest.approx(order, abs=0.1))
    power = {"first order": 1, "second order": 2}[found.basis]
    A = np.column_stack([np.ones(len(sizes)), np.array(sizes) ** power])
    solution = np.linalg.lstsq(A, np.array(values), rcond=None)[0]
    assert found.limit == pytest.approx(solution[0], rel=1e-12)
    scatter = float(np.sqrt(np.mean((A @ solution - values) ** 2)))
    step = (max(values) - min(values)) / (len(values) - 1)
    off = scatter + abs(values[-1] - (A @ solution)[-1])
    distance = abs(values[-1] - found.limit)
    expected = 3 * distance + off if scatter < step else 3 * scatter / step * (distance + off)
    assert uncertainty(sizes, values, found) == pytest.approx(expected, rel=1e-9)


def test_changes_within_the_noise_are_none():
    values = [118.0, 118.2, 118.1]
    found = extrapolate(SIZES, values, noise=0.125)
    assert (found.limit, found.order, found.basis) == (118.1, None, "no change")
    assert uncertainty(SIZES, values, found, 0.125) == pytest.approx(0.2 + 0.125)
    assert extrapolate(SIZES, values).basis != "no change"


@pytest.mark.parametrize("bad", [((1.0, 0.5), (1, 2)), ((0.5, 1.0, 2.0), (1, 2, 3)), (SIZES, (1, np.nan, 2))])
def test_bad_meshes(bad):
    with pytest.raises(InputError):
        extrapolate(*bad)
