"""The nose's firm spring in packs: stable whatever its stiffness, and as stiff at rest as it says."""

from collections import namedtuple
from dataclasses import replace

import numpy as np
import pytest
from conftest_tools import advance, on_grid
from numpy.testing import assert_allclose

from shellfabric.contact import normal_kernels
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.numerics import Numerics
from shellfabric.plies.model import Pack, PlyContact
from shellfabric.projectile import window_kernels
from shellfabric.state import PointLaw
from shellfabric.surface.surface_kernels import quadratic_weights

GAP = 0.1e-3
Point = namedtuple("Point", "dt point_law")
# nodes of unit mass in a row, points of an element
ROW = 14
PER = 8


def law(mass):
    """The constants of a point, of which only the mass is needed."""
    zeros = dict.fromkeys(PointLaw._fields, 0.0)
    return PointLaw(**zeros | {"mass": mass})


def shares():
    """(points, nodes) weights of the smooth surface through a row of nodes."""
    found = []
    for place in 1 + (np.arange((ROW - 3) * PER) + 0.5) / PER:
        near = int(place + 0.5)
        found.append(np.zeros(ROW))
        found[-1][near - 1 : near + 2] = quadratic_weights(place - near)
    return np.array(found)


def forces(depth, away, stiffness, before, usual):
    """Of the firm spring at all points; `before` of a step ago, `usual` on each besides."""
    B = shares()
    const = Point(1.0, law(1.0 / PER))
    damping = stiffness**0.5 / PER
    gaps = zip(depth, away)
    last = zip(before, B @ (B.T @ before))
    spring = stiffness, damping
    return np.array(
        [
            normal_kernels.implicit_penalty_force(const, spring, *point, usual)
            for point in zip(gaps, last)
        ]
    )


def radius(stiffness, before, foreseen=True):
    """Spectral radius of a step of the row of nodes under the nose, on springs at 0.81 of what the step bears."""
    B = shares()
    usual = before.sum() / PER**2
    fabric = 0.81 * (2 * np.eye(ROW) - np.eye(ROW, k=1) - np.eye(ROW, k=-1))

    def step(u, v):
        free = v - fabric @ u
        # so deep that no point leaves the nose: all is linear
        push = forces(B @ u - 1e3, B @ (free if foreseen else v), stiffness, before, usual)
        fast = free + B.T @ push
        return np.concatenate([u + fast, fast])

    rest = step(np.zeros(ROW), np.zeros(ROW))
    columns = [step(*e.reshape(2, ROW)) - rest for e in np.eye(2 * ROW)]
    return abs(np.linalg.eigvals(np.array(columns).T)).max()


COUNT = (ROW - 3) * PER
MIDDLE = abs(np.arange(COUNT) - COUNT // 2)
# forces of a step ago: alike, on a rim, on one point, at random
PATTERNS = {
    "flat": np.ones(COUNT),
    "rim": 1.0 * (MIDDLE < 3),
    "point": 1.0 * (MIDDLE < 1),
    "random": np.random.default_rng(1).random(COUNT) ** 4,
}


@pytest.mark.parametrize("pattern", PATTERNS)
def test_stable_whatever_the_stiffness(pattern):
    for stiffness in (0.1, 1.0, 1e2, 1e5):
        assert radius(stiffness, PATTERNS[pattern]) < 1.0


def test_without_foresight_it_would_not_be():
    assert radius(1e5, PATTERNS["point"], foreseen=False) > 1.05


def test_at_rest_it_is_as_stiff_as_it_says():
    """Where the forces of a step ago are those that hold what else pulls."""
    B = shares()
    stiffness = 100.0
    held = PATTERNS["random"]
    due = -B @ (B.T @ held)
    found = forces(-held / stiffness, due, stiffness, held, 1e-30)
    assert_allclose(found, held, rtol=1e-12)
    # and less where the nose's force is taken to be on all points besides
    softened = forces(-held / stiffness, due, stiffness, held, held.sum() / PER**2)
    assert 0.1 * held.sum() < softened.sum() < held.sum()


def test_in_one_step_a_very_firm_one_closes_the_gap():
    """A lone node under points alike: f = m (d / dt^2 + v / dt), whose sum moves the node by d."""
    const = Point(0.5, law(2.0))
    spring = 1e12, 1.0
    gave = const.dt / const.point_law.mass
    force = normal_kernels.implicit_penalty_force(const, spring, (-0.25, -3.0), (1.0, gave), 0.0)
    assert force == pytest.approx(
        const.point_law.mass * (0.25 / const.dt**2 + 3.0 / const.dt), rel=1e-9
    )
    assert (
        normal_kernels.implicit_penalty_force(const, spring, (-0.25, 3.0), (1.0, 0.25), 0.0) == 0.0
    )


def test_it_foresees_what_all_other_forces_do(ply):
    """What a step does to the nodes about the nose is what was due and what the nose gives."""
    march = PackSolver(Pack.stacked(ply, 3, gap=GAP), 158.0, 12e-6).run()
    state = march.states[0]
    const = march.consts[0]
    advance(march, 1)
    assert march.stack.waits_for_plies[0]
    i0, i1, j0, j1 = window_kernels.reachable_nodes(state, const)
    near = (np.arange(i0, i1 + 1)[:, None] * const.row_stride + np.arange(j0, j1 + 1)).ravel()
    before = [v[near].copy() for v in state.v]
    change = [
        due[i0 : i1 + 1, j0 : j1 + 1].ravel() + state.dt_over_mass[near] * push[near]
        for due, push in zip(np.moveaxis(on_grid(const, state.dv_other), -1, 0), state.f_contact)
    ]
    advance(march, 1)
    for v, old, new in zip(state.v, before, change):
        assert abs(new).max() > 0.1
        assert_allclose(v[near] - old, new, rtol=0, atol=1e-9 * abs(v[near]).max())


def highest(ply, grading=((9, 0.5), (np.inf, 1)), **numbers):
    """[N] highest tension in 40 us in the weft of the first of three plies."""
    chosen = replace(ply, opening=(0.06, 0.06), yarn_failure=False, grading=grading)
    pack = Pack.stacked(chosen, 3, gap=GAP, contact=PlyContact(**numbers))
    return PackSolver(pack, 158.0, 40e-6).run().peak_tensions[0, 1, 0]


def test_tension_under_the_nose_hangs_on_no_numerical_choice(ply):
    """2 % are asked of the stiffness of plies and nose, with two elements a crossover. In S-726 it is this weft that
    fails first."""
    usual = highest(ply)
    assert highest(ply, courant=0.225) == pytest.approx(usual, rel=0.02)
    for stiffness in (0.5, 2.0):
        assert highest(ply, stiffness=stiffness) == pytest.approx(usual, rel=0.02)


@pytest.mark.parametrize("cfl", [0.9, 0.3])
def test_the_nose_presses_on_half_a_ply(ply, cfl):
    """Its stiffness per area is twice that of two half plies, on every mesh and at every step, as that of one ply."""
    single = Pack((replace(ply, grading=((np.inf, 0.25),)),)).constants()[0]
    for grading in (None, ((np.inf, 0.5),)):
        pack = Pack.stacked(replace(ply, grading=grading, numerics=Numerics(cfl=cfl)), 2, gap=GAP)
        for const in (*pack.constants(), single):
            law = const.point_law
            points = const.points_per_side**2 / (const.dx * const.dy)
            assert law.implicit == (const is not single)
            assert law.stiffness * points == pytest.approx(2 * pack.laws[0].stiffness)


@pytest.mark.parametrize("stiffness", [0.2, 0.5, 3.0])
def test_nodes_ahead_of_the_nose_are_called_back_as_those_ahead_of_a_ply(ply, stiffness):
    """By the damper of the plies' spring as it is followed; that of solid fibre would need a shorter step."""
    contact = PlyContact(stiffness=stiffness)
    pack = Pack.stacked(ply, 2, gap=GAP, contact=contact)
    for const in pack.constants():
        law = const.point_law
        spring = pack.contact_laws[0].stiffness * const.dx * const.dy / const.points_per_side**2
        assert law.share_drag == pytest.approx(contact.share_ratio * (spring * law.mass) ** 0.5)
