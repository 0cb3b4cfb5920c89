"""The one file that knows dolfinx has versions: 0.5 (Debian 12) and 0.9 (Debian 13).

It turns arrays of hexahedra into a vector Q1 space and compiled forms, and speaks outwards only in
plain arrays that are numbered as the caller numbered its points and cells.
"""

from __future__ import annotations

import logging
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import basix
import dolfinx
import numpy as np
import ufl
from dolfinx import fem, la
from dolfinx import mesh as dolfinx_mesh
from dolfinx.fem import petsc
from mpi4py import MPI
from petsc4py import PETSc

from fabrics.base.checks import FloatArray, IntArray

# dolfinx orders the corners of a hexahedron as a tensor product, VTK runs round each face
VTK_TO_DOLFINX = np.array([0, 1, 3, 2, 4, 5, 7, 6])
# the law's loops are short and its arithmetic long: vector instructions pay, and reassociation lets
# them be used
COMPILE_ARGUMENTS = ["-O3", "-march=native", "-ffast-math", "-fno-finite-math-only", "-g0"]


TESTED = ("0.5", "0.9")
if not dolfinx.__version__.startswith(tuple(f"{version}." for version in TESTED)):
    logging.getLogger("weavecell").warning(
        f"the 3D crossover is tested with dolfinx {' and '.join(TESTED)}, and this is {dolfinx.__version__}"
    )


def _old():
    return not hasattr(fem, "functionspace")


@dataclass(frozen=True)
class HexSpace:
    """Vector displacements, of order 1 or 2, and cell constants on one serial mesh of hexahedra.

    node : (n,) number of the caller's point that carries block i of the displacement
    cell : (m,) number of the caller's cell that dolfinx keeps as its cell i
    """

    mesh: Any
    displacements: Any
    node: np.ndarray
    cell: np.ndarray

    @classmethod
    def build(cls, points: FloatArray, hexes: IntArray) -> HexSpace:
        """Build the space.

        Parameters
        ----------
        points : (n, 3) [m]
        hexes : (m, 8) point numbers in VTK order, or (m, 27) in that of `second_order_places`; the
            cell's first local axis runs from corner 0 to corner 1
        """
        cells = np.asarray(hexes, np.int64)
        order = 2
        if cells.shape[1] == len(VTK_TO_DOLFINX):
            order = 1
            cells = cells[:, VTK_TO_DOLFINX]
        cells = np.ascontiguousarray(cells)
        given: dict[str, Any] = {"x": np.asarray(points, float)}
        if _old():
            given["domain"] = ufl.Mesh(ufl.VectorElement("Lagrange", "hexahedron", order))
        else:
            import basix.ufl

            given["e"] = ufl.Mesh(basix.ufl.element("Lagrange", "hexahedron", order, shape=(3,)))
        # one process owns a crossover: several crossovers run beside each other in processes of
        # their own. By name, since 0.10 has points and element in the other order
        mesh = dolfinx_mesh.create_mesh(MPI.COMM_SELF, cells, **given)
        space = _vector_space(mesh, "Lagrange", order, 3)
        node = np.empty(len(points), np.int64)
        dofs, corners = (
            _rows(table, cells.shape[1]) for table in (space.dofmap.list, mesh.geometry.dofmap)
        )
        node[dofs] = np.asarray(mesh.geometry.input_global_indices)[corners]
        return cls(mesh, space, node, np.asarray(mesh.topology.original_cell_index))

    @cached_property
    def displacement(self) -> Any:
        """The displacement as a UFL coefficient."""
        return fem.Function(self.displacements)

    def set_displacement(self, u: FloatArray) -> None:
        """Give the coefficient the values `u` : (n, 3) [m] at the caller's points."""
        self.displacement.x.array[:] = u[self.node].ravel()

    def cell_constants(self, values: FloatArray) -> Any:
        """Make a UFL coefficient that is constant in each cell, from `values` : (m, c) by the
        caller's cells."""
        function = fem.Function(_vector_space(self.mesh, "DG", 0, values.shape[1]))
        self.set_cell_constants(function, values)
        return function

    def set_cell_constants(self, function: Any, values: FloatArray) -> None:
        """Give a coefficient of `cell_constants` the values (m, c) by the caller's cells."""
        dofs = _rows(function.function_space.dofmap.list, 1)[:, 0]
        function.x.array.reshape(-1, values.shape[1])[dofs] = values[self.cell]


def second_order_places() -> IntArray:
    """Return the places (27, 3) of 0, 1, 2 along the local axes at which a hexahedron of order 2 has its points."""
    chosen = basix.create_element(
        basix.ElementFamily.P, basix.CellType.hexahedron, 2, basix.LagrangeVariant.gll_warped
    )
    return np.rint(2 * chosen.points).astype(int)


class Assembler:
    """Compiled residual and tangent of a form, assembled into plain arrays in the caller's
    numbering.

    rows, columns : (nnz,) unknown (3 point + component) of each entry of the values that `tangent`
        returns
    """

    def __init__(self, space: HexSpace, residual: Any, tangent: Any) -> None:
        self._space = space
        # compiling the residual changes what UFL reads when it signs the tangent: unsigned, the same
        # tangent is compiled once more by a process that finds the residual in the cache
        for form in (residual, tangent):
            form.signature()
        self._residual = _form(residual)
        self._tangent = _form(tangent)
        dofmap = space.displacements.dofmap
        self._vector = la.vector(dofmap.index_map, dofmap.index_map_bs)
        # by blocks of 3 x 3: to find the places of single entries takes as long as the bricks'
        # tangents themselves
        self._matrix = petsc.create_matrix(self._tangent, "baij")
        self._plain = PETSc.Mat()
        self.rows, self.columns = self._pattern()

    def _pattern(self):
        self.tangent()  # PETSc drops entries that have never been set
        starts, columns, _ = self._entries()
        rows = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
        return tuple(3 * self._space.node[index // 3] + index % 3 for index in (rows, columns))

    def residual(self) -> FloatArray:
        """Assemble the forces (n, 3) [N] at the caller's points for the current displacement."""
        array = self._vector.array
        array[:] = 0
        fem.assemble_vector(array, self._residual)
        forces = np.empty((len(self._space.node), 3))
        forces[self._space.node] = array.reshape(-1, 3)
        return forces

    def tangent(self) -> FloatArray:
        """Assemble the values (nnz,) [N/m] in the order of `rows` and `columns`."""
        self._matrix.zeroEntries()
        petsc.assemble_matrix(self._matrix, self._tangent)
        self._matrix.assemble()
        return self._entries()[2]

    def _entries(self):
        self._matrix.convert("aij", out=self._plain)
        return self._plain.getValuesCSR()


@contextmanager
def _quiet_compiler():
    """Keep the C compiler's command lines out of the user's log."""
    logging.disable(logging.INFO)
    try:
        yield
    finally:
        logging.disable(logging.NOTSET)


@_quiet_compiler()
def _vector_space(mesh, family, degree, size):
    if _old():
        return fem.VectorFunctionSpace(mesh, (family, degree), dim=size)
    return fem.functionspace(mesh, (family, degree, (size,)))


@_quiet_compiler()
def _form(expression):
    options = {"cffi_extra_compile_args": COMPILE_ARGUMENTS, "timeout": 300}
    return (
        fem.form(expression, jit_params=options)
        if _old()
        else fem.form(expression, jit_options=options)
    )


def _rows(table, width):
    return np.asarray(table.array if hasattr(table, "array") else table).reshape(-1, width)
