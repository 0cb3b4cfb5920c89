"""Intervals of several unknowns together."""

import numpy as np
import pytest

from fabrics.intervals import combine


def test_changes_add_as_squares_on_each_side():
    assert combine(10.0, [(7.0, 13.0), (14.0, 6.0)]) == pytest.approx((5.0, 15.0))


def test_both_ends_on_one_side_and_an_end_that_is_missing():
    """The larger of two changes on one side counts; nothing goes down."""
    assert combine(1.0, [(1.5, 2.0), (None, 1.0), ()]) == pytest.approx((1.0, 2.0))


def test_a_linear_function_of_normal_unknowns_has_its_own_interval():
    slopes, half = np.array([3.0, -1.0, 0.5]), np.array([0.1, 0.2, 0.4])
    ends = [(5 - s * h, 5 + s * h) for s, h in zip(slopes, half)]
    width = np.sqrt(np.sum((slopes * half) ** 2))
    assert combine(5.0, ends) == pytest.approx((5 - width, 5 + width))
