"""Cut-out cloth that stays before the projectile does not keep it from having perforated."""

import numpy as np

from fabrics import catalogue
from shellfabric.cloth.membrane_kernels import ERODED
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.panel import perforation
from shellfabric.solver.pack_solver import PackSolver


def cut(panel, state, low, high, whole=0.0):
    """Cut the yarns round the nodes low .. high - 1 along both sides, on all sides that the panel has."""
    ni, nj = panel.counts
    warp, weft = (part[: (ni + 1) * (nj + 1)].reshape(ni + 1, nj + 1) for part in state.intact_fraction)
    inside = np.s_[low:high]
    warp[high - 1, inside] = weft[inside, high - 1] = whole
    if low > 0:
        warp[low - 1, inside] = weft[inside, low - 1] = whole


def test_what_is_held(small):
    """Nodes that yarn joins to no edge are not, nor the elements at them; one yarn left whole keeps them all."""
    for symmetry, low, high in (("quarter", 0, 4), ("whole", 9, 14)):
        panel = small(symmetry=symmetry)
        state, c = panel.state(1.0), panel.constants()
        assert perforation.held(state, c).all()
        cut(panel, state, low, high)
        held = perforation.held(state, c)
        touched = np.s_[max(low - 1, 0) : high, max(low - 1, 0) : high]
        assert not held[touched].any()
        assert held.sum() == panel.elements - held[touched].size
        state.intact_fraction[0][(high - 1) * c.row_stride + low] = 0.5
        assert perforation.held(state, c).all()


def test_eroded_elements_are_not_held(small):
    panel = small()
    state, c = panel.state(1.0), panel.constants()
    state.element_flag[3 * c.row_stride + 4] = ERODED
    held = perforation.held(state, c)
    assert not held[3, 4]
    assert held.sum() == panel.elements - 1


def test_passed(small):
    """The nose has passed where no held cloth is ahead of its edge within its radius."""
    panel = small()
    state, c = panel.state(1.0), panel.constants()
    assert not perforation.passed(state, c)  # cloth at rest before the nose
    cut(panel, state, 0, 4)
    assert perforation.passed(state, c)  # all that is left before it is the plug
    cut(panel, state, 0, 4, whole=1.0)
    assert not perforation.passed(state, c)
    state.projectile_position[2] = 1e-3
    assert perforation.passed(state, c)  # behind the edge


def test_a_plug_that_flies_ahead():
    """S-728 at 205.5 m/s: a plug of two elements flies before the projectile; without asking what holds it, the run
    had no outcome after 5 ms."""
    march = PackSolver(
        ImpactSetup(catalogue.load("S-728").with_effective_density(), 1.0, table_size=101).panel(), 205.5, 600e-6
    ).run()
    assert march.outcome == "perforated"
    assert march.time < 150e-6
    assert march.sample("v")[-1] > 100
