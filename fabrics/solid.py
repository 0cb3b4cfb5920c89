"""The yarn as a solid: a transverse modulus that rises with the fibre volume fraction (thesis
section 3.4.2).

V_f <= Vf0          K_r E_c                  (eq. 3-10)
Vf0 < V_f < V_c     a_E / (b_E - V_f)        (eqs. 3-11 .. 3-13)
V_f >= V_c          E_c                      (eq. 3-14, and the cap of erratum E-20)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.checks import FloatArray, positive, refuse


@dataclass(frozen=True)
class SolidLaw:
    """Solid part of a yarn in the 3D crossover; the fibre bars carry the tension.

    Parameters
    ----------
    E_a : [Pa] axial modulus of the solid, times V_f (eq. 3-2)
    E_c : [Pa] transverse modulus of the packed yarn
    K_r : [-] fraction of E_c left in a loose yarn
    K_G : [-] shear modulus over E_c / 2
    V_c : [-] nominal fibre volume fraction at which the yarn is packed
    Vf0 : [-] initial fibre volume fraction

    Raises
    ------
    InputError : a value is not positive, K_r is not below 1, or Vf0 is not below V_c
    """

    E_a: float
    E_c: float
    K_r: float
    K_G: float
    V_c: float
    Vf0: float

    def __post_init__(self):
        positive(self, "E_a", "E_c", "K_r", "K_G", "V_c", "Vf0")
        if self.K_r >= 1:
            refuse(self, "K_r", "below 1")
        if self.Vf0 >= self.V_c:
            refuse(self, "Vf0", f"below V_c = {self.V_c:g}")

    @property
    def b_E(self) -> float:
        """[-] eq. 3-13."""
        return (self.V_c - self.K_r * self.Vf0) / (1 - self.K_r)

    @property
    def a_E(self) -> float:
        """[Pa] eq. 3-12."""
        return self.E_c * (self.b_E - self.V_c)

    @property
    def G(self) -> float:
        """[Pa] eq. 3-16."""
        return self.K_G * self.E_c / 2

    def transverse_modulus(self, V_f: ArrayLike) -> FloatArray:
        """Compute the secant modulus E_2 = E_3 [Pa] at the fibre volume fraction `V_f` (eqs. 3-10
        .. 3-14)."""
        return self.a_E / (self.b_E - np.clip(V_f, self.Vf0, self.V_c))
