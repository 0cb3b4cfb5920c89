"""The tangent's linear systems: one PETSc matrix on our own CSR arrays, one KSP with MUMPS, kept
for a whole run.

MUMPS orders with METIS where it was built with it: its other orderings are slower or equal. Its
scaling is left out, since it takes time and the unknowns are all displacements. petsc4py 3.18 keeps
a factorisation alive through each wrapper that `PETSc.KSP.getPC` returns, so the solver is configured through
the options database and its PC is never used.
"""

from __future__ import annotations

from itertools import count

import numpy as np
from petsc4py import PETSc

from fabrics.base.checks import FloatArray, IntArray

_serial = count()


class DirectSolver:
    """Solves A x = b for matrices of one pattern; refactors after each `factor`.

    Parameters
    ----------
    starts, columns, entries : CSR arrays, int32 and float; `entries` may be overwritten between
        calls of `factor`
    """

    def __init__(self, starts: IntArray, columns: IntArray, entries: FloatArray) -> None:
        size = len(starts) - 1
        self._matrix = PETSc.Mat().createAIJWithArrays(
            (size, size), (starts, columns, entries), comm=PETSc.COMM_SELF
        )
        self._arrays = starts, columns, entries
        prefix = f"unitcell3d_{next(_serial)}_"
        options = {
            "ksp_type": "preonly",
            "pc_type": "lu",
            "pc_factor_mat_solver_type": "mumps",
            "mat_mumps_icntl_7": 5,  # ordering by METIS
            "mat_mumps_icntl_8": 0,  # no scaling
            "mat_mumps_icntl_14": 80,  # room for pivots, percent: the tangent is unsymmetric and may be indefinite
        }
        database = PETSc.Options()
        for key, value in options.items():
            database[prefix + key] = value
        self._ksp = PETSc.KSP().create(PETSc.COMM_SELF)
        self._ksp.setOptionsPrefix(prefix)
        self._ksp.setOperators(self._matrix)
        self._ksp.setFromOptions()
        for key in options:
            database.delValue(prefix + key)
        self._x, self._b = self._matrix.createVecs()

    def factor(self) -> None:
        """Take up the present values of `entries`; they are factorised at the next `solve`."""
        self._matrix.stateIncrease()  # the matrix lives on the array itself

    def solve(self, b: FloatArray) -> FloatArray | None:
        """Return the solution (size,), or None if the factorisation failed."""
        self._b.setArray(b)
        self._ksp.solve(self._b, self._x)
        if self._ksp.getConvergedReason() <= 0:
            return None
        x = self._x.getArray().copy()
        return x if np.all(np.isfinite(x)) else None

    def close(self) -> None:
        """Give the factorisation back."""
        for thing in (self._ksp, self._matrix, self._x, self._b):
            thing.destroy()
