"""A block of eight-node bricks with one point, elastic-plastic with erosion, in explicit dynamics
(equations: docs/theory-panel.md, "Backing block"; the return is in `flow_kernels`, hourglass control
in `control_kernels`).

Forces are written for each brick and gathered at each node in a fixed order: threads change no bit
of the result. The linear bulk viscosity takes the least height of a brick as it is: with the one at
rest, flattened bricks would bear far shorter steps than their waves allow.
"""

import math

import numpy as np
from numba import prange

from shellfabric.block.brick_kernels import brick_nodes, mean_deformation
from shellfabric.block.control_kernels import (
    control_energy,
    control_forces,
    corner_forces,
    kept_share,
    mode_offsets,
    relax,
)
from shellfabric.flow_kernels import flow_increment
from shellfabric.jit.compile import entry, kernel

SWEEPS = 12  # of Jacobi's rotations; three or four are enough
# corners
CORNER_OFFSETS = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
)


@kernel()
def rotate_columns(A, pair, turn):
    """Turn two columns of (3, 3) into each other by an angle of these cosine and sine."""
    p, q = pair
    cos, sin = turn
    for k in range(3):
        a = A[k, p]
        b = A[k, q]
        A[k, p] = cos * a - sin * b
        A[k, q] = sin * a + cos * b


@kernel()
def principal(A, n):
    """Diagonalise the symmetric A : (3, 3) by Jacobi's rotations, its eigenvectors as columns of
    n."""
    for c in range(3):
        for d in range(3):
            if c == d:
                n[c, d] = 1.0
            else:
                n[c, d] = 0.0
    for _ in range(SWEEPS):
        off = A[0, 1] ** 2 + A[0, 2] ** 2 + A[1, 2] ** 2
        if off <= 1e-30 * (A[0, 0] ** 2 + A[1, 1] ** 2 + A[2, 2] ** 2):
            return
        for p in range(2):
            for q in range(p + 1, 3):
                if A[p, q] == 0.0:
                    continue
                theta = 0.5 * (A[q, q] - A[p, p]) / A[p, q]
                t = math.copysign(1.0, theta) / (abs(theta) + math.sqrt(theta * theta + 1.0))
                cos = 1.0 / math.sqrt(t * t + 1.0)
                sin = t * cos
                rotate_columns(A, (p, q), (cos, sin))
                rotate_columns(A.T, (p, q), (cos, sin))
                rotate_columns(n, (p, q), (cos, sin))


@kernel()
def inverse(F, G):
    """Invert (3, 3): G = F^-1; return det F."""
    for c in range(3):
        d = (c + 1) % 3
        e = (c + 2) % 3
        for r in range(3):
            s = (r + 1) % 3
            t = (r + 2) % 3
            G[r, c] = F[d, s] * F[e, t] - F[d, t] * F[e, s]
    J = F[0, 0] * G[0, 0] + F[0, 1] * G[1, 0] + F[0, 2] * G[2, 0]
    for c in range(3):
        for r in range(3):
            G[r, c] /= J
    return J


@kernel()
def push_forward(F, C, b):
    """Push forward (3, 3): b += F C F^T."""
    for c in range(3):
        for d in range(3):
            for r in range(3):
                for s in range(3):
                    b[c, d] += F[c, r] * C[r, s] * F[d, s]


@kernel()
def from_principal(values, n, b):
    """Compute the symmetric tensor b of (3, 3) with these principal values, along the columns of
    n."""
    v0, v1, v2 = values
    for c in range(3):
        for d in range(3):
            b[c, d] = v0 * n[c, 0] * n[d, 0] + v1 * n[c, 1] * n[d, 1] + v2 * n[c, 2] * n[d, 2]


@kernel()
def hencky(F, C, alpha, law, viscous, dt, P):
    """Compute the first Piola-Kirchhoff stress, with plastic flow where the trial is outside the
    yield surface.

    With F the mean deformation (`hex8.py`), e_i the principal logarithmic strains and Hencky's
    energy,

        b = F C F^T = sum exp(2 e_i) n_i n_i^T,   tau_i = K tr e + 2 G dev e_i,   P = tau F^-T
        W = K/2 (tr e)^2 + G |dev e|^2

    (Simo and Hughes, Computational Inelasticity, chapters 2 and 9). The return is exact along the
    trial; the rate is that of the step, implicit and so without a bound on it. Plastic and viscous
    work are those of the mean of the stresses before and after a step, which is what its forces do:
    a brick that begins to flow in it was below its strength before.

    Parameters
    ----------
    F : (3, 3)
    C : (3, 3) inverse plastic metric, overwritten
    alpha : effective plastic strain before
    law : BlockLaw
    viscous : [Pa] pressure to be added to the Kirchhoff stress, positive in tension
    dt : [s] since C and alpha were found
    P : (3, 3) [Pa] filled

    Returns
    -------
    stored, work : [J/m3] elastic energy, and plastic work of this call
    alpha : after
    """
    K = law.bulk_modulus
    G = law.shear_modulus
    yields = law.yield_stress
    H = law.hardening
    b = np.zeros((3, 3))
    n = np.empty((3, 3))
    Fi = np.empty((3, 3))
    push_forward(F, C, b)
    principal(b, n)
    e0 = 0.5 * math.log(b[0, 0])
    e1 = 0.5 * math.log(b[1, 1])
    e2 = 0.5 * math.log(b[2, 2])
    trace = e0 + e1 + e2
    d0 = e0 - trace / 3.0
    d1 = e1 - trace / 3.0
    d2 = e2 - trace / 3.0
    size = math.sqrt(d0 * d0 + d1 * d1 + d2 * d2)
    q = 2.0 * G * math.sqrt(1.5) * size
    work = 0.0
    inverse(F, Fi)
    if q > yields + H * alpha:
        step = flow_increment(q, yields + H * alpha, law, dt)
        if law.rate_exponent == 0.0:
            work = (yields + H * (alpha + 0.5 * step)) * step
        else:
            work = (q - 3.0 * G * step) * step
        alpha += step
        keep = 1.0 - 3.0 * G * step / q
        d0 = keep * d0
        d1 = keep * d1
        d2 = keep * d2
        size = keep * size
        m0 = math.exp(2.0 * (d0 + trace / 3.0))
        m1 = math.exp(2.0 * (d1 + trace / 3.0))
        m2 = math.exp(2.0 * (d2 + trace / 3.0))
        from_principal((m0, m1, m2), n, b)
        C[:] = 0.0
        push_forward(Fi, b, C)
    p = K * trace + viscous
    t0 = p + 2.0 * G * d0
    t1 = p + 2.0 * G * d1
    t2 = p + 2.0 * G * d2
    from_principal((t0, t1, t2), n, b)
    for c in range(3):
        for r in range(3):
            P[c, r] = b[c, 0] * Fi[r, 0] + b[c, 1] * Fi[r, 1] + b[c, 2] * Fi[r, 2]
    return 0.5 * K * trace * trace + G * size * size, work, alpha


@kernel()
def least_height(inverse, edges):
    """Compute the least distance [m] between opposite faces of a brick of these edges at rest :
    (3,), from the inverse of F."""
    least = np.inf
    for i in range(3):
        square = inverse[i, 0] ** 2 + inverse[i, 1] ** 2 + inverse[i, 2] ** 2
        least = min(least, edges[i] / math.sqrt(square))
    return least


@kernel()
def forces_slice(i, block, dt):
    """Compute the forces of the bricks i along x: see `forces`."""
    law = block.law
    nodes = np.empty(8, np.int64)
    places = np.empty((8, 3))
    F = np.empty((3, 3))
    Fi = np.empty((3, 3))
    P = np.empty((3, 3))
    D = np.empty((3, 3))
    offsets = np.empty((4, 3))
    scratch = np.empty((2, 3, 3))
    shear = law.shear_modulus
    young = 9.0 * law.bulk_modulus * shear / (3.0 * law.bulk_modulus + shear)
    moduli = (shear, young - shear)
    stiff = 3.0 * block.hourglass_factor * shear
    per_time = 0.0
    if dt > 0.0:
        per_time = 1.0 / dt
    for j in range(block.ny):
        for k in range(block.nz):
            m = (i * block.ny + j) * block.nz + k
            if block.gone[m]:
                continue
            own = block.own[m]
            volume = block.volume[m]
            gradient = block.gradient[m]
            brick_nodes(0, i, j, k, block.ny, block.nz, nodes)
            for a in range(8):
                for c in range(3):
                    places[a, c] = block.x[nodes[a], c]
                    own[a, c] = 0.0
            mean_deformation(places, gradient, F)
            J = inverse(F, Fi)
            if not J > 0.0:
                block.elastic_energy[m] = np.nan
                continue
            swell = math.log(J)
            rate = (swell - block.last_swelling[m]) * per_time
            before = block.alpha[m]
            viscous = law.bulk_viscosity * least_height(Fi, block.edges[m]) * rate
            stored, work, alpha = hencky(F, block.metric[m], before, law, viscous, dt, P)
            # the distortion's share of what is stored gives the stress: q^2 / 6 G
            distorting = max(stored - 0.5 * law.bulk_modulus * swell * swell, 0.0)
            mises = math.sqrt(6.0 * shear * distorting)
            flow_stress = law.yield_stress + law.hardening * alpha
            if alpha > before:
                work = 0.5 * (min(block.last_mises[m], mises) + mises) * (alpha - before)
                flow_stress = max(flow_stress, mises)
            damped = 0.5 * (block.last_pressure[m] + viscous) * rate * dt
            block.alpha[m] = alpha
            block.last_swelling[m] = swell
            block.last_pressure[m] = viscous
            block.last_mises[m] = mises
            shape = block.shape[m]
            weight = block.control[m]
            mode_offsets(F, places, shape, offsets)
            held = control_energy(Fi, offsets, weight, moduli)
            twisting = math.sqrt(2.0 * stiff * held / volume)
            keep = kept_share(twisting, flow_stress, alpha - before, stiff)
            if keep < 1.0:
                relax(Fi, keep, offsets, shape)
                held *= keep * keep
                now = keep * twisting
                last = math.sqrt(2.0 * stiff * block.hourglass_energy[m] / volume)
                work += 0.5 * (min(last, now) + now) * (twisting - now) / stiff
            D[:] = 0.0
            control_forces(Fi, offsets, shape, weight, moduli, D, own)
            modulus = stiff * volume / 24.0
            corners = corner_forces(places, swell, Fi, volume, modulus, scratch, D, own)
            block.plastic_work[m] += volume * work
            block.viscous_work[m] += volume * damped
            if alpha >= law.erosion_strain:
                block.gone[m] = True
                # its stress does no work any more, so half of the last step's was never done
                kept = block.elastic_energy[m] + block.hourglass_energy[m] + block.corner_energy[m]
                now = volume * stored + held + corners
                rise = now + volume * (work + damped) - kept
                block.lost_by_erosion[m] = now - 0.5 * rise
                block.elastic_energy[m] = block.hourglass_energy[m] = block.corner_energy[m] = 0.0
                own[:] = 0.0
                continue
            block.elastic_energy[m] = volume * stored
            block.hourglass_energy[m] = held
            block.corner_energy[m] = corners
            for a in range(8):
                for c in range(3):
                    for r in range(3):
                        own[a, c] += (volume * P[c, r] + D[c, r]) * gradient[a, r]


@entry(parallel=True)
def forces(block, dt):
    """Compute the internal forces of every brick, into block.own, and its energies, at the places
    of now.

    dt : [s] since the last call
    """
    for i in prange(block.nx):
        forces_slice(i, block, dt)


@kernel()
def move_slice(i, block, kick, dt):
    """Move the nodes i along x by a step: see `move`."""
    nx = block.nx
    ny = block.ny
    nz = block.nz
    kinetic = lost = taken = ahead = impulse = 0.0
    for j in range(ny + 1):
        for k in range(nz + 1):
            n = (i * (ny + 1) + j) * (nz + 1) + k
            mass = block.mass[n]
            for c in range(3):
                total = block.outer[n, c] + block.drags[n, c]
                for a in range(8):
                    # the brick of which this node is the corner a
                    p = i - CORNER_OFFSETS[a, 0]
                    q = j - CORNER_OFFSETS[a, 1]
                    r = k - CORNER_OFFSETS[a, 2]
                    if 0 <= p < nx and 0 <= q < ny and 0 <= r < nz:
                        m = (p * ny + q) * nz + r
                        if not block.gone[m]:
                            total += block.own[m, a, c]
                dashpot = block.dashpot[n, c]
                lag = 0.5 * kick * dashpot / mass
                before = block.v[n, c]
                pushed = (1.0 - lag) * before - kick * total / mass
                after = block.free[n, c] * pushed / (1.0 + lag)
                mean = 0.5 * (before + after)
                kinetic += 0.5 * mass * mean * mean
                lost += kick * dashpot * mean * mean
                pressed = kick * (block.outer[n, c] + block.drags[n, c])
                taken += pressed * mean
                ahead += 0.5 * pressed * after
                if c == 2 and (block.free[n, c] == 0.0 or dashpot > 0.0):
                    impulse += mass * (before - after) - kick * total
                block.v[n, c] = after
                block.x[n, c] += dt * after
    block.kinetic_energy[i] = kinetic
    block.dashpot_work[i] += lost
    block.contact_work[i] += taken
    block.contact_work_ahead[i] = ahead
    block.outer_impulse[i] += impulse


@entry(parallel=True)
def move(block, kick, dt):
    """Update velocities over `kick` [s] and positions over `dt` [s], by the forces of bricks and
    contacts; work of these, by the sheets of nodes."""
    for i in prange(block.nx + 1):
        move_slice(i, block, kick, dt)
