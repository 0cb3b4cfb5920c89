"""Metals of projectiles by name: lead, jackets, copper and steel (`metals.toml`).

An entry holds constants as they would be written in an input file ("24 MPa"), each with its range,
source and status.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from math import inf, sqrt
from pathlib import Path

from fabrics.base.checks import FilePath, not_negative, positive, refuse
from fabrics.base.errors import InputError, unknown_name
from fabrics.base.files import read_data
from fabrics.materials import in_si, plain

_FILE = Path(__file__).with_name("metals.toml")
STATUSES = ("published", "second-hand", "derived", "assumed")
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
}


@dataclass(frozen=True)
class Metal:
    """Isotropic elasticity, and J2 plasticity with the flow stress of Johnson and Cook (1983):

    (yield_stress + hardening alpha^hardening_exponent) (1 + rate_coefficient ln(1 + rate / reference_rate))
    (1 - (w / melting_work)^softening_exponent), with w the plastic work of a unit of volume.

    Parameters
    ----------
    density : [kg/m3]
    modulus : [Pa] Young's
    poisson : [-]
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

    density: float
    modulus: float
    poisson: float
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
        positive(self, "density", "modulus", "reference_rate", "hardening_exponent")
        positive(self, "softening_exponent", "specific_heat")
        not_negative(self, "hardening", "rate_coefficient")
        if not 0 <= self.poisson < 0.5:
            refuse(self, "poisson", "from 0 to below 0.5")
        if not self.melting_temperature > ROOM_TEMPERATURE:
            refuse(self, "melting_temperature", f"above {ROOM_TEMPERATURE:g} K")
        for key in ("yield_stress", "failure_strain"):
            if not getattr(self, key) > 0:
                refuse(self, key, "above 0")

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
    def melting_work(self) -> float:
        """[J/m3] plastic work that melts it, without conduction of heat; infinite if none does."""
        rise = self.melting_temperature - ROOM_TEMPERATURE
        return self.density * self.specific_heat * rise / HEAT_SHARE


@cache
def _data():
    return read_data(_FILE)["metal"]


def list_names() -> tuple[str, ...]:
    """Return the names of the metals, in the order of the file."""
    return tuple(_data())


def entry(
    name: str, *, file: FilePath | None = None, key: str = "core"
) -> Mapping[str, Mapping[str, str]]:
    """Look up a metal: {constant: value, range, source and status}.

    Raises
    ------
    InputError : an unknown name; one line with the `file` and `key` that it is read from, and the
        names there are
    """
    if name not in list_names():
        raise unknown_name("metal", name, list_names(), file=file, key=key)
    found: Mapping[str, Mapping[str, str]] = _data()[name]
    return found


def load(name: str, *, key: str = "core") -> Metal:
    """Return the metal of a name.

    Raises
    ------
    InputError : an unknown name
    """
    data = entry(name, key=key)
    failure_strain = float(data["failure_strain"]["value"])
    return Metal(**in_si(data, _UNITS, _FILE), failure_strain=failure_strain)


def bounds(name: str, constant: str) -> tuple[float, float]:
    """Return the least and the largest value [SI] that a constant of a metal may have.

    Raises
    ------
    InputError : an unknown name of a metal or of a constant
    """
    data = entry(name)
    if constant not in data:
        raise InputError(key=constant, value=name, allowed=" or ".join(data))
    found = []
    for text in data[constant]["range"]:
        one = {constant: {"value": text}}
        found.append(in_si(one, _UNITS, _FILE).get(constant, plain(text)))
    low, high = map(float, found)
    return low, high
