"""Cloth that nothing holds: drawn together, thrown, and drawn in from free edges."""

import numpy as np
import pytest
from conftest_tools import bring, node_forces
from panels import make_panel

from fabrics.compression import CompressionLaw
from fabrics.errors import UnstableError
from fabrics.fabric import Fabric
from fabrics.trellis import TrellisShear
from fabrics.weave import Weave
from fabrics.yarn import Yarn
from shellfabric.impact.simulation import ImpactSetup, run
from shellfabric.projectile.projectile import Projectile
from shellfabric.solver.pack_solver import PackSolver


def highest_frequency(panel, x):
    """[1/s] of the cloth at x, by power iteration on the change of its forces."""
    state, mass, rng = panel.state(1.0), panel.masses()[..., None], np.random.default_rng(1)

    def forces(x):
        """At rest: brought there twice, so that no stretch changes and nothing is damped."""
        return node_forces(panel, bring(panel, bring(panel, state, x), x))

    at_rest, mode, found, size = forces(x), rng.normal(size=x.shape), 0.0, 1e-4 * min(panel.spacing)
    for _ in range(60):
        mode *= size / np.abs(mode).max()
        mode, last = (at_rest - forces(x + mode)) / mass, mode
        found = np.sqrt(np.linalg.norm(mode) / np.linalg.norm(last))
    return found


@pytest.mark.parametrize("stretches", [(1.0, 1.0), (0.7, 0.7), (0.3, 0.3), (0.1, 0.1), (0.02, 0.02), (0.02, 0.9)])
def test_cloth_that_is_drawn_together_stays_within_the_time_step(stretches):
    """The trellis alone, sheared beyond the angle at which it locks: along unit vectors its stiffness grows as the
    inverse square of the stretch, and the step of cloth at rest is ten times too long at a stretch of 0.1."""
    panel = make_panel(edge="free", symmetry="whole")
    (X, Y), directions = panel.coordinates(), ((np.cos(0.4), np.sin(0.4)), (np.sin(0.4), np.cos(0.4)))
    x = np.stack([stretches[0] * X * a + stretches[1] * Y * b for a, b in zip(*directions)] + [0 * X], axis=-1)
    assert highest_frequency(panel, x) * panel.time_step < 2.0


def test_contact_finds_cloth_that_is_drawn_in_from_a_free_edge():
    """A nose that flies askew takes a free panel along: cloth from far beyond it comes under it, and must not be found
    when it is deep inside: contact gave 1.3 % of the strike energy, and 21 yarns failed in place of 3."""
    warp, weft = (Yarn(tex * 1e-6, 1015, 56e9, 0.0448, crimp) for tex, crimp in ((60.1, 0.0087), (63.1, 0.00385)))
    shear, laws = TrellisShear(8.54e6, 8.54e9, 0.104, 0.485), (CompressionLaw(1.37e-5, 2.17e-5),) * 2
    fabric = Fabric("cloth", Weave(warp, weft, 1904, 1246), laws, shear)
    shot = Projectile(8e-3, 3.33e-3, 0.367e-3, obliquity=0.369, azimuth=3.148)
    ply = ImpactSetup(
        fabric, 120.7, projectile=shot, opening=0.02627, edge="free", symmetry="whole", end_time=118e-6, table_size=101
    )
    panel = ply.panel()
    assert all(reach > x[-1] - x[0] for reach, x in zip(panel.reach(), panel.lines()))
    result = run(ply)
    assert result.energies["contact"].min() > -1e-3 * result.strike_energy


@pytest.mark.parametrize(("edge", "whole"), [("clamped", 0), (("free", "clamped"), 1), ("free", 2)])
def test_reach_is_bounded_along_yarns_that_are_held_at_both_ends(edge, whole):
    panel = make_panel(edge=edge)
    assert sum(reach > x[-1] - x[0] for reach, x in zip(panel.reach(), panel.lines())) == whole


@pytest.mark.parametrize("velocity", [10.0, 400.0])
def test_nodes_may_be_ten_times_as_fast_as_what_sets_them_in_motion(velocity):
    """The projectile, or in a slow strike a yarn that breaks at the strain e: e c."""
    panel = make_panel()
    march = PackSolver(panel, velocity, 5e-6).run()
    speed = 10 * max(velocity, *(yarn.failure_strain * yarn.wave_speed for yarn in panel.weave.yarns))
    assert (speed == 4000.0) == (velocity == 400.0)
    march.state.v[2][30] = 0.9 * speed
    march._guard()
    march.state.v[2][30] = 1.1 * speed
    with pytest.raises(UnstableError, match="a node moves at"):
        march._guard()
