"""What tests of several meshes compute of their elements."""

import numpy as np

# corners of the unit cube in VTK order
CUBE = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], float
)


def volumes(points, hexes):
    """Volume [m3] of each trilinear element, exact: two-point Gauss rule of the Jacobian in each direction."""
    corners = np.asarray(points, float)[np.asarray(hexes)]
    signs = 2 * CUBE - 1
    total = np.zeros(len(corners))
    for gauss in signs / np.sqrt(3):
        factors = 1 + signs * gauss
        slopes = np.stack(
            [signs[:, a] * factors[:, (a + 1) % 3] * factors[:, (a + 2) % 3] / 8 for a in range(3)],
            axis=-1,
        )
        total += np.linalg.det(np.einsum("mnx,na->mxa", corners, slopes))
    return total


def vector_areas(corners):
    """(n, 3) [m2] of quadrilaterals with these corners (n, 4, 3): half the cross product of the diagonals."""
    return np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]) / 2
