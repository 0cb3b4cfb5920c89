"""Coulomb friction between the fabric and the projectile, at the points where they touch.

A point that sticks is held by a spring of the contact's own stiffness k, with its damping c, along the surface; what
the spring could hold beyond the friction mu f it lets slip (Coulomb's law regularised by an elastic slip, as the
penalty regularises the gap). With g the elastic slip and v the velocity of the fabric over the projectile, both along
the surface,

    t = -(k g + c v),    where |t| > mu f:   t := mu f t / |t|,  g := -t / k.

Stiffness and damping being those of the contact, the time step bears it as it bears that; there is no knob.
"""

import math

from shellfabric.jit.compile import kernel


@kernel()
def friction_force(stuck, limit, k, c, dt, n_x, n_y, n_z, v_x, v_y, v_z):
    """Friction at one point over one step.

    stuck : (6,) elastic slip [m] and last friction force [N], updated
    limit : mu f [N]; k, c : [N/m, N s/m]; n : normal of the surface; v : velocity of the fabric over it [m/s]

    Returns the force on the fabric (t_x, t_y, t_z), the energy taken in over the step (trapezoid rule), and what of it
    the spring holds.
    """
    taken = -0.5 * dt * (stuck[3] * v_x + stuck[4] * v_y + stuck[5] * v_z)
    across = v_x * n_x + v_y * n_y + v_z * n_z
    v_x, v_y, v_z = v_x - across * n_x, v_y - across * n_y, v_z - across * n_z
    g_x, g_y, g_z = stuck[0] + dt * v_x, stuck[1] + dt * v_y, stuck[2] + dt * v_z
    across = g_x * n_x + g_y * n_y + g_z * n_z  # the surface may have turned since
    g_x, g_y, g_z = g_x - across * n_x, g_y - across * n_y, g_z - across * n_z
    t_x, t_y, t_z = -k * g_x - c * v_x, -k * g_y - c * v_y, -k * g_z - c * v_z
    size = math.sqrt(t_x * t_x + t_y * t_y + t_z * t_z)
    if size > limit:
        t_x, t_y, t_z = limit * t_x / size, limit * t_y / size, limit * t_z / size
        g_x, g_y, g_z = -t_x / k, -t_y / k, -t_z / k
    taken -= 0.5 * dt * (t_x * v_x + t_y * v_y + t_z * v_z)
    stuck[0], stuck[1], stuck[2] = g_x, g_y, g_z
    stuck[3], stuck[4], stuck[5] = t_x, t_y, t_z
    return t_x, t_y, t_z, taken, 0.5 * k * (g_x * g_x + g_y * g_y + g_z * g_z)
