"""The arrays of a coupon, and their scratch."""

from shellfabric.jit.table import Row, array, number, numbers


class Segments(Row):
    """What the forces of a coupon follow from, and their scratch; n segments of each family."""

    nodes = array("2 x n, 2 int64", "-", "nodes at the ends of the segments")
    cells = array("2 x n", "-", "crossovers that a segment stands for")
    across = array("2 x n, 4 int64", "-", "segments that cross it at its ends; -1 without one")
    quads = array("n, 4 int64", "-", "nodes of the quadrilaterals")
    length = numbers(2, "m", "length at rest of warp and weft segments")
    potential = array("n, 9", "J", "coefficients of the potential in each cell of the table")
    grid = numbers(6, "-", "start, cells per stretch, number of the last cell, of both stretches")
    half_width = numbers(2, "m", "half length w of a crossover along warp and weft")
    yarn_length = numbers(2, "m", "length S0 of a yarn in a crossover at rest")
    stiffness = numbers(2, "N", "axial stiffness E A of a yarn")
    volume = number("m3", "volume of a quadrilateral for its shear energy; 0 without trellis")
    G1 = number("Pa", "shear modulus of the trellis below gamma1")
    G2 = number("Pa", "shear modulus above gamma2")
    gamma1 = number("rad", "shear angle where stiffening begins")
    gamma2 = number("rad", "shear angle where stiffening ends")
    stretch = array("2 x n", "-", "scratch: stretch of the segments")
    direction = array("2 x n, 2", "-", "scratch: their directions")
    pull = array("2 x n", "J", "scratch: dE/dLambda")
    row = array("2 x n", "J/m", "scratch: parts of the bound on a row of the stiffness")
