"""A dent in a block against time: how deep it is, and whether it rests.

A test in clay measures the dent that stays, one in clear gel the deepest point that a camera sees.
The two are not the same number: a dent springs back. Both are read off the depth that a gauge finds
at the samples of a run: the greatest mean over a disc. A single node is no measurement: with bricks
of 2, 1 and 0.75 mm behind one shot the deepest one stood at 5.52, 4.57 and 4.25 mm, where the mean
over such a disc was 3.34, 3.13 and 3.07 mm.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base import sums
from fabrics.base.checks import FloatArray
from shellfabric.block.control_kernels import CORNER_NEIGHBOURS, CORNER_SIGNS

if TYPE_CHECKING:
    from shellfabric.block.block import Block

# share of the energy that a block has taken up: about a dent, motion with less does not change it.
# Further out the whole block may go on swinging between its held faces, and does
AT_REST = 0.01
ABOUT = 2.0  # radii of the dent within which this motion counts
# share of its greatest depth by which a dent at rest may still change in the time in which a shear
# wave crosses it: springing back is shear, and a dent that turns is without motion for a moment
STILL = 0.05
# [m] least radius of the disc of a gauge. Behind a pack it is as wide as the nose (`disc_radius`); on
# a bare face a disc as wide as a ball would miss the ball's own dent
GAUGE = 5e-3
_PARTS = 8  # along a side of a facet of the face, whose middles are in the disc or not


def deepest(face: FloatArray) -> float:
    """Return the depth [m] of the deepest point of a face (nx, ny, 3) [m] of x, y and depth; 0 of
    one that is nowhere below its place at rest."""
    return max(float(face[..., 2].max()), 0.0)


def disc_radius(nose: float) -> float:
    """Return the radius [m] of the disc that gauges the dent behind a pack, struck by a nose of a
    radius [m]."""
    return max(GAUGE, nose)


def gauge(face: FloatArray, mirrors: tuple[bool, bool], radius: float = GAUGE) -> float:
    """Compute the depth [m] that a gauge finds: the greatest mean over the area, seen along the
    flight, of its disc; 0 of a face that is nowhere below its place at rest.

    Its centre is a node within a radius of the deepest one, found by the middles of the facets, or
    the deepest node itself where that reads more. Which node is deepest is chance: under one nose it
    changes from sample to sample, and a disc about it read up to 34 % less than the greatest.

    Parameters
    ----------
    face : (nx, ny, 3) [m] x, y and depth, which is bilinear in each facet
    mirrors : whether x = 0 and y = 0 are planes of symmetry, which it goes on beyond
    radius : [m] of the disc
    """
    if face[..., 2].max() <= 0:
        return 0.0
    deepest_node = face[np.unravel_index(np.argmax(face[..., 2]), face.shape[:2])][:2]
    images = np.array([(1, 1), (-1, 1), (1, -1), (-1, -1)])
    seen = images[[all(np.where(image < 0, mirrors, True)) for image in images]]
    best = _best_centre(face, deepest_node, seen, radius)
    return max(_disc_mean(face, centre, seen, radius) for centre in (deepest_node, best))


def _best_centre(face, deepest_node, seen, radius):
    """The node (2,) [m] within a radius [m] of the deepest about which the middles of the facets
    within it are deepest on average; the deepest one where no disc holds a middle."""
    nodes = face[..., :2].reshape(-1, 2)
    centres = nodes[np.hypot(*(nodes - deepest_node).T) <= radius]
    middles = 0.25 * (face[:-1, :-1] + face[1:, :-1] + face[:-1, 1:] + face[1:, 1:]).reshape(-1, 3)
    across = (face[1:, 1:] - face[:-1, :-1])[..., :2].reshape(-1, 2)
    along = (face[:-1, 1:] - face[1:, :-1])[..., :2].reshape(-1, 2)
    area = 0.5 * np.abs(across[:, 0] * along[:, 1] - across[:, 1] * along[:, 0])
    near = np.abs(middles[:, :2] - deepest_node).max(axis=1) <= 2 * radius
    middles = middles[near]
    weight = np.zeros((len(centres), len(middles)))
    for image in seen:
        apart = middles[:, :2] * image - centres[:, None]
        weight += np.hypot(apart[..., 0], apart[..., 1]) <= radius
    weight *= area[near]
    total = weight.sum(axis=1)
    if not total.any():
        return deepest_node
    depth = np.sum(weight * middles[:, 2], axis=1)
    mean = np.divide(depth, total, out=np.zeros_like(total), where=total > 0)
    return centres[np.argmax(mean)]


def _disc_mean(face, centre, seen, radius):
    """Mean depth [m] of a face over a disc of a radius [m] about a centre (2,) [m], by _PARTS x
    _PARTS points in each facet and its images (k, 2); 0 above the plane, and the depth of the
    deepest node where no point is in the disc."""
    corners = face[:-1, :-1], face[1:, :-1], face[:-1, 1:], face[1:, 1:]
    nearest = np.min([np.abs(corner[..., :2] - centre).max(axis=-1) for corner in corners], axis=0)
    sides = max(float(np.abs(np.diff(face[..., :2], axis=axis)).max()) for axis in (0, 1))
    c00, c10, c01, c11 = (corner[nearest <= radius + sides][:, None] for corner in corners)
    at = (np.arange(_PARTS) + 0.5) / _PARTS
    s, t = (place.reshape(1, -1, 1) for place in np.meshgrid(at, at))
    points = (1 - s) * ((1 - t) * c00 + t * c01) + s * ((1 - t) * c10 + t * c11)
    along = (1 - t) * (c10 - c00) + t * (c11 - c01)
    across = (1 - s) * (c01 - c00) + s * (c11 - c10)
    area = np.abs(along[..., 0] * across[..., 1] - along[..., 1] * across[..., 0])
    within = sum(np.hypot(*(points[..., :2] * image - centre).T).T <= radius for image in seen)
    weight = area * within
    if not weight.any():
        return deepest(face)
    return max(float(np.sum(weight * points[..., 2]) / np.sum(weight)), 0.0)


def change(time: FloatArray, depth: FloatArray, window: float) -> float:
    """Compute the change [-] of a dent over the last `window` [s], from its highest to its lowest
    depth, over the greatest of all time.

    Parameters
    ----------
    time, depth : (n,) [s], [m]; NaN where they do not reach back that far
    """
    if time[-1] - time[0] < window:
        return float("nan")
    if depth.max() <= 0:
        return 0.0
    last = depth[time >= time[-1] - window]
    return float((last.max() - last.min()) / depth.max())


def at_rest(motion: float, time: FloatArray, depth: FloatArray, window: float) -> bool:
    """Tell whether a dent rests: what is about it moves with less than AT_REST of the energy that
    the block has taken up, and its depth has changed by less than STILL.

    Parameters
    ----------
    motion : [-] of `motion_about`
    time, depth, window : of `change`
    """
    return bool(motion <= AT_REST and change(time, depth, window) <= STILL)


def motion_about(block: Block, radius: float) -> float:
    """Compute the kinetic energy [-] within ABOUT radii [m] of the axis and below as much of the
    face, at rest, over all energy that the block has taken up; 0 of a block that has taken none."""
    taken = sum(block.energies().values())
    if taken <= 0:
        return 0.0
    reach = ABOUT * radius
    below = block.rest[:, 2] - block.backing.standoff
    near = (np.hypot(*block.rest[:, :2].T) <= reach) & (below <= reach)
    speed = np.sum(block.v[near] ** 2, axis=1)
    return 0.5 * sums.dot(block.mass[near], speed) / taken


def floor_brick(face: FloatArray, radius: float) -> float:
    """Compute the longest edge seen along the flight of the facets at the deepest node of a face
    (nx, ny, 3) [m], over the radius [m] of the dent."""
    i, j = np.unravel_index(np.argmax(face[..., 2]), face.shape[:2])
    part = face[max(i - 1, 0) : i + 2, max(j - 1, 0) : j + 2, :2]
    edges = [np.linalg.norm(np.diff(part, axis=axis), axis=-1).max(initial=0.0) for axis in (0, 1)]
    if radius <= 0:
        return 0.0
    return float(max(edges) / radius)


def folding(block: Block) -> float:
    """Compute the largest share [-] of its part of a brick's volume that a corner has lost: the
    triple product of its edges against the brick's mean deformation. Above 1 the corner is turned
    inside out and the brick folded, of which its mean deformation knows nothing."""
    x = block.x[block.bricks[~block.gone]]
    edges = x[:, CORNER_NEIGHBOURS] - x[:, :, None]  # bricks, corners, edges, axes
    triple = np.prod(CORNER_SIGNS, axis=1) * sums.determinant(edges)
    mean = sums.determinant(np.einsum("bac,bai->bci", x, block.row.gradient[~block.gone]))
    at_rest = block.row.volume[~block.gone]
    shares = triple / (mean * at_rest)[:, None]
    return float(1.0 - shares.min(initial=1.0))


def crossing(block: Block) -> float:
    """Compute how far [m] a node has come across a plane of symmetry, beyond which the block is
    its own mirror image; 0 where none has."""
    found = 0.0
    for axis, mirrored in enumerate(block.backing.mirrors):
        if mirrored:
            found = max(found, -float(block.x[:, axis].min()))
    return found


def held_motion(block: Block) -> float:
    """Compute the largest displacement [m] of the nodes a brick away from faces that are held; 0 of
    a block whose faces are not."""
    if block.backing.outer_boundary != "fixed":
        return 0.0
    nodes = block.nodes
    beside = [nodes[-2], nodes[:, -2], nodes[:, :, -2]]
    for axis, mirrored in enumerate(block.backing.mirrors):
        if not mirrored:
            beside.append(np.take(nodes, 1, axis))
    chosen = np.concatenate([part.ravel() for part in beside])
    moved = np.sum((block.x[chosen] - block.rest[chosen]) ** 2, axis=1)
    return float(np.sqrt(moved.max()))


def covered(panel: Any) -> float:
    """Compute the share [-] of the face of a block that lies under a panel all of whose sides are
    held, and which keeps down the rim of a dent; 0 where a side is free."""
    if any(side == "free" for pair in panel.supports for side in pair):
        return 0.0
    across, along = panel.opening
    area = across * along * (np.pi / 4 if panel.round else 1.0)
    return float(area / (panel.backing.size[0] * panel.backing.size[1]))
