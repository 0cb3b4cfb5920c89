"""What a loading path of a crossover leaves behind: a record with columns of its own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fabrics.checks import FloatArray
from fabrics.record import Record

MEANINGS = {
    "path": "[-] share of the path",
    "d1": "[m] end displacement of the warp, per end",
    "d2": "[m] the same of the weft",
    "plates": "[m] half the distance of the plates (infinite: none)",
    "T1": "[N] tension of the whole warp yarn, from the reactions",
    "T2": "[N] the same of the weft",
    "F_c": "[N] contact force of the crossover",
    "F_plate": "(n, 2) [N] force on the upper and the lower plate",
    "h1": "[m] height of the warp's centreline",
    "h2": "[m] the same of the weft",
    "d_c": "[m] compression of one yarn, half of the loss of h1 + h2",
    "d_yarns": "(n, 2) [m] of each yarn by itself: what its axis has approached its contact face at the crossing",
    "fibre_strain_max": "(n, 2) [-] of the worst bar of warp and weft",
    "fibre_strain_mean": "(n, 2) [-] mean of the bars of warp and weft",
    "iterations": "[-] tangents factorised",
    "seconds": "[s] wall time of each step",
}


@dataclass(frozen=True)
class History(Record):
    """A path of n converged steps, the first of them at rest; index 0 is warp, 1 is weft.

    Its columns, `MEANINGS`, are attributes as well: `history.T1` is `history["T1"]`.
    """

    def __getattr__(self, name: str) -> FloatArray:
        if name in MEANINGS and "columns" in self.__dict__:
            return self.columns[name]
        raise AttributeError(name)

    @property
    def gaps(self) -> tuple[FloatArray, FloatArray]:
        """Per yarn (nodes of the contact face,) [m] in the last step, infinite without a partner."""
        return self.last["gaps_warp"], self.last["gaps_weft"]

    def at(self, column: FloatArray, quantity: FloatArray, value: float) -> float | None:
        """`column` interpolated where `quantity` first reaches `value`; None where it never does.

        Parameters
        ----------
        column, quantity : (n,) arrays of this history
        """
        reached = np.flatnonzero(np.asarray(quantity) >= value)
        if reached.size == 0:
            return None
        i = reached[0]
        if i == 0:
            return float(column[0])
        share = (value - quantity[i - 1]) / (quantity[i] - quantity[i - 1])
        return float(column[i - 1] + share * (column[i] - column[i - 1]))
