"""The foot of a cone: of a straight side, none of a bump before it, and none of what rises twice."""

import numpy as np
import pytest

from shellfabric.loop.cone import find_foot

X = np.arange(-20.0, 21.0) * 1e-3  # [m]


def tent(height, foot, top=0.0):
    return height * np.clip((foot - np.abs(X)) / (foot - top), 0.0, 1.0)


@pytest.mark.parametrize("height, foot", [(2e-3, 12.3e-3), (0.1e-3, 9.1e-3)])
def test_a_straight_side_ends_at_its_foot(height, foot):
    assert find_foot(X, tent(height, foot), 1e-3) == pytest.approx(foot, rel=0.02)
    # beside it waves of the weave that stay below a quarter of it
    ripple = 0.2 * height * (np.abs(X) > 15e-3)
    assert find_foot(X, tent(height, foot) + ripple, 1e-3) == pytest.approx(foot, rel=0.02)


def test_fabric_that_rises_twice_has_no_cone_yet():
    """A small bump under the nose, and yarns that are pressed up far from it."""
    bump = tent(0.2e-3, 1.5e-3)
    far = 0.08e-3 * np.exp(-(((np.abs(X) - 14e-3) / 3e-3) ** 2))
    assert np.isnan(find_foot(X, bump + far, 1e-3))
    assert np.isnan(find_foot(X, bump, 1e-3))
