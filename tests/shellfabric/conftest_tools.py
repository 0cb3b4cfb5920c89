"""Helpers to put panels into a given shape or motion, and to read them."""

from copy import deepcopy

import numpy as np
from panels import rest, set_nodal

from shellfabric.jit.compile import entry
from shellfabric.jit.table import Rows, row_of
from shellfabric.loop import ply_kernels
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.arrays import with_ghosts
from shellfabric.membrane.slots import by_node
from shellfabric.plies import frame_kernels, near_kernels, pressure_kernels
from shellfabric.plies.arrays import on_grids
from shellfabric.surface.grid_kernels import place


def bring(panel, state, x):
    """Move the nodes to x (ni+1, nj+1, 3), all at once and at rest, and find the forces."""
    set_nodal(state.u, x - rest(panel))
    ply_kernels.initial_forces(state, panel.constants(), panel.work())
    return state


def solver_at_rest(target, strike_velocity):
    """PackSolver of one thread, for steps without samples and checks of the energy."""
    solver = PackSolver(target, strike_velocity, 1.0)
    solver.threads = 1
    solver.exchange = np.inf
    return solver


def out_of_reach(panel):
    """A solver of one thread whose projectile is far away from its panel, all rows of which move; state, constants."""
    solver = solver_at_rest(panel, 1.0)
    solver.state.projectile_position[2] = -1.0
    solver.state.first_row = 0
    solver.state.end_row = solver.const.ni
    return solver, solver.state, solver.const


def momenta(solver):
    """(plies, 3) [kg m/s] of the plies."""
    return np.array([[state.mass @ v for v in state.v] for state in solver.states])


def advance(solver, steps):
    """(made, 3) history of at most so many steps."""
    history = np.empty((steps, 3))
    made, _ = solver.advance(history)
    return history[:made]


def same(one, other):
    """Whether two states are the same to the last bit."""
    names = one.kept()
    return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in names)


def far_from_nose(pack):
    """Solver of a pack whose plies are free to move by themselves, all of them looked at."""
    solver = solver_at_rest(pack, 1e-3)
    solver.stack.projectile_position[:, 2] -= 1.0
    solver.stack.awake[:] = True
    for state, const in zip(solver.states, solver.consts):
        state.first_row = 0
        state.end_row = const.ni
    return solver


def collide(pack, velocity, steps):
    """Let the first of two plies fly at the other: (solver, momentum (3,) [N s] and energy [J] before)."""
    solver = far_from_nose(pack)
    front = solver.states[0]
    velocity = np.asarray(velocity)
    for v, speed in zip(front.v, velocity):
        v[:] = np.where(front.mass > 0, speed, 0.0)
    solver.samples.clear()
    solver.energy_at_start = None  # the plies have been set in motion
    solver._sample()
    advance(solver, steps)
    solver._sample()
    return solver, front.mass.sum() * velocity, 0.5 * front.mass.sum() * velocity @ velocity


def on_grid(const, vector):
    """The three components of a vector on the grid of a ply (`surface.grid_kernels`) as (ni+1, nj+1, 3)."""
    stride = const.row_stride + 2
    rows = [part[: (const.ni + 3) * stride].reshape(-1, stride) for part in vector]
    return np.stack(rows, axis=-1)[1:-1, 1:-1]


def foresee(state, const, due, given):
    """The state with firm springs that foresee `due`, and have given so much, both (ni+1, nj+1, 3) [m/s]."""
    found = []
    for vectors in (due, given):
        found.append(tuple(np.zeros((3, state.surface.x[0].size))))
        for part, component in zip(found[-1], with_ghosts(const, np.moveaxis(vectors, -1, 0))):
            part[:] = component
    return state._replace(dv_other=found[0], dv_contact=found[1], force_scale=np.array(0.02))


def node_forces(panel, state):
    """(ni+1, nj+1, 3) [N] forces of the fabric on its nodes."""
    ni, nj = panel.counts
    f = np.array(state.f_int) + np.array(state.f_int_above)
    return np.moveaxis(f[:, : (ni + 1) * (nj + 1)].reshape(3, ni + 1, nj + 1), 0, -1)


def grid(const, flat):
    """(ni+1, nj+1) view of a flat array of the state."""
    return by_node(flat, const)


class Interrupted(Exception):
    """The user ends a run."""


@entry(_nrt=False)
def press_once(states, consts, contact):
    """Forces between plies where they are, of all their points, into contact.pressure.force."""
    contact.step += 1
    for p in range(len(states)):
        state = row_of(states, p)
        place(state, row_of(consts, p), state.first_row, state.end_row)
        frame_kernels.mark_torn(state, row_of(consts, p), contact, p)
    for t in range(contact.lists.displacement.size):
        near_kernels.refresh_box(contact, t)
    near_kernels.list_tiles(contact)
    near_kernels.list_contact_pairs(contact)
    pressure_kernels.press(contact, 0, 1)
    pressure_kernels.press_others(contact)
    for p in range(len(states)):
        frame_kernels.collect_forces(row_of(states, p), row_of(consts, p), contact, p)


class Pressed:
    """The plies of a pack and the contact between them, outside of a run.

    Attributes
    ----------
    pack, states, consts, contact : as of `shellfabric.loop.pack_solver.PackSolver`
    """

    def __init__(self, pack):
        self.pack, self.consts = pack, pack.constants()
        self.states, self.stack = pack.states(1.0)
        self.contact = pack.plies_contact(self.consts, self.states)
        self.states = on_grids(self.states, self.contact)
        for state, const in zip(self.states, self.consts):
            state.first_row = 0
            state.end_row = const.ni
        self.thickness = self.contact.thickness[:2].mean()

    def copy(self):
        """Plies of their own in the same state; their surfaces are parts of the grids of their contact again."""
        found = deepcopy(self)
        found.states = on_grids(found.states, found.contact)
        return found

    def alone(self):
        """The same, whose points are all computed one at a time."""
        self.contact.pressure.same_angle[:] = False
        return self

    def press(self, times=1):
        """Forces on the nodes of the first two plies, each (ni+1, nj+1, 3), with their closest points found; what the
        points have closed by in all but the last of several times counts as come by motion."""
        for n in range(times):
            if n > 0:
                self.contact.pressure.unearned_closure[:] = 0.0
            self.contact.pressure.last_contact_step[:] += 1  # of the two steps that a press counts
            press_once(Rows(self.states), Rows(self.consts), self.contact)
        return self.force(0, frame_kernels.BEHIND), self.force(1, frame_kernels.BEFORE)

    def force(self, ply, side):
        """(ni+1, nj+1, 3) [N] of the plies on one side of a ply."""
        return np.stack(
            [grid(self.consts[ply], part) for part in self.contact.pressure.force[ply, side]],
            axis=-1,
        )

    def spring(self):
        """[J] in the springs of all points."""
        return self.contact.pressure.spring_energy.sum()

    def bulge(self, rng, together, width=4e-3):
        """Have the plies bulge into each other, the first by `together` [m] more than the second."""
        for p, (ply, state, const) in enumerate(zip(self.pack.plies, self.states, self.consts)):
            X, Y = ply.coordinates()
            bulge = (3e-3 + (1 - p) * together) * np.exp(-(X**2 + 1.3 * Y**2) / width**2)
            for c, size in enumerate((-0.05 * X * bulge / 1e-3, -0.03 * Y * bulge / 1e-3, bulge)):
                grid(const, state.u[c])[:] = size
                grid(const, state.v[c])[:] = rng.normal(0, 5, X.shape)
            if const.mirror_x:
                for x in (state.u, state.v):
                    grid(const, x[0])[0] = 0.0
                    grid(const, x[1])[:, 0] = 0.0
        return self
