"""The interval of what follows from several independent unknowns, each taken to both ends of its own interval."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def combine(value: float, ends: Sequence[Sequence[float | None]]) -> tuple[float, float]:
    """(low, high) about `value`: the changes that the unknowns make add as squares, downwards and upwards on their own.

    Parameters
    ----------
    value : with all unknowns at their best
    ends : for each unknown, the value at both ends of its interval, the others at their best; None where there is none
    """
    changes = [[end - value for end in pair if end is not None] for pair in ends]
    down = np.sqrt(sum(min([0.0, *each]) ** 2 for each in changes))
    up = np.sqrt(sum(max([0.0, *each]) ** 2 for each in changes))
    return float(value - down), float(value + up)
