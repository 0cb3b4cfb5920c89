"""A projectile's body of any shape: its surface, and its signed distance sampled on a regular grid.

Between the samples the distance is that of tricubic B-splines through them (`sdf_kernels.sampled`),
whose first and second derivatives are continuous. The grid is symmetric about the axis.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from fabrics.base.checks import FloatArray

MARGIN = 2  # samples beyond the body on each side
_SIDES = 16
_NEAR, _EVEN = (
    3.0,
    0.3,
)  # [spacings] from the surface, within which two mirrored distances are the same


def volume(points: FloatArray, faces: np.ndarray) -> float:
    """Compute the volume [m3] within a closed surface of triangles (m, 3) of points (n, 3) [m];
    negative if they face inwards."""
    a, b, c = points[faces.T]
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


@dataclass(frozen=True)
class Solid:
    """A closed surface of triangles and its signed distance, the axis along z, the foremost point
    at z = 0.

    Parameters
    ----------
    digest : of what it was made from, by which two are the same
    spacing : [m] of the samples
    points : (n, 3) [m] corners of the surface
    faces : (m, 3) corners of its triangles, counterclockwise seen from outside
    distances : (i, j, k) [m] signed distance at the samples, `axes`; i and j odd
    """

    digest: str
    spacing: float
    points: FloatArray = field(compare=False, repr=False)
    faces: np.ndarray = field(compare=False, repr=False)
    distances: FloatArray = field(compare=False, repr=False)

    @staticmethod
    def axes(points: FloatArray, spacing: float) -> tuple[FloatArray, ...]:
        """Return the places (i,), (j,), (k,) [m] of samples that reach beyond points (n, 3) [m] of
        a surface."""
        half = [int(np.ceil(np.abs(points[:, c]).max() / spacing)) + MARGIN for c in (0, 1)]
        back = int(np.ceil(-points[:, 2].min() / spacing)) + MARGIN
        return (
            *(spacing * np.arange(-n, n + 1) for n in half),
            spacing * np.arange(-back, MARGIN + 1),
        )

    @cached_property
    def form(self) -> FloatArray:
        """The numbers that `sdf_kernels.sampled` needs."""
        from scipy import ndimage

        first = [axis[0] for axis in self.axes(self.points, self.spacing)]
        splines = ndimage.spline_filter(self.distances, order=3, mode="mirror")
        return np.concatenate([first, [1 / self.spacing], self.distances.shape, splines.ravel()])

    @cached_property
    def radius(self) -> float:
        """[m] of the cylinder about the axis that holds it."""
        return float(np.hypot(*self.points[:, :2].T).max())

    @property
    def length(self) -> float:
        """[m] along the axis."""
        return float(-self.points[:, 2].min())

    @cached_property
    def shoulder(self) -> float:
        """[m] depth behind the nose from which it has its full width, but for a thousandth, on all
        of its sides."""
        x, y, z = self.points.T
        r = np.hypot(x, y)
        side = np.floor(_SIDES * np.arctan2(y, x) / (2 * np.pi))
        sides = [side == one for one in np.unique(side)]
        return max(float(-z[one & (r >= 0.999 * r[one].max())].max()) for one in sides)

    @cached_property
    def even(self) -> tuple[bool, bool]:
        """Whether it is its own mirror image in the plane x = 0, and in y = 0."""
        d = self.distances
        near = np.abs(self.distances) < _NEAR * self.spacing
        off = [np.abs(d - np.flip(d, axis))[near].max() for axis in (0, 1)]
        return off[0] < _EVEN * self.spacing, off[1] < _EVEN * self.spacing
