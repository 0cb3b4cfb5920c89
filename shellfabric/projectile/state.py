"""The arrays of a projectile that is a bar along its axis."""

from shellfabric.jit.table import Row, array, integer, number, total


class BarRow(Row):
    """The bar along the axis of a projectile; masses and sections are its share of the model."""

    mass = array("nodes", "kg", "lumped masses")
    h = array("elements", "m", "lengths at rest")
    area = array("elements", "m2", "cross sections at rest")
    modulus = number("Pa", "Young's modulus")
    yield_stress = number("Pa", "stress at which it first yields; infinite of an elastic bar")
    hardening = number("Pa", "slope of the yield stress over the plastic strain")
    substeps = integer("-", "time steps of the bar in one of the fabric")
    u = array("nodes", "m", "displacements along the axis", kept=True)
    v = array("nodes", "m/s", "velocities along the axis", kept=True)
    plastic = array("elements", "-", "plastic (logarithmic) strain", kept=True)
    stress = array("elements", "Pa", "Kirchhoff stress, positive in tension", kept=True)
    tip_work = total("J", "work of the force at the tip so far", kept=True)
    plastic_work = total("J", "plastic work so far", kept=True)
    motion = array(
        "6",
        "m/s, m",
        "along the axis: velocities of tip, tail and centre of mass, and how far they have come",
        kept=True,
    )
