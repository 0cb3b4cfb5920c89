"""Extrapolation to the limit of fine meshes and its uncertainty, against closed forms."""

import pytest

from validation.verification.richardson import extrapolate, observed_order, uncertainty


@pytest.mark.parametrize("p", [0.6, 2.0])
@pytest.mark.parametrize("sizes", [(1.0, 1 / 2, 1 / 3), (0.9, 0.4, 0.35)])
def test_values_of_an_exact_order_give_the_limit(p, sizes):
    """The uncertainty is 1.25 of the step to the limit (grid convergence index), and what the values are known to."""
    values = [120.0 - 7.0 * h**p for h in sizes]
    found = extrapolate(sizes, values)
    assert observed_order(sizes, values) == pytest.approx(p, rel=1e-9)
    assert found.limit == pytest.approx(120.0, rel=1e-10)
    assert uncertainty(sizes, values, found, 0.2) == pytest.approx(1.25 * (120.0 - values[-1]) + 0.2, rel=1e-9)


def test_irregular_values_are_fitted_and_are_less_certain():
    sizes, values = (1.0, 1 / 2, 1 / 3), [114.0, 119.0, 118.5]
    found = extrapolate(sizes, values)
    assert found.remark == "not monotone"
    assert 118.5 < found.limit < 121
    assert uncertainty(sizes, values, found) > 3 * abs(values[-1] - found.limit)
