"""Steps of a woven patch of solid yarns with fibre bars, struck by a rigid projectile: central differences.

    v(n+1/2) = v(n-1/2) - (dt(n-1) + dt(n)) / 2 f(n) / m,      x(n+1) = x(n) + dt(n) v(n+1/2)

Yarns share no node, so each is one thread's work from its bricks to its step; crossings come in colours. Sums are kept
for each yarn and crossing and added in their order: threads change no bit of the result. The bodies of the parallel
loops are calls: numba loses what such a body itself writes into an array of a named tuple.

Contact with the projectile: penalty, with a toe, on the signed distance of the nodes of the faces (`sdf_kernels`),
damped, what the nodes get taken from the projectile.
"""

import math

import numpy as np
from numba import prange

from shellfabric.backing.brick_kernels import brick_nodes, mean_deformation
from shellfabric.jit.compile import entry, kernel
from shellfabric.projectile import sdf_kernels
from validation.models.solid import fibre_kernels, solid_kernels, yarn_contact_kernels
from validation.models.solid.solid_kernels import KINETIC, SOLID

NOSE, LOST, FORCE = 0, 1, 2  # of the sums over the nose's contact: energy stored, damped, and the force on the nose


@kernel()
def nose_forces(shape, x, v, inverse_mass, area, damping, nose, spring, dt, force, out):
    """Penalty contact of the two faces of a yarn with the projectile.

    Parameters
    ----------
    shape : first node of the yarn and bricks along, across and through
    inverse_mass : (n,) [1/kg]
    area, damping : (nx + 1, ny + 1) [m2], [N s/m] of the nodes of a face
    nose : (position, speed, shot, form), the first two (3,) of the nose [m], [m/s]
        shot : (4,) number of the shape, radius, edge radius, length [m];  form : (4,) as for `sdf_kernels`
    spring : (2,) penalty [Pa/m], toe [m]
    dt : [s]
    force : (n, 3) [N] added to
    out : (5,) NOSE [J] and the force [N] on the nose, PUSH .. PUSH + 2, overwritten; LOST [J] added to
    """
    (first, nx, ny, nz), (position, speed, shot, form) = shape, nose
    out[NOSE] = out[FORCE] = out[FORCE + 1] = out[FORCE + 2] = 0.0
    widest = shot[1] * shot[1]
    for i in range(nx + 1):
        for j in range(ny + 1):
            for face in (0, nz):
                n = first + (i * (ny + 1) + j) * (nz + 1) + face
                p0, p1, p2 = x[n, 0] - position[0], x[n, 1] - position[1], x[n, 2] - position[2]
                if p2 > 0.0 or p0 * p0 + p1 * p1 > widest:
                    continue
                gap, n0, n1, n2 = sdf_kernels.distance(int(shot[0]), p0, p1, p2, shot[1], shot[2], shot[3], form)
                if gap >= 0.0:
                    continue
                p, energy, closed = yarn_contact_kernels.pressure(-gap, spring[0], spring[1])
                opening = (v[n, 0] - speed[0]) * n0 + (v[n, 1] - speed[1]) * n1 + (v[n, 2] - speed[2]) * n2
                push = area[i, j] * p
                drag = max(-closed * damping[i, j] * opening, -push)
                push += drag
                out[NOSE] += energy * area[i, j]
                out[LOST] -= drag * (opening + 0.5 * dt * inverse_mass[n] * push) * dt  # mid-push, as at crossings
                force[n, 0] -= push * n0
                force[n, 1] -= push * n1
                force[n, 2] -= push * n2
                out[FORCE] -= push * n0
                out[FORCE + 1] -= push * n1
                out[FORCE + 2] -= push * n2


@kernel()
def clear(first, last, material, force):
    """Set the forces of the nodes first .. last - 1 to zero."""
    for n in range(first, last):
        for c in range(3):
            material[n, c] = force[n, c] = 0.0


@entry(parallel=True)
def forces(state, const, dt):
    """Internal forces of the whole patch and its contacts, state.f_material and state.f_other [N]."""
    for y in prange(const.first_node.size):
        f, nx, ny, nz = const.first_node[y], const.bricks_along[y], const.ny, const.nz
        sheet = (ny + 1) * (nz + 1)
        kind = const.yarn_type[y]
        e0, b0 = const.first_brick[y], const.first_bar[y]
        e1, b1 = e0 + nx * ny * nz, b0 + nx * sheet
        # where its kind of yarn has the same
        k0, l0, r0 = const.type_brick[kind], const.type_bar[kind], const.type_face[kind]
        k1, l1, r1 = k0 + nx * ny * nz, l0 + nx * sheet, r0 + nx + 1
        clear(f, f + (nx + 1) * sheet, state.f_material, state.f_other)
        alive = state.bar_intact[b0:b1]
        fibre_kernels.bar_forces(
            f, b1 - b0, sheet, state.x, state.v, const.bar_length[l0:l1], const.bar_stiffness[kind],
            const.fibre_law[kind], dt, alive, state.f_other, state.energy_sums[y],
        )  # fmt: skip
        solid_kernels.solid_forces(
            (f, nx, ny, nz), state.x,
            (const.gradient[k0:k1], const.volume[k0:k1], const.hourglass_pattern[k0:k1],
             const.hourglass_stiffness[k0:k1], const.solid_viscosity[k0:k1]),
            const.solid_law[kind], dt, alive, state.last_log_stretch[e0:e1], state.brick_failed[e0:e1],
            state.f_material, state.f_other, state.energy_sums[y],
        )  # fmt: skip
        nose_forces(
            (f, nx, ny, nz), state.x, state.v, const.inverse_mass, const.face_area[r0:r1], const.nose_damping[r0:r1],
            (state.projectile_position, state.projectile_velocity, const.nose_shape, const.nose_parameters),
            const.nose_penalty, dt, state.f_other, state.nose_sums[y],
        )  # fmt: skip
    yarn_contact_kernels.crossings(
        const.crossing_order, const.colour_start, (state.x, state.v, const.inverse_mass), state.brick_failed,
        (const.crossing_node, const.crossing_brick, const.crossing_start, const.warp_over, const.cp_bounds),
        const.crossing_shape, const.contact_penalty,
        (const.contact_area, const.contact_damping, state.closest_point, state.wait_steps),
        (dt, state.step_sizes[1]), state.f_other, state.contact_energy,
    )  # fmt: skip


@kernel()
def move_yarn(y, nodes, x, v, material, force, mass, inverse_mass, kick, dt, sums, half):
    """Velocities of the nodes first .. last - 1, nodes = (first, last), over `kick` [s], places over `dt` [s].

    The work of the material's forces is added to sums[y, SOLID], half of this step's is left in half[y], and the
    kinetic energy at the instant of the forces in sums[y, KINETIC] [J].
    """
    power, kinetic = 0.0, 0.0
    for n in range(nodes[0], nodes[1]):
        for c in range(3):
            before = v[n, c]
            after = before - kick * inverse_mass[n] * (material[n, c] + force[n, c])
            mean = 0.5 * (before + after)
            power += material[n, c] * mean
            kinetic += 0.5 * mass[n] * mean * mean
            v[n, c] = after
            x[n, c] += dt * after
    sums[y, SOLID] += kick * power
    sums[y, KINETIC] = kinetic
    half[y] = 0.5 * kick * power


@kernel(parallel=True)
def move(state, const, kick, dt):
    """Step of all yarns; work and kinetic energy are kept for each."""
    for y in prange(const.first_node.size):
        first = const.first_node[y]
        last = first + (const.bricks_along[y] + 1) * (const.ny + 1) * (const.nz + 1)
        move_yarn(
            y, (first, last), state.x, state.v, state.f_material, state.f_other, const.mass, const.inverse_mass, kick,
            dt, state.energy_sums, state.half_step_work,
        )  # fmt: skip


@entry()
def run_steps(state, const, steps):
    """Make `steps` steps of state.step_sizes[0] [s]."""
    push = np.empty(3)
    dt = state.step_sizes[0]
    for _ in range(steps):
        forces(state, const, state.step_sizes[2])
        kick = 0.5 * (state.step_sizes[2] + dt)
        move(state, const, kick, dt)
        push[:] = 0.0
        for y in range(const.first_node.size):
            for c in range(3):
                push[c] += state.nose_sums[y, FORCE + c]
        state.projectile_energy[0] = 0.0
        for c in range(3):
            before = state.projectile_velocity[c]
            state.projectile_velocity[c] += kick * push[c] / const.projectile_mass
            mean = 0.5 * (before + state.projectile_velocity[c])
            state.projectile_energy[0] += 0.5 * const.projectile_mass * mean * mean
            state.projectile_position[c] += dt * state.projectile_velocity[c]
            state.f_contact_nose[c] = push[c]
        state.step_sizes[2] = dt
        state.counter[0] += 1
        state.time[0] += dt


@entry(parallel=True)
def frequency_bounds(state, const, worst):
    """Bounds of the square of the highest frequency, per yarn: row sums of the tangent over the nodal mass.

    Parameters
    ----------
    worst : (yarns, 2) filled: [1/s2], and the node
    """
    for y in prange(const.first_node.size):
        nx, kind = const.bricks_along[y], const.yarn_type[y]
        sheet = (const.ny + 1) * (const.nz + 1)
        bricks, bars, e0, b0 = nx * const.ny * const.nz, nx * sheet, const.first_brick[y], const.first_bar[y]
        k0, l0 = const.type_brick[kind], const.type_bar[kind]
        yarn_frequency_bound(
            y, (const.first_node[y], nx, const.ny, const.nz), state.x,
            (const.gradient[k0 : k0 + bricks], const.volume[k0 : k0 + bricks], const.solid_law[kind],
             const.hourglass_stiffness[k0 : k0 + bricks], state.brick_failed[e0 : e0 + bricks]),
            (const.bar_length[l0 : l0 + bars], const.bar_stiffness[kind], state.bar_intact[b0 : b0 + bars]),
            const.contact_row_sum, const.inverse_mass, worst,
        )  # fmt: skip


@kernel()
def yarn_frequency_bound(y, shape, x, bricks, bars, contact_rows, inverse_mass, worst):
    """The bound of one yarn, worst[y].

    shape : as for `nose_forces`;  bricks : gradient, volume, law, hourglass stiffness, failed;  bars : length,
    stiffness, intact
    """
    (first, nx, ny, nz), (gradient, volume, law, control, torn), (length, stiffness, alive) = shape, bricks, bars
    sheet = (ny + 1) * (nz + 1)
    rows = np.zeros((nx + 1) * sheet)
    brick_row_sums(first, nx, ny, nz, x, gradient, volume, law, control, torn, rows)
    for m in range(nx * sheet):
        if alive[m]:
            k = 2.0 * stiffness[m % sheet] / length[m]
            rows[m] += k
            rows[m + sheet] += k
    worst[y, 0] = worst[y, 1] = 0.0
    for m in range(rows.size):
        square = (rows[m] + contact_rows[first + m]) * inverse_mass[first + m]
        if not square <= worst[y, 0]:
            worst[y, 0], worst[y, 1] = square, first + m


@kernel()
def brick_row_sums(first, nx, ny, nz, x, gradient, volume, law, control, torn, rows):
    """Add bounds of the rows of the bricks' tangents [N/m] to rows : nodes of the yarn."""
    nodes, places, f, sums = np.empty(8, np.int64), np.empty((8, 3)), np.empty((3, 3)), np.empty(3)
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                m = (i * ny + j) * nz + k
                if torn[m]:
                    continue
                brick_nodes(first, i, j, k, ny, nz, nodes)
                for a in range(8):
                    for c in range(3):
                        places[a, c] = x[nodes[a], c]
                mean_deformation(places, gradient[m], f)
                _, _, _, R11, R22, R33, _, _, _ = solid_kernels.triangular(f)
                V_f = law[3] / (R22 * R33)
                E_2, slope = solid_kernels.transverse_modulus(V_f, law[3], law[4], law[1], law[2])
                e2, e3 = abs(math.log(R22)), abs(math.log(R33))
                steep = E_2 + (e2 + e3) * slope * V_f + 2.0 * law[5]
                axial = law[0] * V_f * (1.0 + abs(math.log(R11))) + 2.0 * law[5]
                J = R11 * R22 * R33
                moduli = (axial * J / R11**2, steep * J / R22**2, steep * J / R33**2)
                for c in range(3):
                    sums[c] = 0.0
                    for a in range(8):
                        sums[c] += abs(gradient[m, a, c])
                shape = 0.0
                for q in range(4):
                    for c in range(3):
                        shape += 8.0 * control[m, q, c]
                for a in range(8):
                    row = shape
                    for c in range(3):
                        row += volume[m] * moduli[c] * abs(gradient[m, a, c]) * sums[c]
                    rows[nodes[a] - first] += row
