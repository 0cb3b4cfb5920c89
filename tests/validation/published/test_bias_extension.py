"""The bias extension test: the element of the source, explicit runs of a small coupon, and the claims at full size."""

import numpy as np
import pytest

from shellfabric.cell.model import CellModel
from shellfabric.coupon import quasistatic
from validation.published.bias_extension import cases, dynamic


def test_the_sources_element_balances_and_shears_as_the_law():
    """No net force; in a pure shear of all elements the forces do the trellis law's work; only zigzags are damped."""
    fabric, model, _ = cases.cloth("soft")
    table = CellModel(fabric, model=model, form="variational").table(61)
    coupon, _, _ = quasistatic.bias_coupon(table, 0.03, 0.016)
    forces, rest, still = dynamic.one_point(coupon), coupon.points, np.zeros_like(coupon.points)

    def sheared(gamma):
        """Along the yarns' bisectors, their lengths kept."""
        return rest * np.sqrt([1 - np.sin(gamma), 1 + np.sin(gamma)])

    gamma, step = 0.2, 1e-6
    f = forces(sheared(gamma), still)
    volume = len(coupon.quads) * np.prod(coupon.spacing) * coupon.weave.thickness
    rate = (sheared(gamma + step) - sheared(gamma - step)) / (2 * step)
    assert -np.sum(f * rate) == pytest.approx(volume * fabric.shear.stress(gamma), rel=1e-3)
    assert np.abs(f.sum(axis=0)).max() < 1e-9 * np.abs(f).max()
    stretching = rest * [0.1, -0.2] + 0.3
    assert forces(sheared(gamma), stretching) == pytest.approx(f, abs=1e-9 * np.abs(f).max())


def test_the_source_ran_it_likewise():
    """Explicit, with either element: the modulus G1 at all angles is stable, no trellis is not."""
    small = {"length": 0.03, "width": 0.016, "elongation": 0.001, "speed": 4.0, "looks": 1, "table_size": 61}
    for element in ("yarns", "one point"):
        soft, none = (dynamic.pull(name, element=element, **small) for name in ("soft", "none"))
        assert soft.concentration[-1] < 1.5
        assert none.concentration[-1] > 3
        A, B, C = soft.angles[-1]
        assert A > B > C


@pytest.mark.slow(60)
def test_claims_at_full_size():
    """bias-zones, bias-zone-average, bias-angle-value where yarns do not stretch; bias-symmetry; Figure 4-27."""
    straight = cases.run("straight", steps=10)
    A, B, C = straight.means()
    assert A - B > 3
    assert B - C > 3
    assert abs(B - 0.5 * (A + C)) < 1.5
    assert pytest.approx(72.0, abs=2) == C
    assert pytest.approx(81.0, abs=2) == B
    locking = cases.run("locking", steps=20)
    assert locking.concentration() < 1.5
    assert cases.asymmetry(locking.result) < 1e-6
    A, B, C = locking.means(9)  # 5 mm in all
    assert abs(B - 0.5 * (A + C)) < 1.5
    # crimped, locking cloth stretches along its yarns, so that it shears less than the closed form
    assert C > locking.inextensible(9)
    unlocked = cases.run("none")
    assert unlocked.concentration() > 3
    assert unlocked.problem
