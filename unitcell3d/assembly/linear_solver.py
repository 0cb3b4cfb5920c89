"""The tangent's linear systems: one PETSc matrix on our own CSR arrays, one KSP with MUMPS, kept for a whole run.

MUMPS orders with METIS where it was built with it: its other orderings are slower or equal. Its scaling is left out,
since it takes time and the unknowns are all displacements. petsc4py 3.18 keeps a
factorisation alive through each wrapper that `getPC` returns, so the solver is configured through the options database
and its PC is never used.

Several processes may share a factorisation: each holds the whole tangent and gives its rows, and each gets the whole
solution back, the same to the last bit, so that they stay in step.
"""

from __future__ import annotations

from itertools import count
from typing import Any

import numpy as np
from petsc4py import PETSc

from fabrics.checks import FloatArray, IntArray

_serial = count()


class DirectSolver:
    """Solves A x = b for matrices of one pattern; refactors after each `factor`.

    Parameters
    ----------
    starts, columns, entries : CSR arrays, int32 and float; `entries` may be overwritten between calls of `factor`
    comm : MPI communicator of the processes that factorise together, or None
    """

    def __init__(self, starts: IntArray, columns: IntArray, entries: FloatArray, comm: Any = None) -> None:
        size = len(starts) - 1
        self._comm = PETSc.COMM_SELF if comm is None else comm
        self._shared = comm is not None and comm.size > 1
        if self._shared:
            bounds = size * np.arange(comm.size + 1) // comm.size
            self._rows = slice(*bounds[comm.rank : comm.rank + 2])
            self._counts = np.diff(bounds)
            own = slice(starts[self._rows.start], starts[self._rows.stop])
            starts = starts[self._rows.start : self._rows.stop + 1] - starts[self._rows.start]
            columns, entries = columns[own], entries[own]
            self._matrix = PETSc.Mat().createAIJ(
                ((len(starts) - 1, size), (len(starts) - 1, size)), csr=(starts, columns, entries), comm=comm
            )
        else:
            self._matrix = PETSc.Mat().createAIJWithArrays((size, size), (starts, columns, entries), comm=self._comm)
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
        self._ksp = PETSc.KSP().create(self._comm)
        self._ksp.setOptionsPrefix(prefix)
        self._ksp.setOperators(self._matrix)
        self._ksp.setFromOptions()
        for key in options:
            database.delValue(prefix + key)
        self._x, self._b = self._matrix.createVecs()

    def factor(self) -> None:
        """Take up the present values of `entries`; they are factorised at the next `solve`."""
        if self._shared:
            self._matrix.setValuesCSR(*self._arrays)
            self._matrix.assemble()
        else:
            self._matrix.stateIncrease()  # the matrix lives on the array itself

    def solve(self, b: FloatArray) -> FloatArray | None:
        """(size,) solution, or None where the factorisation failed."""
        self._b.setArray(b[self._rows] if self._shared else b)
        self._ksp.solve(self._b, self._x)
        if self._ksp.getConvergedReason() <= 0:
            return None
        x = self._gathered() if self._shared else self._x.getArray().copy()
        return x if np.all(np.isfinite(x)) else None

    def _gathered(self):
        x = np.empty(self._counts.sum())
        self._comm.Allgatherv(self._x.getArray(), (x, self._counts))
        return x

    def close(self) -> None:
        """Give the factorisation back."""
        for thing in (self._ksp, self._matrix, self._x, self._b):
            thing.destroy()
