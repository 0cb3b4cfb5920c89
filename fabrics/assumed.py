"""Laws that are assumed for para-aramid fabrics whose file gives none: trellis shear, and the yarn as a solid.

The values, and the range of yarns for which they are assumed, stand in assumed.toml. A fabric that has been completed
says so: `Fabric.assumed` names the tables, its `sources` hold the values with the status "assumed", and `lines` is what
a command prints and records.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

from fabrics import catalogue
from fabrics.errors import InputError
from fabrics.fabric import Fabric

_FILE = Path(__file__).with_name("assumed.toml")
_RANGE = {  # quantity of the file: attribute of a yarn, its unit, the unit of messages and the factor to it
    "modulus": ("E", "Pa", "GPa", 1e-9),
    "fibre_density": ("fibre_density", "kg/m^3", "kg/m^3", 1.0),
}
_HOLDS = {"shear": "G1, G2, gamma1 and gamma2", "solid": "E_a, E_c, K_r, K_G, V_c and Vf0 of warp and weft"}


@cache
def _read():
    """(name of the fabric whose values they are, {table: (field of Fabric, law)}, {quantity: limits [SI]}, sources)."""
    numbers = {f"yarns.{name}_{end}": unit for name, (_, unit, *_) in _RANGE.items() for end in ("least", "most")}
    name, shear, solids, values, sources = catalogue.tables(_FILE, numbers)
    limits = {quantity: [values[f"yarns.{quantity}_{end}"] for end in ("least", "most")] for quantity in _RANGE}
    return name, {"shear": ("shear", shear), "solid": ("solid_laws", solids)}, limits, sources


def with_shear(fabric: Fabric) -> Fabric:
    """The fabric with a trellis law, the assumed one where its file gives none.

    Raises
    ------
    InputError : it has none, and its yarns are not para-aramid
    """
    return fabric if fabric.shear is not None else _completed(fabric, "shear")


def with_solid_laws(fabric: Fabric) -> Fabric:
    """The fabric with solid laws of its yarns, the assumed ones where its file gives none.

    Raises
    ------
    InputError : it has none, and its yarns are not para-aramid
    """
    return fabric if fabric.solid_laws is not None else _completed(fabric, "solid")


def lines(fabric: Fabric) -> list[str]:
    """One line for each table that was assumed."""
    return [f"assumed: [{table}] of {_read()[0]}, because {fabric.name} gives none" for table in fabric.assumed]


def _completed(fabric, table):
    _, laws, limits, known = _read()
    for quantity, (attribute, _, unit, factor) in _RANGE.items():
        low, high = limits[quantity]
        if not all(low <= getattr(yarn, attribute) <= high for yarn in fabric.weave.yarns):
            raise InputError(
                f"fabric {fabric.name} has no [{table}] table",
                allowed=f"given, with {_HOLDS[table]}: it is assumed for para-aramid yarns alone, whose {quantity} "
                f"is {factor * low:g} to {factor * high:g} {unit}",
            )
    field, law = laws[table]
    sources = {key: entry for key, entry in known.items() if key.startswith(f"{table}.")}
    assumed = (*fabric.assumed, table)
    return replace(fabric, **{field: law}, sources={**fabric.sources, **sources}, assumed=assumed)
