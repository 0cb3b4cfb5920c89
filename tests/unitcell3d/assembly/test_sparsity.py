"""The tangent as blocks, reduced to the unknowns."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import sparse

from unitcell3d.assembly.constraints import Ties
from unitcell3d.assembly.sparsity import Pattern

NODES = 5
STENCILS = [np.array([[0, 1, 2], [2, 3, 4]]), np.array([[1, 4]])]


def tied(held):
    """Nodes of which one follows another upside down; a component of node `held` is prescribed."""
    ties = Ties(NODES, 1)
    ties.hold([held], 1)
    ties.follow([3], [0], 2, -1.0)
    return ties.done(())


@pytest.mark.parametrize("held", [0, 4])
def test_the_reduced_matrix_is_that_of_all_unknowns(held):
    """C^T K C of a matrix without symmetry; the first and the last unknown are free."""
    constraints = tied(held)
    pattern = Pattern(NODES, STENCILS, constraints)
    random = np.random.default_rng(4)
    K = np.zeros((NODES, 3, NODES, 3))
    for stencil in STENCILS:
        for nodes, places in zip(stencil, pattern.places(stencil)):
            blocks = random.normal(size=(len(nodes), len(nodes), 3, 3))
            pattern.values[places] += blocks
            for i, one in enumerate(nodes):
                for j, other in enumerate(nodes):
                    K[one, :, other, :] += blocks[i, j]
    size = 3 * NODES
    wanted = constraints.C.T @ K.reshape(size, size) @ constraints.C
    shape = (constraints.size,) * 2
    reduced = sparse.csr_matrix((pattern.reduce(), pattern.columns, pattern.starts), shape=shape)
    assert_allclose(reduced.toarray(), wanted, rtol=1e-12, atol=1e-14)
    assert_allclose(pattern.entries[pattern.diagonal], wanted.diagonal(), rtol=1e-12, atol=1e-14)
    rows, columns = np.array([3, 7, 12]), np.array([8, 3, 13])
    found = pattern.values.ravel()[pattern.scalar_places(rows, columns)]
    assert_allclose(found, K.reshape(size, size)[rows, columns])
    assert pattern.holds(np.array([[1, 4]]))
    assert not pattern.holds(np.array([[0, 4]]))
