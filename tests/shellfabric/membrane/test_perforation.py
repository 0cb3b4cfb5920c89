"""Cut-out fabric that stays before the projectile does not keep it from having perforated."""

from math import inf

import numpy as np
import pytest
from conftest_tools import grid
from numpy.testing import assert_array_equal
from panels import make_panel

from fabrics import catalogue
from shellfabric.impact.setup import ImpactSetup
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane import perforation
from shellfabric.membrane.numerics import Numerics
from shellfabric.projectile.projectile import Projectile
from shellfabric.projectile.window_kernels import erode
from shellfabric.state import ERODED
from shellfabric.yarns.model import YarnZone, aim


def cut(panel, state, low, high, intact=0.0):
    """Cut the yarns round the nodes low .. high - 1 along both sides, on all sides that the panel has."""
    warp, weft = (grid(panel.constants(), part) for part in state.intact_fraction)
    for line in (high - 1, low - 1) if low > 0 else (high - 1,):
        warp[line, low:high] = weft[low:high, line] = intact


@pytest.mark.parametrize("symmetry, low, high", [("quarter", 0, 4), ("whole", 9, 14)])
def test_what_is_held(symmetry, low, high):
    """Nodes that yarn joins to no edge are not, nor the elements at them; one yarn left whole keeps them all. What is
    eroded is not."""
    panel = make_panel(symmetry=symmetry)
    state = panel.state(1.0)
    const = panel.constants()
    assert perforation.held(state, const).all()
    cut(panel, state, low, high)
    held = perforation.held(state, const)
    touched = np.zeros(panel.counts, bool)
    touched[max(low - 1, 0) : high, max(low - 1, 0) : high] = True
    assert_array_equal(held, ~touched)
    state.intact_fraction[0][(high - 1) * const.row_stride + low] = 0.5
    assert perforation.held(state, const).all()
    state.element_flag[3 * const.row_stride + 4] = ERODED
    assert np.argwhere(~perforation.held(state, const)).tolist() == [[3, 4]]


def test_passed():
    """The nose has passed where no held fabric is ahead of its edge within its radius."""
    panel = make_panel()
    state = panel.state(1.0)
    c = panel.constants()
    assert not perforation.passed(state, c)  # fabric at rest before the nose
    cut(panel, state, 0, 4)
    assert perforation.passed(state, c)  # all that is left before it is the plug
    cut(panel, state, 0, 4, intact=1.0)
    assert not perforation.passed(state, c)
    state.projectile_position[2] = 1e-3
    assert perforation.passed(state, c)  # behind the edge


def test_a_plug_that_flies_ahead():
    """S-728 at 205.5 m/s: a plug of two elements flies before the projectile; without asking what holds it, the run
    had no outcome after 5 ms."""
    march = PackSolver(
        ImpactSetup(catalogue.load("S-728").with_effective_density(), 1.0, table_size=101).panel(),
        205.5,
        600e-6,
    ).run()
    assert march.outcome == "perforated"
    assert march.time < 150e-6
    assert march.sample("v")[-1] > 100


def test_samples_do_not_move_the_end():
    """A shot ends by its own clock: to the last bit with three intervals."""
    panel = ImpactSetup(catalogue.load("S-728"), 1.0, opening=0.04, table_size=101).panel()
    runs = [PackSolver(panel, 170.0, 2e-4, interval=us * 1e-6).run() for us in (0.5, 2, 10)]
    assert {run.outcome for run in runs} == {"perforated"}
    assert len({(run.steps, run.sample("v")[-1]) for run in runs}) == 1


def test_a_shank_that_pushed_yarns_aside_ends():
    """Yarns that were pushed aside rub an endless cylinder for ever: that is no push."""
    setup = ImpactSetup(
        catalogue.load("S-728"),
        1.0,
        opening=0.05,
        symmetry="whole",
        impact_point=aim(catalogue.load("S-728").weave),
        projectile=Projectile(friction=0.1),
        crossovers=YarnZone(inf, 0.2),
    )
    march = PackSolver(setup.target(), 46.25, 1e-3, interval=1e-5).run()
    assert march.outcome == "perforated"
    assert march.time < 250e-6
    assert march.contact_force[-1] != 0


@pytest.mark.parametrize("opened, eroded", [(2.35, False), (2.45, True)])
@pytest.mark.parametrize("family", [0, 1])
def test_a_distorted_element_is_eroded_at_the_gap_that_is_given(family, opened, eroded):
    """Nodes drawn 2.35 and 2.45 lengths apart, with erosion_gap = 2.4: the length counts across the
    failed family alone, and only where it failed."""
    panel = make_panel(numerics=Numerics(erosion_gap=2.4))
    const = panel.constants()
    state = panel.state(1.0)
    i, j = 3, 5
    row = const.row_stride
    first = i * row + j
    # warp runs along x: where it has failed the cell opens along x
    length = (const.dx, const.dy)[family]
    beyond = [[first + row, first + row + 1], [first + 1, first + row + 1]][family]
    state.u[family][beyond] = (opened - 1) * length
    assert not erode.py_func(state, const, i, j)
    failed = [[first, first + 1], [first, first + row]][family]
    state.intact_fraction[family][failed] = 0.0
    assert bool(erode.py_func(state, const, i, j)) == eroded
    assert bool(state.element_flag[first] & ERODED) == eroded
    # the neighbour has the same gap on one side, and its yarns
    assert not erode.py_func(state, const, i + 1, j + 1)
