"""Solid yarns that are struck: balances, the quarter against the whole, checkpoints."""

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("gmsh")

from fabrics import catalogue
from fabrics.base import run_cache
from fabrics.base.errors import InputError
from shellfabric.loop import checkpoint
from tests.validation.models.solids.solid_patches import SHOT, struck, woven
from validation.models.solids.numerics import SolidNumerics
from validation.models.solids.strike import strike


@pytest.fixture(scope="module")
def mesh():
    return woven()


@pytest.fixture(scope="module")
def run(mesh):
    return struck(mesh, end_time=6e-6).run()


def test_all_energies_are_booked(run):
    error = np.abs(run.sample("error")).max()
    assert error < 2e-4 * run.strike_energy
    for name in ("kinetic_fabric", "fibres", "solids", "hourglass", "friction", "viscous"):
        assert run.sample(name)[-1] > 2 * error, name


def test_the_projectile_is_slowed_by_what_it_is_pushed_with(run):
    """Its loss of momentum is the integral of the force that its samples have."""
    mass = run.projectile.mass
    lost = mass * (run.strike_velocity - run.sample("v")[-1])
    time = run.sample("t")
    force = run.sample("force")
    assert lost == pytest.approx(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(time)), rel=0.2)
    assert run.sample("v")[-1] < 59.5


def test_a_free_patch_keeps_the_momentum(mesh):
    run = struck(mesh, clamped=False, end_time=2e-6).run()
    row = run.row
    momentum = row.mass @ row.v + run.projectile.mass * row.nose_velocity
    assert row.mass @ row.v[:, 2] > 1e-3 * momentum[2]
    assert momentum == pytest.approx([0, 0, run.projectile.mass * 60.0], abs=1e-12)


def test_a_quarter_is_the_whole(mesh):
    """A crossover of an odd patch is struck: planes through the middles of the yarns are planes of symmetry."""
    whole = struck(mesh, end_time=3e-6).run()
    quarter = struck(mesh, quarter=True, end_time=3e-6).run()
    for name in whole.sample_names:
        if name in ("error", "failed_bars", "torn_bricks"):
            continue
        scale = np.abs(whole.sample(name)).max()
        assert quarter.sample(name) == pytest.approx(whole.sample(name), abs=1e-6 * scale), name


def test_waiting_changes_nothing_but_the_cost(mesh):
    patient = struck(mesh, end_time=2e-6).run()
    eager = struck(mesh, end_time=2e-6)
    pace = eager._set_time_step

    def widen(left):
        steps = pace(left)
        eager.row.wait[:] = 0
        eager.row.nose_wait[:] = 0
        return steps

    eager._set_time_step = widen
    eager.run()
    assert eager.row.x == pytest.approx(patient.row.x, abs=1e-10)


def test_a_resumed_run_goes_on_bit_for_bit(mesh, tmp_path):
    pytest.importorskip("h5py")
    whole = struck(mesh, end_time=2e-6).run()
    first = struck(mesh, end_time=1e-6).run()
    checkpoint.write(first, tmp_path / "half.h5")
    second = struck(mesh, end_time=2e-6)
    checkpoint.read(second, tmp_path / "half.h5")
    second.run()
    assert np.array_equal(second.row.x, whole.row.x)
    assert np.array_equal(second.samples, whole.samples)
    for name in whole.row.kept():
        assert np.array_equal(vars(second.row)[name], vars(whole.row)[name]), name


@pytest.mark.parametrize(
    "changes",
    [
        {"velocity": 61.0},
        {"interval": 0.2e-6},
        {"friction": 0.21},
        {"failure": True},
        {"aim": (1e-4, 0.0)},
        {"numerics": SolidNumerics(cfl=0.4)},
        {"numerics": SolidNumerics(hourglass=0.06)},
    ],
    ids=str,
)
def test_what_steps_and_samples_follow_from_tells_one_run_from_another(mesh, changes):
    one, other = (
        run_cache.inputs_digest(struck(mesh, **given).checkpoint_identity()[0])
        for given in ({}, changes)
    )
    assert one != other


def test_fibres_that_fail_are_booked(mesh):
    run = struck(mesh, velocity=250.0, end_time=6e-6, failure=True).run()
    assert run.sample("failed_bars")[-1] > 0
    assert run.sample("failure_dissipation")[-1] > 0
    assert np.abs(run.sample("error")).max() < 5e-3 * run.strike_energy


@pytest.mark.parametrize(
    "crossings, modelled, family, friction", [(4, 1.0, None, 0.2), (3, 0.25, "UHMWPE", 0.12)]
)
def test_a_patch_is_struck_in_one_call(crossings, modelled, family, friction):
    """An even number of yarns has a gap in its middle, an odd one a crossover; friction is of the family."""
    fabric = replace(catalogue.load("S-720"), family=family)
    shot = strike(fabric, 60.0, SHOT, crossings=crossings, size=(2, 2, 1), duration=1e-6)
    assert shot.patch.friction == friction
    assert shot.patch.mesh.share == modelled
    assert shot.t[-1] == pytest.approx(1e-6)
    assert shot.v[-1] < 60 == shot.v[0]
    assert shot.z[-1] == pytest.approx(60e-6, rel=0.01)
    assert shot.energy_error < 1e-4
    assert shot.edge_time > 0
    sums = sum(energy for name, energy in shot.energies.items() if name != "error")
    assert sums - shot.strike_energy == pytest.approx(shot.energies["error"], abs=1e-12)


@pytest.mark.parametrize(
    "choices, words",
    [({"crossings": 2}, "crossings = 2"), ({"duration": 1e-3}, "first microseconds")],
)
def test_a_large_patch_and_a_long_shot_are_refused(choices, words):
    with pytest.raises(InputError, match=words):
        strike("S-720", 60.0, SHOT, **choices)
