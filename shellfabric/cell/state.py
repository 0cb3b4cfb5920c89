"""The numbers of a crossover that its kernels take."""

from shellfabric.jit.table import Row, flag, integer, number, row


class CellYarn(Row):
    """A yarn of a crossover."""

    w = number("m", "half length of the cell at rest")
    S0 = number("m", "length of the yarn in it at rest")
    EA = number("N", "axial stiffness")
    slack = number(
        "-", "strain by which the foot of its tension curve lies off; 0: a straight line"
    )
    turning = number(
        "-", "share of its way over which it changes sides; it is straight on the rest"
    )
    h0 = number("m", "height at rest")
    a = number("m", "law of compression d = a - b (F + shift)^(-1/3) (eq. 4-12); 0: none")
    b = number("m N^(1/3)", "factor in it")
    shift = number("N", "(b / a)^3 of a regularised law, 0 of the printed one")
    stiffening = number("-", "growth of the force at one compression with the yarn's strain")


class Crossover(Row):
    """Two yarns that cross."""

    warp = row(CellYarn, "the warp yarn")
    weft = row(CellYarn, "the weft yarn")
    gap = number("m", "between the yarns at rest")
    form = integer("-", "formulation, see `cell.crossover_kernels`")
    coupled = flag("whether the yarns press on each other")
    straight = flag("whether centrelines are straight from crossing to crossing, else cosines")
