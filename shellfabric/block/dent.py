"""A dent in a block against time: how deep it is, and whether it rests.

A test in clay measures the dent that stays, one in clear gel the deepest point that a camera sees.
The two are not the same number: a dent springs back. Both are read off the depth of the deepest
point of the face at the samples of a run.
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


def deepest(face: FloatArray) -> float:
    """Return the depth [m] of the deepest point of a face (nx, ny, 3) [m] of x, y and depth; 0 of
    one that is nowhere below its place at rest."""
    return max(float(face[..., 2].max()), 0.0)


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


def spike(face: FloatArray, mirrors: tuple[bool, bool]) -> float:
    """Compute how far [-] the deepest node of a face stands below the deepest of its neighbours,
    over its depth: near 1 where a single node makes the dent, 0 of a face that is nowhere below.

    Parameters
    ----------
    face : (nx, ny, 3) [m] x, y and depth
    mirrors : whether x = 0 and y = 0 are planes of symmetry, which it goes on beyond
    """
    depth = face[..., 2]
    if depth.max() <= 0:
        return 0.0
    i, j = np.unravel_index(np.argmax(depth), depth.shape)
    around = depth[max(i - 1, 0) : i + 2, max(j - 1, 0) : j + 2].copy()
    around[min(i, 1), min(j, 1)] = -np.inf
    # beyond a plane of symmetry a neighbour on it has its like, the node itself none
    return float(min((depth[i, j] - around.max()) / depth[i, j], 1.0))


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
