"""The eight-node brick with one integration point in explicit dynamics: mean deformation and
hourglass control.

F is the mean over the element, f_i = F e_i = sum_a x_a b_ai with b the mean gradients of the shape
functions (Flanagan and Belytschko 1981), so that every patch test is met. Hourglass control, with
the patterns h of the four modes over the corners and c_mi = sum_a h_ma X_a . e_i at rest:

    q_m = sum_a h_ma x_a - sum_i c_mi f_i,      W = 1/2 sum_mi K_mi (q_m . f_i)^2

q vanishes in every linear motion, and W is blind to rotation. K makes W at rest the energy of the 2
x 2 x 2 rule in the same mode (`hex8.py`), times a factor.
"""

from shellfabric.jit.compile import kernel


@kernel(fastmath={"contract"})
def brick_nodes(first, i, j, k, ny, nz, nodes):
    """Fill in the numbers of the eight nodes of the brick (i, j, k), in the order of `PATTERNS`."""
    sheet = (ny + 1) * (nz + 1)
    row = nz + 1
    n = first + i * sheet + j * row + k
    nodes[0] = n
    nodes[1] = n + sheet
    nodes[2] = n + sheet + row
    nodes[3] = n + row
    nodes[4] = n + 1
    nodes[5] = n + sheet + 1
    nodes[6] = n + sheet + row + 1
    nodes[7] = n + row + 1


@kernel(fastmath={"contract"})
def patterns(x, H):
    """Compute H[m, c] = sum_a h_ma x_ac of the modes eta zeta, xi zeta, xi eta and xi eta zeta; x :
    (8, 3)."""
    for c in range(3):
        s0 = x[0, c] + x[4, c]
        s1 = x[1, c] + x[5, c]
        s2 = x[2, c] + x[6, c]
        s3 = x[3, c] + x[7, c]
        d0 = x[4, c] - x[0, c]
        d1 = x[5, c] - x[1, c]
        d2 = x[6, c] - x[2, c]
        d3 = x[7, c] - x[3, c]
        H[0, c] = -d0 - d1 + d2 + d3
        H[1, c] = -d0 + d1 + d2 - d3
        H[2, c] = s0 - s1 + s2 - s3
        H[3, c] = d0 - d1 + d2 - d3


@kernel(fastmath={"contract"})
def spread_patterns(g, force):
    """Add the forces of the modes: force[a, c] += sum_m h_ma g_mc."""
    for c in range(3):
        p = g[0, c]
        q = g[1, c]
        r = g[2, c]
        s = g[3, c]
        force[0, c] += p + q + r - s
        force[1, c] += p - q - r + s
        force[2, c] += -p - q + r - s
        force[3, c] += -p + q - r + s
        force[4, c] += -p - q + r + s
        force[5, c] += -p + q - r - s
        force[6, c] += p + q + r + s
        force[7, c] += p - q - r - s


@kernel(fastmath={"contract"})
def hourglass(f, x, twist, K, H, D, force):
    """Add the forces of the hourglass control of one brick.

    Parameters
    ----------
    f : (3, 3), f[c, i] the component c of F e_i
    x : (8, 3) [m] corners
    twist, K : (4, 3) c and the stiffness above
    H : (4, 3) scratch
    D : (3, 3) filled: what acts through the mean gradients, as volume times P does
    force : (8, 3) [N] what acts through the patterns, added to

    Returns
    -------
    energy : [J]
    """
    patterns(x, H)
    energy = 0.0
    D[:] = 0.0
    for m in range(4):
        q0 = H[m, 0]
        q1 = H[m, 1]
        q2 = H[m, 2]
        for i in range(3):
            q0 -= twist[m, i] * f[0, i]
            q1 -= twist[m, i] * f[1, i]
            q2 -= twist[m, i] * f[2, i]
        g0 = g1 = g2 = 0.0
        for i in range(3):
            s = q0 * f[0, i] + q1 * f[1, i] + q2 * f[2, i]
            t = K[m, i] * s
            energy += 0.5 * t * s
            g0 += t * f[0, i]
            g1 += t * f[1, i]
            g2 += t * f[2, i]
            D[0, i] += t * q0
            D[1, i] += t * q1
            D[2, i] += t * q2
        for i in range(3):
            D[0, i] -= twist[m, i] * g0
            D[1, i] -= twist[m, i] * g1
            D[2, i] -= twist[m, i] * g2
        H[m, 0] = g0
        H[m, 1] = g1
        H[m, 2] = g2
    spread_patterns(H, force)
    return energy


@kernel(fastmath={"contract"})
def mean_deformation(x, b, f):
    """Compute f[c, i] = sum_a x_ac b_ai."""
    for c in range(3):
        f[c, 0] = f[c, 1] = f[c, 2] = 0.0
        for a in range(8):
            f[c, 0] += x[a, c] * b[a, 0]
            f[c, 1] += x[a, c] * b[a, 1]
            f[c, 2] += x[a, c] * b[a, 2]
