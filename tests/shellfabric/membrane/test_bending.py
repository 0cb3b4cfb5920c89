"""Bending of yarns: closed forms of beams and of circles."""

import numpy as np
import pytest
from panels import FINER, make_panel, rest, set_nodal

from shellfabric.membrane import bending_kernels, forces

EI = 2e-6


def turns(panel, x):
    """Energy [J] of the turns of yarns with the nodes at x, and the forces (3, nodes) [N] of that."""
    state = panel.state(1.0)
    const = panel.constants()
    set_nodal(state.u, x - rest(panel))
    return bending_kernels.bending_forces(state, const, state.parts, 0, const.ni, True), np.array(
        state.f_int
    )


@pytest.mark.parametrize("axis", [0, 1])
def test_clamped_yarn_under_a_point_load(axis):
    """F L^3 / 192 EI in the middle of a yarn clamped at both ends, and 8 / n^2 more with n segments."""
    bending = tuple(EI * (family == axis) for family in (0, 1))
    panel = make_panel(symmetry="whole", bending=bending, yarn_failure=False)
    n = panel.counts[axis]
    d = panel.spacing[axis]
    middle = panel.counts[1 - axis] // 2
    stiffness = []
    for k in range(1, n):
        x = rest(panel)
        np.moveaxis(x, axis, 0)[k, middle, 2] = 1e-7
        force = turns(panel, x)[1][2][: x[..., 2].size].reshape(x.shape[:2])
        stiffness.append(-np.moveaxis(force, axis, 0)[1:n, middle] / 1e-7)
    w = np.linalg.solve(stiffness, np.eye(n - 1)[n // 2 - 1])[n // 2 - 1]
    assert w == pytest.approx(
        (1 + 8 / n**2) * (n * d) ** 3 / (192 * panel.yarns_a_line[axis] * EI), rel=5e-3
    )


@pytest.mark.parametrize("grading", [None, FINER])
def test_pure_bending_is_a_circle(grading):
    """Yarns whose nodes lie on a circle store 1/2 EI kappa^2 a length, to the chords' error, in all zones alike."""
    panel = make_panel(
        0.06,
        symmetry="whole",
        boundary="free",
        bending=(EI, 0.0),
        yarn_failure=False,
        grading=grading,
    )
    X, Y = panel.coordinates()
    sides = panel.sides or tuple(map(np.full, panel.counts, panel.spacing))
    radius = 0.05
    x = np.stack([radius * np.sin(X / radius), Y, radius * (1 - np.cos(X / radius))], axis=-1)
    length = (
        (sides[0].sum() - 0.5 * sides[0][[0, -1]].sum()) * panel.weave.warp_count * sides[1].sum()
    )
    assert turns(panel, x)[0] == pytest.approx(0.5 * EI / radius**2 * length, rel=2e-3)


def test_the_bound_of_the_time_step_holds_the_stiffest_mode():
    """Neighbours that swing to and fro across the panel: by their forces, a little below the bound for the rim."""
    panel = make_panel(symmetry="whole", bending=(EI, 2 * EI), yarn_failure=False)
    x = rest(panel)
    i, j = np.indices(x.shape[:2])
    swing = 1e-8 * (-1.0) ** (i + j)
    swing[[0, -1]] = 0.0
    swing[:, [0, -1]] = 0.0
    x[..., 2] = swing
    force = turns(panel, x)[1][2][: swing.size].reshape(swing.shape)
    mass = panel.weave.areal_density * np.prod(panel.spacing)
    square = -(force * swing).sum() / (mass * (swing**2).sum())
    bound = forces.Bending(panel).stiffness
    assert 0.9 * bound < square / 4 < bound
