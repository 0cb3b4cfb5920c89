"""The panel with sliding crossovers: the pinned panel in the limit, stability, energy, forces as gradients."""

from dataclasses import fields

import numpy as np
import pytest

from fabrics.base.errors import InputError
from shellfabric.cell.model import CellModel
from shellfabric.cloth.membrane_kernels import ERODED, WINDOW
from shellfabric.panel.boundary import PullIn
from shellfabric.panel.model import Panel
from shellfabric.panel.numerics import Numerics
from shellfabric.projectile.projectile import Projectile
from shellfabric.sliding import flow_kernels, slip_kernels
from shellfabric.sliding.model import CrossoverFriction, SlidingPanel, grid
from shellfabric.solver import ply_kernels
from shellfabric.solver.pack_solver import SLIP_WORK, PackSolver

ONE = Numerics(threads=1)


def pinned(panel):
    return Panel(**{each.name: getattr(panel, each.name) for each in fields(Panel)})


@pytest.mark.parametrize(
    "cohesion, cfl", [(0.05, 0.9), (0.5, 0.9), (0.5, 0.45), (5.0, 0.9), (1000.0, 0.9)]
)
def test_every_threshold_is_stable_and_keeps_the_energy(sliding, cohesion, cfl):
    panel = sliding(0.0, cohesion, numerics=Numerics(cfl=cfl, threads=1))
    run = PackSolver(panel, 80.0, 60e-6).run()
    assert np.abs(run.sample("error")).max() < 0.005 * run.strike_energy
    assert np.all(np.diff(run.sample("crossover_friction")) > -1e-6 * run.strike_energy)
    assert all(grid(share, panel).min() > 0.2 for share in run.slips[0].share)


def test_yarn_is_neither_made_nor_lost(sliding):
    run = PackSolver(sliding(0.1, yarn_failure=False), 80.0, 60e-6).run()
    warp, weft = (grid(share, run.panel) for share in run.slips[0].share)
    assert warp[:-1].sum(axis=0) == pytest.approx(
        np.full(warp.shape[1], warp.shape[0] - 1), rel=1e-12
    )
    assert weft[:, :-1].sum(axis=1) == pytest.approx(
        np.full(weft.shape[0], weft.shape[1] - 1), rel=1e-12
    )
    assert run.slip_summaries()[0].pulled_out_length > 1e-6
    assert run.slip_summaries()[0].friction_work > 0


def test_forces_are_the_derivatives_of_one_energy(sliding):
    """Of positions and of the shares of yarn alike."""
    panel = sliding(
        0.0, symmetry="whole", trellis=False, numerics=Numerics(threads=1, stretch_viscosity=0.0)
    )
    random = np.random.default_rng(3)
    run = PackSolver(panel, 10.0, 1e-6)
    state = run.state
    slip = run.slips[0]
    const = run.const
    x, y = (grid(u, panel) for u in state.u[:2])
    X, Y = panel.coordinates()
    x += 0.03 * X + 2e-6 * random.standard_normal(X.shape)
    y += 0.03 * Y + 2e-6 * random.standard_normal(X.shape)
    for share, inverse in zip(slip.share, slip.inv_share):
        grid(share, panel)[:] = 1 + 0.01 * random.standard_normal(X.shape)
        inverse[:] = 1 / share
    slip.share[1][const.nj :: const.row_stride] = slip.inv_share[1][
        const.nj :: const.row_stride
    ] = 1.0

    def energy():
        forces(run)
        out = np.empty(5)
        ply_kernels.energies(state, const, (slip, run.effective[0]), out)
        return out[1]

    energy()
    node = 12 * const.row_stride + 10
    found = [state.f_int[c][node] + state.f_int_above[c][node] for c in (0, 1)]
    for c in (0, 1):
        assert found[c] == pytest.approx(-slope(energy, state.u[c], node, 1e-9), rel=0.02, abs=0.05)
    for family, side in ((0, const.dx), (1, const.dy)):
        forces(run)
        config = slip.config[family][node]
        assert config * side == pytest.approx(
            -slope(energy, slip.share[family], node, 1e-6, slip.inv_share[family]), rel=0.02
        )


def forces(run):
    (_, _, _, work_x), works = run._works[0]
    slide = run.slips[0], run.effective[0], work_x.values[0]
    ply_kernels.initial_forces(run.state, run.const, slide, works.values[0])


def slope(energy, array, k, step, inverse=None):
    inverse = np.empty_like(array) if inverse is None else inverse
    start = array[k]
    found = []
    for place in (start + step, start - step, start):
        array[k] = place
        inverse[k] = 1 / (place or 1.0)
        found.append(energy())
    return (found[0] - found[1]) / (2 * step)


def test_the_iteration_and_the_bounds_of_a_flux_are_counted_apart_from_friction(sliding):
    run = PackSolver(sliding(0.0), 60.0, 60e-6).run()
    found = {name: run.sample(name) / run.strike_energy for name in SLIP_WORK}
    assert np.all(found["crossover_friction"] == 0.0)  # no threshold, no friction
    assert 0 < np.abs(found["slip_residual"]).max() < 1e-4
    slip = run.slips[0]
    node = (
        int(np.argmax(slip.mobility[0] > 0)) + 8 * run.const.row_stride
    )  # a node with a segment that gives no more
    slip.share[0][node - run.const.row_stride] = 0.5 * slip.least
    slip.q[0][node] = -1.0
    slip.q_before[0][node] = -1.0
    slip.stop[0][node] = 0.0
    slip.share[0][node] = 0.5 * slip.least
    before = slip.work.copy()
    slip_kernels.slip_nodes(run.state, run.const, slip)
    assert slip.q[0][node] == 0.0
    assert slip.work[1] > before[1]
    assert slip.work[0] == before[0]


def test_a_uniform_strain_moves_no_yarn(sliding):
    """Patch test: stretched and sheared evenly, the panel drives no flux but at its rim, at any threshold."""
    run = PackSolver(sliding(0.2, symmetry="whole", trellis=False), 10.0, 1e-6)
    X, Y = run.panel.coordinates()
    grid(run.state.u[0], run.panel)[:] = 0.02 * X + 0.01 * Y
    grid(run.state.u[1], run.panel)[:] = 0.015 * Y - 0.003 * X
    forces(run)
    for config, axis in zip(run.slips[0].config, (0, 1)):
        inner = grid(config, run.panel)[2:-3, 2:-3]
        assert inner.min() > 1.0
        assert np.abs(np.diff(inner, axis=axis)).max() < 1e-9 * inner.max()
    run.state.active_rows[:] = 0, run.const.ni
    slip_kernels.slip_nodes(run.state, run.const, run.slips[0])
    for q in run.slips[0].q:
        assert np.all(grid(q, run.panel)[3:-3, 3:-3] == 0.0)
    assert np.all(run.slips[0].work == 0.0)


@pytest.mark.parametrize(
    "mu, cohesion, alone, pressed, slips",
    [
        (0.0, 0.5, False, 0.0, True),
        (0.0, 1.0, False, 0.0, False),
        (0.0, 1.0, True, 0.0, True),  # nothing holds a yarn that is alone at a node
        (0.2, 0.1, False, 10.0, False),  # 0.2 of the projectile's 10 N on the crossover
    ],
)
def test_a_yarn_slips_above_its_threshold(sliding, mu, cohesion, alone, pressed, slips):
    """0.6 N on the weft at one node."""
    panel = sliding(mu, cohesion, symmetry="whole")
    const = panel.constants()
    state = panel.state(10.0)
    slip = panel.slip(state)
    node = 5 * const.row_stride + 5
    state.active_rows[:] = 0, const.ni
    if alone:
        state.intact_fraction[0][[node, node - const.row_stride]] = 0.0
    slip.config[1][node] = 0.6
    state.f_contact[2][node] = pressed
    slip_kernels.slip_nodes(state, const, slip)
    held = 0.0 if alone else cohesion
    speed = (0.6 - held) * const.dt * slip.mobility[1][node]
    assert slip.q[1][node] == pytest.approx(speed if slips else 0.0, rel=1e-9)


@pytest.mark.parametrize("cohesion, share", [(1e6, 0.5), (0.0, 1.0)])
def test_waves_travel_at_c_in_a_free_yarn_and_at_c_over_root_2_in_a_stuck_one(
    straight, cohesion, share
):
    """The crossing yarns, as heavy, move with a stuck yarn."""
    table = CellModel(straight(1.0), cell_model="decoupled").table(41)
    panel = SlidingPanel(
        table,
        (0.2, 0.02),
        Projectile(radius=1e-3, edge_radius=1e-4),
        "whole",
        1,
        numerics=ONE,
        trellis=False,
        friction=CrossoverFriction(0.0, cohesion),
    )
    run = PackSolver(panel, 1.0, 8e-6, energy_error_limit=np.inf)
    middle = run.const.ni // 2
    yarn = panel.weave.warp
    grid(run.state.v[0], panel)[
        1:middle
    ] = -0.1  # half of the panel is torn away: a front of strain in both halves
    run.state.active_rows[:] = 0, run.const.ni
    run.state.contact_window[:] = 0
    run.run()
    strain = grid(run.slips[0].x[0], panel)[:, run.const.nj // 2] - 1
    plateau = strain[middle + 10 : middle + 20].mean()
    reach = (np.flatnonzero(strain[:-10] > 0.5 * plateau)[-1] + 0.5 - middle) * panel.spacing[0]
    speed = (share * yarn.EA / yarn.linear_density) ** 0.5
    assert plateau > 0
    assert reach == pytest.approx(speed * run.time, rel=0.04)


def test_a_smaller_time_step_changes_a_shot_little(sliding):
    found = []
    for cfl in (0.9, 0.45, 0.225):
        run = PackSolver(sliding(0.2, numerics=Numerics(threads=1, cfl=cfl)), 80.0, 40e-6).run()
        found.append(
            [
                np.interp(38e-6, run.sample("t"), run.sample(name))
                for name in ("v", "crossover_friction")
            ]
        )
    coarse, fine = (np.abs(np.array(one) / found[2] - 1) for one in found[:2])
    assert np.all(fine < 0.6 * coarse)
    assert np.all(coarse < [3e-3, 0.15])


def test_the_time_step_is_that_of_the_free_yarn(sliding):
    panel = sliding(0.2, numerics=Numerics(threads=1, stretch_viscosity=0.0))
    assert panel.time_step / pinned(panel).time_step == pytest.approx(min(panel.own_masses) ** 0.5)
    # sides of the one are those of the weave, of the other the opening over their number
    assert sliding(np.inf).time_step == pytest.approx(pinned(sliding(np.inf)).time_step, rel=1e-14)


def test_a_window_that_the_projectile_fits_through_is_out_of_contact(sliding):
    """Yarns of a loose panel are drawn past a slender projectile, which none of them stops."""
    run = PackSolver(sliding(0.0), 50.0, 1e-6)
    width = 2 * run.const.projectile_radius
    for stretch, side in zip(run.state.stretch, (run.const.dx, run.const.dy)):
        stretch[:] = 1.01 * width / side
    run.state.stretch[0][0] = 1.0
    flow_kernels.open_windows(run.state, run.const, run.slips[0])
    i0, i1, j0, j1 = run.state.contact_window
    flags = grid(run.state.element_flag, run.panel)[i0:i1, j0:j1]
    assert flags[0, 0] == WINDOW  # one of its yarns is where it was
    assert np.all(flags.ravel()[1:] & ERODED)


@pytest.mark.parametrize(
    "key, value",
    [
        ("elements_per_crossover", 2),
        ("grading", ((8, 1), (np.inf, 2))),
        ("bending", (1e-8, 1e-8)),
        ("boundary", PullIn(1e-3, 0.0, 1e-4)),
        ("impact_point", (15e-3, 0.0)),
        ("cell_formulation", None),
        ("mu", -0.1),
        ("cohesion", -1.0),
    ],
)
def test_what_is_not_supported_is_refused(sliding, tables, key, value):
    changes = {"table": tables["equilibrium"]} if key == "cell_formulation" else {key: value}
    with pytest.raises(InputError, match={"mu": "crossover_friction"}.get(key, key)):
        sliding(projectile=Projectile(radius=1e-3), symmetry="whole", **changes)
