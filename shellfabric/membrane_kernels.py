"""The fabric: yarn segments along the grid lines, crossovers at the nodes, trellis in between; total Lagrangian.

Displacements, not positions, are stored, so that cloth at rest is exactly at rest. Lines j = const are warp, lines
i = const weft. The edge from a node to the next one along its line is a segment of yarn with the stretch

    Lambda1 = |dX + u(i+1, j) - u(i, j)| / |dX|   (warp),      Lambda2 likewise from u(i, j+1) - u(i, j)   (weft)

so that neighbouring yarns are told apart, and no in-plane motion of the nodes is without force. The crossovers of a
segment see its own stretch and the mean <> of the four segments of the other family that meet its two ends. With the
cell of `cell_kernels`

    equilibrium form   T1 = T1(Lambda1, <Lambda2>),   T2 = T2(<Lambda1>, Lambda2)           forces along the segments
    variational form   E = 1/2 sum_warp n W(Lambda1, <Lambda2>) + 1/2 sum_weft n W(<Lambda1>, Lambda2)

n being the crossovers that a segment stands for: half of a segment's on lines that bound the panel. The variational
forces are the exact gradient of E. The trellis (eq. 4-35 as a total, odd function, erratum E-11) has one point in each
quadrilateral: a, b being the means of its two warp and two weft edges, sin(gamma) = a.b / <Lambda1><Lambda2> of these.

Where yarns have failed. Segment e keeps the part alpha_e of its yarns; kappa_e = mean of alpha over the four crossing
segments is the part of it that is still crossed. Means are weighted by alpha, and the rest is alone (erratum E-14):

    N_e = kappa_e N(Lambda_e, <Lambda>_e) + (1 - kappa_e) T_alone(Lambda_e),     force alpha_e N_e

How it is made fast. Arrays are flat, by component, a row of s = nj + 1 slots for each i; node (i, j), the warp edge to
(i+1, j), the weft edge to (i, j+1) and the quadrilateral beside both share the slot k = i s + j. Weft edges and
quadrilaterals leave the last slot of a row idle. An element row - the warp edges and quadrilaterals between two node
rows, and the weft edges of the lower one - adds to the node row below it (g0) and above it (g1), and a node adds the
two: nothing is written twice, and the result does not depend on the order of the blocks. Every loop below runs over a
block of rows, has few inputs, and vectorises; look-ups have loops of their own. Indices are unsigned because a signed
one is checked for wrap-around, which stops vectorisation. Scratch begins two rows before the block's first: one is
idle, one repeats the last row of the block before, and another follows the block's last.
"""

import math

import numpy as np
from numba import njit

ONE = np.uint64(1)
WARP_FAILED, WEFT_FAILED, ERODED = 1, 2, 4
# P(z) of asin(x) = x + x z P(z), z = x^2 <= 1/4: interpolated at Chebyshev points, to 1e-13
_Z = 0.125 * (1 - np.cos(np.pi * (np.arange(12) + 0.5) / 12))
_P = (np.arcsin(np.sqrt(_Z)) / np.sqrt(_Z) - 1) / _Z
ARCSINE = tuple(np.polynomial.Polynomial.fit(_Z, _P, 11).convert().coef)
FAST = {"reassoc", "contract", "nsz", "arcp"}


@njit(cache=True, fastmath=FAST, error_model="numpy")
def edges(u, k0, m0, n, step, r, unit, A):
    """One component of n edges from the slots k0 on, relative to the length at rest, into scratch from m0 on."""
    for j in range(n):
        k = k0 + j
        A[m0 + j] = unit + r * (u[k + step] - u[k])


@njit(cache=True, error_model="numpy")
def rest(m0, n, s, B):
    """Put the idle slot at the end of each row of weft edges to rest, where `edges` has joined two rows."""
    for j in range(m0 + s - ONE, m0 + n, s):
        B[0][j] = B[2][j] = 0.0
        B[1][j] = 1.0


@njit(cache=True, fastmath=FAST, error_model="numpy")
def stretches(m0, n, x, y, z, L, inverse):
    """Stretches of n edges and their inverses."""
    for j in range(m0, m0 + n):
        length = math.sqrt(x[j] * x[j] + y[j] * y[j] + z[j] * z[j])
        L[j] = length
        inverse[j] = 1.0 / length


@njit(cache=True, error_model="numpy")
def copy(n, source, target, x):
    """Repeat a row: n slots of x from `source` to `target`."""
    for j in range(n):
        x[target + j] = x[source + j]


@njit(cache=True, fastmath=FAST, error_model="numpy")
def across_warp(m0, n, s, x, mean):
    """For n warp edges the mean of x over the weft edges that cross them: four, or two at the ends of a row."""
    for j in range(m0, m0 + n):
        mean[j] = 0.25 * ((x[j - ONE] + x[j]) + (x[j + s - ONE] + x[j + s]))
    for j in range(m0, m0 + n, s):
        mean[j] = 0.5 * (x[j] + x[j + s])
    for j in range(m0 + s - ONE, m0 + n, s):
        mean[j] = 0.5 * (x[j - ONE] + x[j + s - ONE])


@njit(cache=True, fastmath=FAST, error_model="numpy")
def across_weft(m0, n, s, x, mean):
    """For n weft edges the mean of x over the warp edges that cross them; rows beyond the panel repeat its last."""
    for j in range(m0, m0 + n):
        mean[j] = 0.25 * ((x[j - s] + x[j - s + ONE]) + (x[j] + x[j + ONE]))
    for j in range(m0 + s - ONE, m0 + n, s):
        mean[j] = 1.0


@njit(cache=True, fastmath=FAST, error_model="numpy")
def place(m0, n, l, x0, r, top, cell, part):
    """Where n stretches lie in the table: the cell along one side, 0 .. top, and the place in it, at least 0."""
    for j in range(m0, m0 + n):
        p = max((l[j] - x0) * r, 0.0)
        whole = math.floor(min(p, top))
        cell[j] = whole
        part[j] = p - whole


@njit(cache=True, fastmath=FAST, error_model="numpy")
def tensions(m0, n, cell1, part1, cell2, part2, table, across, T):
    """Bilinear look-up of one tension in a table of `across` cells along its second side. Returns the largest.

    Below the table its edge, which is exact there; above it linear.
    """
    most = 0.0
    for j in range(m0, m0 + n):
        p, q = part1[j], part2[j]
        m = np.uint32(cell1[j] * across + cell2[j])
        tension = table[m, 0] + table[m, 1] * p + q * (table[m, 2] + table[m, 3] * p)
        T[j] = tension
        most = max(most, tension)
    return most


@njit(cache=True, fastmath=FAST, error_model="numpy")
def potential_forces(m0, n, cell1, part1, cell2, part2, table, across, per1, per2, N1, N2):
    """Gradient of the bicubic potential, N = per dW/d(local coordinate).

    Above the table cubes go on as parabolas, so that tensions go on straight: (1 + e)^3 - e^3 with e what is above.
    """
    for j in range(m0, m0 + n):
        p, q = part1[j], part2[j]
        e, f = max(p - 1.0, 0.0), max(q - 1.0, 0.0)
        cube1, cube2 = p * p * p - e * e * e, q * q * q - f * f * f
        turn1, turn2 = 3.0 * (p * p - e * e), 3.0 * (q * q - f * f)
        m = np.uint32(cell1[j] * across + cell2[j])
        d1 = table[m, 4] + q * (table[m, 5] + q * table[m, 6]) + cube2 * table[m, 7]
        d1 += 2.0 * p * (table[m, 8] + q * (table[m, 9] + q * table[m, 10]) + cube2 * table[m, 11])
        d1 += turn1 * (table[m, 12] + q * (table[m, 13] + q * table[m, 14]) + cube2 * table[m, 15])
        d2 = table[m, 1] + p * (table[m, 5] + p * table[m, 9]) + cube1 * table[m, 13]
        d2 += 2.0 * q * (table[m, 2] + p * (table[m, 6] + p * table[m, 10]) + cube1 * table[m, 14])
        d2 += turn2 * (table[m, 3] + p * (table[m, 7] + p * table[m, 11]) + cube1 * table[m, 15])
        N1[j] = per1 * d1
        N2[j] = per2 * d2


@njit(cache=True, fastmath=FAST, error_model="numpy")
def halves(m0, n, own, shared, N):
    """N = (own + shared) / 2 of n edges."""
    for j in range(m0, m0 + n):
        N[j] = 0.5 * (own[j] + shared[j])


@njit(cache=True, error_model="numpy")
def largest(m0, n, values):
    """The largest of n values, at least 0."""
    most = 0.0
    for j in range(m0, m0 + n):
        most = max(most, values[j])
    return most


@njit(cache=True, fastmath=FAST, error_model="numpy")
def yarn_work(k0, m0, n, cv, l, N, y, L, P, D, force):
    """Advance n edges of one family; force = y (N + cv dL), dE/dLambda with y [m] the length of yarn of an edge.

    Returns the work of N and of the viscous force. The work of a step is the trapezoid of the force over the change of
    stretch. Summed over the steps it equals, term by term, what central differences exchange with the kinetic energy.
    """
    work, viscous = 0.0, 0.0
    for j in range(n):
        k, m = k0 + j, m0 + j
        d = l[m] - L[k]
        part = y[k] * d
        work += part * (N[m] + P[k])
        viscous += part * (d + D[k])
        force[m] = y[k] * (N[m] + cv * d)
        L[k] = l[m]
        P[k] = N[m]
        D[k] = d
    return 0.5 * work, 0.5 * cv * viscous


@njit(cache=True, fastmath=FAST, error_model="numpy")
def yarn_again(k0, m0, n, cv, N, y, P, D, force):
    """The forces of `yarn_work` once more, after yarns have failed in this step."""
    for j in range(n):
        k, m = k0 + j, m0 + j
        force[m] = y[k] * (N[m] + cv * D[k])
        P[k] = N[m]


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
    """Energy V U of the trellis in one quadrilateral."""
    return V * trellis(math.asin(min(max(sine, -0.999), 0.999)), G1, G2, gamma1, gamma2)[1]


@njit(cache=True, fastmath=FAST, error_model="numpy")
def shear(m0, n, s, ax, ay, az, bx, by, bz, l1, l2, sine):
    """Sine of the shear angle of n quadrilaterals."""
    for j in range(m0, m0 + n):
        x = (ax[j] + ax[j + ONE]) * (bx[j] + bx[j + s])
        y = (ay[j] + ay[j + ONE]) * (by[j] + by[j + s])
        z = (az[j] + az[j + ONE]) * (bz[j] + bz[j + s])
        sine[j] = (x + y + z) / ((l1[j] + l1[j + ONE]) * (l2[j] + l2[j + s]))


@njit(cache=True, fastmath=FAST, error_model="numpy")
def shear_slope(m0, n, sine, V, G1, G2, gamma1, gamma2, slope):
    """V dU/d(sin gamma) = V tau / cos(gamma). Yarns closer to each other than 2.6 degrees count as that.

    `trellis` written without branches. The angle is x + x z P(z), z = x^2, up to sine 1/2 and pi/2 less twice the
    angle of sine sqrt((1 - x) / 2) above it.
    """
    half_rise, jump, span = 0.5 * (G2 - G1) / (gamma2 - gamma1), G2 - G1, gamma2 - gamma1
    for j in range(m0, m0 + n):
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
def turn(m0, n, step, slope, sine, l, turned):
    """-dE/dLambda that n quadrilaterals give to each of their two edges of one family, `step` slots apart."""
    for j in range(m0, m0 + n):
        turned[j] = slope[j] * sine[j] / (l[j] + l[j + step])


@njit(cache=True, fastmath=FAST, error_model="numpy")
def cross(m0, n, s, slope, l1, l2, crossed):
    """dE/d(a.b) of n quadrilaterals, over four, a and b being doubled."""
    for j in range(m0, m0 + n):
        crossed[j] = slope[j] / ((l1[j] + l1[j + ONE]) * (l2[j] + l2[j + s]))


@njit(cache=True, fastmath=FAST, error_model="numpy")
def times(m0, n, step, crossed, A, X):
    """One component of the doubled mean of two edges, `step` slots apart, times dE/d(a.b), for n quadrilaterals."""
    for j in range(m0, m0 + n):
        X[j] = crossed[j] * (A[j] + A[j + step])


@njit(cache=True, fastmath=FAST, error_model="numpy")
def pulls(m0, n, back, r, force, turned, inverse, on):
    """Pulls of n edges along themselves over their stretch, less what the trellis on both sides takes; r = 1 / dX."""
    for j in range(m0, m0 + n):
        on[j] = r * inverse[j] * (force[j] - (turned[j] + turned[j - back]))


@njit(cache=True, fastmath={"nsz"}, error_model="numpy")
def gather(k0, m0, n, rx, ry, on1, A, on2, B, X, Y, g0):
    """One component of what n slots' edges and quadrilaterals give to the nodes of their own row.

    Without contraction uniform tension cancels digit by digit.
    """
    for j in range(n):
        m = m0 + j
        trellis = rx * (X[m] + X[m - ONE]) + ry * (Y[m] - Y[m - ONE])
        g0[k0 + j] = (on1[m] * A[m] + (on2[m] * B[m] - on2[m - ONE] * B[m - ONE])) + trellis


@njit(cache=True, fastmath={"nsz"}, error_model="numpy")
def gather_next(k0, m0, n, rx, ry, on1, A, X, Y, g1):
    """One component of what they give to the nodes of the next row, which begin at slot k0."""
    for j in range(n):
        m = m0 + j
        g1[k0 + j] = ry * (Y[m] - Y[m - ONE]) - (on1[m] * A[m] + rx * (X[m] + X[m - ONE]))


@njit(cache=True, fastmath={"nsz"}, error_model="numpy")
def gather_last(k0, m0, n, on2, B, g0):
    """One component of what the weft edges on the panel's last row give to their nodes."""
    for j in range(n):
        m = m0 + j
        g0[k0 + j] = on2[m] * B[m] - on2[m - ONE] * B[m - ONE]
