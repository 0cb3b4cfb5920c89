"""Metals of projectiles by name: lead, jackets, copper and steel (`metals.toml`).

`TABLES` has their constants with range, source and status.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from pathlib import Path

from fabrics.base.checks import not_negative, positive, refuse
from fabrics.base.sourced import SourcedTables
from fabrics.materials import Elastic

_FILE = Path(__file__).with_name("metals.toml")
ROOM_TEMPERATURE = 293.0  # [K]
HEAT_SHARE = 0.9  # [-] of the plastic work, which stays as heat
_UNITS = {
    "density": "kg/m^3",
    "modulus": "Pa",
    "poisson": "",
    "yield_stress": "Pa",
    "hardening": "Pa",
    "hardening_exponent": "",
    "rate_coefficient": "",
    "reference_rate": "1/s",
    "softening_exponent": "",
    "melting_temperature": "K",
    "specific_heat": "J/(kg K)",
    "failure_strain": "",
}


@dataclass(frozen=True)
class Metal(Elastic):
    """Elasticity, and J2 plasticity with the flow stress of Johnson and Cook (1983):

    (yield_stress + hardening alpha^hardening_exponent) (1 + rate_coefficient ln(1 + rate / reference_rate))
    (1 - (w / melting_work)^softening_exponent), with w the plastic work of a unit of volume.

    Parameters
    ----------
    density, modulus, poisson : of `Elastic`
    yield_stress : [Pa] at no plastic strain, slowly; infinite of an elastic metal
    hardening, hardening_exponent : [Pa], [-] of the effective plastic strain alpha
    rate_coefficient : [-] 0 without an effect of the rate
    reference_rate : [1/s]
    softening_exponent : [-]
    melting_temperature : [K] infinite of a metal that heat does not soften
    specific_heat : [J/(kg K)]
    failure_strain : [-] effective plastic strain at which it would tear, for a check alone

    Raises
    ------
    InputError : a value out of its range
    """

    yield_stress: float = inf
    hardening: float = 0.0
    hardening_exponent: float = 1.0
    rate_coefficient: float = 0.0
    reference_rate: float = 1.0
    softening_exponent: float = 1.0
    melting_temperature: float = inf
    specific_heat: float = 400.0
    failure_strain: float = inf

    def __post_init__(self):
        super().__post_init__()
        positive(self, "reference_rate", "hardening_exponent")
        positive(self, "softening_exponent", "specific_heat")
        not_negative(self, "hardening", "rate_coefficient")
        if not self.melting_temperature > ROOM_TEMPERATURE:
            refuse(self, "melting_temperature", f"above {ROOM_TEMPERATURE:g} K")
        for key in ("yield_stress", "failure_strain"):
            if not getattr(self, key) > 0:
                refuse(self, key, "above 0")

    @property
    def melting_work(self) -> float:
        """[J/m3] plastic work that melts it, without conduction of heat; infinite if none does."""
        rise = self.melting_temperature - ROOM_TEMPERATURE
        return self.density * self.specific_heat * rise / HEAT_SHARE


TABLES = SourcedTables(_FILE, "metal", _UNITS)
list_names = TABLES.list_names
entry = TABLES.entry
bounds = TABLES.bounds


def load(name: str, *, key: str = "core") -> Metal:
    """Return the metal of a name.

    Raises
    ------
    InputError : an unknown name
    """
    return Metal(**TABLES.values(name, key=key))
