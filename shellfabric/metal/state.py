"""The arrays of a projectile that deforms as a body of revolution."""

from shellfabric.jit.table import Row, array, number, row, tally, total
from shellfabric.state import Profile


class MetalLaw(Row):
    """A metal: Hencky's elasticity, and the flow stress of Johnson and Cook (`flow_kernels`)."""

    bulk_modulus = number("Pa", "K")
    shear_modulus = number("Pa", "G")
    yield_stress = number("Pa", "A; infinite of an elastic metal")
    hardening = number("Pa", "B")
    hardening_exponent = number("-", "n")
    rate_coefficient = number("-", "C")
    reference_rate = number("1/s", "rate of plastic strain from which C counts")
    melting_work = number("J/m3", "plastic work that melts it; infinite if none does")
    softening_exponent = number("-", "m")
    density = number("kg/m3", "at rest")
    wave_speed = number("m/s", "of a longitudinal wave")


class BodyRow(Row):
    """A body of revolution in motion; masses and volumes are its share of the model."""

    corners = array("elements, 4 int64", "-", "nodes of an element, counterclockwise in (r, z)")
    jacketed = array("elements boolean", "-", "whether it is of the jacket's metal")
    gradient = array("elements, 4, 2", "1/m", "of the shape functions at its middle, at rest")
    pattern = array("elements, 4", "-", "hourglass pattern of its corners")
    radius = array("elements", "m", "of its middle at rest")
    area = array("elements", "m2", "in the plane (r, z) at rest")
    volume = array("elements", "m3", "at rest")
    hourglass_stiffness = array("elements", "N/m", "of the hourglass control")
    hourglass_damping = array("elements", "N s/m", "of the hourglass control")
    core = row(MetalLaw, "metal of the core")
    jacket = row(MetalLaw, "metal of the jacket")
    mass = array("nodes", "kg", "of the nodes")
    outline = array("rings int64", "-", "nodes of the surface, from the tip on to the tail")
    wall = number("m", "place along z of a rigid wall; infinite without")
    start = array("3", "m", "places of tip, tail and centre of mass along z at first")
    x = array(
        "nodes, 2", "m", "places (r, z); z along the flight, 0 at the tip at first", kept=True
    )
    v = array("nodes, 2", "m/s", "velocities", kept=True)
    f = array("nodes, 2", "N", "forces of the elements", kept=True)
    outer = array("nodes, 2", "N", "forces of what touches it, held over a step of the run")
    before = array("rings, 2", "m", "places of the outline a step of the run ago", kept=True)
    metric = array("elements, 4", "-", "inverse plastic metric rr, rz, zz, hoop", kept=True)
    alpha = array("elements", "-", "effective plastic strain", kept=True)
    heat = array("elements", "J/m3", "plastic work so far", kept=True)
    last_mises = array("elements", "Pa", "stress q of the last call", kept=True)
    last_swelling = array("elements", "-", "ln J of the last call", kept=True)
    last_pressure = array("elements", "Pa", "viscous pressure of the last call", kept=True)
    outer_work = total("J", "work of the outer forces so far", kept=True)
    plastic_work = total("J", "so far", kept=True)
    viscous_work = total("J", "of bulk viscosity and hourglass damping so far", kept=True)
    kinetic_energy = total("J", "of its motion along z and r", kept=True)
    elastic_energy = total("J", "stored by the law", kept=True)
    hourglass_energy = total("J", "stored by the hourglass control", kept=True)
    most_hourglass_energy = total("J", "largest of these so far", kept=True)
    longest_step = total("s", "that its elements bear; negative if one is inside out", kept=True)
    critical = tally("-", "element that bears the shortest step", kept=True)
    own_steps = tally("-", "steps of its own in the last one of the run", kept=True)
    most_own_steps = tally("-", "most of these so far", kept=True)
    fault = tally("-", "0, or what is wrong: see `metal.motion_kernels`", kept=True)
    motion = array("6", "m/s, m", "as `Stack.motion`", kept=True)
    profile = row(Profile, "its outline as what touches it sees it")
    ring_force = array(
        "partners, rings, 2", "N", "of each ply, and of a block, on the outline", kept=True
    )
