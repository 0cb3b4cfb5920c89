"""The C1 surface near the nodes of a face of a yarn, whose every facet hands each of its corners the
same share.

Along each direction it is the mean of the Catmull-Rom and the uniform cubic B-spline of the nodes:
with t in 0 .. 1 between the two middle nodes of four,

    12 w = 1 - 6 t + 9 t^2 - 4 t^3,  10 - 21 t^2 + 12 t^3,  1 + 6 t + 15 t^2 - 12 t^3,  - 3 t^2 + 4 t^3,

which integrate over a facet to 0, 1/2, 1/2, 0 as linear shape functions do. It is the surface of the
quasi-static crossover (`unitcell3d.contact.surface_kernels`). Beyond its ends it goes straight on;
beyond a symmetry plane it is its own mirror image.
"""

import math

import numpy as np

from shellfabric.jit.compile import kernel

STENCIL = 16  # nodes that shape a facet


@kernel(fastmath={"contract"})
def cubics(t, w, slope):
    """Fill in the weights (4,) of the four nodes at t, and their slopes."""
    w[0] = (1.0 + t * (-6.0 + t * (9.0 - 4.0 * t))) / 12.0
    w[1] = (10.0 + t * t * (-21.0 + 12.0 * t)) / 12.0
    w[2] = (1.0 + t * (6.0 + t * (15.0 - 12.0 * t))) / 12.0
    w[3] = t * t * (-3.0 + 4.0 * t) / 12.0
    slope[0] = (-6.0 + t * (18.0 - 12.0 * t)) / 12.0
    slope[1] = t * (-42.0 + 36.0 * t) / 12.0
    slope[2] = (6.0 + t * (30.0 - 36.0 * t)) / 12.0
    slope[3] = t * (-6.0 + 12.0 * t) / 12.0


@kernel(fastmath={"contract"})
def line_weights(xi, cells, mirrored, w, slope):
    """Fill in the weights (4,) of the nodes cell - 1 .. cell + 2 at xi on a line of `cells` facets,
    and their slopes.

    Beyond an end the line is straight. Its phantom node is the straight continuation, folded back
    into the real ones, or at a mirrored low end the image of node 1.

    Returns
    -------
    cell : the facet
    """
    cell = min(max(math.floor(xi), 0), cells - 1)
    t = xi - cell
    inside = min(max(t, 0.0), 1.0)
    if mirrored and t < 0.0 and cell == 0:
        inside = t
    cubics(inside, w, slope)
    if cell == 0 and not mirrored:
        fold(w, 0, 1, 2)
        fold(slope, 0, 1, 2)
    if cell == cells - 1:
        fold(w, 3, 2, 1)
        fold(slope, 3, 2, 1)
    for m in range(4):
        w[m] += (t - inside) * slope[m]
    return cell


@kernel()
def fold(w, phantom, end, next_one):
    """Hand the weight of a phantom node, twice the last node less the one before, to these."""
    w[end] += 2.0 * w[phantom]
    w[next_one] -= w[phantom]
    w[phantom] = 0.0


@kernel(fastmath={"contract"})
def surface_point(patch, face, xi0, xi1, scratch):
    """Find the point of the surface of a face at (xi0, xi1), and its weights of nodes.

    Parameters
    ----------
    scratch : (nodes, weights, flips, line, S) with nodes : (16,) and weights : (16,) filled; flips :
        (16, 2) filled, -1 where a node is seen in the mirror of the first row along, or across,
        else 1; line : (4, 4); S : (3, 3) filled with S, S_,1, S_,2
    """
    nodes, weights, flips, line, S = scratch
    yarn = face // 2
    nx = patch.nx[yarn]
    ny = patch.ny[yarn]
    stride = patch.nz + 1
    sheet = (ny + 1) * stride
    axial = patch.family[yarn]
    i = line_weights(xi0, nx, patch.quarter == 1, line[0], line[1])
    j = line_weights(xi1, ny, patch.cut[yarn], line[2], line[3])
    for c in range(3):
        S[0, c] = 0.0
        S[1, c] = 0.0
        S[2, c] = 0.0
    for a in range(4):
        along = i + a - 1
        for b in range(4):
            across = j + b - 1
            m = 4 * a + b
            n = patch.face_node[face]
            n += min(abs(along), nx) * sheet + min(abs(across), ny) * stride
            nodes[m] = n
            weights[m] = line[0, a] * line[2, b]
            flips[m, 0] = math.copysign(1.0, along)
            flips[m, 1] = math.copysign(1.0, across)
            for c in range(3):
                x = patch.x[n, c] * sign_of(flips, m, c, axial)
                S[0, c] += weights[m] * x
                S[1, c] += line[1, a] * line[2, b] * x
                S[2, c] += line[0, a] * line[3, b] * x


@kernel()
def sign_of(flips, m, c, axial):
    """Return the sign of component c of a node of the stencil, as its mirror image has it."""
    if c == axial:
        return flips[m, 0]
    if c == 1 - axial:
        return flips[m, 1]
    return 1.0


@kernel()
def make_scratch():
    """Make what `surface_point` fills."""
    return (
        np.empty(STENCIL, np.int64),
        np.empty(STENCIL),
        np.empty((STENCIL, 2)),
        np.empty((4, 4)),
        np.empty((3, 3)),
    )
