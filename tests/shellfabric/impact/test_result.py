"""What a result says of a pack, from the columns of its plies."""

from types import SimpleNamespace

import numpy as np
from numpy.testing import assert_array_equal

from shellfabric.impact.data import ImpactData
from shellfabric.impact.result import ImpactResult

# two instants of three plies, all of them unlike
PLIES = {
    "cut_yarns": np.array([[0, 1, 0], [3, 2, 7]]),
    "reaction_warp": np.array([[1.0, 2.0, 4.0], [8.0, 16.0, 32.0]]),
    "reaction_weft": np.array([[0.5, 0.25, 3.0], [5.0, 7.0, 11.0]]),
}


def test_counts_and_forces_of_a_pack_are_sums_over_its_plies():
    pack = SimpleNamespace(plies=PLIES)
    assert_array_equal(ImpactData.cut_yarns.fget(pack), [1, 12])
    reactions = ImpactResult.reactions.fget(pack)
    assert_array_equal(reactions["warp"], [7.0, 56.0])
    assert_array_equal(reactions["weft"], [3.75, 23.0])
