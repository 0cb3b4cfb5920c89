"""The march: energy balance, symmetry, the window, checkpoints, guards, failure."""

from dataclasses import replace

import numpy as np
import pytest

from fabrics.errors import InputError, UnstableError
from shellfabric import checkpoint, march_kernels, measures
from shellfabric.hooks import Progress, Snapshots
from shellfabric.impact import ImpactSetup, run
from shellfabric.march import March
from shellfabric.panel import Numerics, Panel

QUICK = {"opening": 0.0508, "table_size": 101, "end_time": 60e-6}


@pytest.fixture(scope="module")
def quick(fabric):
    """Run S-720, 40 x 40 crossovers as a whole, briefly."""

    def make(strike_velocity=150.0, hooks=(), resume=None, **changes):
        return run(ImpactSetup(fabric, strike_velocity, **{**QUICK, **changes}), hooks=hooks, resume=resume)

    return make


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"form": "variational"},
        {"cell_model": "incompressible"},
        {"cell_model": "decoupled"},
        {"elements_per_crossover": 2},
    ],
    ids=lambda changes: next(iter(changes.values()), "default"),
)
def test_energy_balance(quick, changes):
    """Energies found on their own add up to the strike energy, to 0.1 % while nothing fails."""
    result = quick(100.0, **changes)
    assert result.failed[-1] == 0
    assert result.worst_balance < 1e-3
    assert result.energies["kinetic_projectile"][-1] < 0.99 * result.strike_energy
    for name in ("viscous", "hourglass", "contact", "stored"):
        assert result.energies[name][-1] > 0


def test_energy_balance_with_failure(quick):
    result = quick(260.0)
    assert result.failed[-1] > 0
    assert result.energies["failed"][-1] > 0
    assert result.worst_balance < 1e-2


def test_stored_energy_is_the_potential(quick):
    """In the variational form the work summed over the steps is the potential of the stretches at the end."""
    result = quick(100.0, form="variational", table_size=401)
    march = March(result.panel, 100.0, QUICK["end_time"]).run()
    ni, nj = result.panel.counts
    l1, l2 = (L[: ni * (nj + 1)].reshape(ni, nj + 1)[:, :nj] for L in (march.state.L1, march.state.L2))
    W = march.const.cells * result.panel.table.model.solve(l1, l2)["W"].sum() / result.panel.share
    assert result.energies["stored"][-1] == pytest.approx(W, rel=2e-3)


def test_parts_of_the_panel_agree(quick):
    """A quarter, a half and the whole panel are one run."""
    quarter, half, whole = (quick(200.0, symmetry=part) for part in ("quarter", "half", "whole"))
    assert quarter.failed[-1] > 0
    for other in (half, whole):
        np.testing.assert_allclose(other.v, quarter.v, rtol=1e-9)
        np.testing.assert_allclose(other.reactions["warp"], quarter.reactions["warp"], atol=1e-6)
        assert other.failed[-1] == quarter.failed[-1]
        for name in ("stored", "shear", "viscous", "hourglass", "contact"):
            np.testing.assert_allclose(other.energies[name], quarter.energies[name], rtol=1e-6, atol=1e-9)


def test_window_is_exact(small):
    """Working only where motion has come gives the very numbers of working everywhere."""
    panel = small(symmetry="whole")
    states = []
    for everywhere in (False, True):
        state, const = panel.state(100.0), panel.constants()
        if everywhere:
            state.rows[:] = 0, const.ni
        march_kernels.advance(state, const, panel.work(), 9, np.empty((9, 3)))
        states.append(state)
    assert states[0].rows[0] > 0
    for part in ("u", "v"):
        for mine, other in zip(getattr(states[0], part), getattr(states[1], part)):
            np.testing.assert_array_equal(mine, other)


def test_block_size_does_not_matter(quick):
    one, other = (quick(numerics=Numerics(block=block)) for block in (100, 5000))
    np.testing.assert_allclose(one.v, other.v, rtol=1e-12)


def test_resumed_run_is_the_same_bit_for_bit(quick, tmp_path):
    path = tmp_path / "run.h5"
    whole = quick(260.0, snapshot_interval=10e-6)

    class Interrupted(Exception):
        pass

    class Saver(checkpoint.Checkpoints):
        def __call__(self, march):
            super().__call__(march)
            if march.time > 20e-6:
                raise Interrupted

    with pytest.raises(Interrupted):
        quick(260.0, hooks=[Saver(path, 8e-6)], snapshot_interval=10e-6)
    resumed = quick(260.0, resume=path, snapshot_interval=10e-6)
    assert resumed.steps == whole.steps
    assert resumed.failed[-1] > 0
    for name in ("t", "v", "z", "failed", "fine", "nodes", "tension", "broken"):
        np.testing.assert_array_equal(getattr(resumed, name), getattr(whole, name), err_msg=name)
    for name, values in whole.energies.items():
        np.testing.assert_array_equal(resumed.energies[name], values, err_msg=name)
    assert [shot.t for shot in resumed.snapshots] == [shot.t for shot in whole.snapshots]
    np.testing.assert_array_equal(resumed.snapshots[0].nodes, whole.snapshots[0].nodes)


def test_wrong_checkpoints(quick, tmp_path):
    path = tmp_path / "run.h5"
    quick(100.0, hooks=[checkpoint.Checkpoints(path, 30e-6)])
    with pytest.raises(InputError, match="another run"):
        quick(101.0, resume=path)
    with pytest.raises(InputError, match="readable checkpoint"):
        quick(100.0, resume=tmp_path / "none.h5")
    broken = tmp_path / "broken.h5"
    broken.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(InputError, match="readable checkpoint"):
        quick(100.0, resume=broken)


def test_unstable_run_stops_itself(quick):
    """A contact stiffer than its bound is found out, and what was computed is kept."""
    with pytest.raises(UnstableError, match="node") as caught:
        quick(100.0, numerics=Numerics(penalty=60.0, contact_damping=0.0))
    result = caught.value.result
    assert result.outcome == "unstable"
    assert len(result.t) >= 2
    assert caught.value.when
    assert caught.value.where


def test_hooks(quick):
    seen = []
    result = quick(100.0, hooks=[Progress(lambda share, v: seen.append((share, v)))], snapshot_interval=20e-6)
    assert seen[-1][0] == 1.0
    assert seen == sorted(seen, key=lambda entry: entry[0])
    assert [round(shot.t * 1e6, -1) for shot in result.snapshots] == [20, 40, 60]
    assert Snapshots(1e-6).interval == 1e-6


def test_failure_takes_one_yarn_then_the_element(small, fabric):
    """Past its strength a yarn goes, its crossing yarn is left alone (E-14), and with that the element erodes."""
    panel = small(edge="free", symmetry="whole")
    state, const, work = panel.state(1.0), panel.constants(), panel.work()
    weave, (ni, nj) = fabric.weave, panel.counts
    X, Y = panel.coordinates()

    def pull(stretch1, stretch2):
        state.u[0][: X.size], state.u[1][: X.size] = ((stretch1 - 1) * X).ravel(), ((stretch2 - 1) * Y).ravel()
        march_kernels.first_forces(state, const, work)
        return state.flag[: ni * (nj + 1)].reshape(ni, nj + 1)[:, :nj]

    stored = []
    for stretch in np.linspace(1.0, 1.06, 400):
        flag = pull(stretch, 1.03)
        if flag.any():
            break
        stored.append(state.W.sum())
    assert np.all(flag == 1)
    after = weave.weft.EA * (2.06 * weave.w2 - weave.S02) / weave.S02
    shot = measures.snapshot(panel, state, 0.0)
    np.testing.assert_allclose(shot.tension[..., 1], after, rtol=1e-9)
    assert np.all(shot.tension[..., 0] == 0)
    # what was stored is either still there or lost
    lost = state.sums[:, march_kernels.LOST].sum()
    cells = panel.elements * const.cells
    assert state.W.sum() == pytest.approx(cells * after**2 * weave.S02 / (2 * weave.weft.EA), rel=1e-9)
    assert lost + state.W.sum() == pytest.approx(stored[-1], rel=0.02)
    flag = pull(stretch, 1.06)
    assert np.all(flag == 7)
    assert state.W.sum() == 0.0
    assert all(np.all(g == 0.0) for g in (*state.g0, *state.g1))


def test_stopping_and_the_end_of_time(quick):
    slow = quick(8.0, end_time=800e-6)
    assert slow.outcome == "stopped"
    assert slow.v[-1] <= 0.01
    assert quick(100.0).outcome == "in flight"


def test_measures(quick):
    result = quick(100.0, snapshot_interval=30e-6)
    shot = result.snapshots[-1]
    (x, z), (_, other) = measures.deflection_profile(result.panel, shot)
    assert z.max() == pytest.approx(result.z[-1], abs=0.5e-3)
    assert x[0] == 0.0
    assert z[-1] == other[-1] == 0.0
    reach = measures.pyramid(result.panel, shot)
    assert 0.003 < reach[0] < 0.0254
    assert result.nodes.shape[0] == (result.quads.max() + 1)
    assert result.tension.shape == (result.panel.elements, 2)
    assert 0 < result.tension.max() <= result.peak_tension[0] + result.peak_tension[1]


@pytest.mark.parametrize(
    "bad",
    [
        {"strike_velocity": -1.0},
        {"end_time": 0.0},
        {"symmetry": "third"},
        {"edge": "glued"},
        {"opening": 1e-3},
        {"elements_per_crossover": 0},
        {"cell_model": "soft"},
        {"table_size": 2},
        {"audit_interval": 0.0},
        {"snapshot_interval": 0.0},
    ],
    ids=lambda bad: next(iter(bad)),
)
def test_bad_setups(fabric, bad):
    with pytest.raises(InputError):
        run(ImpactSetup(**{"fabric": fabric, "strike_velocity": 100.0, **QUICK, **bad}))
    with pytest.raises(InputError):
        Numerics(safety=2.0)


def test_meshed_size_follows_the_source(tables, fabric):
    """The source meshed whole crossovers only: 79 along half of 203 mm (erratum E-34)."""
    assert Panel(tables["equilibrium"]).counts == (79, 79)
    assert replace(Panel(tables["equilibrium"]), elements_per_crossover=2).counts == (158, 158)
