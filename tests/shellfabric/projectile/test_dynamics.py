"""The projectile as a bar in a march: its twin outside, the rigid limit, waves, symmetry, energy, resumption."""

from dataclasses import replace

import numpy as np
import pytest
from bar_motion import Motion

from fabrics.errors import InputError
from shellfabric.impact.simulation import ImpactSetup, collect_result, run
from shellfabric.output import checkpoint
from shellfabric.projectile.bar import Bar, held_force
from shellfabric.projectile.projectile import Projectile
from shellfabric.solver.pack_solver import PackSolver

QUICK = {"opening": 0.0508, "table_size": 61, "end_time": 60e-6}


def shoot(fabric, body, velocity=100.0, **changes):
    return run(ImpactSetup(fabric, velocity, projectile=Projectile(body=body), **QUICK | changes))


def uniform(stiffer=1.0):
    """The cylinder without a bore, stiffer, and elastic whatever happens."""
    full = Bar.full()
    return replace(full, material=replace(full.material, modulus=stiffer * full.material.modulus, yield_stress=np.inf))


@pytest.fixture(scope="module")
def struck(fabric):
    return shoot(fabric, "elastic_bar")


def test_the_bar_of_the_march_is_the_bar_alone(fabric, struck):
    """Given the forces of the march step by step, `Motion` moves tip and tail alike."""
    motion, fine = Motion(struck.setup.projectile.bar, 100.0), struck.step_history
    dt, force, tips, tails = fine[0, 0], 0.0, [], []
    for now in fine[:, 3]:
        tip, _ = motion.push(force, dt)
        tips.append(tip)
        tails.append(motion.u[-1])
        force = now
    assert struck.bar.tip == pytest.approx(np.array(tips), rel=1e-12)
    assert struck.bar.tail == pytest.approx(np.array(tails), rel=1e-12)
    assert struck.nose_position[-1] == pytest.approx(tips[-1], rel=1e-12)


def test_energy_and_momentum_balance(struck):
    assert struck.energy_error_max < 5e-3
    assert struck.energies["elastic_projectile"].max() > 0
    fine, bar = struck.step_history, struck.bar
    impulse = np.sum(fine[:-1, 3]) * fine[0, 0]
    assert 3e-3 * (bar.centre_velocity[-1] - 100.0) == pytest.approx(impulse, rel=1e-9)
    assert struck.v[-1] == pytest.approx(bar.centre_velocity[-1], rel=1e-12)


def test_energy_balance_of_a_wall_that_yields(fabric):
    """At 155 m/s on the whole panel the bored wall of 220 MPa is squeezed: the plastic term is not small."""
    result = shoot(fabric, "elastic_bar", 155.0, opening=0.203, end_time=200e-6)
    assert result.energies["plastic_projectile"][-1] > 0.03 * result.strike_energy
    assert result.bar.shortening > 0.5e-3
    assert result.energy_error_max < 5e-3


def test_a_stiff_bar_is_rigid(fabric):
    rigid, soft, stiff = shoot(fabric, "rigid"), shoot(fabric, uniform()), shoot(fabric, uniform(100.0))
    assert rigid.bar is None
    assert np.abs(stiff.step_history[:, 2] - rigid.step_history[:, 2]).max() < 0.3
    splits = [np.abs(one.bar.tip_velocity - one.bar.tail_velocity)[50:].max() for one in (soft, stiff)]
    assert splits[1] < 0.25 * splits[0]
    assert stiff.nose_position[-1] == pytest.approx(rigid.nose_position[-1], rel=2e-3)


def test_tip_and_tail_swing_with_the_period_of_the_bar(fabric):
    """2 L / c = 17.0 us, from the histories of an impact."""
    result = shoot(fabric, uniform(), opening=0.203, end_time=250e-6)
    difference = result.bar.tip_velocity - result.bar.tail_velocity
    t = result.bar.t
    # the difference's autocorrelation, over a window that the first mode rules
    k = slice(int(5e-6 / t[0]), None)
    wave = difference[k] - difference[k].mean()
    wave = np.convolve(wave, np.ones(41) / 41, "same")  # high modes out
    auto = np.correlate(wave, wave, "full")[wave.size - 1 :]
    lags = np.arange(auto.size) * t[0]
    first = (lags > 10e-6) & (lags < 26e-6)
    assert lags[first][np.argmax(auto[first])] == pytest.approx(17.0e-6, rel=0.1)
    assert result.bar.period == pytest.approx(17.0e-6, rel=2e-3)


def test_quarter_and_whole_agree(fabric, struck):
    whole = shoot(fabric, "elastic_bar", symmetry="whole", end_time=30e-6)
    n = whole.steps
    assert whole.bar.tip == pytest.approx(struck.bar.tip[:n], rel=1e-9)
    assert whole.bar.tail_velocity == pytest.approx(struck.bar.tail_velocity[:n], rel=1e-6, abs=1e-6)


def test_an_oblique_bar_moves_rigidly_across_its_axis(fabric):
    changes = {"symmetry": "half", "end_time": 25e-6}
    shots = []
    for body in ("rigid", uniform(100.0)):
        shot = Projectile(body=body, obliquity=0.4, azimuth=np.pi / 2)
        shots.append(run(ImpactSetup(fabric, 100.0, projectile=shot, **QUICK | changes)))
    rigid, bar = shots
    assert bar.projectile_position == pytest.approx(rigid.projectile_position, abs=2e-6)
    assert bar.velocity == pytest.approx(rigid.velocity, abs=0.3)
    assert bar.energy_error_max < 5e-3


def test_resumes_bit_for_bit(fabric, struck, tmp_path):
    path = tmp_path / "checkpoint.h5"
    half = run(replace(struck.setup, end_time=30e-6), hooks=(checkpoint.Checkpoints(path, 20e-6),))
    assert half.steps < struck.steps
    march = PackSolver(struck.setup.panel(), 100.0, struck.setup.end_time)
    checkpoint.read(march, path)
    resumed = collect_result(struck.setup, march.run())
    np.testing.assert_array_equal(resumed.bar.tip_velocity, struck.bar.tip_velocity)
    np.testing.assert_array_equal(resumed.last[0].nodes, struck.last[0].nodes)


def test_a_checkpoint_of_another_body_is_refused(fabric, struck, tmp_path):
    path = tmp_path / "checkpoint.h5"
    run(replace(struck.setup, end_time=10e-6), hooks=(checkpoint.Checkpoints(path, 5e-6),))
    setup = replace(struck.setup, projectile=Projectile())
    with pytest.raises(InputError):
        checkpoint.read(PackSolver(setup.panel(), 100.0, setup.end_time), path)


def test_says_when_rigid_is_enough(struck):
    """The contact, not the run, is held against the period of the first mode, 19.2 us of the bored cylinder."""
    told = struck.rigidity
    assert told.period == pytest.approx(19.2e-6, abs=0.1e-6)
    assert told.enough == (told.contact_time >= 3 * told.period)
    assert told.yield_force == pytest.approx(220e6 * np.pi / 4 * (5.5e-3**2 - 4.5e-3**2))


def test_says_that_a_wall_yields(fabric):
    """On S-720 the rigid run alone tells it: at 155 m/s more than the yield force is held, at 92.5 less."""
    found = {v: shoot(fabric, "rigid", v, opening=0.203, end_time=350e-6).rigidity for v in (92.5, 155.0)}
    assert found[155.0].force > found[155.0].yield_force > found[92.5].force
    assert found[92.5].enough
    assert not found[155.0].enough
    assert "yields at 1728 N: use the elastic projectile" in str(found[155.0])


def test_the_held_force_is_the_largest_mean():
    t = np.linspace(1e-6, 100e-6, 100)
    force = np.where((t > 20e-6) & (t < 31e-6), -100.0, -1.0)
    assert held_force(t, force, 10e-6) == pytest.approx(100.0, rel=0.02)
    assert held_force(t, force, 20e-6) == pytest.approx((11 * 100 + 9) / 20, rel=0.02)


@pytest.mark.parametrize(
    "changes",
    [
        {"body": "soft"},
        {"body": "elastic_bar", "shape": "hemisphere"},
        {"body": "elastic_bar", "mass": 1e-3},
        {"body": "elastic_bar", "mass": 9e-3},
        {"body": uniform(), "mass": 4e-3},
        {"bore_diameter": 1e-3},
        {"body": "elastic_bar", "bore_diameter": 6e-3},
    ],
)
def test_bad_bodies_are_refused(changes):
    with pytest.raises(InputError):
        Projectile(**changes)
