"""The arrays of a block behind the fabric, and of the points that touch its face."""

from shellfabric.jit.table import Row, array, integer, number, row, tally, total


class BlockLaw(Row):
    """The material of a block, and its bulk viscosity."""

    bulk_modulus = number("Pa", "K")
    shear_modulus = number("Pa", "G")
    yield_stress = number("Pa", "stress at which it first yields; infinite of an elastic block")
    hardening = number("Pa", "H, slope of the yield stress over the plastic strain")
    erosion_strain = number("-", "effective plastic strain at which a brick is taken out")
    rate_exponent = number("-", "m of the strength at strain rates; 0 without")
    reference_rate = number("1/s", "rate of plastic strain of that law")
    bulk_viscosity = number("Pa s/m", "of the linear bulk viscosity, over the length of a brick")


class BlockRow(Row):
    """The block behind the last ply: bricks, nodes, and what its contacts give in a step."""

    nx = integer("-", "bricks along x; nodes and bricks are numbered with the last axis fastest")
    ny = integer("-", "bricks along y")
    nz = integer("-", "bricks along z")
    gradient = array("bricks, 8, 3", "1/m", "mean gradients of the shape functions at rest")
    volume = array("bricks", "m3", "at rest")
    control = array("bricks, 4, 3", "m", "weights of the hourglass control, of each mode and edge")
    hourglass_factor = number("-", "f of the hourglass control")
    edges = array("bricks, 3", "m", "lengths of the edges at rest")
    law = row(BlockLaw, "its material")
    mass = array("nodes", "kg", "of the nodes")
    dashpot = array("nodes, 3", "N s/m", "of absorbing faces")
    free = array("nodes, 3", "-", "1 where a node may move, 0 where it is held")
    stiffness = array("nodes", "N/m", "contact springs with a projectile")
    damping = array("nodes", "N s/m", "dampers of these")
    x = array("nodes, 3", "m", "places", kept=True)
    v = array("nodes, 3", "m/s", "velocities, at half steps", kept=True)
    shape = array("bricks, 4, 3", "m", "hourglass patterns that bear no force", kept=True)
    metric = array("bricks, 3, 3", "-", "inverse plastic metric", kept=True)
    alpha = array("bricks", "-", "effective plastic strain", kept=True)
    last_swelling = array("bricks", "-", "ln J of the last call", kept=True)
    last_pressure = array("bricks", "Pa", "viscous pressure of the last call", kept=True)
    last_mises = array("bricks", "Pa", "stress q of the last call", kept=True)
    gone = array("bricks boolean", "-", "whether a brick has eroded", kept=True)
    elastic_energy = array("bricks", "J", "stored by the law", kept=True)
    plastic_work = array("bricks", "J", "so far", kept=True)
    hourglass_energy = array("bricks", "J", "stored by the hourglass springs", kept=True)
    corner_energy = array("bricks", "J", "stored by the volumes of corners", kept=True)
    viscous_work = array("bricks", "J", "of the bulk viscosity so far", kept=True)
    lost_by_erosion = array("bricks", "J", "what a brick had stored when it eroded", kept=True)
    own = array("bricks, 8, 3", "N", "internal forces of each brick on its nodes", kept=True)
    outer = array("nodes, 3", "N", "forces of contacts, as internal forces", kept=True)
    drags = array("nodes, 3", "N", "those of their damping", kept=True)
    kinetic_energy = array("sheets", "J", "of the nodes of one i", kept=True)
    dashpot_work = array("sheets", "J", "that their dashpots have taken", kept=True)
    contact_work = array("sheets", "J", "that contacts have taken from them", kept=True)
    contact_work_ahead = array("sheets", "J", "of this what is after this instant", kept=True)
    outer_impulse = array("sheets", "N s", "along z, that held and absorbing faces took", kept=True)
    nose_spring_energy = total("J", "stored in the contact with a projectile", kept=True)
    nose_force = array("3", "N", "elastic force on the projectile", kept=True)
    nose_drag = array("3", "N", "damping force on the projectile", kept=True)
    point_spring_energy = total("J", "stored in the contact with points", kept=True)
    force_before = array("3", "N", "force of the projectile of a step ago", kept=True)
    time = total("s", "since the block was at rest", kept=True)
    kick = total("s", "length of the last step", kept=True)
    taken = total("J", "work that contacts have taken from projectile and points", kept=True)
    substeps = tally("-", "steps in one of the run", kept=True)
    steps = tally("-", "steps of the run so far", kept=True)


class BlockPoints(Row):
    """Points that touch the face of the block, such as those of the last ply."""

    x = array("points, 3", "m", "places")
    v = array("points, 3", "m/s", "velocities")
    stiffness = array("points", "N/m", "contact spring of each")
    damping = array("points", "N s/m", "damper of each")
    columns = array("points, 2 int64", "-", "column of bricks that each was over", kept=True)
    inside = array("points", "m", "how far each was inside the face, negative outside", kept=True)
    offset = array("points", "m", "what of it no motion has made", kept=True)
    feet = array("points, 4 int64", "-", "nodes of the facet that each bears on")
    depth = array("points", "m", "in the face; 0 where there is no contact")
    damping_force = array("points", "N", "along the normal")
    normal = array("points, 3", "-", "of the face, outwards")
    weights = array("points, 4", "-", "weights of the nodes of the facet")
    force = array("points, 3", "N", "elastic force on each")
    drag = array("points, 3", "N", "damping force on each")
    force_before = array("points, 3", "N", "force on each a step ago", kept=True)


class HandOver(Row):
    """Whether the last ply has left the floor of the dent, and what it was like when it had."""

    gap = total("m", "least distance of the ply from the floor at the last sample", kept=True)
    growing = tally("-", "samples in a row at which that had grown and nothing touched", kept=True)
    deepest_ply = total("m", "depth of the ply's deepest point there at the hand-over", kept=True)
    rim_force = total("N", "of the ply on the face at the last sample", kept=True)
    peak_force = total("N", "the largest of it so far", kept=True)
