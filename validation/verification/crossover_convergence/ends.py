"""End conditions of a crossover that are not the weave's, to be set beside its two-fold axis.

pin           the middle row of the end face is held along the yarn and in height, the rest of the face is free
upright face  the whole face is held along the yarn, its middle row in height
clamped face  the whole face is held along the yarn and in height
"""

from __future__ import annotations

from fabrics.checks import IntArray
from unitcell3d.assembly.constraints import AXIAL, VERTICAL, WIDTH, Constraints, Ties

TWO_FOLD, PIN, UPRIGHT, CLAMPED = "two-fold axis", "pin", "upright face", "clamped face"


def held(grids: tuple[IntArray, IntArray], n: int, end: str) -> Constraints:
    """Constraints of a quarter crossover with another end condition.

    Parameters
    ----------
    grids : of warp and weft, node numbers (i along, j across, k through), an even number of elements through
    n : number of nodes
    end : `PIN`, `UPRIGHT` or `CLAMPED`
    """
    ties = Ties(n, 2)
    for yarn, grid in enumerate(grids):
        ties.hold(grid[0], AXIAL[yarn])
        ties.hold(grid[:, 0], WIDTH[yarn])
        face = grid[-1]
        row = face[:, face.shape[1] // 2]
        ties.drive[3 * face + AXIAL[yarn], yarn] = 1.0
        ties.hold(row if end == PIN else face, AXIAL[yarn])
        ties.hold(face if end == CLAMPED else row, VERTICAL)
    return ties.done(tuple(grid[-1].ravel() for grid in grids))
