"""Helpers to put a panel into a given shape, and to read and to check its nodal forces."""

import numpy as np
import pytest

from shellfabric.panel import grading
from shellfabric.solver import ply_kernels
from shellfabric.solver.pack_solver import PackSolver


def rest(panel):
    """(ni+1, nj+1, 3) [m] places of the nodes at rest."""
    X, Y = panel.coordinates()
    return np.stack([X, Y, np.zeros_like(X)], axis=-1)


def bring(panel, state, x):
    """Move the nodes to x (ni+1, nj+1, 3), all at once and at rest, and find the forces."""
    moved = x - rest(panel)
    for c in range(3):
        state.u[c][: moved[..., c].size] = moved[..., c].ravel()
    ply_kernels.initial_forces(state, panel.constants(), None, panel.work())
    return state


def solver_at_rest(target, strike_velocity):
    """PackSolver of one thread, for steps without samples and checks of the energy."""
    solver = PackSolver(target, strike_velocity, 1.0)
    solver.threads, solver.exchange = 1, np.inf
    return solver


def advance(solver, steps):
    """(made, 3) history of at most so many steps."""
    history = np.empty((steps, 3))
    made, _ = solver.advance(history)
    return history[:made]


def same(one, other):
    """Whether two states are the same to the last bit."""
    return all(np.array_equal(np.array(a), np.array(b)) for a, b in zip(one, other))


def far_from_nose(pack):
    """Solver of a pack whose plies are free to move by themselves, all of them looked at."""
    solver = solver_at_rest(pack, 1e-3)
    solver.stack.projectile_position[:, 2] -= 1.0
    solver.stack.awake[:] = True
    for state, const in zip(solver.states, solver.consts):
        state.active_rows[:] = 0, const.ni
    return solver


def collide(pack, velocity, steps):
    """Let the first of two plies fly at the other: (solver, momentum (3,) [N s] and energy [J] before)."""
    solver = far_from_nose(pack)
    front, velocity = solver.states[0], np.asarray(velocity)
    for v, speed in zip(front.v, velocity):
        v[:] = np.where(front.mass > 0, speed, 0.0)
    solver.samples.clear()
    solver.energy_at_start = None  # the plies have been set in motion
    solver._sample()
    advance(solver, steps)
    solver._sample()
    return solver, front.mass.sum() * velocity, 0.5 * front.mass.sum() * velocity @ velocity


def node_forces(panel, state):
    """(ni+1, nj+1, 3) [N] forces of the cloth on its nodes."""
    ni, nj = panel.counts
    f = np.array(state.f_int) + np.array(state.f_int_above)
    return np.moveaxis(f[:, : (ni + 1) * (nj + 1)].reshape(3, ni + 1, nj + 1), 0, -1)


def grid(const, flat):
    """(ni+1, nj+1) view of a flat array of the state."""
    return flat[: (const.ni + 1) * const.row_stride].reshape(const.ni + 1, const.row_stride)


def assert_gradient(panel, x, f, nodes, energy):
    """Forces f : (ni+1, nj+1, 3) [N] at some nodes are minus the derivative of energy(panel, x) [J], to the table's
    error."""
    step = 1e-8
    for node in nodes:
        for c in range(3):
            energies = []
            for sign in (1, -1):
                moved = x.copy()
                moved[(*node, c)] += sign * step
                energies.append(energy(panel, moved))
            expected = -(energies[0] - energies[1]) / (2 * step)
            assert f[(*node, c)] == pytest.approx(expected, abs=0.02 * np.abs(f).max()), (node, c)


def assert_balance(x, f):
    """The cloth's own forces f on nodes at x, both (ni+1, nj+1, 3), add up to nothing and have no moment."""
    scale = np.abs(f).sum()
    assert np.abs(f.sum(axis=(0, 1))).max() < 1e-14 * scale
    assert np.abs(np.cross(x, f).sum(axis=(0, 1))).max() < 1e-14 * scale * np.abs(x).max()


class Interrupted(Exception):
    """The user ends a run."""


def crumple(panel, scale=5e-6):
    """(ni+1, nj+1, 3) [m] nodes of a stretched, sheared, crumpled panel, off by `scale` at random."""
    X, Y = panel.coordinates()
    x = np.stack([1.015 * X + 0.1 * Y, 1.012 * Y, 0.0005 * np.sin(200 * X)], axis=-1)
    return x + np.random.default_rng(3).normal(scale=scale, size=x.shape)


def plain_energy(panel, x):
    """Energy of the cloth with nodes x (ni+1, nj+1, 3), graded or not, from the definitions alone."""
    weave, shear, model = panel.weave, panel.fabric.shear, panel.table.model
    (ni, nj), (w1, w2) = panel.counts, weave.w
    a, b = panel.sides or map(np.full, panel.counts, panel.spacing)
    m, n = grading.tributary(a), grading.tributary(b)
    warp, weft = np.diff(x, axis=0) / a[:, None, None], np.diff(x, axis=1) / b[None, :, None]
    l1, l2 = np.linalg.norm(warp, axis=-1), np.linalg.norm(weft, axis=-1)
    total = 0.0
    for i in range(ni):
        for j in range(nj + 1):
            met = [(l2[p, q], b[q]) for p in (i, i + 1) for q in (j - 1, j) if 0 <= q < nj]
            mean = np.average([s for s, _ in met], weights=[length for _, length in met])
            total += 0.5 * a[i] * n[j] / (4 * w1 * w2) * float(model.solve(l1[i, j], mean)["W"])
    for i in range(ni + 1):
        for j in range(nj):
            met = [(l1[p, q], a[p]) for p in (i - 1, i) for q in (j, j + 1) if 0 <= p < ni]
            mean = np.average([s for s, _ in met], weights=[length for _, length in met])
            total += 0.5 * m[i] * b[j] / (4 * w1 * w2) * float(model.solve(mean, l2[i, j])["W"])
    edge1, edge2 = 0.5 * (warp[:, 1:] + warp[:, :-1]), 0.5 * (weft[1:] + weft[:-1])
    mean = 0.25 * (l1[:, 1:] + l1[:, :-1]) * (l2[1:] + l2[:-1])
    gamma = np.abs(np.arcsin(np.sum(edge1 * edge2, axis=-1) / mean))
    points, weights = np.polynomial.legendre.leggauss(40)
    trellis = sum(0.5 * gamma * w * shear.stress(0.5 * gamma * (1 + p)) for p, w in zip(points, weights))
    return total + weave.thickness * float(np.sum(np.multiply.outer(a, b) * trellis))
