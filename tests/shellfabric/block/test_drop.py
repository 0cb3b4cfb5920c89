"""The drop test of a clay calibration, coarse: its dent at its deepest and after that."""

import pytest

from fabrics import backings
from shellfabric.block.block import Backing
from shellfabric.projectile.projectile import Projectile
from validation.models.bare_impact import strike


@pytest.mark.slow(40)
def test_the_dent_of_a_drop_test_is_deepest_before_it_rests():
    """1 kg falls by 2 m on bricks of 14 mm: peak and rest are two numbers, and the test measures the second."""
    clay = backings.load("Roma Plastilina No. 1")
    block = Backing(
        clay,
        size=(0.61, 0.61, 0.14),
        min_size=14e-3,
        refined_depth=0.045,
        growth=1.5,
        after_stop=6e-3,
    )
    ball = Projectile(mass=1.0, shape="sphere", radius=0.5 * 63.5e-3)
    found = strike(block, ball, 6.264, 0.03, after=block.after_stop)
    dent = found.block
    assert dent.dent.size == found.t.size > 50
    assert 15e-3 < dent.deepest_dent < 35e-3
    assert 0 < dent.deepest_dent_time < found.t[-1] - 1e-3
    assert 0.02 < dent.springback < 0.2
    assert dent.at_rest
    assert dent.back_face_signature == dent.gauge_depth < dent.deepest_dent
    assert dent.gauge_depth < dent.deepest_point < 1.1 * dent.gauge_depth  # a ball of 25 mm
    assert dent.gauge_depth == pytest.approx((1 - dent.springback) * dent.deepest_dent)
