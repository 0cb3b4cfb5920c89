"""Isotropic elastic-plastic materials: the projectile's steel and the default block (thesis Tables
4-2, 6-1).

Clay and gelatine by name are in `fabrics.backings`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import inf, sqrt
from pathlib import Path

from fabrics.base.checks import FilePath, positive, refuse
from fabrics.base.errors import InputError
from fabrics.base.files import read_data
from fabrics.base.sourced import Constants, in_si

_FILE = Path(__file__).with_name("materials.toml")
UNITS = {
    "density": "kg/m^3",
    "modulus": "Pa",
    "poisson": "",
    "yield_stress": "Pa",
    "hardening": "Pa",
    "rate_exponent": "",
    "reference_rate": "1/s",
    "erosion_strain": "",
}
_ROUND = {"diameter": "m", "length": "m", "mass": "kg", "bore": "m"}


@dataclass(frozen=True)
class Elastic:
    """Isotropic elasticity; Hencky's, where strains are large.

    Parameters
    ----------
    density : [kg/m3]
    modulus : [Pa] Young's
    poisson : [-]

    Raises
    ------
    InputError : a value out of its range
    """

    density: float
    modulus: float
    poisson: float

    def __post_init__(self):
        positive(self, "density", "modulus")
        if not 0 <= self.poisson < 0.5:
            refuse(self, "poisson", "from 0 to below 0.5")

    @property
    def shear(self) -> float:
        """[Pa] shear modulus."""
        return self.modulus / (2 * (1 + self.poisson))

    @property
    def bulk(self) -> float:
        """[Pa] bulk modulus."""
        return self.modulus / (3 * (1 - 2 * self.poisson))

    @property
    def wave_speed(self) -> float:
        """[m/s] of a longitudinal wave in the bulk."""
        return sqrt((self.bulk + 4 / 3 * self.shear) / self.density)

    @property
    def shear_speed(self) -> float:
        """[m/s] of a shear wave."""
        return sqrt(self.shear / self.density)


@dataclass(frozen=True)
class Isotropic(Elastic):
    """Elasticity, and J2 plasticity with linear hardening and a power of the rate.

    q = (yield_stress + hardening alpha) (1 + d(alpha)/dt / reference_rate)^rate_exponent while it
    flows.

    Parameters
    ----------
    density, modulus, poisson : of `Elastic`
    yield_stress : [Pa] in tension; infinite for an elastic material
    hardening : [Pa] plastic modulus, d(yield stress) / d(effective plastic strain)
    erosion_strain : [-] effective plastic strain at which an element is taken out; infinite for
        never
    rate_exponent : [-] of the flow stress; 0 for none (which is all that a projectile of steel has)
    reference_rate : [1/s] from which the rate counts

    Raises
    ------
    InputError : a value out of its range
    """

    yield_stress: float = inf
    hardening: float = 0.0
    erosion_strain: float = inf
    rate_exponent: float = 0.0
    reference_rate: float = 1.0

    def __post_init__(self):
        super().__post_init__()
        positive(self, "reference_rate")
        if not self.hardening >= 0:
            refuse(self, "hardening", "at least 0")
        if not 0 <= self.rate_exponent <= 1:
            refuse(self, "rate_exponent", "from 0 to 1")
        for key in ("yield_stress", "erosion_strain"):
            if not getattr(self, key) > 0:
                refuse(self, key, "above 0")


def read_table(name: str) -> Constants:
    """Read a material of `materials.toml`: {constant: its row}."""
    found: Constants = read_data(_FILE)[name]
    return found


@cache
def load(name: str) -> Isotropic:
    """Return the material "steel" or "backing" of `materials.toml`.

    Raises
    ------
    InputError : another name
    """
    if name not in ("steel", "backing"):
        raise InputError(key="material", value=name, allowed="steel or backing")
    return of_table(read_table(name), _FILE)


def of_table(table: Constants, file: FilePath) -> Isotropic:
    """Return the material of {constant: its row}, as data files have it; constants left out have
    their defaults."""
    return Isotropic(**in_si(table, UNITS, file))


@cache
def round_projectile() -> dict[str, float]:
    """Read diameter, length, mass and bore [m, kg] of the right circular cylinder of the thesis."""
    return in_si(read_table("rcc"), _ROUND, _FILE)
