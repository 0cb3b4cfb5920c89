"""Ranges and spreads of the input from inputs.toml, and a fabric changed by them.

Areal density changes mass alone, the stiffness of the yarns is kept, as in the source (thesis section 6.3.3).
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, replace
from importlib import resources
from math import inf

from fabrics.errors import InputError
from fabrics.units import si

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


def table(section, unit=""):
    """Entries of a section, by name; InputError where one lacks source or status."""
    text = (resources.files("weavecell.analysis.uncertainty") / FILE).read_text("utf-8")
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


def changed(fabric, **factors):
    """A fabric with some of its numbers times a factor, by the names of [range] in inputs.toml.

    Raises
    ------
    InputError : an unknown name, or the trellis or compression of a fabric that has none
    """
    f = dict.fromkeys(table("range"), 1.0)
    unknown = set(factors) - set(f)
    if unknown:
        raise InputError(key=min(unknown), allowed=f"one of {', '.join(f)}")
    f |= factors
    mass, laws, shear = f["areal_density"], fabric.laws, fabric.shear
    warp, weft = (
        replace(
            yarn,
            E=yarn.E * f["modulus"] / mass,  # the section grows with the linear density, and E A_s is to stay
            linear_density=yarn.linear_density * mass,
            failure_strain=yarn.failure_strain * f["failure_strain"],
            crimp=yarn.crimp * f[f"crimp_{family}"],
        )
        for yarn, family in zip(fabric.weave.yarns, ("warp", "weft"))
    )
    if laws is not None:
        laws = tuple(replace(law, a=law.a * f["compression_a"], b=law.b * f["compression_b"]) for law in laws)
    if shear is not None:
        stiffer, wider = f["trellis_stiffness"], f["trellis_angles"]
        shear = replace(
            shear,
            G1=shear.G1 * stiffer,
            G2=shear.G2 * stiffer,
            gamma1=shear.gamma1 * wider,
            gamma2=shear.gamma2 * wider,
        )
    return replace(fabric, weave=replace(fabric.weave, warp=warp, weft=weft), laws=laws, shear=shear)
