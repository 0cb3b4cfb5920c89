"""The three zones of `fabrics.trellis.TrellisShear` from a computed curve of shear stress against
shear angle.

For given gamma1 < gamma2 the stress (thesis eq. 4-35 integrated, erratum E-11) is linear in G1 and
G2 - G1, both positive: non-negative least squares gives them, and a search over the two angles the
rest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize, nnls

from fabrics.errors import InputError
from fabrics.trellis import TrellisShear

FEWEST = 8
GRID = 40
_ROUNDING = 1e-6  # of G1: a rise below it is none


@dataclass(frozen=True)
class ShearFit:
    """A trellis law fitted to a curve.

    Parameters
    ----------
    law : TrellisShear
    rms : [Pa] residual of the stress
    locked : whether the curve goes on beyond gamma2, so that it determines G2
    """

    law: TrellisShear
    rms: float
    locked: bool


def fit(gamma: ArrayLike, tau: ArrayLike) -> ShearFit:
    """Fit the law to a curve.

    Parameters
    ----------
    gamma : (n,) [rad] rising from 0
    tau : (n,) [Pa]

    Raises
    ------
    InputError : too few points, or a curve that does not stiffen
    """
    gamma = np.asarray(gamma, float)
    tau = np.asarray(tau, float)
    if len(gamma) < FEWEST:
        raise InputError(key="shear angles", value=len(gamma), allowed=f"at least {FEWEST}")
    last = gamma[-1]
    steps = np.linspace(0, last, GRID + 1)[1:]
    trials = [(a, b) for a in steps[:-1] for b in steps if b > a]
    best = min(trials, key=lambda pair: _misfit(pair, gamma, tau))
    found = minimize(
        lambda pair: _misfit(pair, gamma, tau),
        best,
        method="Nelder-Mead",
        options={"xatol": 1e-5, "fatol": 0},
    )
    pair = np.array(best)
    if found.fun <= _misfit(best, gamma, tau):
        pair = found.x
    (G1, rise), rms = _moduli(pair, gamma, tau)
    if not (G1 > 0 and rise > _ROUNDING * G1):
        raise InputError("the curve of shear stress does not stiffen: it has no gamma1 and gamma2")
    return ShearFit(
        TrellisShear(G1, G1 + rise, *map(float, pair)), rms, bool(pair[1] < 0.98 * last)
    )


def _misfit(pair, gamma, tau):
    a, b = pair
    if not 0 < a < b <= gamma[-1]:
        return np.inf
    return _moduli(pair, gamma, tau)[1]


def _moduli(pair, gamma, tau):
    """(G1, G2 - G1) [Pa] and the rms [Pa] that they leave at given angles."""
    a, b = pair
    stiffer = (np.clip(gamma, a, b) - a) ** 2 / (2 * (b - a)) + np.maximum(gamma - b, 0)
    scale = np.abs(tau).max()
    moduli, left = nnls(np.stack([gamma, stiffer], axis=1), tau / scale)
    return moduli * scale, float(left * scale / np.sqrt(len(gamma)))
