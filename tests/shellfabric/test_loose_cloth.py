"""Cloth that nothing holds: drawn together, thrown, and drawn in from free edges."""

from dataclasses import replace
from math import radians

import numpy as np
import pytest
from conftest_tools import bring, node_forces

from fabrics.errors import UnstableError
from shellfabric import march_kernels
from shellfabric.march import March, fastest
from shellfabric.projectile import Projectile


def forces(panel, state, x):
    """Forces of the cloth at rest at x: brought there twice, so that no stretch changes and nothing is damped."""
    return node_forces(panel, bring(panel, bring(panel, state, x), x))


def squeezed(panel, stretch1, stretch2, angle):
    """(ni+1, nj+1, 3) places of cloth that is evenly drawn together and sheared."""
    X, Y = panel.coordinates()
    turn = 0.5 * angle
    along, across = (np.cos(turn), np.sin(turn)), (np.sin(turn), np.cos(turn))
    return np.stack([stretch1 * X * a + stretch2 * Y * b for a, b in zip(along, across)] + [0 * X], axis=-1)


def highest_frequency(panel, x):
    """[1/s] of the cloth at x, by power iteration on the change of its forces."""
    state, mass, rng = panel.state(1.0), panel.masses()[..., None], np.random.default_rng(1)
    rest, mode, found, size = forces(panel, state, x), rng.normal(size=x.shape), 0.0, 1e-4 * min(panel.spacing)
    for _ in range(60):
        mode *= size / np.abs(mode).max()
        mode, last = (rest - forces(panel, state, x + mode)) / mass, mode
        found = np.sqrt(np.linalg.norm(mode) / np.linalg.norm(last))
    return found


@pytest.mark.parametrize("stretches", [(1.0, 1.0), (0.7, 0.7), (0.3, 0.3), (0.1, 0.1), (0.02, 0.02), (0.02, 0.9)])
def test_cloth_that_is_drawn_together_stays_within_the_time_step(small, stretches):
    """The trellis alone, sheared beyond the angle at which it locks: along unit vectors its stiffness grows as the
    inverse square of the stretch, and the step of cloth at rest is ten times too long at a stretch of 0.1."""
    panel = small(edge="free", symmetry="whole")
    assert highest_frequency(panel, squeezed(panel, *stretches, 0.8)) * panel.time_step < 2.0


@pytest.mark.parametrize("stretch", [0.95, 0.6, 0.2, 0.03])
def test_trellis_forces_are_a_gradient_wherever_cloth_is(small, stretch):
    """Work of the forces over a small uneven motion against the change of the energy that the audit has."""
    panel, rng = small(edge="free", symmetry="whole"), np.random.default_rng(2)
    state, const, out = panel.state(1.0), panel.constants(), np.empty(5)
    x = squeezed(panel, stretch, 0.9 * stretch, 0.7)
    x += 0.05 * stretch * min(panel.spacing) * rng.normal(size=x.shape)
    motion = 1e-5 * stretch * min(panel.spacing) * rng.normal(size=x.shape)
    energy = []
    for sign in (-1, 1):
        bring(panel, state, x + sign * motion)
        march_kernels.energies(state, const, out)
        energy.append(out[march_kernels.STORED] + out[march_kernels.SHEAR])
    work = (forces(panel, state, x) * 2 * motion).sum()
    assert energy[1] - energy[0] == pytest.approx(-work, rel=1e-4)


def test_contact_finds_cloth_that_is_drawn_in_from_a_free_edge(small):
    """A nose that flies askew takes a free panel along: cloth from far beyond it comes under it, and must not be found
    when it is deep inside the nose: contact gives no energy that it has not taken."""
    shot = Projectile(obliquity=radians(50), shape="hemisphere", radius=2e-3, edge_radius=0.3e-3)
    panel = small(edge="free", symmetry="whole", projectile=shot, failure=False)
    march = March(panel, 200.0, 90e-6).run()
    for k in range(0, (march.const.ni + 1) * march.const.s):
        i, j = divmod(k, march.const.s)
        x = np.array([X[i, j] for X in (*panel.coordinates(), 0 * panel.coordinates()[0])])
        x += [march.state.u[c][k] for c in range(3)]
        assert shot.distance(x - march.state.position)[0] > -0.1 * shot.radius, (i, j)


def test_nodes_may_be_fast_but_not_faster_than_an_element_a_step(small):
    panel = small()
    march = March(panel, 100.0, 20e-6).run()
    speed = fastest(march.const)
    assert speed == pytest.approx(min(panel.spacing) / panel.time_step)
    march.state.v[2][30] = 0.9 * speed
    march._guard()
    march.state.v[2][30] = 1.1 * speed
    with pytest.raises(UnstableError, match="a node moves at"):
        march._guard()


def test_two_plies_of_soft_yarns_bear_a_fast_shot(fabric):
    """Nodes that a nose at 661 m/s throws, at twice that and more, outrun no element."""
    from shellfabric.impact import ImpactSetup
    from shellfabric.pack_impact import PackSetup, run

    weave = fabric.weave
    soft = replace(fabric, weave=replace(weave, **{n: replace(getattr(weave, n), E=50e9) for n in ("warp", "weft")}))
    ply = ImpactSetup(soft, 661.0, opening=0.0306, end_time=6e-6, table_size=101)
    result = run(PackSetup(ply, 2, gap=1e-5))
    assert result.worst_balance < 5e-3
