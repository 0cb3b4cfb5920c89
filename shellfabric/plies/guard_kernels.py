"""The guard: facets of different plies that are near each other stay on their sides of a plane between them (why it
works: docs/theory-panel.md, "Packs: contact between plies"). A constraint has two facets A and B at the distance d
[m] at the beginning of a step, with the direction n from A to B; with y the places of nodes after it, and t the
thickness,

    min n.y_b - max n.y_a >= need,      need = max(0.2 d, min(d, 0.05 t))

A plane of symmetry is a constraint with PLANE_X or PLANE_Y for the nodes of A. A node on such a plane has the bit of
its axis in `PackContact.plane_bits`, and keeps to the plane.
"""

from shellfabric.jit.compile import kernel
from shellfabric.plies.state import unit
from shellfabric.surface.vector_kernels import dot, nodal

PLANE_X = -1
PLANE_Y = -2
SWEEPS = 30
KEPT = 0.2  # share of the distance that stays
NEAREST = 0.05  # thicknesses within which all of it does
HELD = 7  # bits of all axes: a cluster that does not move
_SLACK = 1e-3  # share of the distance by which a constraint may be missed


@kernel(_nrt=False, forceinline=True)
def gap_to_keep(distance, thickness):
    """Return how much [m] of a distance has to be left."""
    return max(KEPT * distance, min(distance, NEAREST * thickness))


@kernel(_nrt=False, forceinline=True)
def remaining_gap(y, nodes, n):
    """Return what is left between the facets of a constraint, and the two nodes that violate it
    most."""
    low = 1e30
    high = -1e30
    a = nodes[0]
    b = nodes[3]
    for i in range(3):
        k = nodes[i]
        along = 0.0  # of a plane of symmetry
        if k >= 0:
            along = dot(n, nodal(y, k))
        if along > high:
            high = along
            a = k
        k = nodes[3 + i]
        along = dot(n, nodal(y, k))
        if along < low:
            low = along
            b = k
    return low - high, a, b


@kernel(_nrt=False, forceinline=True)
def mobility(contact, k, n):
    """Return by how much [s/kg] an impulse along n moves a node along n in a step; 0 of one that is
    held."""
    guard = contact.guard
    if k < 0:
        return 0.0
    free = 1.0
    for c in range(2):
        if contact.plane_bits[k] >> c & 1:
            free -= n[c] * n[c]
    return guard.dt_over_mass[k] * max(free, 0.0)


@kernel(_nrt=False, forceinline=True)
def add_impulse(contact, k, n, impulse):
    """Give a node an impulse [kg m/s] along n."""
    guard = contact.guard
    if k < 0 or guard.dt_over_mass[k] == 0.0:
        return
    for c in range(3):
        if not (c < 2 and contact.plane_bits[k] >> c & 1):
            guard.impulse[c, k] += impulse * n[c]
            guard.predicted_x[c, k] += guard.dt_over_mass[k] * impulse * n[c]


@unit("integer; flag")
def project_constraints(contact, rows, nodes):
    """Find the impulses by which the first `rows` constraints hold, into guard.impulse, and the
    positions with them, in guard.predicted_x.

    A constraint that is violated gets the inelastic impulse n J between the two nodes that violate
    it most, as large as stops them: what is then left is d. Constraints are swept again
    (Gauss-Seidel) until all hold, or SWEEPS times. An impulse that left no more than need would
    leave every constraint of a stack at its limit, which the next impulse violates: sweeps would
    not end, and whole stacks would move as one, which takes energy that no two facets have had
    between them.

    nodes : how many of guard.nodes have a part in the constraints

    Returns
    -------
    number of impulses given, whether all constraints hold
    """
    guard = contact.guard
    given = 0
    for _ in range(SWEEPS):
        held = 0
        for row in range(rows):
            n = guard.normal[row]
            left, a, b = remaining_gap(guard.predicted_x, guard.constraint_nodes[row], n)
            missing = guard.required_gap[row] - left
            # an impulse leaves the distance, not the least that is needed (see the head of this file)
            if missing > _SLACK * guard.required_gap[row]:
                give = mobility(contact, a, n) + mobility(contact, b, n)
                missing = max(missing, guard.gap[row] - left)
                held += 1
                if give > 0.0:
                    add_impulse(contact, a, n, -missing / give)
                    add_impulse(contact, b, n, missing / give)
        given += held
        if held == 0:
            return given, True
    # the sweeps have not resolved all: what is violated moves as one from here on
    for m in range(nodes):
        k = guard.nodes[m]
        guard.cluster_root[k] = k
        guard.cluster_fixed[k] = contact.plane_bits[k]
    # each round joins two clusters at least, or one and a plane
    for _ in range(nodes + 3):
        if not join_clusters(contact, rows):
            return given, True
        move_clusters(contact, nodes)
    return given, False


@kernel(_nrt=False, forceinline=True)
def find_root(contact, k):
    """Return the node that stands for the cluster of a node."""
    guard = contact.guard
    while guard.cluster_root[k] != k:
        k = guard.cluster_root[k]
    return k


@kernel(_nrt=False)
def join_clusters(contact, rows):
    """Join the nodes of each constraint that does not hold in one cluster; return whether there is
    any."""
    guard = contact.guard
    found = False
    for row in range(rows):
        nodes = guard.constraint_nodes[row]
        if (
            remaining_gap(guard.predicted_x, nodes, guard.normal[row])[0]
            >= (1.0 - 2.0 * _SLACK) * guard.required_gap[row]
        ):
            continue
        found = True
        first = find_root(contact, nodes[3])
        for i in range(6):
            if nodes[i] < 0:  # what would go through a plane of symmetry keeps to it from then on
                plane = 2
                if nodes[i] == PLANE_X:
                    plane = 1
                guard.cluster_fixed[first] |= plane
                continue
            other = find_root(contact, nodes[i])
            if other != first:
                guard.cluster_root[other] = first
                guard.cluster_fixed[first] |= guard.cluster_fixed[other]
    return found


@kernel(_nrt=False)
def move_clusters(contact, nodes):
    """Give all nodes of a cluster its mean velocity, or none along an axis that one of them cannot
    move along."""
    guard = contact.guard
    for m in range(nodes):
        k = guard.nodes[m]
        guard.cluster_mass[k] = 0.0
        for c in range(3):
            guard.cluster_momentum[c, k] = 0.0
    for m in range(nodes):
        k = guard.nodes[m]
        r = find_root(contact, k)
        if guard.dt_over_mass[k] == 0.0:
            guard.cluster_fixed[r] = HELD
            continue
        guard.cluster_mass[r] += 1.0 / guard.dt_over_mass[k]
        for c in range(3):
            step = guard.predicted_x[c, k] - contact.x[c, k]
            guard.cluster_momentum[c, r] += step / guard.dt_over_mass[k]
    for m in range(nodes):
        k = guard.nodes[m]
        r = find_root(contact, k)
        if guard.dt_over_mass[k] == 0.0:
            continue
        for c in range(3):
            step = 0.0
            if not guard.cluster_fixed[r] >> c & 1:
                step = guard.cluster_momentum[c, r] / guard.cluster_mass[r]
            missing = step + contact.x[c, k] - guard.predicted_x[c, k]
            guard.impulse[c, k] += missing / guard.dt_over_mass[k]
            guard.predicted_x[c, k] = contact.x[c, k] + step
