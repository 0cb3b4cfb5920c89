"""The fabric element: one quadrilateral, warp along i and weft along j, total Lagrangian, one point (see `panel`).

Displacements, not positions, are stored, so that cloth at rest is exactly at rest. At the centre of an element

    a = e_x + du/dX along the warp,   b = e_y + du/dY along the weft      are the yarn vectors themselves,
    Lambda1 = |a|,  Lambda2 = |b|,  sin(gamma) = a.b / |a||b|            (for eqs. 4-36 to 4-45; errata E-12, E-13)

and the forces on its four nodes are the derivatives of its energy

    E = n W(Lambda1, Lambda2) + V U(sin gamma) + k_h |h|^2 / 2

W of the n crossovers in the element, U = integral of the trellis stress over gamma (eq. 4-35 as a total, odd function,
erratum E-11), h = u00 - u10 - u01 + u11 the hourglass vector. Added to it are viscous forces on the rates of the two
stretches and of h.

How it is made fast. Arrays are flat, by component, a row of s = nj + 1 slots for each i; element (i, j) and node
(i, j) share the slot k = i s + j, and the last slot of an element row is idle. An element row adds to the node row
below it (g0) and above it (g1), and a node adds the two: nothing is written twice, and the result does not depend on
the order of the blocks. Every loop below runs over a block of rows, has few inputs, and vectorises; the table has a
loop of its own. Indices are unsigned because a signed one is checked for wrap-around, which stops vectorisation.
"""

import math

import numpy as np
from numba import njit

from shellfabric.cell_kernels import yarn_alone

ONE = np.uint64(1)
WARP_FAILED, WEFT_FAILED, ERODED = 1, 2, 4
# P(z) of asin(x) = x + x z P(z), z = x^2 <= 1/4: interpolated at Chebyshev points, to 1e-13
_Z = 0.125 * (1 - np.cos(np.pi * (np.arange(12) + 0.5) / 12))
_P = (np.arcsin(np.sqrt(_Z)) / np.sqrt(_Z) - 1) / _Z
ARCSINE = tuple(np.polynomial.Polynomial.fit(_Z, _P, 11).convert().coef)
FAST = {"reassoc", "contract", "nsz", "arcp"}


@njit(cache=True, fastmath=FAST, error_model="numpy")
def kinematics(u, v, k0, n, s, ra, rb, dt, unit_a, unit_b, A, B, H, dH):
    """One component of a, b, h and of the last change of h, in the slots k0 .. k0 + n; ra = 1 / 2 dX, rb = 1 / 2 dY."""
    for j in range(n):
        k = k0 + j
        u00, u01, u10, u11 = u[k], u[k + ONE], u[k + s], u[k + s + ONE]
        near, far = u10 - u00, u11 - u01
        A[j] = unit_a + ra * (near + far)
        B[j] = unit_b + rb * ((u01 - u00) + (u11 - u10))
        H[j] = far - near
    for j in range(n):
        k = k0 + j
        dH[j] = dt * ((v[k + s + ONE] - v[k + ONE]) - (v[k + s] - v[k]))


@njit(cache=True, error_model="numpy")
def rest(n, s, A, B, H, dH):
    """Put the idle slot at the end of each row to rest, where `kinematics` has joined two rows."""
    for j in range(s - ONE, n, s):
        for c in range(3):
            A[c][j] = B[c][j] = H[c][j] = dH[c][j] = 0.0
        A[0][j] = B[1][j] = 1.0


@njit(cache=True, fastmath=FAST, error_model="numpy")
def stretches(n, ax, ay, az, bx, by, bz, l1, l2, ia, ib, sine):
    """Stretches of the two yarns, their inverses, and the sine of the shear angle."""
    for j in range(n):
        aa = ax[j] * ax[j] + ay[j] * ay[j] + az[j] * az[j]
        bb = bx[j] * bx[j] + by[j] * by[j] + bz[j] * bz[j]
        ab = ax[j] * bx[j] + ay[j] * by[j] + az[j] * bz[j]
        la, lb = math.sqrt(aa), math.sqrt(bb)
        inverse_a, inverse_b = 1.0 / la, 1.0 / lb
        l1[j] = la
        l2[j] = lb
        ia[j] = inverse_a
        ib[j] = inverse_b
        sine[j] = ab * inverse_a * inverse_b


@njit(cache=True, fastmath=FAST, error_model="numpy")
def tensions(n, l1, l2, table, x0, rx, top1, y0, ry, top2, T1, T2):
    """Bilinear look-up of both tensions; below the table its edge (exact there), above it linear. Returns the peaks."""
    peak1, peak2 = 0.0, 0.0
    for j in range(n):
        p = max((l1[j] - x0) * rx, 0.0)
        q = max((l2[j] - y0) * ry, 0.0)
        i1, i2 = max(min(int(p), top1), 0), max(min(int(q), top2), 0)
        p -= i1
        q -= i2
        m = np.uint64(i1 * (top2 + 1) + i2)
        pq = p * q
        t1 = table[m, 0] + table[m, 1] * p + table[m, 2] * q + table[m, 3] * pq
        t2 = table[m, 4] + table[m, 5] * p + table[m, 6] * q + table[m, 7] * pq
        T1[j] = t1
        T2[j] = t2
        peak1 = max(peak1, t1)
        peak2 = max(peak2, t2)
    return peak1, peak2


@njit(cache=True, fastmath=FAST, error_model="numpy")
def potential_forces(n, l1, l2, table, x0, rx, top1, y0, ry, top2, per1, per2, N1, N2):
    """Gradient of the bicubic potential, N = per dW/d(local coordinate); constant beyond the table's upper edge."""
    for j in range(n):
        p = max((l1[j] - x0) * rx, 0.0)
        q = max((l2[j] - y0) * ry, 0.0)
        i1, i2 = max(min(int(p), top1), 0), max(min(int(q), top2), 0)
        p = min(p - i1, 1.0)
        q = min(q - i2, 1.0)
        m = np.uint64(i1 * (top2 + 1) + i2)
        d1 = table[m, 4] + q * (table[m, 5] + q * (table[m, 6] + q * table[m, 7]))
        d1 += 2.0 * p * (table[m, 8] + q * (table[m, 9] + q * (table[m, 10] + q * table[m, 11])))
        d1 += 3.0 * p * p * (table[m, 12] + q * (table[m, 13] + q * (table[m, 14] + q * table[m, 15])))
        d2 = table[m, 1] + p * (table[m, 5] + p * (table[m, 9] + p * table[m, 13]))
        d2 += 2.0 * q * (table[m, 2] + p * (table[m, 6] + p * (table[m, 10] + p * table[m, 14])))
        d2 += 3.0 * q * q * (table[m, 3] + p * (table[m, 7] + p * (table[m, 11] + p * table[m, 15])))
        N1[j] = per1 * d1
        N2[j] = per2 * d2


@njit(cache=True, fastmath=FAST, error_model="numpy")
def yarn_work(k0, n, c, cv, l, N, L, P, D, W, force):
    """Advance one yarn family: work of its force into W, viscous force, the total dE/dLambda. Returns viscous work.

    The work of a step is the trapezoid of the force over the change of stretch. Summed over the steps it equals, term
    by term, what central differences exchange with the kinetic energy, so that the energy balance tests the element.
    """
    viscous = 0.0
    for j in range(n):
        k = k0 + j
        d = l[j] - L[k]
        W[k] += 0.5 * c * (N[j] + P[k]) * d
        viscous += d * (d + D[k])
        force[j] = c * (N[j] + cv * d)
        L[k] = l[j]
        P[k] = N[j]
        D[k] = d
    return 0.5 * c * cv * viscous


@njit(cache=True, error_model="numpy")
def trellis(gamma, G1, G2, gamma1, gamma2):
    """Trellis stress, odd in the shear angle gamma, and its integral: three zones (eq. 4-35, erratum E-11)."""
    g = abs(gamma)
    rise = (G2 - G1) / (gamma2 - gamma1)
    middle = min(max(g - gamma1, 0.0), gamma2 - gamma1)
    beyond = max(g - gamma2, 0.0)
    stress = G1 * g + 0.5 * rise * middle * middle + (G2 - G1) * beyond
    energy = 0.5 * G1 * g * g + rise * middle**3 / 6.0
    energy += 0.5 * rise * (gamma2 - gamma1) ** 2 * beyond + 0.5 * (G2 - G1) * beyond * beyond
    return math.copysign(stress, gamma), energy


@njit(cache=True, error_model="numpy")
def shear_energy(sine, V, G1, G2, gamma1, gamma2):
    """Energy V U of the trellis in one element."""
    return V * trellis(math.asin(min(max(sine, -0.999), 0.999)), G1, G2, gamma1, gamma2)[1]


@njit(cache=True, fastmath=FAST, error_model="numpy")
def shear_slope(n, sine, V, G1, G2, gamma1, gamma2, slope):
    """V dU/d(sin gamma) = V tau / cos(gamma). Yarns closer to each other than 2.6 degrees count as that.

    `trellis` written without branches. The angle is x + x z P(z), z = x^2, up to sine 1/2 and pi/2 less twice the
    angle of sine sqrt((1 - x) / 2) above it.
    """
    half_rise, jump, span = 0.5 * (G2 - G1) / (gamma2 - gamma1), G2 - G1, gamma2 - gamma1
    for j in range(n):
        x = min(abs(sine[j]), 0.999)
        high = x > 0.5
        z = 0.5 * (1.0 - x) if high else x * x
        root = math.sqrt(z) if high else x
        P = ARCSINE[8] + z * (ARCSINE[9] + z * (ARCSINE[10] + z * ARCSINE[11]))
        P = ARCSINE[4] + z * (ARCSINE[5] + z * (ARCSINE[6] + z * (ARCSINE[7] + z * P)))
        P = ARCSINE[0] + z * (ARCSINE[1] + z * (ARCSINE[2] + z * (ARCSINE[3] + z * P)))
        angle = root + root * z * P
        angle = 0.5 * math.pi - 2.0 * angle if high else angle
        middle = min(max(angle - gamma1, 0.0), span)
        stress = G1 * angle + half_rise * middle * middle + jump * max(angle - gamma2, 0.0)
        slope[j] = V * math.copysign(stress, sine[j]) / math.sqrt(1.0 - x * x)


@njit(cache=True, fastmath=FAST, error_model="numpy")
def projections(n, force1, force2, slope, sine, ia, ib, ra, rb, on_a, cross_a, cross_b, on_b):
    """Coefficients of dE/da = on_a a + cross_a b and dE/db = cross_b a + on_b b, times ra and rb."""
    for j in range(n):
        turn = slope[j] * sine[j]
        cross = slope[j] * ia[j] * ib[j]
        on_a[j] = ra * ia[j] * (force1[j] - turn * ia[j])
        on_b[j] = rb * ib[j] * (force2[j] - turn * ib[j])
        cross_a[j] = ra * cross
        cross_b[j] = rb * cross


@njit(cache=True, fastmath=FAST, error_model="numpy")
def nodal_parts(k0, n, A, B, H, dH, on_a, cross_a, cross_b, on_b, kh, ch, dH_old, Q, R, G):
    """One component of the parts of the nodal forces: Q = fa + fb, R = fa - fb, G hourglass. Returns hourglass work."""
    work = 0.0
    for j in range(n):
        k = k0 + j
        fa = on_a[j] * A[j] + cross_a[j] * B[j]
        fb = cross_b[j] * A[j] + on_b[j] * B[j]
        Q[j] = fa + fb
        R[j] = fa - fb
        G[j] = kh * H[j] + ch * dH[j]
        work += dH[j] * (dH[j] + dH_old[k])
        dH_old[k] = dH[j]
    return 0.5 * ch * work


@njit(cache=True, fastmath={"contract", "nsz"}, error_model="numpy")
def gather(k0, n, s, Q, R, G, g0, g1):
    """Add the corner forces of neighbours in a row: g0 on the node row of the elements, g1 on the next one.

    Corners: f00 = Q - G, f01 = R + G, f10 = G - R, f11 = -Q - G. Uniform tension cancels exactly, digit by digit.
    """
    g0[k0] = Q[0] - G[0]
    g1[k0 + s] = G[0] - R[0]
    for j in range(ONE, n):
        k = k0 + j
        g0[k] = (Q[j] - G[j]) + (R[j - ONE] + G[j - ONE])
        g1[k + s] = (G[j] - R[j]) - (Q[j - ONE] + G[j - ONE])


@njit(cache=True, error_model="numpy")
def settle_failures(k0, n, l1, l2, sine, T1, T2, N1, N2, H, dH, state, const):
    """Failed yarns of a block: take their forces out, book the energy that goes with them, erode empty elements.

    A yarn fails where its tension passes its strength and is gone for good; the other is then alone (erratum E-14).
    With a yarn the trellis goes too. An element erodes when both are gone, or when the gap that a failed yarn left has
    opened beyond const.widest: its survivor is far from any neighbour. Mass stays. Returns (energy lost, viscous work,
    failures).
    """
    lost, viscous, count = 0.0, 0.0, 0
    for j in range(n):
        k = k0 + j
        flag = state.flag[k]
        if flag == 0 and T1[j] <= const.strength1 and T2[j] <= const.strength2:
            continue
        gone1, gone2, eroded = flag & WARP_FAILED, flag & WEFT_FAILED, flag & ERODED
        t1, u1 = yarn_alone(l1[j], const.w1, const.S01, const.EA1)
        t2, u2 = yarn_alone(l2[j], const.w2, const.S02, const.EA2)
        if not eroded:
            if (T1[j] if flag == 0 else t1) > const.strength1:
                gone1 = WARP_FAILED
            if (T2[j] if flag == 0 else t2) > const.strength2:
                gone2 = WEFT_FAILED
            if (gone1 and gone2) or (gone1 and l1[j] > const.widest) or (gone2 and l2[j] > const.widest):
                eroded = ERODED
        if gone1 or eroded:
            t1, u1 = 0.0, 0.0
        if gone2 or eroded:
            t2, u2 = 0.0, 0.0
        now = gone1 | gone2 | eroded
        if now != flag:
            d1, d2 = l1[j] - state.L1[k], l2[j] - state.L2[k]
            W = state.W[k] + 0.5 * const.c1 * (t1 + state.P1[k]) * d1 + 0.5 * const.c2 * (t2 + state.P2[k]) * d2
            viscous += 0.5 * const.c1 * const.cv1 * state.D1[k] * d1 + 0.5 * const.c2 * const.cv2 * state.D2[k] * d2
            after = const.cells * (u1 + u2)
            lost += W - after
            state.W[k] = after
            if flag == 0:
                lost += shear_energy(sine[j], const.V, const.G1, const.G2, const.gamma1, const.gamma2)
            state.L1[k], state.L2[k] = l1[j], l2[j]
            state.P1[k], state.P2[k] = t1, t2
            state.D1[k] = state.D2[k] = 0.0
            if eroded:
                for c in range(3):
                    lost += 0.5 * const.kh * H[c][j] ** 2
            state.flag[k] = now
            count += 1
        if gone1:
            state.L1[k] = l1[j]
        if gone2:
            state.L2[k] = l2[j]
        if eroded:
            state.L1[k], state.L2[k] = l1[j], l2[j]
            for c in range(3):
                H[c][j] = dH[c][j] = 0.0
                state.dH[c][k] = 0.0
        T1[j], T2[j], N1[j], N2[j], sine[j] = t1, t2, t1, t2, 0.0
    return lost, viscous, count
