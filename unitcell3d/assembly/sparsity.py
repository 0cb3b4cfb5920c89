"""The tangent K as 3 x 3 blocks between nodes, and its reduction C^T K C to the matrix of the
unknowns.

C is that of `constraints.Constraints`, u = C q + drive p. Its rows have one entry at most, so each
entry of K goes to one entry of the reduced matrix: one sparse matrix of +-1 does it, whose pattern
is worked out once a layout.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse

from fabrics.base.checks import FloatArray, IntArray
from unitcell3d.assembly.constraints import Constraints


class Pattern:
    """Block pattern of a set of stencils (nodes that all act on each other) and its reduction to
    the unknowns.

    Parameters
    ----------
    n : number of nodes
    stencils : iterable of (m, s) node numbers
    constraints : constraints.Constraints

    Attributes
    ----------
    values : (k, 3, 3) [N/m] blocks, assembled into by the kernels
    starts, columns, entries : the CSR matrix of the unknowns; `entries` is filled by `reduce`
    diagonal : (unknowns,) places of the diagonal in `entries`
    """

    def __init__(self, n: int, stencils: Iterable[ArrayLike], constraints: Constraints) -> None:
        self._n = n
        self._keys = np.unique(np.concatenate([np.unique(self._pairs(each)) for each in stencils]))
        self.values = np.zeros((len(self._keys), 3, 3))
        first, second = np.divmod(self._keys, n)
        component = np.arange(9)
        i = (3 * first[:, None] + component // 3).ravel()
        j = (3 * second[:, None] + component % 3).ravel()
        row = constraints.unknown[i]
        column = constraints.unknown[j]
        kept = np.flatnonzero((row >= 0) & (column >= 0))
        sign = constraints.sign[i[kept]] * constraints.sign[j[kept]]
        size = constraints.size
        keys, target = np.unique(row[kept] * size + column[kept], return_inverse=True)
        self._sum = sparse.csr_matrix((sign, (target, kept)), shape=(len(keys), len(i)))
        self.starts = np.searchsorted(keys, size * np.arange(size + 1)).astype(np.int32)
        self.columns = (keys % size).astype(np.int32)
        self.diagonal = np.searchsorted(keys, (size + 1) * np.arange(size))
        self.entries = np.zeros(len(keys))

    def _pairs(self, stencils):
        """(m, s, s) key of each pair of nodes of the stencils (m, s)."""
        stencils = np.asarray(stencils, np.int64)
        return stencils[:, :, None] * self._n + stencils[:, None, :]

    def holds(self, stencil: IntArray) -> bool:
        """Tell whether every pair of nodes of the stencils (m, s) has its block."""
        pairs = self._pairs(stencil)
        # the keys are sorted
        places = np.minimum(np.searchsorted(self._keys, pairs), len(self._keys) - 1)
        return bool(np.all(self._keys[places] == pairs))

    def places(self, stencil: IntArray) -> IntArray:
        """Return the number of the block (m, s, s) of each pair of nodes of the stencils (m, s)."""
        return np.searchsorted(self._keys, self._pairs(stencil))

    def scalar_places(self, rows: IntArray, columns: IntArray) -> IntArray:
        """Return the flat index into `values` of the entries between components (3 node +
        component)."""
        block = np.searchsorted(self._keys, (rows // 3).astype(np.int64) * self._n + columns // 3)
        return 9 * block + 3 * (rows % 3) + columns % 3

    def reduce(self) -> FloatArray:
        """Add the blocks up into the matrix of the unknowns: returns `entries`."""
        self.entries[:] = self._sum @ self.values.ravel()
        return self.entries
