"""What collisions hand on from ply to ply: no node becomes faster than momentum and restitution allow."""

from dataclasses import replace
from math import radians

import numpy as np
import pytest
from conftest_tools import advance, far_from_nose, grid, momenta
from numba import njit
from numpy.testing import assert_allclose

from fabrics import catalogue
from shellfabric.impact.setup import ImpactSetup, Ply
from shellfabric.jit.simd import load, store
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.numerics import Numerics
from shellfabric.plies.model import Pack, PlyContact
from shellfabric.projectile.projectile import Projectile
from shellfabric.surface.surface_kernels import (
    point_mean_speed,
    point_speeds8,
    point_tilt,
    scatter_limited_to_points8,
    share_out_limited,
    speeds_at,
)

STRIKE = 400.0
S728 = catalogue.load("S-728").with_effective_density()
S726 = catalogue.load("S-726").with_effective_density()
BULLET = ImpactSetup(
    S728,
    STRIKE,
    projectile=Projectile(mass=8e-3, radius=4.5e-3, shape="hemisphere"),
    opening=0.03,
    grading=((17, 1), (np.inf, 4)),
    plies=5,
    yarn_failure=False,
    table_size=81,
    numerics=Numerics(threads=1),
    end_time=4e-6,
)


def normal_velocities(run):
    """(plies, ni+1, nj+1) [m/s] of plies of one grid."""
    return np.array([grid(const, state.v[2]) for _, const, state in run.plies])


def test_a_collision_sets_no_node_faster_than_the_fastest(ply):
    """Of equal masses each is left with a mean of both velocities, whatever the restitution: also of plies whose
    nodes are not alike in speed. 1 us, in which the yarns do next to nothing."""
    free = replace(ply, boundary="free", symmetry="whole", opening=(0.034, 0.034))
    march = far_from_nose(Pack.stacked(free, 3, gap=20e-6))
    front = march.states[0]
    uneven = np.random.default_rng(1).uniform(100.0, 400.0, front.mass.size)
    front.v[2][:] = np.where(front.mass > 0, uneven, 0.0)
    fastest = 0.0
    slowest = 0.0
    for _ in range(8):
        advance(march, max(1, round(1.25e-7 / march.const.dt)))
        within = normal_velocities(march)[:, 3:-3, 3:-3]
        fastest = max(fastest, within.max())
        slowest = min(slowest, within.min())
    assert normal_velocities(march)[1].max() > 100.0
    assert fastest < 1.05 * 400.0
    assert slowest > -0.05 * 400.0


CASES = {
    "in line": {},
    "half": {"grading": ((17, 0.5), (np.inf, 2))},
    "turned": {
        "symmetry": "whole",
        "lay_up": tuple(Ply(S728, angle=radians(angle)) for angle in (0, 45, 0, 30, 0)),
        "opening": 0.024,
    },
    "unlike": {"lay_up": tuple(Ply(fabric) for fabric in (S728, S726, S728, S726, S728))},
}


@pytest.mark.parametrize("case", CASES)
def test_a_round_nose_throws_no_ply_at_twice_its_speed(case):
    """A column of equal plies before a rigid nose has 1.4 V, and 2 V at most, of elastic collisions. Plain shares throw
    nodes at 2.2 to 2.7 V here, and others back at 0.6 V."""
    setup = replace(BULLET, **CASES[case])
    march = PackSolver(setup.target(), STRIKE, setup.end_time, interval=1.25e-7)
    fastest = []
    slowest = []

    def watch(run):
        along = [state.v[2] for state in run.states]
        fastest.append(max(v.max() for v in along))
        slowest.append(min(v.min() for v in along))

    march.run((watch,))
    assert march.states[-1].v[2].max() > 0.9 * STRIKE
    assert max(fastest) < 1.85 * STRIKE
    assert min(slowest) > -0.05 * STRIKE
    assert abs(march.sample("error")).max() < 1e-4 * march.strike_energy


def test_the_shares_of_a_struck_pack_keep_momentum():
    """Of nose and free plies that tear and rub on both, to round-off."""
    fast = 1.6 * STRIKE
    setup = replace(
        BULLET,
        strike_velocity=fast,
        plies=3,
        symmetry="whole",
        boundary="free",
        opening=0.024,
        yarn_failure=True,
        ply_friction=0.2,
        projectile=replace(BULLET.projectile, friction=0.3),
        end_time=8e-6,
    )
    march = PackSolver(setup.target(), fast, setup.end_time).run()
    assert march.sample("cut_yarns")[-1] > 4
    carried = momenta(march).sum(axis=0)
    flying = march.const.projectile_mass * march.stack.projectile_velocity
    assert carried[2] > 5e-3 * flying[2]
    struck = march.const.projectile_mass * fast
    assert_allclose(carried + flying, [0.0, 0.0, struck], rtol=0, atol=1e-12 * struck)
    assert abs(march.sample("error")).max() < 1e-3 * march.strike_energy


def test_an_undamped_contact_limits_nothing():
    assert PlyContact(damping=0.0).share_drag == 0.0
    one = PlyContact(damping=0.7, courant=0.45)
    assert one.share_drag * one.damping * one.courant == pytest.approx(1.35)


@njit
def share(v, at, weights, pushes, one, eight):
    """Share the pushes of eight points side by side out, one at a time and eight at once; the means of speeds by these
    shares and by the plain ones, and the tilts of one point at a time and of eight."""
    forces, normals, of_push, drags = pushes
    means = np.empty((2, 8))
    tilts = np.empty((2, 8))
    first, stride = at
    wa, wb = weights
    window = np.array([99, 0, 99, 0])
    for p in range(8):
        force = forces[0, p], forces[1, p], forces[2, p]
        n = normals[0, p], normals[1, p], normals[2, p]
        foot = 0, p, (first + p, stride), wa, wb
        speeds = speeds_at(v, (first + p, stride), n)
        tilts[0, p] = point_tilt(speeds, wa, wb)
        limit = 1.0, of_push[p], drags[p]
        means[0, p] = share_out_limited(one, window, foot, speeds, (force, limit))
    n = load(normals[0], 0), load(normals[1], 0), load(normals[2], 0)
    force = load(forces[0], 0), load(forces[1], 0), load(forces[2], 0)
    speeds = point_speeds8(v, at, n)
    limit = 1.0, load(of_push, 0), load(drags, 0)
    went = scatter_limited_to_points8(eight, at, weights, speeds, (force, limit))
    store(means[1], 0, went)
    plain = np.empty(8)
    store(plain, 0, point_mean_speed(speeds, wa, wb))
    store(tilts[1], 0, point_tilt(speeds, wa, wb))
    return means, plain, tilts


def test_limited_shares_keep_the_force_and_only_take_energy():
    """Of eight points as of one: the sum, no share for who runs far ahead, a power that is no higher than that of plain
    shares; and plain shares if nobody runs ahead."""
    rng = np.random.default_rng(3)
    stride = 13
    v = rng.normal(0.0, 10.0, (3, 5 * stride))
    normals = rng.normal(size=(3, 8))
    normals /= np.linalg.norm(normals, axis=0)
    size = rng.uniform(1.0, 3.0, 8)
    weights = (0.11, 0.72, 0.17), (0.23, 0.71, 0.06)
    plain = np.outer(*weights)

    def shared(of_push, drags):
        one = np.zeros((3, v.shape[1]))
        eight = np.zeros((3, v.shape[1]))
        means, mean, tilts = share(
            v, (0, stride), weights, (size * normals, normals, of_push, drags), one, eight
        )
        assert_allclose(tilts[1], tilts[0], rtol=1e-12)
        assert_allclose(eight, one, atol=1e-13)
        assert_allclose(means[1], means[0], rtol=1e-12)
        assert_allclose(one.sum(axis=1), (size * normals).sum(axis=1), rtol=1e-12)
        return one, means[0], mean

    _, _, mean = shared(np.zeros(8), np.zeros(8))
    limited, means, _ = shared(mean, rng.uniform(0.05, 0.5, 8))
    assert (means < mean - 0.1).all()
    stopped, _, _ = shared(mean, np.full(8, 1e9))
    unlimited, means, _ = shared(np.full(8, 99.0), np.full(8, 1e9))
    assert_allclose(means, mean, rtol=1e-12)
    expected = np.zeros_like(unlimited)
    for p in range(8):
        for m in range(3):
            row = slice(m * stride + p, m * stride + p + 3)
            expected[:, row] += np.outer(size[p] * normals[:, p], plain[m])
    assert_allclose(unlimited, expected, rtol=1e-12)
    assert abs(limited - unlimited).max() > 0.1
    assert abs(stopped - limited).max() > 0.1
