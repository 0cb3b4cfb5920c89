"""The arrays of a patch of solid yarns: bricks, fibre bars, faces, and the facets that meet in contact.

Nodes are numbered yarn by yarn, those through a yarn fastest, then across, then along. A bar has the
number of its first node less the sections of the yarns before. A yarn has two faces, lower and upper,
with facets in rows along it, and two sides with a tip for each section.
"""

from shellfabric.jit.table import Row, array, integer, number, row, tally, total
from shellfabric.state import Nose


class SolidRow(Row):
    """A patch of solid yarns, the projectile, and what their contacts give in a step."""

    first_node = array("yarns int64", "-", "of each yarn")
    nx = array("yarns int64", "-", "bricks along each yarn")
    ny = array("yarns int64", "-", "bricks across each yarn; half of them if it is cut along")
    nz = integer("-", "bricks through a yarn")
    family = array("yarns int64", "-", "0 along x, 1 along y")
    first_brick = array("yarns int64", "-", "of each yarn")
    first_bar = array("yarns int64", "-", "of each yarn")
    law = array("yarns, 6", "-", "E_a, a_E [Pa], b_E, Vf0, V_c, G [Pa] of the solid")
    lag = array("yarns", "s/m", "damping ratio of the fibres over their wave speed")
    failure_strain = array("yarns", "-", "of the fibres; infinite where they do not fail")
    slack_stiffness = number("-", "fraction of its stiffness that a slack fibre keeps")
    slack_width = number("-", "fibre strain over which a fibre becomes taut")
    gradient = array("bricks, 8, 3", "1/m", "mean gradients of the shape functions at rest")
    volume = array("bricks", "m3", "at rest")
    point_gradient = array(
        "bricks, points, 8, 3",
        "1/m",
        "gradients at the points of the full rule; none with one point",
    )
    point_volume = array("bricks, points", "m3", "at rest, of these points")
    twist = array("bricks, 4, 3", "m", "hourglass patterns of the corners at rest")
    control = array("bricks, 4, 3", "N/m3", "stiffness of the hourglass control")
    viscosity = array("bricks, 2", "-", "eta of S_22 and S_33 [Pa^(1/2) s]")
    bar_length = array("bars", "m", "at rest")
    bar_stiffness = array("bars", "N", "E A of each bar")
    mass = array("nodes", "kg", "of the nodes")
    whole_mass = array("nodes", "kg", "of a whole node, of which a plane of symmetry leaves a half")
    free = array("nodes, 3", "-", "1 where a node may move, 0 where it is held")
    contact_stiffness = array("nodes", "N/m", "bound of what all contacts of a node give")
    face_node = array("faces int64", "-", "first node of each face; two of each yarn")
    face_facet = array("faces int64", "-", "its first facet")
    face_turn = array("faces", "-", "1 where S_,1 x S_,2 points out of the yarn, else -1")
    cut = array("yarns boolean", "-", "half of a yarn: its first row lies on a plane of symmetry")
    quarter = integer("-", "1 if all yarns begin on symmetry planes, else 0")
    area = array("facets", "m2", "at rest")
    damping = array("facets", "N s/m", "damper of the contact of each")
    side_node = array("sides int64", "-", "first node of each side; two of each yarn")
    side_tip = array("sides int64", "-", "its first tip")
    side_partner = array("sides int64", "-", "side that faces it; -1 for none")
    tip_area = array("tips", "m2", "length of the edge of each section, times its diameter")
    tip_damping = array("tips", "N s/m", "damper of the contact of each")
    tip_diameter = array(
        "tips", "m", "of the rounded edge; less where neighbours are closer at rest"
    )
    penalty = number("Pa/m", "of yarns on each other, both passes together, and of the projectile")
    toe = number("m", "penetration over which the contact stiffness sets in")
    friction = number("-", "Coulomb's coefficient between yarns")
    nose_friction = number("-", "Coulomb's coefficient between yarns and projectile")
    nose = row(Nose, "shape of the projectile")
    projectile_mass = number("kg", "of the modelled part of the projectile")
    projectile_free = array("3", "-", "1 along axes on which the projectile may move")
    x = array("nodes, 3", "m", "places", kept=True)
    v = array("nodes, 3", "m/s", "velocities, at half steps", kept=True)
    f_solid = array("nodes, 3", "N", "internal forces of the solids' law", kept=True)
    f_other = array("nodes, 3", "N", "all other internal forces and contacts", kept=True)
    bar_intact = array("bars boolean", "-", "whether a bar is whole", kept=True)
    torn = array("bricks boolean", "-", "whether a brick has gone with its bars", kept=True)
    log_stretch = array("bricks, 2", "-", "ln R_22 and ln R_33 at the last call", kept=True)
    partner = array("facets int64", "-", "face that a facet may meet; -1 for none", kept=True)
    foot = array("facets, 2", "facets", "its closest point on that face", kept=True)
    overlap = array("facets", "m", "gap, below 0, at which its contact begins", kept=True)
    wait = array("facets int64", "-", "steps for which it cannot get there", kept=True)
    slider = array("facets, 3", "m", "elastic slip of its friction", kept=True)
    contact_energy = array("facets", "J", "stored in its contact, friction included", kept=True)
    tip_foot = array(
        "tips", "bricks", "closest point of a tip on the side that it faces", kept=True
    )
    tip_wait = array("tips int64", "-", "steps for which it cannot get there", kept=True)
    tip_slider = array("tips, 3", "m", "elastic slip of its friction", kept=True)
    tip_energy = array("tips", "J", "stored in its contact, friction included", kept=True)
    nose_wait = array("facets int64", "-", "steps for which the nose cannot get there", kept=True)
    nose_slider = array("facets, 3", "m", "elastic slip of its friction on the nose", kept=True)
    nose_energy = array("facets", "J", "stored in its contact with the nose", kept=True)
    nose_position = array("3", "m", "of the nose's foremost point", kept=True)
    nose_velocity = array("3", "m/s", "at half steps", kept=True)
    nose_force = array("3", "N", "on the modelled part of the projectile", kept=True)
    dt = total("s", "length of the steps", kept=True)
    last_dt = total("s", "length of the last step; 0 before the first", kept=True)
    reach = total("m", "by which a gap may close in a step at most", kept=True)
    time = total("s", "of the places", kept=True)
    steps = tally("-", "made so far", kept=True)
    kinetic_energy = total("J", "of the yarns at the instant of the forces", kept=True)
    projectile_energy = total("J", "of the modelled part of the projectile", kept=True)
    fibre_energy = total("J", "stored in the bars", kept=True)
    hourglass_energy = total("J", "stored by the hourglass control", kept=True)
    solid_work = total("J", "that the solids' law has taken, a half step ahead", kept=True)
    half_work = total("J", "of this what is ahead", kept=True)
    solid_damping = total("J", "of this what its viscosity has taken", kept=True)
    fibre_damping = total("J", "that the viscosity of the fibres has taken", kept=True)
    contact_damping = total("J", "that the dampers of contacts have taken", kept=True)
    friction_work = total("J", "that sliding has taken", kept=True)
    failure_energy = total("J", "of fibres, bricks and contacts that are gone", kept=True)
