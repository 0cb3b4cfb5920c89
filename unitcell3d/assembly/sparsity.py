"""The tangent's places: 3 x 3 blocks between nodes, and where each entry goes in the matrix of the unknowns."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse

from fabrics.checks import FloatArray, IntArray
from unitcell3d.assembly.constraints import Constraints
from unitcell3d.assembly.sparsity_kernels import gather


class Pattern:
    """Block pattern of a set of stencils (nodes that all act on each other) and its reduction to the unknowns.

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
        keys = np.unique(np.concatenate([self._pairs(stencil, n) for stencil in stencils]))
        self._n, self._keys = n, keys
        self.values = np.zeros((len(keys), 3, 3))
        rows, columns = keys // n, keys % n
        component = np.arange(9)
        row = constraints.unknown[3 * rows[:, None] + component // 3].ravel()
        column = constraints.unknown[3 * columns[:, None] + component % 3].ravel()
        sign = (
            constraints.sign[3 * rows[:, None] + component // 3]
            * constraints.sign[3 * columns[:, None] + component % 3]
        ).ravel()
        kept = np.flatnonzero((row >= 0) & (column >= 0))
        row, column = row[kept], column[kept]
        size = constraints.size
        matrix = sparse.csr_matrix((np.ones(len(kept)), (row, column)), shape=(size, size))
        matrix.sort_indices()
        # place of each entry: its row's start plus the rank of its column in the sorted row
        numbering = sparse.csr_matrix(
            (np.arange(matrix.nnz), matrix.indices, matrix.indptr), shape=matrix.shape
        )
        self.starts, self.columns = matrix.indptr.astype(np.int32), matrix.indices.astype(np.int32)
        self.entries = np.zeros(matrix.nnz)
        self.diagonal = np.flatnonzero(
            np.repeat(np.arange(size), np.diff(matrix.indptr)) == matrix.indices
        )
        self._target = np.asarray(numbering[row, column]).ravel().astype(np.int64)
        self._source, self._sign = kept, sign[kept]

    @staticmethod
    def _pairs(stencil, n):
        stencil = np.asarray(stencil, np.int64)
        return np.unique((stencil[:, :, None] * n + stencil[:, None, :]).ravel())

    def holds(self, stencil: IntArray) -> bool:
        """Whether every pair of nodes of the stencils (m, s) has its block."""
        keys = self._pairs(stencil, self._n)
        found = np.searchsorted(self._keys, keys)
        return bool(np.all(self._keys[np.minimum(found, len(self._keys) - 1)] == keys))

    def places(self, stencil: IntArray) -> IntArray:
        """Number of the block (m, s, s) of each pair of nodes of the stencils (m, s)."""
        stencil = np.asarray(stencil, np.int64)
        return np.searchsorted(self._keys, stencil[:, :, None] * self._n + stencil[:, None, :])

    def scalar_places(self, rows: IntArray, columns: IntArray) -> IntArray:
        """Flat index into `values` of the entries between components (3 node + component)."""
        block = np.searchsorted(self._keys, (rows // 3).astype(np.int64) * self._n + columns // 3)
        return 9 * block + 3 * (rows % 3) + columns % 3

    def reduce(self) -> FloatArray:
        """Add the blocks up into the matrix of the unknowns: returns `entries`."""
        gather(self.values.reshape(-1), self._source, self._sign, self._target, self.entries)
        return self.entries
