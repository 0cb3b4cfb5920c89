"""The bias extension strip on the sliding panel: pinned it is the explicit coupon; with friction yarns slip."""

from math import inf

import numpy as np
import pytest

from validation.published.bias_extension import dynamic, sliding

SMALL = {"length": 0.057, "width": 0.0296, "elongation": 0.002, "speed": 4.0, "table_size": 61}


@pytest.fixture(scope="module")
def runs():
    return {mu: sliding.pull(mu, **SMALL) for mu in (inf, 0.2, 0.1)}


def test_pinned_it_is_the_explicit_coupon(runs):
    """The same strip, speed and elongation on the mesh of the coupon, whose outline has half yarns."""
    coupon = dynamic.pull("locking", **SMALL)
    assert runs[inf].elongation[-1] == pytest.approx(coupon.elongation[-1], rel=0.02)
    np.testing.assert_allclose(runs[inf].angles[-1], coupon.angles[-1], atol=np.radians(0.5))
    assert runs[inf].passed == 0.0
    assert runs[inf].friction_work == 0.0


@pytest.mark.parametrize("mu", [0.2, 0.1])
def test_yarns_slip_where_friction_is_finite(runs, mu):
    """How far depends little on the coefficient: the contact force of flexible yarns vanishes at their free ends."""
    assert runs[mu].passed > 1e-4  # [m]
    assert runs[mu].friction_work > 0
    assert 0 < runs[mu].load[-1] < runs[inf].load[-1]


def test_the_table_has_a_row_a_look(runs):
    text = sliding.table(list(runs.values()), "python -m x")
    assert text.count("| pinned |") == text.count("| mu = 0.1, flexible |") == sliding.LOOKS
    assert "mu = 0.2, flexible: at most" in text
