"""The block behind a panel: momentum of all three, steps of its face, and the run that goes on after the stop."""

from dataclasses import replace

import numba
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from panels import BLOCK, COARSER

from fabrics.base.errors import InputError, UnstableError
from fabrics.materials import Isotropic, load
from shellfabric.block import contact_kernels
from shellfabric.block.block import Backing
from shellfabric.block.coupling import BackingCoupling, radius_at, result_of, wall_angle
from shellfabric.impact.result import collect_result
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import UNFAILING, ImpactSetup
from shellfabric.loop import checkpoint
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.numerics import Numerics
from shellfabric.plies.model import at_angle
from shellfabric.projectile.projectile import Projectile
from weavecell.studies import ballistic_limit

BACKING = load("backing")
ELASTIC = Isotropic(BACKING.density, BACKING.modulus, BACKING.poisson)
QUICK = {"opening": 0.0508, "table_size": 61, "end_time": 40e-6, "backing": BLOCK}


@pytest.mark.parametrize("faces", ["free", "fixed", "absorbing"])
def test_momentum_of_all_three_is_kept(fabric, faces):
    """Free fabric before a block: what the projectile loses they have, and the outer faces of the block."""
    thin = (0.06, 0.06, 9e-3)  # its far face is reached within 20 us
    setup = ImpactSetup(
        fabric,
        100.0,
        **QUICK | {"backing": replace(BLOCK, outer_boundary=faces, size=thin), "boundary": "free"},
        grading=COARSER,
    )
    march = PackSolver(setup.panel(), 100.0, 20e-6)
    start = march.const.projectile_mass * 100.0
    march.run()
    state = march.state
    const = march.const
    block = march.part("block").block
    # the block is a step ahead: what it was given last still waits in state.f_block_cloth and state.f_block_nose
    waiting = sum(b.sum() for b in state.f_block_cloth[2:]) + state.f_block_nose[2]
    fabric = float(state.mass @ state.v[2]) + const.projectile_mass * state.projectile_velocity[2]
    found = fabric + const.dt * waiting + block.momentum
    moving = float(block.mass @ block.v[:, 2])
    assert moving > 0.02 * start
    assert found == pytest.approx(start, rel=1e-9)
    taken = block.momentum - moving
    if faces == "free":
        assert taken == pytest.approx(0.0, abs=1e-12 * start)
    else:
        assert abs(taken) > 1e-4 * start
    assert numba.threading_layer() == "omp"  # others can hang as the process ends


def test_forces_on_points_are_given_to_nodes_by_their_weights(fabric):
    setup = ImpactSetup(fabric, 100.0, **QUICK)
    panel = setup.panel()
    const = panel.constants()
    state = panel.state(100.0)
    behind = BackingCoupling(BLOCK, panel, const)
    random = np.random.default_rng(0)
    forces = random.normal(size=(const.ni, const.nj, 4, 3))
    forces[0] = forces[:, 0] = 0.0  # nothing is taken out on the planes of symmetry
    behind._spread(forces.reshape(-1, 3), state)
    nodal = np.array([behind._nodal(b) for b in state.f_block_cloth])
    assert nodal.sum(axis=(1, 2)) == pytest.approx(forces.sum(axis=(0, 1, 2)), rel=1e-9)
    places = np.empty((const.ni * const.nj * 4, 3))
    contact_kernels.at_points(state.u, behind._rest, behind._weights, const.nj, places)
    for c, at in enumerate(behind._rest[:2]):
        moment = (forces[..., 2].ravel() * places[:, c]).sum()
        assert (nodal[2].ravel() * at).sum() == pytest.approx(moment, rel=1e-9)
    assert (state.first_row, state.end_row) == (0, const.ni)


def test_a_step_of_the_face_throws_no_point_out():
    """A point that comes over a higher column is inside it at once by the step, which pushes it by nothing; going
    further in by motion it is pushed by that, and after it has come out the step is forgotten."""
    block = replace(BLOCK, material=ELASTIC).block(1e-7)
    block.gone.reshape(block.shape)[:2, :, 0] = (
        True  # the two columns nearest the axis are a brick lower
    )

    def push(x, z, v=0.0):
        places = np.array([[x, 1e-3, z]])
        velocities = np.array([[0, 0, v]])
        return block.press(places, velocities, np.ones(1))[0, 2]

    assert push(5.9e-3, 2e-3) == 0.0  # above the lower column
    assert push(6.1e-3, 2e-3) == 0.0  # 2 mm inside the higher one
    assert push(6.1e-3, 2.01e-3, 100.0) == pytest.approx(-1e-5, rel=1e-6)
    assert push(6.1e-3, 2.0e-3, -100.0) == pytest.approx(0.0, abs=1e-12)
    push(6.1e-3, -1e-5, -2e4)
    assert push(6.1e-3, 1e-5, 200.0) == pytest.approx(-1e-5, rel=1e-6)
    # the face drops away under a point that bears on it: what its spring held is lost, and told
    before = block.energies()["damped"]
    block.gone.reshape(block.shape)[2, :, 0] = True
    assert push(6.1e-3, 1e-5) == 0.0
    assert block.energies()["damped"] - before == pytest.approx(0.5e-10, rel=1e-6)


def test_shots_without_failure_have_a_table_that_goes_far(fabric):
    """Forces beyond a table follow its last cell; yarns that do not fail are stretched far beyond their strength."""
    setup = ImpactSetup(fabric, 100.0, yarn_failure=False, table_size=61)
    reached = setup.table().stretch1[-1]
    assert reached > 1 + UNFAILING * fabric.weave.warp.failure_strain
    assert replace(setup, yarn_failure=True).table().stretch1[-1] < 1.06
    assert not setup.panel().yarn_failure


def test_a_run_goes_on_after_the_stop_and_resumes(fabric, tmp_path):
    """The run goes on for `after_stop`. What came before the stop is the same; a limit needs no more."""
    light = Projectile(mass=0.02e-3, radius=3e-3)
    given = QUICK | {"end_time": 200e-6, "grading": COARSER}
    short = ImpactSetup(fabric, 60.0, projectile=light, **given)
    long = replace(short, backing=replace(BLOCK, after_stop=30e-6))
    stopped = run_impact(short)
    path = tmp_path / "checkpoint.h5"
    rested = run_impact(long, hooks=(checkpoint.Checkpoints(path, stopped.time[-1] + 10e-6),))
    assert stopped.outcome == "stopped"
    assert rested.outcome == "stopped"
    assert rested.residual_velocity == 0
    assert rested.time[-1] == pytest.approx(stopped.time[-1] + 30e-6, abs=2.1e-6)
    assert_array_equal(rested.step_history[: len(stopped.step_history)], stopped.step_history)
    assert rested.energies["backing_kinetic"][-1] < stopped.energies["backing_kinetic"][-1]
    assert rested.energy_error_max < 5e-3
    march = PackSolver(long.target(), 60.0, long.end_time)
    checkpoint.read(march, path)
    assert march.time > stopped.time[-1]
    assert_array_equal(collect_result(long, march.run()).step_history, rested.step_history)
    cut = run_impact(replace(long, end_time=stopped.time[-1] + 10e-6))
    assert cut.outcome == "stopped"
    assert ballistic_limit.shoot(long.target(), [60.0])[0].time == pytest.approx(
        stopped.time[-1], abs=2.1e-6
    )


def test_a_block_that_breaks_down_ends_a_run_of_two_threads(fabric, monkeypatch):
    first = []

    def step(self, state):
        if first:
            raise UnstableError("a brick is turned inside out", where="here", when="now")
        first.append(state)  # as the run is laid out

    monkeypatch.setattr(BackingCoupling, "step", step)
    pack = ImpactSetup(fabric, 100.0, **QUICK, plies=2, numerics=Numerics(threads=2))
    march = PackSolver(pack.target(), 100.0, QUICK["end_time"])
    assert march.threads == 2
    with pytest.raises(UnstableError, match="inside out"):
        march.run()


def test_one_thread_moves_the_block_where_the_panel_has_one(fabric, monkeypatch):
    """Its kernels are told to use one of the eight threads of numba, which has all of them back afterwards."""
    asked = []
    monkeypatch.setattr(numba, "get_num_threads", lambda: 8)
    monkeypatch.setattr(numba, "set_num_threads", asked.append)
    setup = ImpactSetup(fabric, 100.0, **QUICK, numerics=Numerics(threads=1))
    PackSolver(setup.target(), 100.0, 20e-6)
    assert asked == [1, 8]


def test_measures_of_a_crater():
    radius = np.linspace(0, 0.02, 41)
    cone = np.stack([radius, np.maximum(0.01 - 2 * radius, 0)], axis=1)
    assert radius_at(cone, 0.5) == pytest.approx(2.5e-3)
    assert wall_angle(cone) == pytest.approx(np.arctan(2))


@pytest.mark.parametrize("mirrors", [(True, True), (False, True), (False, False)])
def test_a_crater_along_each_yarn_is_the_line_of_the_face_along_it(mirrors):
    """Of a block whose sides differ, pressed in by unlike amounts along x and y."""
    size = (0.08, 0.06, 0.03)
    backing = Backing(
        BACKING, size=size, min_size=5e-3, refined_depth=10e-3, growth=1.0, mirrors=mirrors
    )
    block = backing.block(1e-8)
    x, y, _ = block.rest.T
    top = block.nodes[:, :, 0]
    block.x[top, 2] += 5e-3 * np.exp(-((x[top] / 0.02) ** 2) - (y[top] / 0.01) ** 2)
    found = result_of(block)
    for line, half, scale in ((found.crater, 0.04, 0.02), (found.crater_weft, 0.03, 0.01)):
        assert line[-1, 0] == pytest.approx(half)
        assert line[:, 1] == pytest.approx(5e-3 * np.exp(-((line[:, 0] / scale) ** 2)), abs=1e-6)
    # measures of the dent are means along both
    radii = [radius_at(line, 0.5) for line in (found.crater, found.crater_weft)]
    angles = [wall_angle(line) for line in (found.crater, found.crater_weft)]
    assert radii[0] > 1.3 * radii[1]
    assert angles[1] > 1.3 * angles[0]
    assert found.half_width == pytest.approx(np.mean(radii))
    assert found.steepness == pytest.approx(np.mean(angles))


@pytest.mark.parametrize("share", [0.0, 1.0, float("nan")])
def test_a_share_of_packed_fabric_that_is_none_is_refused(fabric, share):
    with pytest.raises(InputError, match="packed_area"):
        ImpactSetup(fabric, 100.0, **QUICK | {"packed_area": share}).panel()


def test_a_whole_block_is_four_quarters(fabric):
    """In all that is read off it."""
    given = QUICK | {"end_time": 12e-6, "grading": COARSER}
    one, other = (
        run_impact(ImpactSetup(fabric, 100.0, symmetry=part, **given)).backing
        for part in ("whole", "quarter")
    )
    assert one.depth > 1e-4
    assert one.share == 1.0
    assert other.share == 0.25
    for name in ("crater", "crater_weft"):
        assert_allclose(getattr(one, name), getattr(other, name), atol=1e-12)
    assert one.volume == pytest.approx(other.volume, rel=1e-9)
    assert one.depth_map[::-1, ::-1] * [-1, -1, 1] == pytest.approx(one.depth_map, abs=1e-12)


def test_a_block_behind_a_turned_ply_lies_along_the_opening(fabric):
    """A force at one of its nodes, seen from the ply, and back: momentum along all axes is kept, at any angle."""
    setup = ImpactSetup(fabric, 100.0, **QUICK | {"symmetry": "whole"}, elements_per_crossover=1)
    panel = at_angle(setup.panel(setup.plain_table()), 0.5)
    const = panel.constants()
    state = panel.state(100.0)
    behind = BackingCoupling(replace(BLOCK, outer_boundary="free"), panel, const)
    n = panel.areas.size
    state.u[2][:n] = (0.2e-3 * np.exp(-(np.hypot(*panel.coordinates()) ** 2) / 1e-5)).ravel()
    behind.block.x[:, 2] += 0.02 * behind.block.x[:, 0]  # a face that leans along the opening
    behind.step(state)
    pushed = -np.array([force.sum() for force in state.f_block_cloth])
    # from rest, the first kick is half a step's
    got = behind.block.mass @ behind.block.v / (0.5 * const.dt)
    assert abs(got[0]) > 0.01 * abs(got[2]) > 0.01
    assert np.append(panel.axes @ got[:2], got[2]) == pytest.approx(pushed, rel=1e-6)
    assert not np.any(behind._stiffness[~np.repeat(panel.movable(), behind.p**2)])
