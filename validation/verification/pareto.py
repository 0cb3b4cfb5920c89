"""Which of several methods are worth their time: those that no other one beats in both time and error."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike


def non_dominated(cost: ArrayLike, error: ArrayLike, margin: float = 0.0) -> list[int]:
    """Numbers of the methods of which none other is at most as dear and at most as wrong, and better in one of the two.

    Parameters
    ----------
    cost, error : (n,) of each method; one that is not a number dominates nothing and is left out
    margin : share of the error that a dearer method has to take off the next cheaper one's to be named

    Returns
    -------
    list of int, from the cheapest to that of the lowest error
    """
    cost, error = np.asarray(cost, float), np.asarray(error, float)
    good = [int(i) for i in np.flatnonzero(np.isfinite(cost) & np.isfinite(error))]
    kept, least = [], np.inf
    for i in sorted(good, key=lambda i: (cost[i], error[i])):
        if error[i] < least:
            kept.append(i)
            least = (1 - margin) * error[i]
    return kept
