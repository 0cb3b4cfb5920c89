"""Plies at any angle: what they come to does not depend on the frames of the computation, and nothing is lost."""

from dataclasses import replace
from math import pi, radians

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fabrics import catalogue
from fabrics.base.errors import InputError
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup, Ply
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.numerics import Numerics
from shellfabric.plies.frame_kernels import BEFORE, BEHIND
from shellfabric.plies.model import PlyContact, at_angle
from shellfabric.projectile.projectile import Projectile

# round, and so small a time that no wave comes back from the edge: what is left of the opening turns with nothing
SETUP = ImpactSetup(
    catalogue.load("S-728"),
    260.0,
    opening=0.08,
    round=True,
    symmetry="whole",
    end_time=7e-6,
    audit_interval=1e-6,
    elements_per_crossover=1,
    table_size=61,
    numerics=Numerics(threads=1),
    ply_friction=0.2,
)
FSP = Projectile(
    mass=1.1e-3,
    radius=2.73e-3,
    edge_radius=0.3e-3,
    shape="chisel",
    flat_width=2.54e-3,
    flat_angle=radians(35),
    length=6.35e-3,
)
ROUND_OFF = 1e-12  # of the strike energy


def laid(*degrees, **changes):
    """The set-up with plies at these angles."""
    plies = tuple(Ply(SETUP.fabric, angle=radians(angle)) for angle in degrees)
    return replace(SETUP, plies=len(plies), lay_up=plies, **changes)


def alike(one, other):
    """Whether two results are equal but for round-off: energies of the panel and of each ply, motion, deflections."""
    E = one.strike_energy
    v = one.setup.strike_velocity
    far = max(
        float(abs(one.energies[name] - other.energies[name]).max()) / E for name in one.energies
    )
    far = max(far, float(abs(one.plies["energy"] - other.plies["energy"]).max()) / E)
    far = max(far, float(abs(one.velocity - other.velocity).max()) / v)
    return far < ROUND_OFF and np.allclose(
        one.plies["deflection"], other.plies["deflection"], rtol=1e-6
    )


def test_a_right_angle_by_turning_is_that_by_exchanging_the_yarns():
    """Both the special way of 0 and 90 degrees, and the general one, whose points are computed one at a time."""
    special = run_impact(laid(0, 90))
    general = run_impact(laid(30, -60))
    assert len(set(special.target.angles)) == 1
    assert len(set(general.target.angles)) == 2
    assert special.energies["ply_friction"][-1] > 1e-4
    assert alike(special, general)


def test_what_all_plies_turn_with_changes_nothing():
    """The scene turned as a whole, its fragment simulator with it; and the same, all plies at one angle."""
    straight = run_impact(laid(0, 45, projectile=FSP))
    assert alike(straight, run_impact(laid(20, 65, projectile=replace(FSP, roll=radians(20)))))
    assert not alike(straight, run_impact(laid(20, 65, projectile=FSP)))  # which is another scene
    one = laid(35, 35)
    assert alike(run_impact(laid(0, 0)), run_impact(one))


def test_an_oblique_shot_turns_with_its_pack():
    """Velocity, place of the projectile and of the nodes are told in the frame of the pack, not in a ply's own."""
    aslant = Projectile(obliquity=radians(35), azimuth=radians(50), yaw=radians(5), friction=0.2)
    one = run_impact(laid(0, 30, projectile=aslant))
    two = run_impact(laid(-50, -20, projectile=replace(aslant, azimuth=0.0)))
    assert alike(one, two)
    c = np.cos(radians(50))
    s = np.sin(radians(50))
    turn = np.array([[c, s], [-s, c]])
    for name in ("final_velocity", "projectile_position"):
        there = getattr(one, name)
        here = getattr(two, name)
        assert_allclose(turn @ there[:2], here[:2], rtol=1e-9, atol=1e-12)
    assert two.final_velocity[0] == pytest.approx(260.0 * np.sin(radians(35)), rel=0.05)
    for shots in (one.last, two.last):  # the deepest node is where the projectile is, in every ply
        for shot in shots:
            deepest = shot.nodes[..., 2].argmax()
            assert (
                np.hypot(*(shot.nodes.reshape(-1, 3)[deepest] - shot.projectile_position)[:2])
                < 6e-3
            )


def test_angles_of_either_sign_mirror_each_other():
    assert alike(run_impact(laid(0, 45, 20)), run_impact(laid(0, -45, -20)))


@pytest.mark.parametrize("damping, within", [(0.0, 1e-3), (0.7, 1e-2)])
def test_forces_between_turned_plies_balance(damping, within):
    """Their sum vanishes to round-off, and without friction, which acts half a thickness away, their moment about the
    impact axis as far as closest points have been found; limited shares, which go with damping, move a push among the
    nodes of its point."""
    aslant = Projectile(obliquity=radians(35), azimuth=radians(50))
    pack = laid(0, 30, projectile=aslant, ply_friction=1e-9).target()
    pack = replace(pack, contact=PlyContact(damping=damping))
    solver = PackSolver(pack, 260.0, 12e-6)
    solver.run()
    total = np.zeros(3)
    moment = 0.0
    size = 0.0
    for p, side in ((0, BEHIND), (1, BEFORE)):
        ply = solver.pack.plies[p]
        state = solver.states[p]
        forces = solver.contact.pressure.force[p, side]
        f = np.stack([part[: ply.areas.size] for part in forces], axis=1)
        x = np.stack(
            [X.ravel() + u[: ply.areas.size] for X, u in zip(ply.coordinates(), state.u)], axis=1
        )
        f[:, :2], x = ply.in_pack(f[:, :2]), ply.in_pack(x)
        arms = x[:, 0] * f[:, 1] - x[:, 1] * f[:, 0]
        total = total + f.sum(axis=0)
        moment = moment + arms.sum()
        size = size + abs(arms).sum()
    push = abs(f[:, 2]).sum()
    assert np.hypot(f[:, 0].sum(), f[:, 1].sum()) > 0.01 * push > 0.01
    assert_allclose(total, 0.0, atol=1e-12 * push)
    assert abs(moment) < within * size


def test_an_oblique_weave_is_turned_with_its_ply():
    with pytest.raises(InputError, match=r"angle = 2: must be above -pi/2 and at most pi/2"):
        at_angle(SETUP.panel(SETUP.plain_table()), 2)
    oblique = at_angle(replace(SETUP, weave_angle=0.2).panel(SETUP.plain_table()), pi / 2)
    assert (oblique.weave_angle, oblique.ply_angle) == pytest.approx((0.2 - pi / 2, -pi / 2))


def test_a_point_stands_for_no_more_than_the_other_ply_bears():
    """Of a graded ply turned over the fine zone of another: its own area, but for that of the points of four there."""
    panel = replace(SETUP, elements_per_crossover=None, plies=2).panel(SETUP.plain_table())
    own = np.multiply.outer(*panel.sides) / np.prod(panel.spacing)
    middle = np.array(panel.counts).reshape(2, 1, 1, 1, 1) / 2
    places = middle + np.zeros((2, panel.counts[0], 2, 2, panel.counts[1]))
    assert own.max() > 4.0
    pack = laid(0, 45, elements_per_crossover=None).target()
    assert_allclose(pack._areas(0, places), np.minimum(own, 4.0), rtol=1e-12)
