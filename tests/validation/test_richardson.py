"""Extrapolation to the limit of fine meshes, against closed forms."""

import pytest

from validation.richardson import extrapolate, observed_order


@pytest.mark.parametrize("p", [0.6, 2.0])
@pytest.mark.parametrize("sizes", [(1.0, 1 / 2, 1 / 3), (0.9, 0.4, 0.35)])
def test_values_of_an_exact_order_give_the_limit(p, sizes):
    values = [120.0 - 7.0 * h**p for h in sizes]
    found = extrapolate(sizes, values)
    assert observed_order(sizes, values) == pytest.approx(p, rel=1e-9)
    assert found.limit == pytest.approx(120.0, rel=1e-10)


def test_irregular_values_are_fitted():
    sizes = (1.0, 1 / 2, 1 / 3)
    values = [114.0, 119.0, 118.5]
    found = extrapolate(sizes, values)
    assert found.remark == "not monotone"
    assert 118.5 < found.limit < 121
    assert found.scatter > 0
