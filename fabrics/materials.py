"""Isotropic elastic-plastic materials: the projectile's steel and the default block (thesis Tables
4-2, 6-1).

Clay and gelatine by name are in `fabrics.backings`. An input file gives the constants of a block by
`IsotropicKeys`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import inf, sqrt
from pathlib import Path
from typing import Annotated

from fabrics.base.checks import FilePath, positive, refuse
from fabrics.base.errors import InputError
from fabrics.base.fields import check_fields
from fabrics.base.files import read_data
from fabrics.base.schema import declared, key, number, quantity, unit_of
from fabrics.base.sourced import Constants, in_si

_FILE = Path(__file__).with_name("materials.toml")
_ROUND = {"diameter": "m", "length": "m", "mass": "kg", "bore": "m"}


@dataclass(frozen=True, kw_only=True)
class IsotropicKeys:
    """Constants of `Isotropic` as keys of the table [backing], None of one that is not given; a line says
    all of one, its unit in data files too. Read by a "block"."""

    density: Annotated[
        float | None, key(quantity("density of the block", "kg/m^3", "3 g/cm^3"), "block")
    ] = None
    modulus: Annotated[
        float | None, key(quantity("Young's modulus of the block", "Pa", "100 MPa"), "block")
    ] = None
    poisson: Annotated[
        float | None, key(number("Poisson's ratio of the block", 0.4, ge=0.0, lt=0.5), "block")
    ] = None
    yield_stress: Annotated[
        float | None,
        key(
            quantity(
                "initial yield stress of the block at slow rates (J2 plasticity)", "Pa", "20 MPa"
            ),
            "block",
        ),
    ] = None
    hardening: Annotated[
        float | None,
        key(quantity("isotropic hardening modulus of the block", "Pa", "0 Pa", zero=True), "block"),
    ] = None
    erosion_strain: Annotated[
        float | None,
        key(
            number(
                "effective plastic strain at which an element is eroded",
                0.9,
                gt=0.0,
                allow_inf_nan=True,
            ),
            "block",
        ),
    ] = None
    rate_exponent: Annotated[
        float | None,
        key(
            number(
                "exponent m of the rate: the yield stress is multiplied by (1 + rate / reference_rate)^m",
                0.1,
                ge=0.0,
                le=1.0,
            ),
            "block",
        ),
    ] = None
    reference_rate: Annotated[
        float | None,
        key(quantity("rate of effective plastic strain in that formula", "1/s", "1 / s"), "block"),
    ] = None


UNITS = {name: unit_of(entry) or "" for name, entry in declared(IsotropicKeys).items()}


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
        check_fields(self)
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
        for name in ("yield_stress", "erosion_strain"):
            if not getattr(self, name) > 0:
                refuse(self, name, "above 0")


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
