"""The arrays of a block behind the fabric, and of the points that touch its face."""

from shellfabric.jit.table import Row, array, integer, total


class BlockRow(Row):
    """The block behind the last ply: bricks, nodes, and what its contacts give in a step."""

    nx = integer("-", "bricks along x; nodes and bricks are numbered with the last axis fastest")
    ny = integer("-", "bricks along y")
    nz = integer("-", "bricks along z")
    gradient = array("bricks, 8, 3", "1/m", "mean gradients of the shape functions at rest")
    volume = array("bricks", "m3", "at rest")
    twist = array("bricks, 4, 3", "m", "hourglass patterns of the corners at rest")
    control = array("bricks, 4, 3", "N/m3", "stiffness of the hourglass control")
    edges = array("bricks, 3", "m", "lengths of the edges at rest")
    law = array(
        "8",
        "Pa, -, 1/s, Pa s/m",
        "K, G, sigma_y, H, erosion strain, rate exponent, reference rate, bulk viscosity over the "
        "length of a brick",
    )
    mass = array("nodes", "kg", "of the nodes")
    dashpot = array("nodes, 3", "N s/m", "of absorbing faces")
    free = array("nodes, 3", "-", "1 where a node may move, 0 where it is held")
    stiffness = array("nodes", "N/m", "contact springs with a projectile")
    damping = array("nodes", "N s/m", "dampers of these")
    x = array("nodes, 3", "m", "places", kept=True)
    v = array("nodes, 3", "m/s", "velocities, at half steps", kept=True)
    metric = array("bricks, 3, 3", "-", "inverse plastic metric", kept=True)
    alpha = array("bricks", "-", "effective plastic strain", kept=True)
    last = array("bricks", "-", "ln J of the last call", kept=True)
    past = array("bricks, 2", "Pa", "viscous pressure and stress q of the last call", kept=True)
    gone = array("bricks boolean", "-", "whether a brick has eroded", kept=True)
    energy = array(
        "bricks, 5",
        "J",
        "elastic, plastic, hourglass, viscous, lost by erosion",
        kept=True,
    )
    own = array("bricks, 8, 3", "N", "internal forces of each brick on its nodes", kept=True)
    outer = array("nodes, 3", "N", "forces of contacts, as internal forces", kept=True)
    drags = array("nodes, 3", "N", "those of their damping", kept=True)
    work = array(
        "sheets, 4",
        "J",
        "of the nodes of one i: kinetic energy; what dashpots, and what contacts have taken; what "
        "of the last is after this instant",
        kept=True,
    )
    shot = array(
        "7", "J, N", "contact with a projectile: stored; elastic and damping force", kept=True
    )
    points = array("7", "J, N", "contact with points: stored", kept=True)
    force_before = array("3", "N", "force of the projectile of a step ago", kept=True)
    time = total("s", "since the block was at rest", kept=True)
    kick = total("s", "length of the last step", kept=True)
    taken = total("J", "work that contacts have taken from projectile and points", kept=True)
    substeps = array(
        "2 int64", "-", "steps in one of the run, and steps since they were found", kept=True
    )


class BlockPoints(Row):
    """Points that touch the face of the block, such as those of the last ply."""

    x = array("points, 3", "m", "places")
    v = array("points, 3", "m/s", "velocities")
    stiffness = array("points", "N/m", "contact spring of each")
    damping = array("points", "N s/m", "damper of each")
    columns = array("points, 2 int64", "-", "column of bricks that each was over", kept=True)
    memory = array(
        "points, 2",
        "m",
        "how far each was inside the face, negative outside; what of it no motion has made",
        kept=True,
    )
    feet = array("points, 4 int64", "-", "nodes of the facet that each bears on")
    contacts = array(
        "points, 9",
        "m, N, -",
        "depth, 0 where there is none; damping force; normal; weights of the nodes",
    )
    force = array("points, 3", "N", "elastic force on each")
    drag = array("points, 3", "N", "damping force on each")
    force_before = array("points, 3", "N", "force on each a step ago", kept=True)
