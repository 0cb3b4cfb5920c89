"""Turns between the frames of plies that lie at other angles.

The arrays of a ply are in its own frame: x along its first family of yarns, the impact point the origin of all. A turn
is (c, s), cosine and sine of the angle from the axes of one frame to those of the other:

    (x, y) -> (c x + s y, c y - s x)

Where all plies lie at one angle, or at right angles to each other, a turn is None: kernels of such packs have no
instruction of all this.
"""

from numba import types
from numba.extending import overload, register_jitable


@register_jitable
def turned(turn, x, y):
    """Components in the other frame of a vector (x, y) of the one."""
    return (x, y) if turn is None else (turn[0] * x + turn[1] * y, turn[0] * y - turn[1] * x)


@register_jitable
def turned_back(turn, x, y):
    """Components in the one frame of a vector (x, y) of the other."""
    return (x, y) if turn is None else (turn[0] * x - turn[1] * y, turn[0] * y + turn[1] * x)


# that a turn is None has to follow from types: of a branch, numba would make what may be None
def turn_of(turns, p):
    """The turn from the frame of the first ply to that of ply p; turns : (plies, 2) or None."""


@overload(turn_of)
def _turn_of(turns, p):
    if isinstance(turns, types.NoneType):
        return lambda turns, p: None
    return lambda turns, p: (turns[p, 0], turns[p, 1])
