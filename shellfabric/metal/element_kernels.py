"""Elements of a body of revolution of metal: exact forces of a stored energy, and plastic flow
(docs/theory-panel.md, "Projectile").

The meridian plane (r, z) is a mesh of quadrilaterals with one point each. b_a are the gradients of the
bilinear shape functions at the middle of an element at rest, R its radius there, A its area:

    F_ci = sum_a x_ac b_ai  (c, i of r, z),   F_h = sum_a r_a / 4 R,   V = 2 pi R A            (1)
    W = V w(F, F_h) + k |q|^2 / 2,            q_c = sum_a g_a x_ac                             (2)

g is the hourglass pattern less its linear part, w Hencky's energy as in `block.block_kernels`; the hoop
is always a principal direction. A bulk viscosity, linear and square in the rate of ln J, damps shocks.
"""

import math

import numpy as np

from shellfabric.flow_kernels import metal_flow_increment
from shellfabric.jit.compile import entry, kernel
from shellfabric.metal.state import BodyRow, MetalLaw
from shellfabric.state import unit

LINEAR_VISCOSITY = 0.06
SQUARE_VISCOSITY = 1.5
CFL = 0.6  # of the height over the speed of waves
ISOTROPIC = 1e-14  # share of its mean below which two principal values are one


@kernel()
def deformation(own, m):
    """Compute the mean deformation (F_rr, F_rz, F_zr, F_zz, F_h) of element m, eq. (1)."""
    b = own.gradient[m]
    rr = rz = zr = zz = 0.0
    radius = 0.0
    for a in range(4):
        n = own.corners[m, a]
        r = own.x[n, 0]
        z = own.x[n, 1]
        rr += r * b[a, 0]
        rz += r * b[a, 1]
        zr += z * b[a, 0]
        zz += z * b[a, 1]
        radius += 0.25 * r
    return rr, rz, zr, zz, radius / own.radius[m]


@kernel()
def push_forward(F, C):
    """Push forward the symmetric C (rr, rz, zz) by F (rr, rz, zr, zz): F C F^T."""
    s_rr = F[0] * C[0] + F[1] * C[1]
    s_rz = F[0] * C[1] + F[1] * C[2]
    s_zr = F[2] * C[0] + F[3] * C[1]
    s_zz = F[2] * C[1] + F[3] * C[2]
    return s_rr * F[0] + s_rz * F[1], s_rr * F[2] + s_rz * F[3], s_zr * F[2] + s_zz * F[3]


@kernel()
def principal(b):
    """Diagonalise the symmetric b (rr, rz, zz): its two values, and cosine and sine of twice the
    angle of the first direction from r."""
    mean = 0.5 * (b[0] + b[2])
    half = 0.5 * (b[0] - b[2])
    apart = math.sqrt(half * half + b[1] * b[1])
    first = mean + apart
    second = (b[0] * b[2] - b[1] * b[1]) / first
    if apart > ISOTROPIC * mean:
        return first, second, half / apart, b[1] / apart
    return first, second, 1.0, 0.0


@kernel()
def from_principal(first, second, cosine, sine):
    """Compute the symmetric tensor (rr, rz, zz) of `principal`."""
    mean = 0.5 * (first + second)
    half = 0.5 * (first - second)
    return mean + half * cosine, half * sine, mean - half * cosine


@kernel()
def least_height(own, m, area):
    """Compute the least height [m] of element m as it is: its area over its longest side or
    diagonal."""
    longest = 0.0
    for a in range(4):
        n = own.corners[m, a]
        for further in (1, 2):
            other = own.corners[m, (a + further) % 4]
            r = own.x[n, 0] - own.x[other, 0]
            z = own.x[n, 1] - own.x[other, 1]
            longest = max(longest, r * r + z * z)
    return area * own.area[m] / math.sqrt(longest)


@kernel()
def flow(own, law, m, F, strains, turn, dt):
    """Let element m flow to its yield surface in a step of dt [s].

    Parameters
    ----------
    F : (rr, rz, zr, zz, hoop)
    strains : deviators (first, second, hoop) of the trial, and a third of the trace
    turn : cosine and sine of `principal`

    Returns
    -------
    keep : [-] share of the trial's deviators that is left
    """
    first, second, hoop, third = strains
    q = math.sqrt(6.0) * law.shear_modulus * math.sqrt(first**2 + second**2 + hoop**2)
    d = 0.0
    if dt > 0.0:
        d = metal_flow_increment(q, law, own.alpha[m], own.heat[m], dt)
    if d == 0.0:
        own.last_mises[m] = q
        return 1.0
    keep = 1.0 - 3.0 * law.shear_modulus * d / q
    # an element that begins to flow in this step was below its strength before
    work = 0.5 * (min(own.last_mises[m], keep * q) + keep * q) * d
    own.last_mises[m] = keep * q
    own.alpha[m] += d
    own.heat[m] += work
    own.plastic_work += own.volume[m] * work
    # C = F^-1 b F^-T of the elastic b that is left
    b = from_principal(
        math.exp(2.0 * (keep * first + third)),
        math.exp(2.0 * (keep * second + third)),
        turn[0],
        turn[1],
    )
    area = F[0] * F[3] - F[1] * F[2]
    back = F[3] / area, -F[1] / area, -F[2] / area, F[0] / area
    rr, rz, zz = push_forward(back, b)
    own.metric[m, 0] = rr
    own.metric[m, 1] = rz
    own.metric[m, 2] = zz
    own.metric[m, 3] = math.exp(2.0 * (keep * hoop + third)) / (F[4] * F[4])
    return keep


@kernel()
def viscous_pressure(own, law, m, swell, height, dt):
    """Compute the viscous part [Pa] of the Kirchhoff stress, positive in tension, and the rate
    [1/s] of ln J."""
    rate = 0.0
    if dt > 0.0:
        rate = (swell - own.last_swelling[m]) / dt
    own.last_swelling[m] = swell
    found = LINEAR_VISCOSITY * law.density * law.wave_speed * height * rate
    if rate < 0.0:
        found -= SQUARE_VISCOSITY * law.density * height * height * rate * rate
    own.viscous_work += own.volume[m] * 0.5 * (own.last_pressure[m] + found) * rate * dt
    own.last_pressure[m] = found
    return found, rate


@kernel()
def hourglass_force(own, m, dt):
    """Compute the hourglass force (r, z) [N] of element m over its pattern; its energy and work."""
    q_r = q_z = 0.0
    d_r = d_z = 0.0
    for a in range(4):
        n = own.corners[m, a]
        g = own.pattern[m, a]
        q_r += g * own.x[n, 0]
        q_z += g * own.x[n, 1]
        d_r += g * own.v[n, 0]
        d_z += g * own.v[n, 1]
    k = own.hourglass_stiffness[m]
    c = own.hourglass_damping[m]
    own.hourglass_energy += 0.5 * k * (q_r * q_r + q_z * q_z)
    own.viscous_work += c * (d_r * d_r + d_z * d_z) * dt
    return k * q_r + c * d_r, k * q_z + c * d_z


@unit("number", later=True, own=BodyRow, law=MetalLaw, dt="number")
def element_forces(own, law, m, dt):
    """Compute the forces of element m into own.f, a step of dt [s] after the last call; return the
    longest step [s] that it bears, negative of an element that is inside out."""
    F = deformation(own, m)
    area = F[0] * F[3] - F[1] * F[2]
    if not (area > 0.0 and F[4] > 0.0):
        return -1.0
    C = own.metric[m, 0], own.metric[m, 1], own.metric[m, 2]
    square_1, square_2, cosine, sine = principal(push_forward(F, C))
    e_1 = 0.5 * math.log(square_1)
    e_2 = 0.5 * math.log(square_2)
    e_h = 0.5 * math.log(F[4] * F[4] * own.metric[m, 3])
    trace = e_1 + e_2 + e_h
    third = trace / 3.0
    strains = e_1 - third, e_2 - third, e_h - third, third
    keep = flow(own, law, m, F, strains, (cosine, sine), dt)
    d_1 = keep * strains[0]
    d_2 = keep * strains[1]
    d_h = keep * strains[2]
    height = least_height(own, m, area)
    viscous, rate = viscous_pressure(own, law, m, math.log(area * F[4]), height, dt)
    K = law.bulk_modulus
    G = law.shear_modulus
    volume = own.volume[m]
    own.elastic_energy += volume * (0.5 * K * trace**2 + G * (d_1**2 + d_2**2 + d_h**2))
    p = K * trace + viscous
    t_rr, t_rz, t_zz = from_principal(p + 2.0 * G * d_1, p + 2.0 * G * d_2, cosine, sine)
    # P = tau F^-T
    p_rr = (t_rr * F[3] - t_rz * F[1]) / area
    p_rz = (-t_rr * F[2] + t_rz * F[0]) / area
    p_zr = (t_rz * F[3] - t_zz * F[1]) / area
    p_zz = (-t_rz * F[2] + t_zz * F[0]) / area
    p_h = (p + 2.0 * G * d_h) / F[4]
    h_r, h_z = hourglass_force(own, m, dt)
    for a in range(4):
        n = own.corners[m, a]
        g_r = own.gradient[m, a, 0]
        g_z = own.gradient[m, a, 1]
        g = own.pattern[m, a]
        own.f[n, 0] -= volume * (p_rr * g_r + p_rz * g_z + 0.25 * p_h / own.radius[m]) + h_r * g
        own.f[n, 1] -= volume * (p_zr * g_r + p_zz * g_z) + h_z * g
    speed = law.wave_speed + SQUARE_VISCOSITY * height * max(-rate, 0.0)
    return CFL * height / speed


@entry()
def forces(own, dt):
    """Compute the forces of all elements at the present places, a step of dt [s] after the last
    call; the longest step that they bear into own.longest_step."""
    own.f[:] = 0.0
    own.elastic_energy = 0.0
    own.hourglass_energy = 0.0
    longest = np.inf
    for m in range(own.alpha.size):
        if own.jacketed[m]:
            step = element_forces(own, own.jacket, m, dt)
        else:
            step = element_forces(own, own.core, m, dt)
        if step < longest:
            longest = step
            own.critical = m
    own.longest_step = longest
    own.most_hourglass_energy = max(own.most_hourglass_energy, own.hourglass_energy)
