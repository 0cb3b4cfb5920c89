"""Forces of one yarn: hexahedra with one integration point, and fibre bars on the mesh edges along it.

The bricks follow the law of `fabrics.yarn_stress_kernels` at their mean deformation, with the viscous stress of
`law_kernels` and the hourglass control of `block.brick_kernels`, which has the energy of the 2 x 2 x 2 rule at rest
and is too soft in packed yarns (docs/theory-panel.md, "Woven solid yarns"; one that stiffens with the law was tried:
it has no potential, and torn yarns became unstable).

A bar has N = E A [s(e) + s'(e) xi (L / c) de/dt], xi the damping ratio of the highest mode along a taut yarn. A brick
is gone with half of its bars; in a yarn that has been cut also once its fibres are folded to a tenth of their length
or it has no volume left; in a whole yarn that makes the run unstable.
"""

import math

import numpy as np

from fabrics import yarn_stress_kernels
from shellfabric.block.brick_kernels import brick_nodes, hourglass, mean_deformation
from shellfabric.jit.compile import kernel
from shellfabric.surface.vector_kernels import dot, scaled, subtract, three
from validation.models.solids.law_kernels import damped_stress, elastic_stress, moduli_bound

FOLDED = 0.1  # length of fibres over that at rest
CORNERS = 8

fibre_law = kernel()(yarn_stress_kernels.fibre_law)
fibre_energy = kernel()(yarn_stress_kernels.fibre_energy)


@kernel()
def count_bars(patch, yarn):
    """Return the numbers of nodes in a section and of bars of a yarn."""
    sheet = (patch.ny[yarn] + 1) * (patch.nz + 1)
    return sheet, patch.nx[yarn] * sheet


@kernel(fastmath={"contract"})
def bar_forces(patch, yarn, dt):
    """Add the internal forces of the bars of one yarn; bars that are strained too far fail first.

    dt : [s] for what the viscous forces take
    """
    sheet, bars = count_bars(patch, yarn)
    first = patch.first_node[yarn]
    stored = 0.0
    lost = 0.0
    for m in range(bars):
        bar = patch.first_bar[yarn] + m
        if not patch.bar_intact[bar]:
            continue
        near = first + m
        far = near + sheet
        edge = subtract(three(patch.x[far], 0), three(patch.x[near], 0))
        now = math.sqrt(dot(edge, edge))
        length = patch.bar_length[bar]
        stiffness = patch.bar_stiffness[bar]
        strain = now / length - 1.0
        energy = fibre_energy(strain, patch.slack_stiffness, patch.slack_width)
        energy = energy * stiffness * length
        if strain >= patch.failure_strain[yarn]:
            patch.bar_intact[bar] = False
            patch.failure_energy += energy
            continue
        stored += energy
        value, slope = fibre_law(strain, patch.slack_stiffness, patch.slack_width)
        opening = subtract(three(patch.v[far], 0), three(patch.v[near], 0))
        rate = dot(edge, opening) / (now * length)
        drag = slope * patch.lag[yarn] * length * rate
        lost += stiffness * length * drag * rate * dt
        pull = scaled(stiffness * (value + drag) / now, edge)
        for c in range(3):
            patch.f_other[near, c] -= pull[c]
            patch.f_other[far, c] += pull[c]
    patch.fibre_energy += stored
    patch.fibre_damping += lost


@kernel()
def brick_held(patch, yarn, i, j, k):
    """Tell whether three of the four bars on the edges of a brick are whole."""
    row = patch.nz + 1
    bar = patch.first_bar[yarn] + (i * (patch.ny[yarn] + 1) + j) * row + k
    whole = patch.bar_intact
    return (
        int(whole[bar]) + int(whole[bar + 1]) + int(whole[bar + row]) + int(whole[bar + row + 1])
        >= 3
    )


@kernel()
def brick_folded(f):
    """Tell whether a brick's fibres are folded to `FOLDED`, or it has no volume left; f[c, i] the
    component c of F e_i."""
    if f[0, 0] * f[0, 0] + f[1, 0] * f[1, 0] + f[2, 0] * f[2, 0] < FOLDED * FOLDED:
        return True
    return inverted(f)


@kernel()
def inverted(f):
    """Tell whether no volume is left; f as in `brick_folded`."""
    volume = (
        f[0, 0] * (f[1, 1] * f[2, 2] - f[2, 1] * f[1, 2])
        - f[1, 0] * (f[0, 1] * f[2, 2] - f[2, 1] * f[0, 2])
        + f[2, 0] * (f[0, 1] * f[1, 2] - f[1, 1] * f[0, 2])
    )
    return volume <= 0.0


@kernel()
def yarn_is_cut(patch, yarn):
    """Tell whether a bar of a yarn has failed."""
    bars = count_bars(patch, yarn)[1]
    first = patch.first_bar[yarn]
    return not patch.bar_intact[first : first + bars].all()


@kernel()
def point_inverted(patch, brick, places, f):
    """Tell whether a brick has no volume left at a point of the full rule; f : (3, 3) scratch."""
    for q in range(patch.point_volume.shape[1]):
        mean_deformation(places, patch.point_gradient[brick, q], f)
        if inverted(f):
            return True
    return False


@kernel(fastmath={"contract"})
def add_stress(patch, nodes, b, volume, P):
    """Add the forces of a stress P that acts over a volume [m3] with the gradients b : (8, 3)."""
    for a in range(CORNERS):
        for c in range(3):
            stress = P[c, 0] * b[a, 0] + P[c, 1] * b[a, 1] + P[c, 2] * b[a, 2]
            patch.f_solid[nodes[a], c] += volume * stress


@kernel(fastmath={"contract"})
def brick_forces(patch, yarn, dt):
    """Add the internal forces of the bricks of one yarn: those of the law to `f_solid`, those of the
    hourglass control to `f_other`.

    dt : [s] since the last call; 0 at the first, for no rates
    """
    nodes = np.empty(CORNERS, np.int64)
    places = np.empty((CORNERS, 3))
    own = np.empty((CORNERS, 3))
    f = np.empty((3, 3))
    F = np.empty((3, 3))
    P = np.empty((3, 3))
    D = np.empty((3, 3))
    H = np.empty((4, 3))
    ny = patch.ny[yarn]
    nz = patch.nz
    law = six(patch.law, yarn)
    per_time = 0.0
    if dt > 0.0:
        per_time = 1.0 / dt
    cut = yarn_is_cut(patch, yarn)
    points = patch.point_volume.shape[1]
    elastic = 0.0 if points else 1.0
    stored = 0.0
    lost = 0.0
    brick = patch.first_brick[yarn] - 1
    for i in range(patch.nx[yarn]):
        for j in range(ny):
            for k in range(nz):
                brick += 1
                if patch.torn[brick]:
                    continue
                brick_nodes(patch.first_node[yarn], i, j, k, ny, nz, nodes)
                for a in range(CORNERS):
                    for c in range(3):
                        places[a, c] = patch.x[nodes[a], c]
                        own[a, c] = 0.0
                b = patch.gradient[brick]
                mean_deformation(places, b, f)
                energy = hourglass(f, places, patch.twist[brick], patch.control[brick], H, D, own)
                gone = not brick_held(patch, yarn, i, j, k) or (cut and brick_folded(f))
                if gone or (cut and point_inverted(patch, brick, places, F)):
                    patch.torn[brick] = True
                    patch.failure_energy += energy
                    continue
                last = (patch.log_stretch[brick, 0], patch.log_stretch[brick, 1])
                eta = (patch.viscosity[brick, 0], patch.viscosity[brick, 1])
                e2, e3, loss = damped_stress(f, law, last, per_time, eta, elastic, P)
                patch.log_stretch[brick, 0] = e2
                patch.log_stretch[brick, 1] = e3
                volume = patch.volume[brick]
                lost += loss * volume * dt
                stored += energy
                add_stress(patch, nodes, b, volume, P)
                for a in range(CORNERS):
                    for c in range(3):
                        shape = D[c, 0] * b[a, 0] + D[c, 1] * b[a, 1] + D[c, 2] * b[a, 2]
                        patch.f_other[nodes[a], c] += own[a, c] + shape
                for q in range(points):
                    mean_deformation(places, patch.point_gradient[brick, q], F)
                    elastic_stress(F, law, P)
                    volume = patch.point_volume[brick, q]
                    add_stress(patch, nodes, patch.point_gradient[brick, q], volume, P)
    patch.solid_damping += lost
    patch.hourglass_energy += stored


@kernel()
def six(values, row):
    """Return the six numbers of a row."""
    return (
        values[row, 0],
        values[row, 1],
        values[row, 2],
        values[row, 3],
        values[row, 4],
        values[row, 5],
    )


@kernel()
def add_bar_rows(patch, yarn, rows):
    """Add the row sums of the tangents of a yarn's bars [N/m] to rows : (nodes,)."""
    sheet, bars = count_bars(patch, yarn)
    first = patch.first_node[yarn]
    for m in range(bars):
        bar = patch.first_bar[yarn] + m
        if patch.bar_intact[bar]:
            row = 2.0 * patch.bar_stiffness[bar] / patch.bar_length[bar]
            rows[first + m] += row
            rows[first + m + sheet] += row


@kernel()
def add_brick_rows(patch, yarn, rows):
    """Add bounds of the row sums of the tangents of a yarn's bricks [N/m] to rows : (nodes,)."""
    nodes = np.empty(CORNERS, np.int64)
    places = np.empty((CORNERS, 3))
    f = np.empty((3, 3))
    ny = patch.ny[yarn]
    law = six(patch.law, yarn)
    brick = patch.first_brick[yarn] - 1
    for i in range(patch.nx[yarn]):
        for j in range(ny):
            for k in range(patch.nz):
                brick += 1
                if patch.torn[brick]:
                    continue
                brick_nodes(patch.first_node[yarn], i, j, k, ny, patch.nz, nodes)
                for a in range(CORNERS):
                    for c in range(3):
                        places[a, c] = patch.x[nodes[a], c]
                shape = 0.0
                for mode in range(4):
                    for c in range(3):
                        shape += CORNERS * patch.control[brick, mode, c]
                for a in range(CORNERS):
                    rows[nodes[a]] += shape
                b = patch.gradient[brick]
                if patch.point_volume.shape[1] == 0:
                    add_point_rows(places, nodes, b, patch.volume[brick], law, f, rows)
                for q in range(patch.point_volume.shape[1]):
                    b = patch.point_gradient[brick, q]
                    add_point_rows(places, nodes, b, patch.point_volume[brick, q], law, f, rows)


@kernel()
def add_point_rows(places, nodes, b, volume, law, f, rows):
    """Add to rows what one point of a brick gives, with its gradients b : (8, 3); f : (3, 3) scratch."""
    mean_deformation(places, b, f)
    moduli = moduli_bound(f, law)
    for c in range(3):
        size = 0.0
        for a in range(CORNERS):
            size += abs(b[a, c])
        size = size * volume * moduli[c]
        for a in range(CORNERS):
            rows[nodes[a]] += size * abs(b[a, c])
