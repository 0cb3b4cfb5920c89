"""Helpers to put panels into a given shape or motion, and to read them."""

import numpy as np
from panels import rest, set_nodal

from shellfabric.solver import ply_kernels
from shellfabric.solver.pack_solver import PackSolver


def bring(panel, state, x):
    """Move the nodes to x (ni+1, nj+1, 3), all at once and at rest, and find the forces."""
    set_nodal(state.u, x - rest(panel))
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


class Interrupted(Exception):
    """The user ends a run."""
