"""Ranges and spreads of the input from inputs.toml, and a fabric changed by them.

Areal density changes mass alone, the stiffness of the yarns is kept, as in the thesis (thesis section 6.3.3).
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources
from math import inf
from typing import Any

from fabrics import variants
from fabrics.compression import CompressionLaw
from fabrics.errors import InputError
from fabrics.fabric import Fabric
from fabrics.units import si
from shellfabric.impact.simulation import ImpactSetup

STATUSES = ("measured", "derived", "corrected", "fitted", "assumed")
FILE = "inputs.toml"


@dataclass(frozen=True)
class Entry:
    """A number of inputs.toml in SI, with where it comes from."""

    name: str
    value: float
    source: str
    status: str


@dataclass(frozen=True)
class Scatter:
    """Scatter of yarns and panels.

    Parameters
    ----------
    shape : [-] Weibull modulus of the yarns' strength; infinite for yarns that are all alike
    gauge_length : [m] at which the mean of the strengths is that of the fabric
    modulus, crimp : [-] standard deviation over mean from panel to panel
    """

    shape: float = inf
    gauge_length: float = 0.2
    modulus: float = 0.0
    crimp: float = 0.0

    def __post_init__(self):
        for key in ("shape", "gauge_length"):
            if not getattr(self, key) > 0:
                raise InputError(key=key, value=getattr(self, key), allowed="above 0")
        for key in ("modulus", "crimp"):
            if not 0 <= getattr(self, key) < 1:
                raise InputError(key=key, value=getattr(self, key), allowed="at least 0 and below 1")


def table(section: str, unit: str = "") -> dict[str, Entry]:
    """Entries of a section, by name; InputError where one lacks source or status."""
    return dict(_entries(section, unit))


@cache
def _entries(section, unit):
    text = (resources.files("weavecell.studies") / FILE).read_text("utf-8")
    found = {}
    for name, row in tomllib.loads(text)[section].items():
        if row.get("status") not in STATUSES or not row.get("source"):
            raise InputError(file=FILE, key=f"{section}.{name}", allowed="a value with its source and status")
        length = "m" if name.endswith("length") else unit
        found[name] = Entry(name, si(row["value"], length, file=FILE, key=name), row["source"], row["status"])
    return found


def published() -> Scatter:
    """The scatter of inputs.toml."""
    yarn, panel = table("weibull"), table("spread")
    values = {"shape": yarn["shape"], "gauge_length": yarn["gauge_length"], **panel}
    return Scatter(**{name: entry.value for name, entry in values.items()})


def changed(fabric: Fabric, **factors: float) -> Fabric:
    """A fabric with some of its numbers times a factor, by the names of [range] in inputs.toml.

    Raises
    ------
    InputError : an unknown name
    """
    f = dict.fromkeys(table("range"), 1.0)
    unknown = set(factors) - set(f)
    if unknown:
        raise InputError(key=min(unknown), allowed=f"one of {', '.join(f)}")
    f |= factors
    fabric = variants.scale_yarns(
        fabric, E=f["modulus"], failure_strain=f["failure_strain"], crimp=(f["crimp_warp"], f["crimp_weft"])
    )
    fabric = variants.scale_areal_density(fabric, f["areal_density"])
    fabric = variants.scale_laws(fabric, f["compression_a"], f["compression_b"])
    return variants.scale_shear(fabric, f["trellis_stiffness"], f["trellis_angles"])


def changed_with_laws(
    fabric: Fabric, laws: tuple[CompressionLaw, CompressionLaw] | None, **factors: float
) -> tuple[Fabric, tuple[CompressionLaw, CompressionLaw] | None]:
    """(fabric, laws) changed by `changed`; laws, which may be others than the fabric's own, are changed alike.

    Raises
    ------
    InputError : an unknown name
    """
    if laws:
        scales = (factors.get(f"compression_{name}", 1.0) for name in "ab")
        laws = variants.scale_laws(replace(fabric, laws=laws), *scales).laws
    return changed(fabric, **factors), laws


def alone(setup: ImpactSetup, **others: Any) -> ImpactSetup:
    """The set-up on one thread, since others run beside it, that records nothing beside its samples; others change."""
    numerics = replace(setup.numerics, threads=1)
    return replace(setup, **{"numerics": numerics, "history": None, "snapshot_interval": None} | others)


def changed_setup(setup: ImpactSetup, **factors: float) -> ImpactSetup:
    """A set-up whose plies are of a fabric changed by `changed`, with the laws that it names changed alike.

    Raises
    ------
    InputError : an unknown name
    """

    def one(held):
        fabric, laws = changed_with_laws(held.fabric, held.laws, **factors)
        return replace(held, fabric=fabric, laws=laws)

    return one(replace(setup, lay_up=tuple(map(one, setup.lay_up))))
