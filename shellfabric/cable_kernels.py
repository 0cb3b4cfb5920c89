"""The pin-jointed cable model: masses at the crossovers, joined by bars that only pull (source thesis section 4.4.2).

Bars lie along warp and weft between neighbouring crossovers. A bar of natural length S0 over the distance L of its nodes

    e = max(L - S0, 0),   T = k e,   k = EA / S0      (crimp is slack, S0 > L0; erratum E-18: strain beyond crimp)

pulls with T and, while taut, with a viscous force on its rate; never less than nothing in all. It fails where e passes
its limit, at once and for good. Time goes by central differences, forces standing at whole steps:

    v(n+1/2) = v(n-1/2) + dt f(n) / m,    u(n+1) = u(n) + dt v(n+1/2),    f(n+1) from u(n+1), L(n+1) - L(n)

Layout, as in `membrane_kernels`: arrays are flat, by component, node (i, j) in slot k = i s + j, s = nj + 1; the bar
along the warp from (i, j) to (i+1, j) and the bar along the weft from (i, j) to (i, j+1) share the slot k. Where there
is no such bar, or no longer one, its stiffness is zero. Each loop below has few arrays, so that it vectorises.
"""

import math

import numpy as np
from numba import njit

from shellfabric import contact_kernels
from shellfabric.march_kernels import widen

ONE = np.uint64(1)
RUNNING, STOPPED, PERFORATED, NOT_FINITE = 0, 1, 2, 3
STEP, IDLE, FAILURES = 0, 1, 2
COLUMNS = 8  # of a history: z, v_z, force on the projectile, reaction of all edges along z, and of the two middle yarns
FAST = {"reassoc", "contract", "nsz", "arcp"}
_STILL = 1e-60
_SHORTEST = 1e-12


@njit(cache=True, fastmath=FAST, error_model="numpy")
def differences(u, k0, n, offset, along, D):
    """One component of the bar vectors: D = along + u(other end) - u(this end)."""
    for j in range(n):
        k = k0 + j
        D[j] = along + (u[k + offset] - u[k])


@njit(cache=True, fastmath=FAST, error_model="numpy")
def lengths(n, dx, dy, dz, L):
    """Lengths of the bars."""
    for j in range(n):
        L[j] = math.sqrt(dx[j] * dx[j] + dy[j] * dy[j] + dz[j] * dz[j])


@njit(cache=True, fastmath=FAST, error_model="numpy")
def pulls(k0, n, S0, limit, cv, stiff, L, L_old, viscous_old, a):
    """a = pull / length of the bars; returns the work of the viscous forces since the last call, and how many are past the limit."""
    work, beyond = 0.0, 0
    for j in range(n):
        k = k0 + j
        length = L[j]
        e = max(length - S0, 0.0)
        rate = length - L_old[k]
        T = stiff[k] * e
        drag = cv * stiff[k] * rate if e > 0.0 else 0.0
        drag = max(drag, -T)
        work += (drag + viscous_old[k]) * rate
        beyond += 1 if T > stiff[k] * limit else 0
        viscous_old[k] = drag
        L_old[k] = length
        a[j] = (T + drag) / max(length, _SHORTEST)
    return 0.5 * work, beyond


@njit(cache=True, error_model="numpy")
def fail(k0, n, S0, limit, stiff, L, rate_of, viscous, a):
    """Take out the bars past their limit. Returns (energy that went with them, viscous work not done, failures).

    A step exchanges the mean of its two end forces times the change of length; the last force of a failing bar is zero.
    """
    lost, undone, count = 0.0, 0.0, 0
    for j in range(n):
        k = k0 + j
        e = L[j] - S0
        if stiff[k] > 0.0 and e > limit:
            rate = rate_of[j]
            lost += 0.5 * stiff[k] * max(e - rate, 0.0) * e
            undone += 0.5 * viscous[k] * rate
            stiff[k] = viscous[k] = a[j] = 0.0
            count += 1
    return lost, undone, count
