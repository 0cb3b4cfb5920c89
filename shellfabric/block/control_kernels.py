"""The hourglass control of a block: springs with the stiffness of its bricks as they are, which flow
with its material, and the volumes of the corners (equations: docs/theory-panel.md, "Backing block").

The energy of the springs is that of the 2 x 2 x 2 rule in the same mode at any F, times the factor
f: a brick that is flattened to a share s of its height is 1 / s^2 times as stiff (physical
stabilisation: Belytschko and Bindeman 1993, Puso 2000). Their stress q_h is the mean of Mises' over
the points, since the modes are orthogonal to a constant; it relaxes with the flow of the brick
(Prandtl and Reuss, linear about the mean stress). Corners are sub-zonal pressures (Caramana and
Shashkov 1998), which flow does not limit, since J_a is a volume: bricks under a dent fold without.
"""

import math

import numpy as np

from shellfabric.block.brick_kernels import patterns, spread_patterns
from shellfabric.jit.compile import kernel

LEAST_SHARE = 0.05  # J_a / J below which U goes on as a parabola
# of each corner the next ones along the edges, and whether these run forwards
CORNER_NEIGHBOURS = np.array(
    [[1, 3, 4], [0, 2, 5], [3, 1, 6], [2, 0, 7], [5, 7, 0], [4, 6, 1], [7, 5, 2], [6, 4, 3]]
)
CORNER_SIGNS = np.array(
    [
        [1, 1, 1],
        [-1, 1, 1],
        [-1, -1, 1],
        [1, -1, 1],
        [1, 1, -1],
        [-1, 1, -1],
        [-1, -1, -1],
        [1, -1, -1],
    ]
)


@kernel()
def mode_offsets(F, x, shape, q):
    """Compute how far the modes of a brick are from the shape that bears no hourglass force.

    Parameters
    ----------
    F : (3, 3) mean deformation
    x : (8, 3) [m] corners
    shape : (4, 3) [m] c above
    q : (4, 3) [m] filled
    """
    patterns(x, q)
    for m in range(4):
        for d in range(3):
            for i in range(3):
                q[m, d] -= F[d, i] * shape[m, i]


@kernel()
def control_energy(inverse, q, weight, moduli):
    """Compute W [J].

    Parameters
    ----------
    inverse : (3, 3) of the mean deformation
    q : (4, 3) [m] of `mode_offsets`
    weight : (4, 3) [m] w above
    moduli : G, E - G [Pa]
    """
    shear, more = moduli
    energy = 0.0
    for m in range(4):
        length = q[m, 0] ** 2 + q[m, 1] ** 2 + q[m, 2] ** 2
        for c in range(3):
            along = q[m, 0] * inverse[c, 0] + q[m, 1] * inverse[c, 1] + q[m, 2] * inverse[c, 2]
            slope = inverse[c, 0] ** 2 + inverse[c, 1] ** 2 + inverse[c, 2] ** 2
            energy += 0.5 * weight[m, c] * (shear * length * slope + more * along * along)
    return energy


@kernel()
def relax(inverse, keep, q, shape):
    """Let a brick keep a share of its hourglass stress: its shape takes up the rest.

    Parameters
    ----------
    inverse : (3, 3) of the mean deformation
    q, shape : (4, 3) [m] of `mode_offsets`, changed
    """
    for m in range(4):
        for i in range(3):
            for d in range(3):
                shape[m, i] += (1.0 - keep) * inverse[i, d] * q[m, d]
    for m in range(4):
        for d in range(3):
            q[m, d] *= keep


@kernel()
def control_forces(inverse, q, shape, weight, moduli, D, force):
    """Add the forces of the hourglass control, the slopes of W.

    Parameters
    ----------
    inverse, q, weight, moduli : of `control_energy`; q is overwritten
    shape : (4, 3) [m] of `mode_offsets`
    D : (3, 3) [J] added to: what acts through the mean gradients, as volume times P does
    force : (8, 3) [N] what acts through the patterns, added to
    """
    shear, more = moduli
    for c in range(3):
        g0 = inverse[c, 0]
        g1 = inverse[c, 1]
        g2 = inverse[c, 2]
        a0 = a1 = a2 = 0.0  # slope of W over g
        for m in range(4):
            along = more * weight[m, c] * (q[m, 0] * g0 + q[m, 1] * g1 + q[m, 2] * g2)
            length = q[m, 0] ** 2 + q[m, 1] ** 2 + q[m, 2] ** 2
            across = shear * weight[m, c] * length
            a0 += across * g0 + along * q[m, 0]
            a1 += across * g1 + along * q[m, 1]
            a2 += across * g2 + along * q[m, 2]
        for i in range(3):
            back = inverse[i, 0] * a0 + inverse[i, 1] * a1 + inverse[i, 2] * a2
            D[0, i] -= g0 * back
            D[1, i] -= g1 * back
            D[2, i] -= g2 * back
    for m in range(4):
        slope = t0 = t1 = t2 = 0.0
        for c in range(3):
            g0 = inverse[c, 0]
            g1 = inverse[c, 1]
            g2 = inverse[c, 2]
            slope += shear * weight[m, c] * (g0 * g0 + g1 * g1 + g2 * g2)
            along = more * weight[m, c] * (q[m, 0] * g0 + q[m, 1] * g1 + q[m, 2] * g2)
            t0 += along * g0
            t1 += along * g1
            t2 += along * g2
        q[m, 0] = t0 + slope * q[m, 0]
        q[m, 1] = t1 + slope * q[m, 1]
        q[m, 2] = t2 + slope * q[m, 2]
        for d in range(3):
            for i in range(3):
                D[d, i] -= q[m, d] * shape[m, i]
    spread_patterns(q, force)


@kernel()
def kept_share(stress, flow_stress, flowed, stiffness):
    """Compute the share of its hourglass stress that a brick keeps in a step.

    Parameters
    ----------
    stress : [Pa] q_h of the trial
    flow_stress : [Pa] sigma
    flowed : [-] d(alpha) of the step
    stiffness : [Pa] 3 f G
    """
    keep = 1.0 / (1.0 + stiffness * flowed / flow_stress)
    if keep * stress > flow_stress:
        keep = flow_stress / stress
    return keep


@kernel()
def corner_forces(x, swelling, inverse, rest, modulus, scratch, D, force):
    """Add the forces of the volumes of the corners of a brick, the slopes of U; return U [J].

    Parameters
    ----------
    x : (8, 3) [m] corners
    swelling : [-] ln J of the mean deformation
    inverse : (3, 3) of that
    rest : [m3] volume at rest, of a brick with square corners
    modulus : [J] f G V / 8
    scratch : (2, 3, 3) of the edges at a corner, and the slopes of their triple product
    D, force : of `control_forces`, added to
    """
    edges = scratch[0]
    slopes = scratch[1]
    energy = 0.0
    total = 0.0
    expected = rest * math.exp(swelling)
    for a in range(8):
        hand = 1.0
        for i in range(3):
            b = CORNER_NEIGHBOURS[a, i]
            sign = CORNER_SIGNS[a, i]
            hand *= sign
            for d in range(3):
                edges[i, d] = x[b, d] - x[a, d]
        for i in range(3):
            j = (i + 1) % 3
            k = (i + 2) % 3
            for d in range(3):
                e = (d + 1) % 3
                f = (d + 2) % 3
                slopes[i, d] = hand * (edges[j, e] * edges[k, f] - edges[j, f] * edges[k, e])
        share = 0.0
        for d in range(3):
            share += edges[0, d] * slopes[0, d]
        share /= expected
        held = max(share, LEAST_SHARE)
        log = math.log(held)
        # slope of 1/2 ln^2 over the share; below LEAST_SHARE along its tangent and curvature
        slope = log / held
        more = share - held
        curve = (1.0 - log) / (held * held)
        energy += modulus * (0.5 * log * log + slope * more + 0.5 * curve * more * more)
        slope = modulus * (slope + curve * more)
        total += slope * share
        push = slope / expected
        for i in range(3):
            b = CORNER_NEIGHBOURS[a, i]
            for d in range(3):
                force[b, d] += push * slopes[i, d]
                force[a, d] -= push * slopes[i, d]
    for d in range(3):
        for i in range(3):
            D[d, i] -= total * inverse[i, d]
    return energy
