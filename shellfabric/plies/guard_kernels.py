"""The guard: facets of different plies that are near each other stay on their sides of a plane between them.

A row of the guard has two facets A and B, with the distance d [m] at the beginning of a step and the direction n from A
to B. With x the places of their nodes and y those after the step by all forces, and t the thickness,

    min n.y_b - max n.y_a >= need,      need = max(0.2 d, min(d, 0.05 t))

A row that is violated gets the inelastic impulse n J between the two nodes that violate it most, as large as it has to
be. Rows are swept again (Gauss-Seidel) until all hold, or SWEEPS times. The nodes of rows that do not hold then move as
one, with the mean of their momentum, and so do those of rows that this violates.

At the beginning of the step A and B are on the two sides of a slab of width d across n, at its end on those of a slab
of width `need`: in between too, as nodes move straight. No motion satisfies every row. So each impulse, and each
cluster, is a projection, in the norm of the kinetic energy, on a set that holds it: the energy never grows, and a
solution exists. Impulses are equal and opposite, but for those of planes of symmetry.

A plane of symmetry, beyond which are the images of the plies, is a row with PLANE_X or PLANE_Y for the nodes of A. A
node on such a plane has the bit of its axis in `mirror`, and keeps to the plane.
"""

from shellfabric.jit.compile import kernel

PLANE_X, PLANE_Y = -1, -2
SWEEPS = 30
KEPT, NEAREST = 0.2, 0.05  # share of the distance that stays, thicknesses within which all of it does
_SLACK = 1e-3  # share of the distance by which a row may be missed
_MASS, _MOMENTUM, _FIXED = 0, 1, 4  # of the sums of a cluster


@kernel(_nrt=False, forceinline=True)
def needed(distance, thickness):
    """[m] that is to be left of a distance."""
    return max(KEPT * distance, min(distance, NEAREST * thickness))


@kernel(_nrt=False, forceinline=True)
def worst(y, nodes, n):
    """What is left between the facets of a row, and the two nodes that are to blame."""
    low, high, a, b = 1e30, -1e30, nodes[0], nodes[3]
    for i in range(3):
        k = nodes[i]
        along = n[0] * y[k, 0] + n[1] * y[k, 1] + n[2] * y[k, 2] if k >= 0 else 0.0
        if along > high:
            high, a = along, k
        k = nodes[3 + i]
        along = n[0] * y[k, 0] + n[1] * y[k, 1] + n[2] * y[k, 2]
        if along < low:
            low, b = along, k
    return low - high, a, b


@kernel(_nrt=False, forceinline=True)
def mobility(guard, k, n):
    """[s/kg] way along n that an impulse along n makes of a node in a step; 0 of one that is held."""
    if k < 0:
        return 0.0
    free = 1.0 - (n[0] * n[0] if guard.mirror[k] & 1 else 0.0) - (n[1] * n[1] if guard.mirror[k] & 2 else 0.0)
    return guard.kick[k] * max(free, 0.0)


@kernel(_nrt=False, forceinline=True)
def push(guard, k, n, impulse):
    """Give a node an impulse [kg m/s] along n."""
    if k < 0 or guard.kick[k] == 0.0:
        return
    for c in range(3):
        if not (c < 2 and guard.mirror[k] >> c & 1):
            guard.impulse[k, c] += impulse * n[c]
            guard.y[k, c] += guard.kick[k] * impulse * n[c]


@kernel(_nrt=False)
def project(guard, rows, nodes):
    """Impulses that make the first `rows` rows hold, into guard.impulse, and the places by them, in guard.y.

    nodes : how many of guard.node_list have a part in the rows. Returns (impulses given, whether all rows hold)
    """
    given = 0
    for _ in range(SWEEPS):
        held = 0
        for row in range(rows):
            n = guard.row_normal[row]
            left, a, b = worst(guard.y, guard.row_nodes[row], n)
            missing = guard.row_need[row] - left
            if missing > _SLACK * guard.row_need[row]:
                give = mobility(guard, a, n) + mobility(guard, b, n)
                held += 1
                if give > 0.0:
                    push(guard, a, n, -missing / give)
                    push(guard, b, n, missing / give)
        given += held
        if held == 0:
            return given, True
    for m in range(nodes):
        guard.root[guard.node_list[m]] = guard.node_list[m]
        guard.cluster[guard.node_list[m], _FIXED] = guard.mirror[guard.node_list[m]]
    for _ in range(nodes + 3):
        if not join_violated(guard, rows):
            return given, True
        move_clusters(guard, nodes)
    return given, False


@kernel(_nrt=False, forceinline=True)
def root_of(guard, k):
    """The node that stands for the cluster of a node."""
    while guard.root[k] != k:
        k = guard.root[k]
    return k


@kernel(_nrt=False)
def join_violated(guard, rows):
    """Join the nodes of each row that does not hold in one cluster: whether there is any."""
    found = False
    for row in range(rows):
        nodes = guard.row_nodes[row]
        if worst(guard.y, nodes, guard.row_normal[row])[0] >= (1.0 - 2.0 * _SLACK) * guard.row_need[row]:
            continue
        found = True
        first = root_of(guard, nodes[3])
        for i in range(6):
            if nodes[i] < 0:  # what would go through a plane of symmetry keeps to it from then on
                guard.cluster[first, _FIXED] = int(guard.cluster[first, _FIXED]) | (1 if nodes[i] == PLANE_X else 2)
                continue
            other = root_of(guard, nodes[i])
            if other != first:
                guard.root[other] = first
                guard.cluster[first, _FIXED] = int(guard.cluster[first, _FIXED]) | int(guard.cluster[other, _FIXED])
    return found


@kernel(_nrt=False)
def move_clusters(guard, nodes):
    """Give all nodes of a cluster its mean velocity, or none along an axis that one of them cannot move along."""
    for m in range(nodes):
        for c in range(_FIXED):
            guard.cluster[guard.node_list[m], c] = 0.0
    for m in range(nodes):
        k = guard.node_list[m]
        r = root_of(guard, k)
        if guard.kick[k] == 0.0:
            guard.cluster[r, _FIXED] = 7
            continue
        guard.cluster[r, _MASS] += 1.0 / guard.kick[k]
        for c in range(3):
            guard.cluster[r, _MOMENTUM + c] += (guard.y[k, c] - guard.x[k, c]) / guard.kick[k]
    for m in range(nodes):
        k = guard.node_list[m]
        r = root_of(guard, k)
        if guard.kick[k] == 0.0:
            continue
        for c in range(3):
            fixed = int(guard.cluster[r, _FIXED]) >> c & 1
            way = 0.0 if fixed else guard.cluster[r, _MOMENTUM + c] / guard.cluster[r, _MASS]
            guard.impulse[k, c] += (way + guard.x[k, c] - guard.y[k, c]) / guard.kick[k]
            guard.y[k, c] = guard.x[k, c] + way
