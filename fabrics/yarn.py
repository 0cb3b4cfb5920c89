"""One yarn: a bundle of straight elastic fibres, woven in with a crimp. Linear elastic to its
failure strain.

Equations (thesis): T = E A_s strain (eq. 4-7), strength T_u = failure_strain E A_s (erratum E-39).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi, sqrt

from fabrics.base.checks import fraction, positive, refuse
from fabrics.base.errors import placed
from fabrics.base.frozen import explain_frozen

# fibre volume fraction of round fibres that touch
CLOSEST_PACKING = pi / (2 * sqrt(3))
STATUSES = ("measured", "assumed")  # of weaving damage


@explain_frozen
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

    def woven(self, damage: WeavingDamage) -> Yarn:
        """Return this yarn after weaving; its failure strain is then strength over modulus.

        Raises
        ------
        InputError : a failure strain that is not below 1
        """
        modulus = damage.shares.get("modulus", 1.0)
        strength = damage.shares.get("strength", 1.0)
        failure_strain = self.failure_strain * strength / modulus
        return replace(self, E=modulus * self.E, failure_strain=failure_strain)


def striking_velocity(c: float, strain: float) -> float:
    """Compute the velocity [m/s] across a straight yarn of the wave speed `c` [m/s] that leaves the
    strain behind its waves (Smith's closed form; docs/theory-panel.md, "Wave speeds")."""
    return c * sqrt(2 * strain * sqrt(strain * (1 + strain)) - strain * strain)


@dataclass(frozen=True)
class WeavingDamage:
    """What weaving leaves of modulus and strength of the yarns of both families.

    Yarn data of a catalogue are those of yarns before weaving, which breaks and abrades fibres
    (thesis sections 5.2.3 and 6.3.1). Neither the thesis nor the catalogue has data of yarns taken
    from a woven fabric: a share is an assumption until it is measured.

    Parameters
    ----------
    modulus, strength : [-] shares that are retained; None of what stays as it is
    source : where the shares come from
    status : of STATUSES

    Raises
    ------
    InputError : a share that is not above 0 and at most 1, an unknown status, or no source
    """

    modulus: float | None = None
    strength: float | None = None
    source: str = ""
    status: str = "assumed"

    def __post_init__(self) -> None:
        with placed(None, "weaving_damage."):
            for key, share in self.shares.items():
                if not 0 < share <= 1:
                    refuse(self, key, "above 0 and at most 1")
            if self.status not in STATUSES:
                refuse(self, "status", " or ".join(STATUSES))
            if not self.source:
                refuse(self, "source", "given")

    @property
    def shares(self) -> dict[str, float]:
        """{"modulus", "strength": [-]} of those that are given."""
        both = {"modulus": self.modulus, "strength": self.strength}
        return {name: share for name, share in both.items() if share is not None}
