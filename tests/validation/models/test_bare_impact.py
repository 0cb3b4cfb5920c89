"""A projectile strikes the bare block: balance of energy, and erosion."""

import numpy as np
import pytest

from shellfabric.block.block import Backing
from shellfabric.projectile.projectile import Projectile
from validation.models.bare_impact import strike


def test_energy_balances_under_a_blow():
    """Elastic-plastic block struck by a ball: balance within 0.2 % of what the ball lost, hourglass within 5 %."""
    backing = Backing(size=(0.04, 0.04, 0.03), min_size=1.5e-3, refined_depth=6e-3, growth=1.4)
    found = strike(backing, Projectile(mass=4e-3, shape="sphere", radius=4e-3), 60.0, 400e-6)
    lost = found.energies["projectile"][0] - found.energies["projectile"]
    assert found.energies["plastic"][-1] > 0.2 * lost[-1]
    assert abs(found.energies["error"]).max() < 0.002 * lost.max()
    assert found.energies["hourglass"].max() < 0.05 * lost.max()


def test_eroded_bricks_are_gone_and_their_energy_kept():
    backing = Backing(size=(0.03, 0.03, 0.03), min_size=1e-3, refined_depth=6e-3, growth=1.4)
    found = strike(backing, Projectile(mass=8.1e-3), 300.0, 30e-6)
    assert found.eroded > 0
    assert found.energies["eroded"][-1] > 0
    assert (np.diff(found.energies["eroded"]) >= 0).all()
    lost = found.energies["projectile"][0] - found.energies["projectile"][-1]
    assert abs(found.energies["error"]).max() < 0.002 * lost
    # under the nose the face is where the nose is; the last sample is some microseconds before the end
    nose = found.z[-1] + found.v[-1] * (30e-6 - found.t[-1])
    assert found.crater[0, 1] == pytest.approx(nose, abs=1.2e-3)
    assert abs(found.crater[-1, 1]) < 0.3e-3


def test_a_projectile_that_is_through_the_block_ends_the_run():
    backing = Backing(size=(0.03, 0.03, 0.006), min_size=2e-3, refined_depth=6e-3)
    found = strike(backing, Projectile(mass=8.1e-3), 300.0, 1e-3)
    assert found.v[-1] > 0
    assert 0.006 < found.z[-1] < 0.007
    assert found.t[-1] < 1e-4
