"""Bending of yarns: closed forms of beams and of circles, the time step, what a run tells of it and what fails."""

from dataclasses import replace

import numpy as np
import pytest
from conftest_tools import advance, solver_at_rest
from panels import FINER, make_panel, rest, set_nodal

from shellfabric.cell.model import CellModel
from shellfabric.cloth import bending_kernels
from shellfabric.panel.model import Numerics, Panel

EI = 2e-6


def turns(panel, x):
    """Energy [J] of the turns of yarns with the nodes at x, and the forces (3, nodes) [N] of that."""
    state, const = panel.state(1.0), panel.constants()
    set_nodal(state.u, x - rest(panel))
    return bending_kernels.bending_forces(const.bending, state, const, 0, const.ni, True), np.array(state.f_int)


@pytest.mark.parametrize("axis", [0, 1])
def test_clamped_yarn_under_a_point_load(axis):
    """F L^3 / 192 EI in the middle of a yarn clamped at both ends, and 8 / n^2 more with n segments."""
    bending = tuple(EI * (family == axis) for family in (0, 1))
    panel = make_panel(symmetry="whole", bending=bending, failure=False)
    n, d, middle, stiffness = panel.counts[axis], panel.spacing[axis], panel.counts[1 - axis] // 2, []
    for k in range(1, n):
        x = rest(panel)
        np.moveaxis(x, axis, 0)[k, middle, 2] = 1e-7
        force = turns(panel, x)[1][2][: x[..., 2].size].reshape(x.shape[:2])
        stiffness.append(-np.moveaxis(force, axis, 0)[1:n, middle] / 1e-7)
    w = np.linalg.solve(stiffness, np.eye(n - 1)[n // 2 - 1])[n // 2 - 1]
    assert w == pytest.approx((1 + 8 / n**2) * (n * d) ** 3 / (192 * panel.yarns_a_line[axis] * EI), rel=5e-3)


@pytest.mark.parametrize("grading", [None, FINER])
def test_pure_bending_is_a_circle(grading):
    """Yarns whose nodes lie on a circle store 1/2 EI kappa^2 a length, to the chords' error, in all zones alike."""
    panel = make_panel(0.06, symmetry="whole", edge="free", bending=(EI, 0.0), failure=False, grading=grading)
    X, Y = panel.coordinates()
    sides, radius = panel.sides or tuple(map(np.full, panel.counts, panel.spacing)), 0.05
    x = np.stack([radius * np.sin(X / radius), Y, radius * (1 - np.cos(X / radius))], axis=-1)
    length = (sides[0].sum() - 0.5 * sides[0][[0, -1]].sum()) * panel.weave.warp_count * sides[1].sum()
    assert turns(panel, x)[0] == pytest.approx(0.5 * EI / radius**2 * length, rel=2e-3)


@pytest.mark.parametrize(("factor", "holds"), [(1.0, True), (1.6, False)])
def test_the_time_step_knows_of_bending(straight, monkeypatch, factor, holds):
    """Yarns a thousand times as stiff as solid ones do not blow up."""
    table, numerics = CellModel(straight(1.0), model="decoupled").table(51), Numerics(cfl=0.99, stretch_viscosity=0.0)
    panel = make_panel(table=table, edge="free", failure=False, symmetry="whole", numerics=numerics, bending=(0.1, 0.1))
    assert panel.critical_step < 0.5 * replace(panel, bending=(0.0, 0.0)).critical_step
    monkeypatch.setattr(Panel, "time_step", factor * panel.time_step)
    solver = solver_at_rest(panel, 1.0)
    state, nodes = solver.state, rest(panel)[..., 0].size
    state.projectile_position[2] = -1.0
    state.v[2][:nodes] = np.random.default_rng(0).normal(scale=1e-6, size=nodes)
    state.active_rows[:] = 0, solver.const.ni
    advance(solver, 300)
    assert (np.nanmax(np.abs(state.v[2])) < 1e-4) == holds
