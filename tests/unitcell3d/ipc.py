"""The crossover under another contact: the barrier of incremental potential contact (Li et al., 2020; IPC Toolkit).

Barriers between the flat triangles of both faces instead of a penalty between nodes and a C1 surface; steps are kept
free of collisions instead of letting nodes through. Solid, bars and constraints are those of the model. Lengths go to
the toolkit in units of 0.1 mm: its absolute tolerances expect numbers of order one.
"""

import ipctk
import numpy as np
from equations import matrix, shares
from scipy import sparse
from scipy.sparse.linalg import splu

from unitcell3d.model.crossover import CrossoverModel, Load

UNIT = 1e-4  # m
# Sums over threads come in any order, and in one run of several on a busy machine the iteration found no equilibrium.
ipctk.set_num_threads(1)


class NoEquilibriumError(Exception):
    """The iteration of a barrier model has not converged."""


class NoContact:
    """Takes the place of the model's own contact."""

    gaps = ()

    def expected_stencils(self):
        return []

    def build_pattern(self, pattern):
        pass

    def pattern_outdated(self):
        return False

    def assemble(self, x, numerics, forces, values=None):
        return 0.0


class BarrierModel:
    """A crossover model whose yarns are kept apart by barriers of range `reach` [m].

    Parameters
    ----------
    apart : [m] by which the yarns are moved apart, so that the flat facets do not intersect at rest
    stiffness : [N/m] scale of the barrier
    """

    def __init__(self, crossover, fabric, *, reach, apart, stiffness):
        points = crossover.points.copy()
        for grid, side in zip(crossover.grids, (0.5, -0.5)):
            points[grid, 2] += side * apart
        self.model = CrossoverModel(type(crossover)(**vars(crossover) | {"points": points}), fabric)
        self.model.surfaces = NoContact()
        upper = crossover.grids[0][:, :, 0]
        lower = crossover.grids[1][:, :, -1]
        self.nodes = np.concatenate([upper.ravel(), lower.ravel()])
        number = np.full(len(points), -1)
        number[self.nodes] = np.arange(len(self.nodes))
        faces = np.concatenate([triangles(number[grid]) for grid in (upper, lower)]).astype(
            np.int32
        )
        self.mesh = ipctk.CollisionMesh(self._scaled(points), ipctk.edges(faces), faces)
        yarn = np.repeat([0, 1], [upper.size, lower.size]).astype(np.int32)
        self.mesh.can_collide = ipctk.make_vertex_patches_filter(yarn)
        self.reach = reach / UNIT
        self.scale = stiffness * UNIT
        self.barrier = ipctk.BarrierPotential(self.reach, 1.0)
        rows = (3 * self.nodes[:, None] + np.arange(3)).ravel()
        self.spread = sparse.csr_matrix(
            (np.ones(len(rows)), (rows, np.arange(len(rows)))), shape=(points.size, len(rows))
        )
        self.warp = upper.size

    def _scaled(self, x):
        return np.asfortranarray(x[self.nodes] / UNIT)

    def _collisions(self, x):
        found = ipctk.NormalCollisions()
        found.build(self.mesh, x, self.reach)
        return found

    def residual(self, q, load):
        """Residual of the unknowns, nodal forces, contact force [N] of the meshed part."""
        forces, _, _ = self.model.forces(q, load)
        x = self._scaled(self.model.positions(q, load))
        push = (
            self.scale
            / UNIT
            * self.barrier.gradient(self._collisions(x), self.mesh, x).reshape(-1, 3)
        )
        np.add.at(forces, self.nodes, push)
        return self.model.constraints.reduce(forces), forces, -push[: self.warp, 2].sum()

    def tangent(self, q, load):
        model = self.model
        model.system(q, load)
        x = self._scaled(model.positions(q, load))
        H = self.scale / UNIT**2 * self.barrier.hessian(self._collisions(x), self.mesh, x)
        C = model.constraints.C
        return matrix(model.pattern) + C.T @ (self.spread @ H @ self.spread.T) @ C

    def solve(self, q, start, load, rounds=300):
        """Equilibrium at `load` from that at `start`: the ends are driven as far as no facets meet, then corrected."""
        driven = start
        shift = 300.0
        residual, forces, contact = self.residual(q, driven)
        for _ in range(rounds):
            arrived = driven.d == load.d
            size = max(
                abs(contact),
                *(abs(self.model.constraints.end_force(forces, y)) for y in (0, 1)),
                1e-2,
            )
            if arrived and np.linalg.norm(residual) < 1e-6 * size:
                return q, forces, contact
            K = self.tangent(q, driven) + shift * sparse.identity(self.model.size)
            goal = driven if arrived else load
            pull = residual
            if not arrived:  # what the residual becomes when the ends go on, to first order
                pull = (
                    residual + (self.residual(q, driven.towards(goal, 1e-4))[0] - residual) / 1e-4
                )
            step = splu(K.tocsc()).solve(-pull)
            share = min(1.0, 5e-6 / abs(step).max())
            before, after = (
                self._scaled(self.model.positions(*state))
                for state in ((q, driven), (q + share * step, driven.towards(goal, share)))
            )
            clear = ipctk.compute_collision_free_stepsize(self.mesh, before, after)
            share *= 1.0 if clear >= 1 else 0.8 * clear
            old = np.linalg.norm(residual)
            for _ in range(12):
                trial = driven.towards(goal, share)
                found = self.residual(q + share * step, trial)
                if np.linalg.norm(found[0]) < 2 * max(old, 1e-3):
                    break
                share *= 0.5
            q, (residual, forces, contact) = q + share * step, found
            driven = goal if share == 1 else trial
            shift = min(max(shift * np.clip(np.linalg.norm(residual) / old, 0.05, 2.0), 1e-3), 1e4)
        raise NoEquilibriumError("the barrier found no equilibrium")

    def path(self, end, steps):
        """(T1, T2, F_c) [N] at the end displacements `end` : (2,) [m], in equal steps from rest."""
        q = np.zeros(self.model.size)
        at = Load()
        for share in shares(steps):
            goal = Load((share * end[0], share * end[1]))
            q, forces, contact = self.solve(q, at, goal)
            at = goal
        x = self._scaled(self.model.positions(q, at))
        self.distance = UNIT * np.sqrt(self._collisions(x).compute_minimum_distance(self.mesh, x))
        return *self.model.tensions(forces), self.model.copies[1] * contact


def triangles(grid):
    """(m, 3) two triangles a quadrilateral, the diagonal turning from cell to cell."""
    a = grid[:-1, :-1]
    b = grid[1:, :-1]
    c = grid[1:, 1:]
    d = grid[:-1, 1:]
    i, j = np.indices(a.shape)
    even = ((i + j) % 2 == 0)[..., None]
    first = np.where(even, np.stack([a, b, c], -1), np.stack([a, b, d], -1))
    second = np.where(even, np.stack([a, c, d], -1), np.stack([b, c, d], -1))
    return np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)])
