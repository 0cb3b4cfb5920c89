"""Clamps that let the ends of sliding yarns slip, and contact where yarns have been drawn apart."""

from dataclasses import replace

import numpy as np
import pytest

from shellfabric.panel.boundary import Grip
from shellfabric.projectile import window_kernels
from shellfabric.projectile.projectile import Projectile
from shellfabric.sliding.model import CrossoverFriction, grid
from shellfabric.solver.pack_solver import PackSolver


def test_yarns_slip_out_of_a_weak_clamp_at_its_force(sliding):
    force = 30.0
    run = PackSolver(sliding(0.1, boundary=Grip(force), yarn_failure=False), 80.0, 80e-6).run()
    last = run.const.ni
    through = grid(run.slips[0].passed[0], run.panel)
    assert through[last].min() < -1e-4  # [m] towards the middle
    assert np.all(through[last] <= 0)
    slips = grid(run.slips[0].q[0], run.panel)[last] < 0
    pull = grid(run.slips[0].config[0], run.panel)[last - 1] * np.where(
        np.arange(slips.size) == 0, 2.0, 1.0
    )  # a half yarn
    assert slips.sum() > 5
    assert pull[slips] == pytest.approx(np.full(slips.sum(), force), rel=0.03)
    assert np.abs(run.sample("error")).max() < 0.005 * run.strike_energy
    free = PackSolver(sliding(0.1, yarn_failure=False), 80.0, 80e-6).run()
    assert run.sample("v")[-1] > free.sample("v")[-1]


def test_the_ends_of_yarn_in_a_weak_clamp_are_never_used_up(sliding):
    run = PackSolver(
        sliding(0.0, boundary=((Grip(1.0), Grip(1.0)), ("free", "free"))), 60.0, 200e-6
    ).run()
    assert np.abs(grid(run.slips[0].passed[0], run.panel)[-1]).max() > run.const.dx
    assert np.all(grid(run.state.intact_fraction[0], run.panel)[:-1] == 1.0)


def test_a_ply_is_struck_beside_a_crossover(sliding):
    """Its grid stays in the opening, and its four sides stay lines that may slip. Mirrored points are alike, and so are
    crossovers until an edge is felt."""
    side = 2 * np.array(sliding().weave.w)

    def shot(places, end):
        point = tuple(np.array(places) * side)
        panel = sliding(0.1, symmetry="whole", boundary=Grip(20.0), impact_point=point)
        for line, x, n, place in zip(panel.lines(), point, panel.nearest_lines, places):
            np.testing.assert_allclose(line[[0, -1]] + x, [-0.0153, 0.0153], atol=side.max())
            np.testing.assert_allclose(line[[0, -1]].sum(), -2 * x, atol=1e-12)
            assert n == line.size // 2 + round(place)
        return PackSolver(panel, 60.0, end).run()

    one = shot((0.25, 0.25), 40e-6)
    mirrored = shot((-0.25, -0.25), 40e-6)
    assert one.sample("v") == pytest.approx(mirrored.sample("v"), rel=1e-6)
    assert np.abs(one.sample("error")).max() < 0.005 * one.strike_energy
    middle, crossover, beside = (
        shot(places, 1.2e-6).sample("v")[-1] for places in ((0, 0), (2, -1), (0.25, 0.25))
    )
    assert crossover == pytest.approx(middle, rel=1e-9)
    assert beside != pytest.approx(middle, rel=1e-6)


def test_contact_ends_in_the_middle_of_a_window_and_not_beside_its_yarns(sliding):
    run = PackSolver(sliding(), 50.0, 1e-6)
    state = run.state
    const = run.const
    share = lambda s, t: window_kernels.cover_at_point(state, const, np.uint64(0), s, t)  # noqa: E731
    places = np.linspace(0, 1, 41)
    for stretch in state.stretch:
        stretch[:] = window_kernels.COVERED
    assert all(share(s, t) == pytest.approx(1.0) for s in places for t in places)
    for stretch in state.stretch:
        stretch[:] = 1.5 * window_kernels.BARE
    found = np.array([[share(s, t) for t in places] for s in places])
    assert found[20, 20] == 0.0
    assert np.all(found[[0, -1]] == 1.0)
    assert np.all(found[:, [0, -1]] == 1.0)
    assert np.abs(np.diff(found, axis=0)).max() < 0.2  # continuous
    state.stretch[0][:] = 1.0
    assert all(
        share(0.5, t) == 1.0 for t in places
    )  # a gap between the yarns of one family alone is no window


def test_a_pointed_nose_wedges_through_between_yarns(sliding):
    """It pushes yarns aside that the closed surface would have to tear."""
    nose = Projectile(shape="cone", radius=1.2e-3, half_angle=0.35, tip_radius=2e-4, mass=1e-3)
    run = PackSolver(sliding(0.02, projectile=nose), 20.0, 1e-3).run()
    assert run.outcome == "perforated"
    assert run.sample("cut_yarns")[-1] == 0
    assert run.slip_summaries()[0].largest_window > 1.2 * run.const.dx
    assert np.abs(run.sample("error")).max() < 0.005 * run.strike_energy
    pinned = PackSolver(replace(run.panel, friction=CrossoverFriction(np.inf)), 20.0, 1e-3).run()
    assert pinned.outcome == "stopped"
