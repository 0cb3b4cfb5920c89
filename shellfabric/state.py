"""The arrays and numbers that kernels take: shape, unit, meaning, and whether a checkpoint keeps it.

A part that plugs in (yarns, block, bar, cell, coupon) has its tables in the `state.py` of its folder.
From the tables follow what kernels are compiled for, the storage for the arrays, checkpoints, and the
page "Arrays of the kernels" of the documentation (`tools/kernel_arrays.py`, which also explains
slots, edges, blocks). In shapes `2 x` is one array for each family of yarns and `3 x` one for each
component; sizes are explained where they first occur. Numbers that are `per_slot` become arrays on a
graded panel.

A kernel that is compiled by itself is a `unit`: its parameters have the names of `PARAMETERS`, all
others are integers unless its decorator says more.
"""

from shellfabric.jit.compile import units
from shellfabric.jit.declared import row_of
from shellfabric.jit.table import (
    Row,
    array,
    flag,
    integer,
    number,
    numbers,
    per_family,
    per_slot,
    row,
    tally,
    total,
)
from shellfabric.panel_numbers import PanelNumbers

# numbers of the two families of yarns
WARP = 0
WEFT = 1
# of state.block_damage: a block without failures, with some, with some of this step; one of a ply
# whose membrane is gone, all its yarns are resolved
INTACT = 0
DAMAGED = 1
REDO = 2
GONE = 3
# of state.element_flag; DRAWN_OUT: torn, and twice its size; RESOLVED: its yarns are resolved
WARP_FAILED = 1
WEFT_FAILED = 2
ERODED = 4
DRAWN_OUT = 8
RESOLVED = 16


Numbers = row_of(PanelNumbers)


class FailureLines(Row):
    """Lines of one family for the failure criterion: strengths, weights of means, low-pass factors."""

    strength = array(
        "lines", "N", "strength of the yarn nearest to the line; infinite where yarns do not fail"
    )
    half_strength = array(
        "lines",
        "N",
        "half of its lowest strength at any strain rate: a tension below is not low-passed",
    )
    first = array("lines int64", "-", "first line of the mean about the line")
    weights = array("lines, n", "-", "weights in it of the lines first ... first + n - 1")
    filter_factor = array(
        "edges along a line",
        "-",
        "share of the difference that a low-passed tension makes up in a step, 1 - exp(-dt / t_f)",
    )


class RateTable(Row):
    """Strength of warp and weft by strain rate (`membrane.criterion_kernels`); no loads without such a law."""

    load = array("2, loads", "-", "loads, rising, over the strength at rest")
    rate = array("2, loads", "1/s", "rate of damage at each of them")
    growth = array(
        "2, loads", "-", "growth of the logarithm of that rate by the load from there on"
    )


class PointLaw(Row):
    """Constants of the contact law of a point of the fabric with the projectile."""

    stiffness = number("N/m", "penalty stiffness of a contact point with the projectile")
    damping = number("N s/m", "damping of a contact point")
    mass = number("kg", "mass of the fabric, or of the net, at a contact point")
    implicit = number("-", "1: the force is that of the end of the step; 0: explicit contact")
    stick_stiffness = number("N/m", "stiffness along the surface of a point that sticks")
    stick_damping = number("N s/m", "most damping along the surface of such a point")
    share_drag = number("N s/m", "D of limited shares of a point; 0: plain shares")


class Profile(Row, kept=True):
    """The meridian of a body of revolution, set back by the edge radius (`projectile.profile_kernels`).

    Its places are those of the nose's frame: r from the axis, z along it, 0 at the foremost point. A
    ring is a node of the outline; not every ring has its place in the profile. All that touches one
    body shares its places, and has its own forces.
    """

    count = tally("-", "nodes of the profile")
    place = array("rings, 2", "m", "places (r, z) of these nodes, from the tip on")
    ring = array("rings int64", "-", "ring of each of them")
    velocity = array("rings, 2", "m/s", "velocities (r, z) of the rings, over that of the nose")
    force = array("rings, 2", "N", "forces (r, z) on the rings")
    widest = total("m", "largest radius of the body")
    shoulder = total("m", "depth behind the nose at which it has that radius")


class Nose(Row):
    """The shape of a projectile (`projectile.sdf_kernels`)."""

    kind = integer("-", "of the shape, see `projectile.sdf_kernels`")
    radius = number("m", "of the cylinder")
    edge_radius = number("m", "radius that rounds the edges")
    length = number("m", "length of the projectile; infinite without a rear end")
    form = array("n", "m, -", "further numbers of the shape, or of a solid its nodes")
    profile = row(Profile, "meridian of a body of revolution; empty of another shape")


class Surface(Row):
    """The nodes of a ply and a ring of ghosts about them, in the frame of the first ply (`surface.grid_kernels`)."""

    x = array("3 x grid slots", "m", "places")
    v = array("3 x grid slots", "m/s", "velocities")
    rest = array("3 x grid slots", "m", "places at rest")
    f = array("3 x grid slots", "N", "forces of the nose, while they are summed up")
    window = array("4 int64", "-", "rows and columns of nodes and ghosts with such forces")
    turn = array("2", "-", "cosine and sine of the angle from the first ply's frame to this one's")


class Scratch(Row):
    """Scratch of one call of the contact of a ply with the projectile."""

    nose_place = array("3", "m", "place of the nose")
    nose_velocity = array("3", "m/s", "its velocity")
    nose_force = array("3", "N", "force on it")
    contact_work = total("J", "work that the contact takes")
    spring_energy = total("J", "energy in its springs")
    axes = array("3, 3", "-", "axes of the projectile as rows, in the frame of the surface")
    bent = array("8 int64", "-", "of eight elements, see `surface.torn_kernels`")
    place = array("3, 8", "m", "places of eight contact points, from the nose along its axes")
    velocity = array("3, 8", "m/s", "their velocities relative to the nose")
    dv_other = array("3, 8", "m/s", "`State.dv_other` at the points")
    dv_contact = array("3, 8", "m/s", "`State.dv_contact` at the points")
    force = array("3, 8", "N", "forces on the points")
    normal = array("3, 8", "-", "directions of the nose's push on them")
    push = array("8", "N", "forces along these")
    closing = array("8", "m/s", "velocities at which the points come nearer to the nose")
    share_drag = array("8", "s/m", "D / f of their limited shares")


class Constants(Row):
    """What does not change of a ply and of its projectile."""

    ni = integer("-", "elements along the warp (x)")
    nj = integer("-", "elements along the weft (y)")
    row_stride = integer("-", "slots of one row of nodes, nj + 1")
    rows_per_block = integer("-", "element rows of a block")
    n_per_crossover = integer("-", "elements along a side of a crossover, where they are smallest")
    warp_lines = row(
        FailureLines,
        "grid lines along the warp: strengths, weights of mean tensions, low-pass factors",
    )
    weft_lines = row(FailureLines, "the same of grid lines along the weft")
    mean_reach = integer(
        "-", "rows to either side that the mean tension of a weft edge may take in"
    )
    mirror_x = flag("whether x = 0 is a plane of symmetry that bounds the model")
    mirror_y = flag("whether y = 0 is a plane of symmetry that bounds the model")
    x0 = number("m", "x of node (0, 0) at rest; the impact point is the origin")
    y0 = number("m", "y of node (0, 0) at rest")
    dx = number("m", "side of an element along the warp; of the smallest on a graded panel")
    dy = number("m", "side of an element along the weft; of the smallest on a graded panel")
    inv_dx = per_slot("1/m", "inverse length at rest of the warp edges; an array on a graded panel")
    inv_dy = per_slot("1/m", "inverse length at rest of the weft edges; an array on a graded panel")
    dt = number("s", "time step")
    tension1 = array(
        "cells, 4",
        "N",
        "warp tension of the cell table: bilinear coefficients of 1, p, q, p q in each table cell",
    )
    tension2 = array("cells, 4", "N", "weft tension of the cell table, likewise")
    tension_bound_table1 = array(
        "n, 2",
        "N",
        "upper bound of the warp tension where no force exceeds step n: max(column 0, "
        "force + column 1)",
    )
    tension_bound_step1 = number("N", "force between two rows of tension_bound_table1")
    tension_bound_table2 = array("n, 2", "N", "upper bound of the weft tension, likewise")
    tension_bound_step2 = number("N", "force between two rows of tension_bound_table2")
    potential_coefficients = array(
        "cells, 8",
        "J",
        "biquadratic potential of a crossover in each table cell: coefficients of p, "
        "p2, q, q2, p q, p2 q, p q2, p2 q2",
    )
    potential_constant = array("cells", "J", "its coefficient of 1")
    table_grid = numbers(
        7,
        "-",
        "of the cell table: lowest warp stretch, cells per unit of it, index of the last cell along "
        "it; the same of the weft stretch; number of cells along that",
    )
    table_beyond = numbers(
        6,
        "-",
        "beyond the table: reaches of the coupling in cells, slopes and curvatures "
        "[J] of the potential at its corner",
    )
    force_per_slope1 = number(
        "1/m",
        "warp force per slope of the potential in local coordinates, cells per stretch over 2 w1",
    )
    force_per_slope2 = number("1/m", "weft force per slope of the potential in local coordinates")
    variational = flag(
        "whether forces are the gradient of the potential; otherwise the equilibrium form"
    )
    mean_weight1 = per_slot(
        "-",
        "weight of the warp edge before a node in the mean of the two edges at the "
        "node; 1/2 on a uniform grid",
    )
    mean_weight2 = per_slot("-", "weight of the weft edge before a node, likewise")
    cv1 = per_slot("N", "viscous force of warp edges per increment of stretch in a step")
    cv2 = per_slot("N", "viscous force of weft edges per increment of stretch in a step")
    trellis_volume = per_slot("m3", "volume of the shell in an element, for its shear energy")
    G1 = number("Pa", "shear modulus of the trellis below gamma1; 0 without trellis")
    G2 = number("Pa", "tangent shear modulus above gamma2 (locked)")
    gamma1 = number("rad", "shear angle where stiffening begins")
    gamma2 = number("rad", "shear angle where stiffening ends")
    w1 = number("m", "half length of a crossover along the warp")
    S01 = number("m", "length of warp yarn in a crossover at rest")
    EA1 = number("N", "axial stiffness of a warp yarn")
    w2 = number("m", "half length of a crossover along the weft")
    S02 = number("m", "length of weft yarn in a crossover at rest")
    EA2 = number("N", "axial stiffness of a weft yarn")
    half_strength1 = number(
        "N", "half of the lowest strength of a warp line: tensions below need no closer look"
    )
    half_strength2 = number("N", "half of the lowest strength of a weft line")
    panel = row(Numbers, "numbers of the panel, as they are declared (`panel_numbers`)")
    rate_law = row(RateTable, "strength of the yarns by strain rate")
    erosion_gap_ratio = number(
        "-", "stretch of the gap left by failed yarns at which an element is eroded"
    )
    window_limits = numbers(4, "-", "largest contact window (i0, i1, j0, j1)", "int64")
    points_per_side = integer("-", "contact points along each side of an element")
    point_law = row(PointLaw, "constants of the contact law of a point (`projectile.contact`)")
    projectile_radius = number("m", "radius of the projectile's cylinder")
    projectile_mass = number("kg", "mass of the modelled part of the projectile")
    free_dofs = numbers(
        3,
        "-",
        "1 for each direction in which the projectile may move, 0 across a plane of symmetry",
    )
    perforation_delay_steps = integer(
        "-",
        "steps with next to no contact and with no fabric ahead, after which the panel is perforated",
    )
    nose = row(Nose, "shape of the projectile")
    frame = array("3, 3", "-", "axes of the projectile's frame as rows; the last is its axis")
    window_follows = flag("whether the contact window follows the projectile, or is fixed")
    body_depth = number(
        "m", "length of the body behind the nose that the moving window takes into account"
    )
    draw_in_reach = numbers(
        2,
        "m",
        "distance from the projectile's middle, along warp and weft, from which "
        "fabric can be drawn under it",
    )
    foremost_offset = number(
        "m", "foremost point of a tilted body ahead of its nose, along the panel's normal"
    )
    shoulder = number("m", "depth behind the nose from which the projectile has its full width")
    friction = number("-", "Coulomb friction coefficient between fabric and projectile")
    holds_force = flag(
        "whether the projectile deforms, and holds the contact force of a step ago over a step"
    )
    slip_node = array("n int64", "-", "slots of the nodes that slip in the clamp")
    slip_axis = array("n int64", "-", "axis along which each of them moves")
    slip_length = array("n", "m", "slip of each that is prescribed, along that axis")
    slip_start = array("n", "s", "time at which it begins")
    slip_end = array("n", "s", "time at which it ends")
    slip_grip = array("n", "N", "friction of the clamp; 0 where the slip is prescribed")
    slip_mass = array("n", "kg", "mass of the node")
    bending = per_family(
        "N m",
        "bending stiffness of a grid line over the element side, n EI / L, of warp "
        "and weft; 0 without",
    )
    packing_stiffness = number("N/m", "stiffness of a ply in its plane as solid fibre")
    packed_area = number(
        "-", "share of its area at rest that packed fabric keeps (`membrane.packing_kernels`)"
    )
    yarn_ends = array(
        "2, 2 int64",
        "-",
        "how warp and weft yarns end at their lower and upper end: free, symmetric or clamped",
    )
    has_backing = flag("whether a backing block is coupled to the ply")


class PartTable(Row):
    """The parts that act in a step of a ply (`parts.Part`), a number for each."""

    flight = array(
        "parts int64", "-", "cell of the unit that acts as the projectile flies on; 0 of none"
    )
    forces = array("parts int64", "-", "cell of the unit that acts with the forces of the ply")
    nose = array("parts int64", "-", "cell of what the nose meets in place of the membrane")
    after = array("parts int64", "-", "cell of what acts when all have moved")
    own = array("parts int64", "-", "address of the part's row; 0 without one")
    replaces_membrane = flag("whether a part stands in for the membrane under the nose")


class State(Row, kept=True):
    """What changes of a ply, and of the projectile as it stands before it."""

    u = array("3 x slots", "m", "displacement of the nodes")
    v = array("3 x slots", "m/s", "velocity of the nodes, at half steps")
    f_int = array("3 x slots", "N", "internal force on the nodes")
    f_int_above = array(
        "3 x slots", "N", "part of it from the block above, on the first row of nodes of a block"
    )
    parts = row(PartTable, "what acts on the ply besides membrane, nose and other plies")
    surface = row(Surface, "what touches the ply sees of it")
    yarns_ahead = tally("-", "points of whole resolved yarns ahead of the nose")
    yarn_work = total("J", "work done so far on resolved yarns and on the contacts of theirs")
    mass = array("slots", "kg", "lumped mass of the nodes")
    inverse_mass = array("slots", "1/kg", "inverse mass; 0 where a node is held or prescribed")
    dt_over_mass = array("slots", "s/kg", "dt times inverse_mass")
    stretch = array("2 x slots", "-", "stretch of the edges at the last step")
    N = array(
        "2 x slots",
        "N",
        "force of the edges at the last step, per yarn, work-conjugate to the stretch",
    )
    T = array(
        "2 x slots", "N", "yarn tension of the edges; the same array as N in the equilibrium form"
    )
    dstretch = array("2 x slots float32", "-", "increment of the stretch in the last step")
    yarn_length = array(
        "2 x slots", "m", "total length of yarn that an edge stands for; reduced by failed yarns"
    )
    intact_fraction = array("2 x slots", "-", "fraction of an edge's yarns that is intact")
    failed = array(
        "2 x slots uint8", "-", "1 at the first node of each yarn segment that has failed"
    )
    filtered_tension = array(
        "2 x slots",
        "N",
        "low-passed mean tension F of the failure criterion; half of the strength "
        "where it is not followed",
    )
    warm_rows = array(
        "2, rows boolean", "-", "whether an edge of a row of warp or weft edges follows its tension"
    )
    warm_blocks = array("blocks boolean", "-", "whether a row of the block does")
    rate_damage = array(
        "2 x slots",
        "-",
        "damage of each yarn segment by the strength at strain rates, at its first "
        "node; empty without such a law",
    )
    failed_segments = total("-", "edges and segments of resolved yarns that have failed")
    loads_at_failure = total(
        "-", "sum over these of their tension at failure over the strength of their yarn"
    )
    element_flag = array(
        "slots uint8",
        "-",
        "damage bits of the elements: 1 a warp yarn failed, 2 a weft yarn failed, 4 "
        "eroded (no longer in contact), 8 torn and "
        "drawn out to twice its size, 16 within a zone of resolved yarns",
    )
    block_damage = array(
        "blocks uint8",
        "-",
        "INTACT, DAMAGED (yarns have failed), REDO (failed in this step: forces "
        "are to be computed again), or GONE (all yarns are resolved: no forces)",
    )
    tension_stale = array(
        "blocks boolean", "-", "whether T of a block is out of date, since nothing has needed it"
    )
    packed_blocks = array(
        "blocks boolean", "-", "whether a block has packed elements (`membrane.packing_kernels`)"
    )
    block_max_tension = array(
        "blocks, 2", "N", "largest tension of warp and weft in a block, or an upper bound of it"
    )
    last_contact_force = array(
        "points, elements + 8",
        "N",
        "size of the normal contact force of each contact point at the last step",
    )
    in_contact = array(
        "elements boolean",
        "-",
        "whether a contact point of the element touched the projectile at the last step",
    )
    dv_other = array(
        "3 x grid slots",
        "m/s",
        "on the grid of `surface`: predicted velocity increment of the step from all other forces, "
        "for the implicit contact; empty if it is explicit",
    )
    dv_contact = array(
        "3 x grid slots",
        "m/s",
        "likewise, velocity increment that the contact force of the last step gave",
    )
    force_scale = total(
        "N",
        "regularising force of the implicit contact: the projectile's force over the "
        "contact points of an element",
    )
    f_contact = array("3 x slots", "N", "contact force of the projectile on the nodes")
    projectile_position = array("3", "m", "position of the projectile's nose")
    projectile_velocity = array("3", "m/s", "velocity of the projectile, at half steps")
    f_contact_nose = array("3", "N", "contact force of the ply on the projectile")
    contact_work = total("J", "work that the normal contact with the nose has taken so far")
    contact_spring_energy = total("J", "stored in its springs")
    nose_friction_work = total("J", "work of the friction on the nose so far")
    friction_spring_energy = total("J", "stored in the springs of this friction")
    max_penetration = total("m", "largest penetration so far of a point of whole fabric")
    first_row = tally("-", "first of the active element rows")
    end_row = tally("-", "row behind the last of them")
    steps = tally("-", "steps made; `motion_kernels.AT_REST` before the initial forces")
    failures = tally("-", "edges of the membrane that have failed")
    edge_work = array("blocks", "J", "work of the yarn forces so far")
    viscous_work = array("blocks", "J", "work of the viscous yarn forces so far")
    lost_with_yarns = total("J", "energy lost with failed yarns")
    lost_with_elements = total("J", "energy lost with trellis, bending and packing beside these")
    peak_tension = array(
        "2", "N", "highest tension of warp and weft so far, as mean over a yarn segment"
    )
    peak_slot = array(
        "2 int64", "-", "slots at which the warp and the weft segment of that tension begin"
    )
    peak_step = array("2 int64", "-", "steps (of `steps`) in which they had it; 0 if none had")
    contact_window = array("4 int64", "-", "present contact window (i0, i1, j0, j1)")
    nose_window = array("4 int64", "-", "rows and columns of nodes with forces of `f_contact`")
    friction_slip = array(
        "elements, points, 3", "m", "elastic slip of each contact point; empty without friction"
    )
    friction_force = array(
        "elements, points, 3", "N", "last friction force of each contact point; likewise"
    )
    slip_force = array("n", "N", "force on the slipping nodes along their axis at the last step")
    slip_push = array("n", "N", "the part of it that other plies exert")
    boundary_work = total("J", "work of the boundary on prescribed nodes so far")
    clamp_friction_work = total("J", "work of clamp friction so far")
    gripped_kinetic_energy = total("J", "kinetic energy of gripped nodes")
    f_block_nose = array("3", "N", "force of the backing block on the projectile")
    f_block_cloth = array(
        "3 x slots", "N", "force of the backing block on the nodes; empty without one"
    )


class Work(Row):
    """Scratch of one thread, for one block of elements."""

    A = array(
        "3 x size",
        "-",
        "warp edge vectors over their length at rest. size: (rows_per_block + 4) "
        "row_stride + 16, from two rows before the block",
    )
    B = array("3 x size", "-", "weft edge vectors over their length at rest")
    stretch = array("2 x size", "-", "stretch of the edges")
    inv_stretch = array("2 x size", "-", "its inverse")
    mean_stretch = array(
        "2 x size", "-", "mean stretch of the edges of a family that cross an edge of the other one"
    )
    intact = array("2 x size", "-", "intact fraction of the edges of a block with failed yarns")
    mean_intact = array(
        "2 x size", "-", "mean of it over the edges of a family that cross an edge of the other one"
    )
    T = array("2 x size", "N", "tension (memory of dW_own)")
    N = array("2 x size", "N", "force of the edges")
    dW_own = array(
        "2 x size", "N", "derivative of an edge's potential with its own stretch, per yarn"
    )
    dW_crossing = array(
        "2 x size",
        "N",
        "derivative of an edge's potential with the mean stretch of the edges that "
        "cross it, per crossing yarn",
    )
    f_over_stretch = array(
        "2 x size",
        "N",
        "axial force of an edge over its stretch, times A or B the nodal force (memory "
        "of dW_crossing)",
    )
    trellis_turn = array(
        "2 x size",
        "J",
        "minus derivative of an element's shear energy with the stretch of each of its edges",
    )
    trellis_cross = array(
        "size",
        "J",
        "derivative of an element's shear energy with the product a.b of its mean edges, over 4",
    )
    f_next_row = array("3 x size", "N", "force of a row of elements on the nodes of the next row")
    cell_index = array("256 int32", "-", "table cell of each edge of a piece")
    contact_scratch = row(Scratch, "of the contact with the projectile")


class Stack(Row, kept=True):
    """What the plies of a run share: the projectile, steps, who is awake."""

    awake = array("plies boolean", "-", "whether anything has acted on the ply yet")
    waits_for_plies = array(
        "plies boolean",
        "-",
        "whether its implicit nose contact is evaluated after the contact of plies in this step",
    )
    steps = tally("-", "steps made")
    idle_steps = tally("-", "of these the last without whole yarns ahead, since the last look")
    idle_push = total("N", "sum over them of the contact force against the flight")
    stop_step = tally(
        "-", "steps up to the stop of the projectile where the run goes on after it, else 0"
    )
    projectile_position = array(
        "plies, 3", "m", "position of the nose, from each ply's own plane at rest"
    )
    f_contact_nose = array("plies, 3", "N", "contact force of each ply on the projectile")
    ply_steps = array("plies int64", "-", "`State.steps` of each ply")
    ply_failures = array("plies int64", "-", "`State.failures` of each ply")
    projectile_velocity = array(
        "3", "m/s", "velocity of the projectile, at half steps, in the first ply's frame"
    )
    turns = array(
        "plies, 2", "-", "cosine and sine of the angle from the first ply's frame to each ply's"
    )
    after_stop = total("s", "for which the run goes on after the projectile has turned back")
    motion = array(
        "n",
        "m/s, m",
        "of a projectile that is not rigid, along its axis: velocities of tip, tail and centre of "
        "mass, and how far they have come; empty of a rigid one",
    )


PARAMETERS = {
    "const": Constants,
    "state": State,
    "work": Work,
    "stack": Stack,
}
unit = units(PARAMETERS)
