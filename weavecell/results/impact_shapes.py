"""What records of an impact hold besides histories: shapes of the fabric, cuts through it, and peak
tensions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from fabrics.base.checks import FloatArray

if TYPE_CHECKING:
    from shellfabric.loop.snapshots import Snapshot
    from shellfabric.membrane.model import Panel
    from shellfabric.metal.body import MetalHistory

_GRIDS = (
    "nodes",
    "tension",
    "failed",
    "pressure",
    "area",
    "failed_segments",
)  # of nodes or elements
# of resolved yarns; a ply without them has none
OF_YARNS = ("yarn_surface", "yarn_tension", "yarn_family", "resolved")


@dataclass(frozen=True)
class Shape:
    """The panel at one instant.

    Parameters
    ----------
    time, nose_position : [s, m] and the foremost point of the projectile
    projectile_position : (3,) [m] position of its nose
    nodes : (k, 3) [m]
    tension : (m, 2) [N] of warp and weft
    failed : (m, 3) bool: warp failed, weft failed, element eroded
    pressure, area, failed_segments : of the nodes, (k, ...), as in a Snapshot
    yarn_surface, yarn_tension, yarn_family, resolved : of resolved yarns, as in a Snapshot, the last
        (m,); empty of a ply without them
    """

    time: float
    nose_position: float
    projectile_position: np.ndarray
    nodes: np.ndarray
    tension: np.ndarray
    failed: np.ndarray
    pressure: np.ndarray
    area: np.ndarray
    failed_segments: np.ndarray
    yarn_surface: np.ndarray = field(default_factory=lambda: np.empty((0, 0, 3)))
    yarn_tension: np.ndarray = field(default_factory=lambda: np.empty(0))
    yarn_family: np.ndarray = field(default_factory=lambda: np.empty(0, np.int8))
    resolved: np.ndarray = field(default_factory=lambda: np.empty(0, bool))

    @classmethod
    def from_snapshot(cls, shot: Snapshot) -> Shape:
        """Take the shape of a `shellfabric.loop.snapshots.Snapshot`."""
        grids = {name: getattr(shot, name) for name in _GRIDS}
        flat = {}
        for name, grid in grids.items():
            flat[name] = grid.reshape(-1, *grid.shape[2:])
        for name in OF_YARNS:
            flat[name] = getattr(shot, name)
        flat["resolved"] = shot.resolved.ravel()
        return cls(float(shot.t), float(shot.nose_position), shot.projectile_position, **flat)


@dataclass(frozen=True)
class Cut:
    """The fabric cut open along x through the impact point, at one instant.

    Parameters
    ----------
    time, nose_position : [s, m] and the foremost point of the projectile
    lines : tuple of (n, 2) [m] places x and z of each ply's middle surface; not a number where its
        yarn has failed
    body, plastic : of a projectile of metal, as in a Snapshot; of another body empty
    face : (nx + 1, ny + 1, 3) [m] nodes of the face of the block behind the last ply, as far as it
        is modelled; without a block empty
    """

    time: float
    nose_position: float
    lines: tuple
    body: np.ndarray = field(default_factory=lambda: np.empty((0, 2)))
    plastic: np.ndarray = field(default_factory=lambda: np.empty(0))
    face: np.ndarray = field(default_factory=lambda: np.empty((0, 0, 3)))

    @classmethod
    def from_snapshots(cls, shots: Sequence[Snapshot], panels: Sequence[Panel]) -> Cut:
        """Cut the plies' `shellfabric.loop.snapshots.Snapshot` of one instant along x at rest."""
        lines = []
        for shot, panel in zip(shots, panels):
            j = panel.nearest_lines[1]
            line = shot.nodes[:, j, [0, 2]]
            gone = np.flatnonzero(shot.failed[:, j, 0])
            if panel.ply_angle:
                line, gone = _cut_turned_ply(shot, panel)
            # beyond the opening it has no length
            long = np.flatnonzero(np.abs(np.diff(line, axis=0)).max(axis=1) > 1e-9)
            line = line[long[0] : long[-1] + 2]
            gone = gone[(gone >= long[0]) & (gone <= long[-1])] - long[0]
            lines.append(np.insert(line, gone + 1, np.nan, axis=0))
        first = shots[0]
        more = {name: getattr(first, name) for name in ("body", "plastic", "face")}
        return cls(float(first.t), float(first.nose_position), tuple(lines), **more)

    @property
    def face_line(self) -> FloatArray:
        """(n, 2) [m] places x and z of the face of the block at y = 0; empty without one."""
        if not self.face.size:
            return np.empty((0, 2))
        # rows along x, of which that through the impact point moves in its plane
        row = int(np.argmin(np.abs(self.face[..., 1]).max(axis=0)))
        line = self.face[:, row, [0, 2]]
        if np.abs(self.face[:, row, 1]).max() < 1e-3 * np.ptp(line[:, 0]):
            return line
        # a block at an angle to the frame of the pack
        from scipy.interpolate import LinearNDInterpolator

        points = self.face.reshape(-1, 3)
        reach = float(np.abs(points[:, 0]).max())
        x = np.linspace(-reach, reach, 4 * len(self.face))
        z = LinearNDInterpolator(points[:, :2], points[:, 2])(x, 0 * x)
        inside = np.isfinite(z)
        return np.column_stack([x[inside], z[inside]])


@dataclass(frozen=True)
class TurnedBody:
    """A projectile of metal at one instant.

    Parameters
    ----------
    drawn : shellfabric.metal.body.MetalHistory, which has its elements and their places at rest
    nodes : (n, 2) [m] r and z, its foremost point at z = 0
    plastic : (elements,) effective plastic strain
    place : (3,) [m] of its foremost point
    """

    drawn: MetalHistory
    nodes: np.ndarray
    plastic: np.ndarray
    place: np.ndarray

    @property
    def strain(self) -> np.ndarray:
        """(elements,) [-] equivalent logarithmic strain (2/3 e:e)^(1/2), elastic and plastic, of the
        deviator e of Hencky's strain at the middle of each element.

        Not that which accumulates: an element that is stretched and pressed back has none.
        """
        rest = self.drawn.rest[self.drawn.corners]
        now = self.nodes[self.drawn.corners]
        # diagonals of the quadrilaterals: F maps those at rest on those of now
        at_rest, as_is = (
            np.stack([x[:, 2] - x[:, 0], x[:, 3] - x[:, 1]], axis=-1) for x in (rest, now)
        )
        gradient = as_is @ np.linalg.inv(at_rest)
        stretches = np.linalg.svd(gradient, compute_uv=False)
        hoop = now[..., 0].mean(axis=1) / rest[..., 0].mean(axis=1)
        logarithms = np.log(np.column_stack([stretches, hoop]))
        deviator = logarithms - logarithms.mean(axis=1, keepdims=True)
        return np.sqrt(2 / 3 * np.sum(deviator**2, axis=1))


def _cut_turned_ply(shot, panel):
    """((n, 2) [m] places x and z of a turned ply along x at rest, from grid line to grid line,
    numbers of those after which a yarn of the element has failed)."""
    from scipy.interpolate import RegularGridInterpolator

    lines = panel.lines()
    # a step along x in the ply's own frame
    way = panel.axes[:, 0]
    at = np.unique(np.concatenate([line / step for line, step in zip(lines, way)]))
    inside = [(at * step >= line[0]) & (at * step <= line[-1]) for line, step in zip(lines, way)]
    at = at[inside[0] & inside[1]]
    middle = [
        np.searchsorted(line, 0.5 * (at[1:] + at[:-1]) * step) - 1 for line, step in zip(lines, way)
    ]
    places = RegularGridInterpolator(lines, shot.nodes[..., [0, 2]])(np.multiply.outer(at, way))
    return places, np.flatnonzero(shot.failed[middle[0], middle[1], :2].any(axis=1))


@dataclass(frozen=True)
class Peak:
    """The highest tension of a family of yarns, as mean over a segment from crossover to crossover.

    Parameters
    ----------
    tension, share : [N, -] and over the strength
    time : [s]
    place : (2,) [m] of the middle of the segment at rest, along warp and weft from the impact point
    ply : number of the ply, the first is 1
    """

    tension: float
    share: float
    time: float
    place: np.ndarray
    ply: int
