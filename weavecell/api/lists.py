"""Fabrics, projectiles, metals and backings by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fabrics import backings as backing_data
from fabrics import catalogue
from fabrics import metals as metal_data
from fabrics import projectiles as projectile_data
from fabrics.base import files
from fabrics.base.checks import FilePath
from fabrics.base.sourced import assumed_of
from fabrics.base.units import si
from weavecell.api.entrance import public

if TYPE_CHECKING:
    from pandas import DataFrame


@public
def fabrics(*, out: FilePath | None = None) -> DataFrame:
    """List the catalogue, a row a fabric.

    Mass and strength are those of the data sheet. Shots use the linear density of the published
    runs, where the file has it, which gives the mass in shots.

    Parameters
    ----------
    out : also write it as this CSV file; never over one that exists

    Examples
    --------
    >>> wc.fabrics()["mass [g/m²]"]["S-720"].round(1)
    252.9
    """
    rows = {}
    for name in catalogue.list_names():
        fabric = catalogue.load(name)
        weave = fabric.weave
        shot_at = fabric
        if fabric.effective_linear_density is not None:
            shot_at = fabric.with_effective_density()
        rows[name] = {
            "warp count [1/cm]": weave.warp_count / 100,
            "weft count [1/cm]": weave.weft_count / 100,
            "warp crimp [%]": 100 * weave.warp.crimp,
            "weft crimp [%]": 100 * weave.weft.crimp,
            "mass [g/m²]": 1e3 * weave.areal_density,
            "mass in shots [g/m²]": 1e3 * shot_at.weave.areal_density,
            "thick [mm]": 1e3 * weave.thickness,
            "warp strength [N]": weave.warp.strength,
            "weft strength [N]": weave.weft.strength,
        }
    return _tabulate("fabric", rows, out)


# (key of a projectile, SI unit, column in thousandths of it)
_SIZES = (
    ("mass", "kg", "mass [g]"),
    ("diameter", "m", "diameter [mm]"),
    ("length", "m", "length [mm]"),
)


@public
def projectiles(*, out: FilePath | None = None) -> DataFrame:
    """List the fragment simulators, cylinders, spheres and bullets that an input file may name, a
    row each.

    Parameters
    ----------
    out : also write it as this CSV file; never over one that exists

    Examples
    --------
    >>> wc.projectiles().index[3]
    'FSP 1.10 g'
    """
    rows = {}
    for name in projectile_data.list_names():
        shape, data = projectile_data.entry(name)
        metals = [data[key]["value"] for key in ("core", "jacket") if key in data]
        row: dict[str, str | float] = {"nose": shape}
        # a sphere has no length, a body of an STL file no diameter
        for key, unit, column in _SIZES:
            if key in data:
                row[column] = 1e3 * si(data[key]["value"], unit)
        rigid = "steel, rigid" if name in projectile_data.TABLES.own else "rigid"
        row["metal"] = " in ".join(metals) or rigid
        assumed_keys = [key for key in assumed_of(data) if key != "mass_tolerance"]
        row["assumed"] = ", ".join(assumed_keys).replace("_", " ") or "nothing"
        rows[name] = row
    return _tabulate("projectile", rows, out)


@public
def metals(*, out: FilePath | None = None) -> DataFrame:
    """List the metals that core and jacket of a projectile may name, a row each.

    Parameters
    ----------
    out : also write it as this CSV file; never over one that exists

    Examples
    --------
    >>> wc.metals().index[0]
    'lead'
    """
    rows = {}
    for name in metal_data.list_names():
        metal = metal_data.load(name)
        rows[name] = {
            "density [kg/m³]": metal.density,
            "modulus [GPa]": metal.modulus / 1e9,
            "yield stress [MPa]": metal.yield_stress / 1e6,
            "hardening [MPa]": metal.hardening / 1e6,
            "hardening exponent": metal.hardening_exponent,
            "rate coefficient": metal.rate_coefficient,
            "failure strain": metal.failure_strain,
            "status of the yield stress": metal_data.entry(name)["yield_stress"]["status"],
        }
    return _tabulate("metal", rows, out)


@public
def backings(*, out: FilePath | None = None) -> DataFrame:
    """List the clay and gelatine that an input file may name behind a panel, a row each.

    Parameters
    ----------
    out : also write it as this CSV file; never over one that exists

    Examples
    --------
    >>> wc.backings().index[0]
    'Roma Plastilina No. 1'
    """
    rows = {}
    for name in backing_data.list_names():
        material = backing_data.load(name)
        rows[name] = {
            "density [kg/m³]": material.density,
            "modulus [MPa]": material.modulus / 1e6,
            "yield stress [MPa]": material.yield_stress / 1e6,
            "rate exponent": material.rate_exponent,
            "erosion strain": material.erosion_strain,
            "wave speed [m/s]": material.wave_speed,
            "status of the yield stress": backing_data.entry(name)["yield_stress"]["status"],
        }
    return _tabulate("backing", rows, out)


def _tabulate(kind, rows, out):
    """The table of {name: {column: value}}, which is also written to `out` if that is given."""
    from weavecell.results.readable import ReadableTable

    table = ReadableTable.from_dict(rows, orient="index").rename_axis(kind)
    if out is not None:
        files.refuse_existing(out)
        files.write(out, table.to_csv(float_format="%.6g"))
    return table
