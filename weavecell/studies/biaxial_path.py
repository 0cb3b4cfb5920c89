"""The crossover stretched along a straight path in its two strains, to the strength of a yarn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from scipy.optimize import brentq

from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from shellfabric.cell.model import CellModel


@dataclass(frozen=True)
class CellPath:
    """Response of a crossover along a path.

    Parameters
    ----------
    ratio : (warp, weft) [-] of the strains, the larger 1
    strain : (n, 2) [-] of the fabric along warp and weft
    response : {name: (n,)} of `CellModel.solve`: T1, T2, N1, N2, F [N], h1, h2 [m], W [J]
    failed : "warp" or "weft", the yarn that is at its strength at the end
    """

    ratio: tuple[float, float]
    strain: np.ndarray
    response: dict
    failed: str

    @property
    def tension(self) -> FloatArray:
        """(n, 2) [N] tensions of warp and weft."""
        return np.stack([self.response["T1"], self.response["T2"]], axis=-1)


def to_strength(model: CellModel, ratio: Sequence[float], n: int = 241) -> CellPath:
    """Stretch a crossover from rest at a fixed ratio of strains until its first yarn is at its
    strength.

    Parameters
    ----------
    model : CellModel
    ratio : (warp, weft) of the strains, at least 0; 0 holds a yarn's ends
    n : states, evenly spaced in strain

    Raises
    ------
    InputError : a ratio that stretches no yarn, or shortens one
    """
    parts = np.asarray(ratio, float)
    if not (parts.shape == (2,) and np.isfinite(parts).all() and parts.min() >= 0 < parts.max()):
        raise InputError(
            key="ratio", value=tuple(parts), allowed="two numbers of at least 0, one of them above"
        )
    parts = parts / parts.max()
    yarns = model.fabric.weave.yarns
    strengths = np.array([yarn.strength for yarn in yarns])

    def state(s):
        return model.solve(1 + parts[0] * s, 1 + parts[1] * s)

    def short_of_strength(s):
        # tensions rise along the path, so that the first failure can be bracketed
        crossing = state(s)
        return float(np.min(1 - np.array([crossing["T1"], crossing["T2"]]) / strengths))

    # a yarn that is straight and past its strength
    far = inf
    for yarn, part in zip(yarns, parts):
        if part > 0:
            beyond_failure = (1 + yarn.crimp) * (1 + 1.01 * yarn.failure_strain)
            far = min(far, (beyond_failure - 1) / part)
    s = np.linspace(0, brentq(short_of_strength, 0.0, far, xtol=1e-12), n)
    response = state(s)
    last = np.array([response["T1"][-1], response["T2"][-1]]) / strengths
    return CellPath(
        (float(parts[0]), float(parts[1])),
        s[:, None] * parts,
        response,
        ("warp", "weft")[int(np.argmax(last))],
    )
