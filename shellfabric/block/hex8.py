"""Geometry of eight-node bricks with one integration point, once, at rest: what `brick_kernels`
needs of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fabrics.base import sums
from fabrics.base.checks import FloatArray

CORNERS = np.array(
    [
        [-1, -1, -1],
        [1, -1, -1],
        [1, 1, -1],
        [-1, 1, -1],
        [-1, -1, 1],
        [1, -1, 1],
        [1, 1, 1],
        [-1, 1, 1],
    ]
)
XI, ETA, ZETA = CORNERS.T
PATTERNS = np.array([ETA * ZETA, XI * ZETA, XI * ETA, XI * ETA * ZETA])  # (4, 8) h
# per mode, the local directions along which it varies, and the mean square of its slope's pattern
SLOPES = (((1, 2), 1 / 3), ((0, 2), 1 / 3), ((0, 1), 1 / 3), ((0, 1, 2), 1 / 9))


@dataclass(frozen=True)
class Bricks:
    """Bricks at rest, in the frame that follows the fibre.

    Parameters
    ----------
    volume : (m,) [m3]
    gradient : (m, 8, 3) [1/m] mean gradients of the shape functions, along e1, e2, e3
    twist : (m, 4, 3) [m] the hourglass patterns of the corners
    edges : (m, 3) [m] mean lengths along, across, through
    """

    volume: np.ndarray
    gradient: np.ndarray
    twist: np.ndarray
    edges: np.ndarray

    @classmethod
    def of(cls, corners: FloatArray) -> Bricks:
        """Compute bricks from (m, 8, 3) [m] corners, edge 0-1 along the fibre, 0-3 across, 0-4
        through; either hand.

        The mean gradients of the trilinear shape functions are found by the 2 x 2 x 2 rule, which
        is exact for them.
        """
        volume = np.zeros(len(corners))
        gradient = np.zeros((len(corners), 8, 3))
        for point in CORNERS / np.sqrt(3):
            slopes = _slopes(point)
            jacobian = np.einsum("mac,ai->mci", corners, slopes)
            measure = np.abs(sums.determinant(jacobian))
            volume = volume + measure
            gradient = gradient + measure[:, None, None] * (
                sums.multiply(slopes, sums.invert(jacobian))
            )
        gradient /= volume[:, None, None]
        middle = np.einsum("mac,ai->mci", corners, _slopes(np.zeros(3)))
        frame = _frame(middle[:, :, 0], middle[:, :, 1])
        local = np.einsum("mac,mci->mai", corners, frame)
        return cls(
            volume,
            np.ascontiguousarray(np.einsum("mac,mci->mai", gradient, frame)),
            np.einsum("ha,mai->mhi", PATTERNS, local),
            2 * np.linalg.norm(middle, axis=1),
        )

    @property
    def control_weights(self) -> FloatArray:
        """Weights (m, 4, 3) [m] of the slopes of each hourglass mode along each edge in the energy
        of the 2 x 2 x 2 rule: volume x mean square of its pattern over the square of the edge."""
        found = np.zeros((len(self.volume), 4, 3))
        for mode, (directions, square) in enumerate(SLOPES):
            for c in directions:
                found[:, mode, c] = self.volume * square / (16 * self.edges[:, c] ** 2)
        return found

    def control(self, moduli: Sequence[float], shear: float) -> FloatArray:
        """Compute the hourglass stiffness (m, 4, 3) [N/m3]: the energy of the 2 x 2 x 2 rule at
        rest.

        Parameters
        ----------
        moduli : (3,) [Pa] along, across and through;  shear : [Pa]
        """
        found = np.empty((len(self.volume), 4, 3))
        for mode, (directions, square) in enumerate(SLOPES):
            for i in range(3):
                stiff = np.zeros(len(self.volume))
                for c in directions:
                    modulus = shear
                    if c == i:
                        modulus = moduli[i]
                    stiff = stiff + modulus / self.edges[:, c] ** 2
                found[:, mode, i] = self.volume * stiff * square / 16
        return found


def at_points(corners: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Compute the gradients (m, 8, 8, 3) [1/m] of the shape functions at the 2 x 2 x 2 points of bricks
    of (m, 8, 3) [m] corners, along e1, e2, e3 at each point, and the volumes (m, 8) [m3]."""
    gradients = []
    volumes = []
    for point in CORNERS / np.sqrt(3):
        slopes = _slopes(point)
        jacobian = np.einsum("mac,ai->mci", corners, slopes)
        frame = _frame(jacobian[:, :, 0], jacobian[:, :, 1])
        gradients.append(
            np.einsum("mac,mci->mai", sums.multiply(slopes, sums.invert(jacobian)), frame)
        )
        volumes.append(np.abs(sums.determinant(jacobian)))
    return np.stack(gradients, axis=1), np.stack(volumes, axis=1)


def _slopes(point):
    """(8, 3) slopes of the shape functions along xi, eta, zeta at a point."""
    factors = 1 + CORNERS * point
    return (
        np.stack(
            [CORNERS[:, i] * np.prod(np.delete(factors, i, axis=1), axis=1) for i in range(3)],
            axis=1,
        )
        / 8
    )


def _frame(along, across):
    """(m, 3, 3) with the columns e1, e2, e3."""
    e1 = along / np.linalg.norm(along, axis=1, keepdims=True)
    e2 = across - np.sum(across * e1, axis=1, keepdims=True) * e1
    e2 /= np.linalg.norm(e2, axis=1, keepdims=True)
    return np.stack([e1, e2, np.cross(e1, e2)], axis=2)
