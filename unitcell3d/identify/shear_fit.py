"""The three zones of `fabrics.trellis.TrellisShear` from a curve of shear stress against shear angle.

For given gamma1 < gamma2 the stress (thesis eq. 4-35 integrated, erratum E-11) is linear in G1 and G2 - G1, both
positive: non-negative least squares gives them, and a search over the two angles the rest. A curve that begins with
friction between the yarns has a stress at the angle zero too, the offset.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize, nnls

from fabrics.base.errors import InputError
from fabrics.trellis import TrellisShear

FEWEST = 8
GRID = 40
_ROUNDING = 1e-6  # of G1: a rise below it is none
CLOSER = 0.5  # an offset has to bring the misfit below this share of the one without


@dataclass(frozen=True)
class ShearFit:
    """A trellis law fitted to a curve.

    Parameters
    ----------
    law : TrellisShear
    rms : [Pa] residual of the stress
    locked : whether the curve goes on beyond gamma2, so that it determines G2
    offset : [Pa] stress at the angle zero, which the law does not have
    stiffens : whether the curve determines gamma1; if it does not, G2 is G1
    """

    law: TrellisShear
    rms: float
    locked: bool
    offset: float = 0.0
    stiffens: bool = True


def fit(
    gamma: ArrayLike, tau: ArrayLike, *, half: float = 0.0, any_curve: bool = False
) -> ShearFit:
    """Fit the law to a curve.

    Parameters
    ----------
    gamma : (n,) [rad] rising from 0
    tau : (n,) [Pa]
    half : [-] share of tau that is the stress at half of the angle; the rest is the stress at the angle
    any_curve : whether an offset is allowed, and a curve that does not stiffen

    Raises
    ------
    InputError : too few points, or a curve that does not stiffen
    """
    gamma = np.asarray(gamma, float)
    tau = np.asarray(tau, float)
    if len(gamma) < FEWEST:
        raise InputError(key="shear angles", value=len(gamma), allowed=f"at least {FEWEST}")
    # a load cell that was not connected leaves zeros
    if not np.abs(tau).max() > 0:
        raise InputError("the shear stress does not rise with the shear angle")
    found = _best(gamma, tau, half, offset=False)
    if any_curve:
        shifted = _best(gamma, tau, half, offset=True)
        if shifted[-1] < CLOSER * found[-1]:
            found = shifted
    (a, b), (G1, rise, offset), rms = found
    if not G1 > 0:
        raise InputError("the shear stress does not rise with the shear angle")
    stiffens = rise > _ROUNDING * G1
    if not stiffens:
        a = 0.5 * gamma[-1]
        b = gamma[-1]
    if not (stiffens or any_curve):
        raise InputError("the curve of shear stress does not stiffen: it has no gamma1 and gamma2")
    law = TrellisShear(G1, G1 + rise, float(a), float(b))
    return ShearFit(law, rms, bool(stiffens and b < 0.98 * gamma[-1]), offset, bool(stiffens))


def _best(gamma, tau, half, offset):
    """((gamma1, gamma2) [rad], (G1, G2 - G1, offset) [Pa], rms [Pa]) of the closest curve."""

    def misfit(pair):
        a, b = pair
        if not 0 < a < b <= gamma[-1]:
            return np.inf
        return _moduli(pair, gamma, tau, half, offset)[1]

    steps = np.linspace(0, gamma[-1], GRID + 1)[1:]
    trials = [(a, b) for a in steps[:-1] for b in steps if b > a]
    best = min(trials, key=misfit)
    options = {"xatol": 1e-5, "fatol": 0}
    found = minimize(misfit, best, method="Nelder-Mead", options=options)
    pair = found.x if found.fun <= misfit(best) else np.array(best)
    return pair, *_moduli(pair, gamma, tau, half, offset)


def _moduli(pair, gamma, tau, half, offset):
    """(G1, G2 - G1, offset) [Pa] and the rms [Pa] that they leave at given angles."""
    scale = np.abs(tau).max()
    columns = (1 - half) * _stresses(pair, gamma) + half * _stresses(pair, 0.5 * gamma)
    moduli, left = nnls(columns[:, : 2 + offset], tau / scale)
    moduli = np.pad(moduli, (0, 3 - moduli.size))
    return moduli * scale, float(left * scale / np.sqrt(len(gamma)))


def _stresses(pair, gamma):
    """(n, 3) stress of G1, of G2 - G1 and of the offset, each of size one."""
    a, b = pair
    stiffer = (np.clip(gamma, a, b) - a) ** 2 / (2 * (b - a)) + np.maximum(gamma - b, 0)
    return np.stack([gamma, stiffer, np.ones_like(gamma)], axis=1)
