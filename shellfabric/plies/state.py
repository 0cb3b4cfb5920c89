"""The arrays and numbers of the contact between the plies of a pack.

`PackContact` has the surfaces of all plies in one frame, and three rows: which tiles and facets are
near each other (`NeighbourLists`), the contact of surfaces that face each other (`Pressure`), and
the constraints that keep facets from passing through each other (`Guard`).

A displacement of a tile is the sum over the steps of the largest displacement of its nodes in each.
It never decreases. What is `gap` [m] apart cannot touch before the displacements of its two tiles
have grown by `gap` together: a field whose name ends with "recheck_at" is the sum at which they can.
"""

from shellfabric.jit.compile import units
from shellfabric.jit.table import Row, array, flag, integer, number, row, tally, total
from shellfabric.state import PARAMETERS


class NeighbourLists(Row):
    """Which tiles and facets of different plies are near each other (`plies.near_kernels`).

    Broad phase: pairs of tiles, by sweep and prune of their boxes; of these, pairs of tiles whose
    surfaces may touch, and pairs of facets. Lists have a skin, and are made anew when it is used up.
    """

    remake = tally("-", "whether all lists are to be made anew before the next step", kept=True)
    tile_ply = array("tiles int64", "-", "ply of each tile")
    first_tile = array(
        "plies + 1 int64", "-", "number of the first tile of each ply, and of all tiles"
    )
    tiles_across = array("plies int64", "-", "tiles along the second axis of each ply")
    displacement = array("tiles", "m", "sum over the steps of the largest of a tile's nodes")
    step_displacement = array("tiles", "m", "the largest of its nodes in the last step")
    listed_displacement = array("tiles", "m", "displacement when pairs of tiles were last listed")
    squared_speed = array(
        "plies, blocks", "m2/s2", "scratch: largest squared speed of the nodes of a block"
    )
    box = array("tiles, 6", "m", "lower and upper ends of the boxes of the tiles")
    box_step = array("tiles int64", "-", "step in which the box of a tile was last found")
    sorted_tiles = array("tiles int64", "-", "tiles by the lower ends of their boxes along x")
    plane_recheck_at = array(
        "tiles", "m", "displacement at which a tile can be near a plane of symmetry"
    )
    tile_pairs = array(
        "pairs, 2 int64", "-", "pairs of tiles of different plies that are within reach"
    )
    n_tile_pairs = tally("-", "how many there are")
    pair_recheck_at = array("pairs", "m", "displacements at which their facets can be near")
    evaluated_at = array(
        "pairs",
        "m",
        "of tiles of neighbours: displacements when the points of the first were last evaluated",
    )
    hole_recheck_at = array(
        "pairs", "m", "of tiles of other plies: displacements at which they may touch"
    )
    tile_gap = array(
        "tiles",
        "m",
        "how far the nearest point of a tile was from touching the next ply when its points were "
        "last evaluated",
    )
    evaluated_step = array(
        "tiles int64", "-", "step in which the points of a tile were last evaluated"
    )
    has_hole = array("tiles uint8", "-", "whether elements of a tile have been dropped")
    faced_step = array(
        "tiles int64", "-", "step in which a tile last had one of the next ply within reach"
    )
    faced_hole_step = array("tiles int64", "-", "step in which one of these last had a hole")
    contact_pairs = array(
        "contact pairs, 2 int64",
        "-",
        "tiles whose points may touch in this step, with a tile of the ply that they may touch",
    )
    n_contact_pairs = tally("-", "how many there are")
    facet_pairs = array(
        "facet pairs, 6 int32",
        "-",
        "pairs of facets within reach: nodes of the one and of the other; a bare yarn has its last "
        "twice",
    )
    n_facet_pairs = tally("-", "how many there are")
    facet_pair_tiles = array("facet pairs int64", "-", "number of their pair of tiles")
    facet_pair_listing = array(
        "facet pairs",
        "m",
        "its pair_recheck_at when they were listed; a pair whose tiles have another by now is "
        "dropped",
    )
    facet_recheck_at = array(
        "facet pairs", "m", "displacements of their tiles at which they can be near"
    )
    facets = array("2, facets, 3 int64", "-", "scratch: facets of two tiles")
    facet_box = array("2, 6, facets", "m", "scratch: their boxes")
    facet_corner = array("2, 3, 3, facets", "m", "scratch: their corners")
    facet_normal = array("2, 3, facets", "-", "scratch: their unit normals n; 0 of bare yarns")
    facet_low = array("2, facets", "m", "scratch: the least n.x of their corners")
    facet_high = array("2, facets", "m", "scratch: the largest")


class Pressure(Row):
    """The contact of the surfaces of plies that face each other, point by point, with friction
    (`plies.pressure_kernels`)."""

    points_per_side = integer("-", "contact points along each side of an element")
    first_point = array(
        "plies int64", "-", "number of the first contact point of each ply but the last"
    )
    closest_a = array(
        "points + 8",
        "-",
        "place of the closest point on the next ply along its first axis, in "
        "elements: where the next search begins",
        kept=True,
    )
    closest_b = array("points + 8", "-", "the same along the second axis", kept=True)
    last_closure = array(
        "4, points + 8",
        "m",
        "closure of a point on the next ply, and on those behind it, when it last touched",
        kept=True,
    )
    unearned_closure = array(
        "4, points + 8",
        "m",
        "part of it that no motion has made, and that does not press",
        kept=True,
    )
    deepest_closure = array(
        "4, points + 8",
        "m",
        "largest closure less that part since the point touched",
        kept=True,
    )
    last_contact_step = array("4, points + 8", "-", "step in which it last touched", kept=True)
    slip_x = array(
        "4, points + 8",
        "m",
        "elastic slip of a point that sticks, along the first axis",
        kept=True,
    )
    slip_y = array("4, points + 8", "m", "the same along the second axis", kept=True)
    slip_z = array("4, points + 8", "m", "the same along the third axis", kept=True)
    first_element = array(
        "plies int64", "-", "number of the first element of each ply but the last, in `area_ratio`"
    )
    area_ratio = array(
        "elements + 8",
        "-",
        "area that the points of an element stand for, over that of the smallest",
    )
    laws = array(
        "plies - 1, cells + 1, 4",
        "N, N/m, N s/m, J",
        "laws of a contact point of each ply but the last: force, stiffness, damping "
        "and energy at the beginning of each cell of the closure, the last for all "
        "beyond",
    )
    law_cell = array("plies - 1", "m", "width of a cell")
    resilience = number("-", "share of the energy of a closure that comes back")
    share_drag = number("-", "D of limited shares over the damping of a point; 0: plain shares")
    friction = number("-", "Coulomb friction coefficient between plies")
    stick_stiffness = array(
        "plies - 1", "N/m", "stiffness along the surface of a contact point that sticks"
    )
    stick_damping = array("plies - 1", "N s/m", "its damping there")
    same_angle = array("plies - 1 boolean", "-", "whether a ply and the next lie at one angle")
    grid_force = array(
        "plies, 2, 3, slots",
        "N",
        "forces of the plies before and of those behind on the nodes and ghosts of "
        "each ply, while they are summed up",
    )
    grid_window = array(
        "plies, 2, 4 int64", "-", "rows and columns of nodes and ghosts with such forces"
    )
    force = array(
        "plies, 2, 3, slots of State",
        "N",
        "the same on the nodes, in each ply's own frame",
        kept=True,
    )
    window = array(
        "plies, 2, 4 int64",
        "-",
        "rows and columns (i0, i1, j0, j1) of nodes with forces of `force`",
        kept=True,
    )
    spring_energy = array(
        "plies", "J", "in the springs of the points of each ply on plies behind it, now", kept=True
    )
    max_closure = array("plies", "m", "largest closure of these points so far", kept=True)
    friction_work = array(
        "plies", "J", "energy lost by the friction of these points so far", kept=True
    )
    lost_energy = array("plies", "J", "of springs whose element was dropped, so far", kept=True)
    work = array("plies", "J", "work that the contact forces have taken from each ply", kept=True)


class Guard(Row):
    """Constraints that keep facets of different plies on their sides of a plane between them, and
    the impulses that enforce them (`plies.guard_kernels`)."""

    dt_over_mass = array("plies slots", "s/kg", "time step over nodal mass; 0 where held")
    predicted_x = array("3, plies slots", "m", "positions after the step of the constrained nodes")
    predicted_step = array(
        "plies slots int64", "-", "step in which the position after the step was last predicted"
    )
    nodes = array("plies slots int64", "-", "the constrained nodes")
    n_nodes = tally("-", "how many there are")
    impulse = array("3, plies slots", "N s", "impulses of the guard on these nodes")
    constraint_nodes = array(
        "constraints, 6 int32",
        "-",
        "nodes of both facets of the constraints of the present step; -1 or -2 for a plane of "
        "symmetry",
    )
    n_constraints = tally("-", "how many there are")
    normal = array("constraints, 3", "-", "direction from the one to the other")
    required_gap = array("constraints", "m", "distance along it that is to be left after the step")
    gap = array("constraints", "m", "distance along it at the beginning of the step")
    cluster_root = array(
        "plies slots int64", "-", "another node of the cluster of a node, or the node itself"
    )
    cluster_mass = array(
        "plies slots", "kg/s", "sum of mass over dt of the cluster that a node stands for"
    )
    cluster_momentum = array("3, plies slots", "kg m/s", "sum of its momentum")
    cluster_fixed = array("plies slots uint8", "-", "bits of the axes along which it cannot move")
    force = array(
        "plies, 3, slots of State",
        "N",
        "forces of the guard on the nodes in the present step; 0 between the steps",
    )
    window = array("plies, 4 int64", "-", "rows and columns of nodes with such forces")
    work = total("J", "work that these forces have taken so far", kept=True)
    n_impulses = tally("-", "impulses given so far", kept=True)
    least_gap_ratio = total("-", "least distance so far, over the thickness", kept=True)
    fault = tally("-", "what has failed, as `near_kernels.NOT_RESOLVED`; 0: nothing", kept=True)


class PackContact(Row):
    """The surfaces of the plies of a pack, in the frame of the first ply, and what is between them.

    Nodes and ghosts of all plies are in one array: node (i, j) of ply p is number base[p] + i
    row_stride[p] + j (`plies.frame_kernels`).
    """

    lists = row(NeighbourLists, "which tiles and facets are near each other")
    pressure = row(Pressure, "the contact of surfaces that face each other")
    guard = row(Guard, "constraints on facets that are near each other")
    step = tally("-", "steps made, and one", kept=True)
    dt = number("s", "time step")
    x = array("3, plies slots", "m", "positions of the nodes and ghosts of all plies")
    v = array("3, plies slots", "m/s", "their velocities")
    rest = array("3, plies slots", "m", "their positions at rest")
    base = array("plies int64", "-", "number of node (0, 0)")
    row_stride = array("plies int64", "-", "numbers from row to row of nodes")
    ni = array("plies int64", "-", "elements along the first axis")
    nj = array("plies int64", "-", "elements along the second axis")
    slots_per_ply = integer("-", "slots of the largest grid with its ghosts")
    turns = array(
        "plies, 2", "-", "cosine and sine of the angle from the first ply's frame to each ply's"
    )
    mirror_x = flag("whether x = 0 is a plane of symmetry")
    mirror_y = flag("whether y = 0 is a plane of symmetry")
    plane_bits = array(
        "plies slots uint8", "-", "1 of nodes on the plane x = 0 of symmetry, 2 on y = 0, 3 on both"
    )
    torn = array("plies slots uint8", "-", "1 of nodes at torn elements")
    dropped = array(
        "plies slots uint8", "-", "1 of elements that have eroded or hang loose", kept=True
    )
    failures = array("plies int64", "-", "failed yarn segments of each ply so far")
    thickness = array("plies", "m", "thickness of each ply")
    max_thickness = number("m", "the largest of them")
    max_diagonal = number("m", "longest diagonal of an element at rest")


unit = units(PARAMETERS | {"contact": PackContact})
