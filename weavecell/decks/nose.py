"""Mesh of the projectile's surface in quadrilaterals alone, as that of a box drawn on the body: it
has no pole.

A square grid on the nose and one on the rear, their sides bowed towards a circle, are joined by
rings of four times as many elements as the grid has along a side. No node belongs to more than four
elements. A pole would: a contact by penalties adds the stiffness of all elements that hold the
touching point.

A place on the surface is (arc, turn): length from the tip along the meridian at turn 0, angle about
the axis. The rings are closer together where that meridian bends.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import map_coordinates

from fabrics.base.checks import FloatArray, IntArray
from shellfabric.projectile.projectile import Projectile
from shellfabric.projectile.shapes import SHAPES

# Least and most elements along a side of the grid; one more if an element, not a node, is to face
# the middle.
_LEAST = 6
_MOST = 24
# [radii] arc from the tip to the sides of the square grid
_GRID = 0.5
# [radii] arc from the tip to the first ring that is a circle
_ROUND = 0.875
# the meridian may turn by so much within one element
_BEND = np.radians(45)
# samples of the surface from the tip to the side
_RAYS = 101
# samples of the surface about the axis
_TURNS = 145


def mesh(shot: Projectile, size: float) -> tuple[FloatArray, IntArray]:
    """Mesh the nose: points (n, 3) [m] about it, and quadrilaterals (m, 4) of their numbers from 0,
    anticlockwise from outside.

    Parameters
    ----------
    shot : Projectile
    size : [m] of the fabric's elements, which those of the projectile have within _LEAST and _MOST
        along the grid
    """
    n = int(np.clip(np.ceil(0.5 * np.pi * shot.radius / size), _LEAST, _MOST)) // 2 * 2 + (
        not SHAPES[shot.shape].pointed
    )
    surface = shot.surface(rise=_RAYS, around=_TURNS)
    arc, measure = _meridian(surface[:, 0], 0.5 * np.pi * shot.radius / n)
    grid_arc = _GRID * shot.radius
    total = arc[-1]
    first, last = np.interp([grid_arc, total - grid_arc], arc, measure)
    rings = np.interp(np.linspace(first, last, 2 + int(last - first)), measure, arc)[1:-1]
    side = np.linspace(-1, 1, n + 1)
    square = np.stack(np.meshgrid(side, side, indexing="ij"), axis=-1).reshape(-1, 2)
    number = np.arange(len(square)).reshape(n + 1, n + 1)
    rim = np.concatenate(
        [number[:-1, 0], number[-1, :-1], number[:0:-1, -1], number[0, :0:-1]]
    )  # anticlockwise
    # nodes: of the front grid, of the rings, of the rear grid
    drawn = [
        (square, grid_arc),
        *((square[rim], ring) for ring in rings),
        (square, total - grid_arc),
    ]
    place, turn = np.hstack([_map_to_arc(points, at, total, shot.radius) for points, at in drawn])
    sample = (
        np.interp(place, arc, np.arange(len(arc))),
        turn % (2 * np.pi) * (_TURNS - 1) / (2 * np.pi),
    )
    points = np.stack(
        [map_coordinates(component, sample, order=1) for component in np.moveaxis(surface, 2, 0)],
        axis=1,
    )
    # elements: of the front grid, between two loops of nodes each, of the rear grid
    rear = len(square) + len(rings) * len(rim)
    loops = np.vstack([rim, np.arange(len(square), rear).reshape(-1, len(rim)), rear + rim])
    ahead = np.roll(loops, -1, axis=1)
    face = np.stack(
        [number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1
    ).reshape(-1, 4)
    around = np.stack([loops[:-1], loops[1:], ahead[1:], ahead[:-1]], axis=-1).reshape(-1, 4)
    return points, np.vstack([face, around, rear + face[:, ::-1]])


def _meridian(line: FloatArray, size: float) -> tuple[FloatArray, FloatArray]:
    """(n,) arc length [m] along a line (n, 3), and elements along it: of a size, and of a bend of
    at most _BEND."""
    steps = np.diff(line, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    moving = lengths > 0
    along = steps[moving] / lengths[moving, None]
    bends = np.zeros(len(lengths))
    bends[np.flatnonzero(moving)[1:]] = np.arccos(
        np.clip((along[1:] * along[:-1]).sum(axis=1), -1, 1)
    )
    return np.append(0, np.cumsum(lengths)), np.append(0, np.cumsum(lengths / size + bends / _BEND))


def _map_to_arc(square: FloatArray, arc: float, total: float, radius: float) -> FloatArray:
    """(2, n) arc and turn of points (n, 2) of the square [-1, 1]^2 whose sides lie at an arc, of
    nose or rear.

    From the sides of the grid to the first circle, the square turns into the circle of the same
    angles.
    """
    x, y = square.T
    wide = np.abs(x) >= np.abs(y)
    angle = (
        0.25
        * np.pi
        * np.where(wide, y / np.where(wide & (x != 0), x, 1), 2 - x / np.where(wide, 1, y))
    )
    circle = np.where(wide, x, y) * np.array([np.cos(angle), np.sin(angle)])
    near = min(arc, total - arc)
    share = np.interp(near / radius, [_GRID, _ROUND], [0.5, 1.0])
    x, y = near * ((1 - share) * square.T + share * circle)
    place = np.hypot(x, y)
    return np.array([place if arc < 0.5 * total else total - place, np.arctan2(y, x)])
