"""One yarn: a bundle of straight elastic fibres, woven in with a crimp. Linear elastic to its failure strain.

Equations (thesis): T = E A_s strain (eq. 4-7), strength T_u = failure_strain E A_s (erratum E-39).
"""

from __future__ import annotations

from dataclasses import dataclass

from fabrics.checks import fraction, positive


@dataclass(frozen=True)
class Yarn:
    """A yarn of one family of a weave.

    Parameters
    ----------
    linear_density : [kg/m] mass per length of straight yarn
    fibre_density : [kg/m3]
    E : [Pa] axial modulus of the fibre
    failure_strain : [-] of the fibre, beyond crimp (erratum E-18)
    crimp : [-] yarn length over cell length, minus one

    Raises
    ------
    InputError : a value is not positive, or the crimp or failure strain is outside [0, 1)
    """

    linear_density: float
    fibre_density: float
    E: float
    failure_strain: float
    crimp: float

    def __post_init__(self):
        positive(self, "linear_density", "fibre_density", "E", "failure_strain")
        fraction(self, "failure_strain", "crimp")

    @property
    def A_s(self) -> float:
        """[m2] cross-section of the fibres alone."""
        return self.linear_density / self.fibre_density

    @property
    def EA(self) -> float:
        """[N] axial stiffness: the slope of tension against strain."""
        return self.E * self.A_s

    @property
    def strength(self) -> float:
        """[N] ultimate tension T_u."""
        return self.failure_strain * self.EA

    @property
    def wave_speed(self) -> float:
        """[m/s] of a longitudinal wave in the straight yarn, sqrt(E/rho)."""
        return (self.E / self.fibre_density) ** 0.5
