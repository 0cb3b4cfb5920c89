"""Two blocks of a linear isotropic material, one on the other, under the contact of the crossover: for closed forms.

The upper block stands for the warp (axis 0 along x), the lower for the weft (axis 0 along y), as in a crossover. All
planes x = 0, y = 0 are symmetry planes where `quarter`; the top of the upper block is pushed down, the bottom held.
"""

import numpy as np
import ufl
from equations import matrix, shares
from scipy import sparse
from scipy.sparse.linalg import splu

from meshing.generate import bricks
from unitcell3d.assembly.compat import Assembler, HexSpace
from unitcell3d.assembly.constraints import Constraints
from unitcell3d.assembly.sparsity import Pattern
from unitcell3d.contact.surfaces import SurfacePairs, facing, tributary_areas
from unitcell3d.model.crossover import Numerics

SOFTENINGS = (1e-3, 1e-2, 0.1, 1.0)


def block(family, along, across, through, face):
    """Nodes (i, j, k, 3) of one block; `face(x, y)` is the height of its contact face, `through` the depths from it."""
    s, p, depth = np.meshgrid(along, across, through, indexing="ij")
    x, y = (s, p) if family == 0 else (p, s)
    if family == 0:
        return np.stack([x, y, face(x, y) + depth], axis=-1)
    return np.stack([x, y, face(x, y) - depth[..., ::-1]], axis=-1)


def graded(end, n, ratio):
    """n + 1 places from 0 to `end`, the last step `ratio` times the first."""
    steps = np.geomspace(1, ratio, n)
    return np.concatenate([[0], np.cumsum(steps)]) * end / steps.sum()


def level(x, y):
    return 0 * x


class Blocks:
    """The pair, solved for a given descent of the top."""

    def __init__(self, upper, lower, E, nu, *, quarter=True, slide=True, numerics=None):
        self.points = np.concatenate([upper.reshape(-1, 3), lower.reshape(-1, 3)])
        first = np.arange(upper[..., 0].size).reshape(upper.shape[:3])
        second = np.arange(lower[..., 0].size).reshape(lower.shape[:3]) + first.size
        self.grids = first, second
        below = second.ravel()[bricks(second.shape, False)]
        hexes = np.concatenate([first.ravel()[bricks(first.shape, True)], below])
        self.space = HexSpace.build(self.points, hexes)
        lame = E * nu / (1 + nu) / (1 - 2 * nu)
        mu = E / 2 / (1 + nu)
        u = self.space.displacement
        v = ufl.TestFunction(self.space.displacements)
        du = ufl.TrialFunction(self.space.displacements)

        def stress(w):
            e = ufl.sym(ufl.grad(w))
            return lame * ufl.tr(e) * ufl.Identity(3) + 2 * mu * e

        forms = [ufl.inner(stress(field), ufl.sym(ufl.grad(v))) * ufl.dx for field in (u, du)]
        self.solid = Assembler(self.space, *forms)
        n = 3 * len(self.points)
        self.unheld = Constraints(np.arange(n), np.ones(n), np.zeros((n, 0)), n, ())
        self.K = sparse.csr_matrix(
            (self.solid.tangent(), (self.solid.rows, self.solid.columns)), shape=(n, n)
        )
        self.numerics = Numerics(penalty=1e14, toe=1e-12) if numerics is None else numerics
        self.surfaces = SurfacePairs([facing(self.points, *self.grids, quarter)])
        fixed = np.zeros((len(self.points), 3), bool)
        self.top = first[:, :, -1].ravel()
        for nodes in (self.top, second[:, :, 0].ravel()):
            fixed[nodes, 2] = True
            if not slide:
                fixed[nodes] = True
        for component in (0, 1):
            fixed[np.isclose(self.points[:, component], 0), component] = True
        self.free = np.flatnonzero(~fixed.ravel())

    def press(self, descent, steps=1, hold=()):
        """Displacement (n, 3) when the top has gone down; `hold` lists further (nodes, component) kept at zero."""
        free = np.setdiff1d(
            self.free, [3 * node + c for nodes, c in hold for node in np.ravel(nodes)]
        )
        u = np.zeros_like(self.points)
        full = self.numerics
        for share in shares(steps):
            u[self.top, 2] = -share * descent
            # the contact stiffens in stages: at once, the first iteration presses the faces through each other
            for factor in SOFTENINGS:
                self.numerics = full.softened(factor)
                self._settle(u, free)
        return u

    def _settle(self, u, free):
        for _ in range(40):
            self.contact, blocks = self._touch(self.points + u)
            residual = (self.K @ u.ravel() + self.contact.ravel())[free]
            if np.linalg.norm(residual) < 1e-9 * max(np.linalg.norm(self.contact), 1e-9):
                return
            matrix = (self.K + blocks)[free][:, free].tocsc()
            u.ravel()[free] -= splu(matrix).solve(residual)
        raise AssertionError("no equilibrium")

    def _touch(self, x):
        """Contact forces (n, 3) and their tangent as a sparse matrix."""
        forces = np.zeros_like(x)
        self.lift = self.surfaces.assemble(x, self.numerics, forces)
        pattern = Pattern(len(x), self.surfaces.expected_stencils(), self.unheld)
        self.surfaces.build_pattern(pattern)
        self.surfaces.assemble(x, self.numerics, np.zeros_like(x), pattern.values)
        pattern.reduce()
        return forces, matrix(pattern)

    def pressures(self, yarn):
        """Positions (s, 2) and contact pressure (s,) [Pa] at the nodes of one face: both passes, over their areas."""
        face = self.grids[0][:, :, 0] if yarn == 0 else self.grids[1][:, :, -1]
        areas = tributary_areas(self.points, face).ravel()
        nodes = face.ravel()
        return self.points[nodes, :2], abs(self.contact[nodes, 2]) / areas
