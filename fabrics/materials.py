"""Isotropic elastic-plastic materials: the projectile's steel and the default block (thesis Tables
4-2, 6-1).

Clay and gelatine by name are in `fabrics.backings`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, sqrt
from pathlib import Path

from fabrics.base.checks import FilePath, positive, refuse
from fabrics.base.errors import InputError
from fabrics.base.files import read_data
from fabrics.base.units import si

_FILE = Path(__file__).with_name("materials.toml")
_UNITS = {
    "density": "kg/m^3",
    "modulus": "Pa",
    "poisson": "",
    "yield_stress": "Pa",
    "hardening": "Pa",
    "rate_exponent": "",
    "reference_rate": "1/s",
}
_ROUND = {"diameter": "m", "length": "m", "mass": "kg", "bore": "m"}


@dataclass(frozen=True)
class Isotropic:
    """Linear elasticity, and J2 plasticity with linear hardening and a power of the rate.

    q = (yield_stress + hardening alpha) (1 + d(alpha)/dt / reference_rate)^rate_exponent while it
    flows.

    Parameters
    ----------
    density : [kg/m3]
    modulus : [Pa] Young's
    poisson : [-]
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

    density: float
    modulus: float
    poisson: float
    yield_stress: float = inf
    hardening: float = 0.0
    erosion_strain: float = inf
    rate_exponent: float = 0.0
    reference_rate: float = 1.0

    def __post_init__(self):
        positive(self, "density", "modulus", "reference_rate")
        if not 0 <= self.poisson < 0.5:
            refuse(self, "poisson", "from 0 to below 0.5")
        if not self.hardening >= 0:
            refuse(self, "hardening", "at least 0")
        if not 0 <= self.rate_exponent <= 1:
            refuse(self, "rate_exponent", "from 0 to 1")
        for key in ("yield_stress", "erosion_strain"):
            if not getattr(self, key) > 0:
                refuse(self, key, "above 0")

    @property
    def shear(self) -> float:
        """[Pa]"""
        return self.modulus / (2 * (1 + self.poisson))

    @property
    def bulk(self) -> float:
        """[Pa]"""
        return self.modulus / (3 * (1 - 2 * self.poisson))

    @property
    def wave_speed(self) -> float:
        """[m/s] of a longitudinal wave in the bulk."""
        return sqrt((self.bulk + 4 / 3 * self.shear) / self.density)

    @property
    def shear_speed(self) -> float:
        """[m/s] of a shear wave."""
        return sqrt(self.shear / self.density)


def read_table(name: str) -> dict[str, dict]:
    """Read a material of `materials.toml`: {constant: its table}."""
    return read_data(_FILE)[name]


def load(name: str) -> Isotropic:
    """Return the material "steel" or "backing" of `materials.toml`.

    Raises
    ------
    InputError : another name
    """
    if name not in ("steel", "backing"):
        raise InputError(key="material", value=name, allowed="steel or backing")
    return of_table(read_table(name), _FILE)


def of_table(table: Mapping[str, Mapping[str, str]], file: FilePath) -> Isotropic:
    """Return the material of {key: {"value": its text, ...}}, as data files have it; keys left out
    have their defaults."""
    read = in_si(table, _UNITS, file)
    return Isotropic(**read, erosion_strain=float(table["erosion_strain"]["value"]))


def in_si(
    table: Mapping[str, Mapping[str, str]], units: Mapping[str, str], file: FilePath
) -> dict[str, float]:
    """Convert the values of a table of a data file to the SI units of its keys; a key may be
    missing."""
    values = {}
    for key, unit in units.items():
        if key in table:
            values[key] = si(plain(table[key]["value"]), unit, file=file, key=key)
    return values


def plain(text: str) -> float | str:
    """Return the number that a text is, else the text: ratios carry no unit."""
    try:
        return float(text)
    except ValueError:
        return text


def round_projectile() -> dict:
    """Read diameter, length, mass and bore [m, kg] of the right circular cylinder of the thesis."""
    return in_si(read_table("rcc"), _ROUND, _FILE)
