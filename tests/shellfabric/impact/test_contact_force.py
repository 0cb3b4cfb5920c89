"""Contact force, deflection and place of the peak tension of every explicit solver of an impact."""

from dataclasses import replace

import numpy as np
import pytest

from fabrics import catalogue
from shellfabric.backing.block import Backing
from shellfabric.impact import simulation
from shellfabric.output import checkpoint
from shellfabric.projectile.projectile import Projectile
from shellfabric.sliding.model import CrossoverFriction

SETUP = simulation.ImpactSetup(
    catalogue.load("S-720").with_effective_density(), 150.0, opening=0.0508, table_size=51, end_time=60e-6,
    audit_interval=1e-6,
)  # fmt: skip
SLIDING = {"crossovers": CrossoverFriction()}


def run(setup, plies=1, **options):
    return simulation.run(replace(setup, plies=plies), **options)


def impulses(result):
    """(n,) [N s] of the contact force from one sample to the next."""
    return result.contact_force[1:] * np.diff(result.t)


@pytest.mark.parametrize(
    ("changes", "plies"),
    [
        ({}, 1), ({}, 2), (SLIDING, 1), (SLIDING, 2),
        ({"symmetry": "whole", "projectile": Projectile(obliquity=0.4)}, 1),
        ({"projectile": replace(Projectile(), friction=0.3)}, 1),
        ({"strike_velocity": 400.0}, 1),
    ],
    ids=["ply", "pack", "sliding ply", "sliding pack", "oblique", "friction", "torn"],
)  # fmt: skip
def test_impulse_is_the_loss_of_momentum(changes, plies):
    """In every interval between samples, to round-off: the force is the sum of the contact's, the velocity that of the
    projectile."""
    result = run(replace(SETUP, **changes), plies)
    mass = SETUP.projectile.mass
    assert result.contact_force[0] == 0.0
    assert result.contact_force.max() > 100.0
    lost = -mass * np.diff(result.v)
    np.testing.assert_allclose(impulses(result), lost, rtol=0, atol=1e-11 * mass * SETUP.strike_velocity)


def test_impulse_of_a_bar():
    """The centre of mass of an elastic projectile takes the force of a step after the sample: half a step's share."""
    shot = SETUP.projectile
    result = run(replace(SETUP, projectile=replace(shot, body="elastic_bar")))
    lost = shot.mass * (result.v[0] - result.v)
    taken = np.concatenate([[0.0], np.cumsum(impulses(result))])
    step = result.step_history[0, 0]
    assert np.abs(taken - lost).max() <= 0.51 * step * result.step_history[:, 3].__abs__().max()
    assert taken[-1] == pytest.approx(lost[-1], rel=0.01)


def test_impulse_with_a_block():
    """The force of the block is recorded a step late: the impulse is off by one step of it at most."""
    block = Backing(size=(0.06, 0.06, 0.03), min_size=0.002, growth=1.5)
    result = run(replace(SETUP, backing=block))
    lost = SETUP.projectile.mass * (result.v[0] - result.v[-1])
    assert impulses(result).sum() == pytest.approx(lost, rel=2e-3)


@pytest.mark.parametrize("plies", [1, 2])
def test_deflection_is_that_of_the_last_ply(plies):
    result = run(replace(SETUP, strike_velocity=60.0), plies)
    nodes, rest = result.last[-1].nodes, 0.0 if plies == 1 else result.target.places[-1]
    assert result.deflection[-1] == pytest.approx(nodes[..., 2].max() - rest, rel=1e-12)
    assert result.deflection[0] == 0.0
    assert result.max_deflection == result.deflection.max()


def test_deflection_leaves_out_what_is_cut_out():
    """A plug that flies on with the projectile is no cloth of the panel any more."""
    result = run(replace(SETUP, strike_velocity=600.0, end_time=100e-6))
    assert result.outcome == "perforated"
    assert result.max_deflection < 0.5 * result.last[0].nodes[..., 2].max()
    assert result.max_deflection < 0.5 * result.nose_position[-1]


@pytest.mark.parametrize("plies", [1, 3])
def test_peak_tension_has_its_time_and_place(plies):
    """Another run that ends at the peak's time finds the same peak there, and one a step shorter a lower one."""
    setup = replace(SETUP, strike_velocity=60.0, end_time=40e-6)
    result = run(setup, plies)
    last = result.peaks[-1]
    peaks, times, places = last[:, 0], last[:, 1], last[:, 2:]
    dt, middle = result.step_history[0, 0], 0.25 * 0.0508
    for family in range(2):
        assert 0 < times[family] <= setup.end_time + dt
        assert np.all((places[family] >= 0) & (places[family] <= 2 * middle))
        until = run(replace(setup, end_time=times[family] - 0.5 * dt), plies)
        short = run(replace(setup, end_time=times[family] - 1.5 * dt), plies)
        assert until.peaks[-1, family, 0] == peaks[family]
        assert short.peaks[-1, family, 0] < peaks[family]


def test_a_run_gone_on_with_has_the_same_histories(tmp_path):
    path = tmp_path / "checkpoint.h5"
    whole = run(SETUP)
    run(replace(SETUP, end_time=30e-6), hooks=(checkpoint.Checkpoints(path, 10e-6),))
    again = run(SETUP, resume=path)
    for name in ("contact_force", "deflection", "peaks"):
        np.testing.assert_array_equal(getattr(again, name), getattr(whole, name))
