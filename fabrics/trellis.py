"""Trellis shear of a plain weave: three zones of the angle between the yarns (thesis section
4.3.2).

The tangent modulus is G1 up to gamma1, rises linearly to G2 at gamma2, and stays G2 (eq. 4-35). The
stress is its integral, a total and odd function of the shear angle (erratum E-11: eq. 4-35 is a
tangent, not a secant).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import acos, pi

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.checks import FloatArray, positive, refuse
from fabrics.base.errors import InputError


@dataclass(frozen=True)
class TrellisShear:
    """Shear law of a weave.

    Parameters
    ----------
    G1, G2 : [Pa] tangent modulus before the yarns touch and after they lock
    gamma1, gamma2 : [rad] shear angles at which parallel yarns touch and lock

    Raises
    ------
    InputError : a value is not positive, or gamma2 is not above gamma1
    """

    G1: float
    G2: float
    gamma1: float
    gamma2: float

    def __post_init__(self):
        positive(self, "G1", "G2", "gamma1", "gamma2")
        if not self.gamma1 < self.gamma2 < pi / 2:
            refuse(
                self,
                "gamma2",
                f"above gamma1 = {self.gamma1:g} and below pi/2",
            )

    def stress(self, gamma: ArrayLike) -> FloatArray:
        """Compute the shear stress [Pa] at the shear angle `gamma` [rad], odd in gamma (eq. 4-35
        integrated)."""
        gamma = np.asarray(gamma, float)
        g = np.abs(gamma)
        middle = np.clip(g, self.gamma1, self.gamma2) - self.gamma1
        rise = (self.G2 - self.G1) / (self.gamma2 - self.gamma1)
        beyond = np.maximum(g - self.gamma2, 0)
        return np.sign(gamma) * (self.G1 * g + rise * middle**2 / 2 + (self.G2 - self.G1) * beyond)


def locking_modulus(E: float, A_s: float, thickness: float, length: float) -> float:
    """Compute G2 [Pa]: half the fibre modulus, smeared over the shell section thickness x length
    (eq. 4-49).

    The thesis took the cell length along the warp for the section (erratum E-07).
    """
    return E / 2 * A_s / (thickness * length)


def touching_angle(width: float, spacing: float) -> float:
    """Compute gamma1 [rad], at which yarns touch, from yarn width and spacing (eq. 4-32).

    Raises
    ------
    InputError : the yarns touch already, or the width is not positive
    """
    if not 0 < width < spacing:
        raise InputError(
            key="yarn width", value=width, allowed=f"above zero and below the spacing {spacing:g} m"
        )
    return acos(width / spacing)


def locking_angle(A_s: float, K_s: float, thickness: float, spacing: float) -> float:
    """Compute gamma2 [rad], at which yarns lock, from a packed ellipse of area A_s / K_s and axes
    u2, thickness / 2 (eqs. 4-33, 4-34, erratum E-08).

    Raises
    ------
    InputError : the packed yarn is wider than its spacing, so that it locks before it shears
    """
    u2 = 8 * A_s / (pi * K_s * thickness)
    if u2 >= spacing:
        raise InputError(
            key="packed yarn width", value=u2, allowed=f"below the spacing {spacing:g} m"
        )
    return acos(u2 / spacing)
