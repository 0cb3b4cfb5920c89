"""The arrays of a zone of resolved yarns (`yarns.patch` makes them)."""

from shellfabric.jit.table import Row, array, flag, integer, number, row, tally, total
from shellfabric.state import Numbers, RateTable


class Zone(Row):
    """Resolved yarns: chains, crossings, neighbours, points under the nose, ties to the membrane
    (`yarns.patch`)."""

    dt = number("s", "time step")
    first = array("2 int64", "-", "first node of the warp yarns, of the weft yarns")
    yarns = array("2 int64", "-", "number of warp yarns, of weft yarns")
    nodes = array("2 int64", "-", "nodes of a warp yarn, of a weft yarn")
    x = array("3, all nodes", "m", "places of the nodes of all chains, yarn after yarn", kept=True)
    v = array("3, all nodes", "m/s", "velocities, half a step behind", kept=True)
    f = array("3, all nodes", "N", "forces", kept=True)
    mass = array("all nodes", "kg", "lumped masses of the chains")
    inverse_mass = array("all nodes", "1/kg", "0 of nodes that are tied to the membrane or led")
    rest_length = array("all nodes", "m", "of the segment from a node to the next")
    whole = array(
        "all nodes boolean",
        "-",
        "whether the segment bears; false at the end of a chain",
        kept=True,
    )
    pull = array("3, all nodes", "N", "force of the segment on its node", kept=True)
    breaking = array(
        "all nodes boolean", "-", "whether the segment breaks in the next step", kept=True
    )
    torn = array(
        "2, n boolean", "-", "whether a yarn of warp or weft has a broken segment", kept=True
    )
    stiffness = array("2", "N", "EA of warp and weft")
    drag = array("2", "N s/m", "viscosity of a segment of warp and weft")
    tension = array("all nodes", "N", "elastic tension of the segment", kept=True)
    viscous_force = array("all nodes", "N", "viscous force of the segment", kept=True)
    strength = array("all nodes", "N", "of the segment's yarn")
    half_strength = array("all nodes", "N", "tension below which the filtered one stays put")
    filtered = array("all nodes", "N", "F of the failure criterion", kept=True)
    filter_factor = array("2", "-", "share of M that F takes over in a step, of warp and weft")
    rate_damage = array("n", "-", "damage by strain rate; empty without", kept=True)
    panel = row(Numbers, "numbers of the panel, as they are declared (`panel_numbers`)")
    rate_law = row(RateTable, "strength of the yarns by strain rate")
    mean_first = array(
        "all yarns int64",
        "-",
        "first yarn that has a weight in the mean about each; warp before weft",
    )
    mean_weights = array(
        "all yarns, n", "-", "weights in the mean tension of this and the next yarns"
    )
    peak_tension = array("2", "N", "highest of warp and weft so far", kept=True)
    peak_segment = array("2 int64", "-", "segments that had it", kept=True)
    place = array(
        "2, warp, weft", "-", "indices of a crossing on its warp and on its weft", kept=True
    )
    slider = array("3, warp, weft", "m", "friction spring of a crossing", kept=True)
    touching = array(
        "warp, weft boolean", "-", "false once a yarn of the crossing has torn", kept=True
    )
    pinned = array("warp, weft boolean", "-", "whether nothing slips there")
    sign = array("warp, weft", "-", "1 with the warp on top, else -1")
    contact_force = array("warp, weft", "N", "normal force of a crossing", kept=True)
    contact_energy = array("warp, weft", "J", "that its normal contact stores", kept=True)
    contact_onset = array(
        "warp, weft", "m", "distance at which its contact begins; below 0 if slack", kept=True
    )
    contact_damping = array("warp, weft", "N", "damping force of its normal contact", kept=True)
    law = array(
        "samples, 4",
        "-",
        "of a crossing: force [N], stiffness from there on [N/m], energy [J] at equal steps of its closure [m]",
    )
    law_scale = number("1/m", "steps of the law in a metre")
    gap = array("warp, weft", "m", "distance of the yarns of a crossing at rest")
    friction = number("-", "coefficient of yarn on yarn")
    friction_stiffness = number("N/m", "of the friction springs")
    damping = number("N s/m", "of a crossing, along its normal")
    foot = array(
        "all nodes",
        "-",
        "index of the closest point on the yarn beside it; below 0 if torn",
        kept=True,
    )
    foot_energy = array("all nodes", "J", "that the contact with it stores", kept=True)
    foot_onset = array(
        "all nodes", "m", "distance at which that contact begins; below 0 if slack", kept=True
    )
    foot_wait = array("all nodes", "-", "steps until it is looked at again", kept=True)
    middle = array(
        "2 int64", "-", "warp yarn, weft yarn towards which the others have their points"
    )
    touch_distance = array("2", "m", "w1 of neighbours, of warp and weft")
    touch_stiffness = array("2", "N/m", "k1")
    closest_distance = array("all nodes", "m", "w2 of a point and the yarn beside it")
    closest_stiffness = array("2", "N/m", "k2")
    rod = number("m", "half thickness of a yarn under the nose")
    nose_edge = array("2", "m", "from the middle line of warp and weft to their edges")
    nose_stiffness = number("N/m", "penalty of three points across a yarn")
    nose_energy = array(
        "all nodes, 6", "J", "that the points at a node and behind it hold", kept=True
    )
    friction_slip = array(
        "n, 6, 3",
        "m",
        "elastic slip of these points on the nose; empty without friction",
        kept=True,
    )
    friction_force = array("n, 6, 3", "N", "last friction forces of these points", kept=True)
    substeps = integer("-", "steps in a step of the ply")
    most_past = tally(
        "-", "nodes that were past the surface of the next ply, at one sample at most", kept=True
    )
    points_ahead = tally("-", "points of whole yarns ahead of the nose", kept=True)
    segments_to_break = tally("-", "segments that break in the next step", kept=True)
    torn_segments_told = tally("-", "of `torn_segments` those that the ply knows of", kept=True)
    tied_node = array("ends int64", "-", "ends of the chains")
    tied_slot = array("ends int64", "-", "slots of the membrane's nodes that they are")
    tied_rest = array("ends, 3", "m", "their places at rest")
    warp_share = number("-", "share of the warp in the place of a shadow node")
    furthest = number("m", "that the two yarns of a shadow node can be apart")
    has_shadow = flag("whether other plies or a block see the zone, by its shadow nodes")
    outer_force = array(
        "n, 3", "N", "on the ends of the chains and on the nose, at the last step", kept=True
    )
    taken_force = array(
        "n, 3", "N", "what rim and nose take of them in a step of the ply", kept=True
    )
    given_work = total("J", "work of the zone's forces on rim and nose", kept=True)
    taken_work = total("J", "work of the forces that rim and nose take", kept=True)
    stored = total("J", "that the yarns store", kept=True)
    stored_at_crossings = total("J", "that crossings store", kept=True)
    stored_at_neighbours = total("J", "that neighbours store", kept=True)
    stored_at_nose = total("J", "that points at the nose store", kept=True)
    damped = total("J", "work of viscous forces so far", kept=True)
    friction_work = total("J", "work of friction at crossings", kept=True)
    lost_with_yarns = total("J", "lost with yarns that tore", kept=True)
    lost_when_slack = total("J", "lost by contacts of slack yarns", kept=True)
    nose_friction_work = total("J", "work of friction at the nose", kept=True)
    mirror_first = array(
        "2 int64",
        "-",
        "local number of the line on the plane of symmetry, of rows of crossings along warp, weft; -1 without",
    )
    node_share = array(
        "all nodes", "-", "share of a node that is modelled: 0 of images, halves on planes"
    )
    segment_share = array("all nodes", "-", "of the segment from a node to the next")
    crossing_share = array("warp, weft", "-", "of a crossing")
    tied_share = array("ends", "-", "of an end; 0 of ends that are images")
    lost_in_snaps = total("J", "lost by steps in which yarns stiffen", kept=True)
    torn_segments = total("-", "segments that tore", kept=True)
    tangled = total("-", "crossings of taut yarns that have changed sides, and are gone", kept=True)
