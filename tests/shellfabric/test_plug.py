"""Cut-out cloth that stays before the projectile does not keep it from having perforated."""

import numpy as np

from fabrics import catalogue
from shellfabric import plug
from shellfabric.impact import ImpactSetup
from shellfabric.march import March
from shellfabric.membrane_kernels import ERODED


def flags(panel, state):
    ni, nj = panel.counts
    return state.flag[: ni * (nj + 1)].reshape(ni, nj + 1)[:, :nj]


def test_what_is_held(small):
    """A closed ring of eroded elements frees what lies within it; a gap of one corner keeps it."""
    for symmetry, ring in (("quarter", np.s_[:4, :4]), ("whole", np.s_[8:14, 8:14])):
        panel = small(symmetry=symmetry)
        state, c = panel.state(1.0), panel.constants()
        flag = flags(panel, state)
        flag[ring] = ERODED
        inner = np.s_[:3, :3] if symmetry == "quarter" else np.s_[9:13, 9:13]
        flag[inner] = 1  # one yarn failed, the other holds
        held = plug.held(state, c)
        assert not held[ring].any()
        assert held.sum() == panel.elements - flag[ring].size
        flag[ring[0].stop - 1, ring[1].stop - 1] = 0
        assert plug.held(state, c)[inner].all()


def test_passed(small):
    """The nose has passed where no held cloth is ahead of its edge within its radius."""
    panel = small()
    state, c, work = panel.state(1.0), panel.constants(), panel.work()
    assert not plug.passed(state, c, work)  # cloth at rest before the nose
    flags(panel, state)[:5, :5] = ERODED
    flags(panel, state)[:2, :2] = 0
    assert plug.passed(state, c, work)  # all that is left before it is the plug
    flags(panel, state)[2, 2] = 0
    assert plug.passed(state, c, work)
    flags(panel, state)[:5, 0] = 0
    assert not plug.passed(state, c, work)
    state.position[2] = 1e-3
    assert plug.passed(state, c, work)  # behind the edge


def test_a_plug_that_flies_ahead():
    """S-728 at 205.5 m/s: a plug of two elements flies before the projectile; without asking what holds it, the run
    had no outcome after 5 ms."""
    march = March(ImpactSetup(catalogue.load("S-728").effective(), 1.0, table_size=101).panel(), 205.5, 600e-6).run()
    assert march.outcome == "perforated"
    assert march.time < 150e-6
    assert march.sample("v")[-1] > 100
