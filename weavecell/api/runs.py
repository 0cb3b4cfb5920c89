"""Fabrics and impacts of the Python interface. Quantities are SI numbers, or texts with a unit
("92.5 m/s")."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, Unpack

from fabrics import catalogue
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.fabric import Fabric
from fabrics.variants import with_linear_density
from weavecell.api.entrance import public
from weavecell.api.keywords import Keywords, explain_keywords
from weavecell.api.target import build_target

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup


@public
def fabric(
    name: FilePath, *, linear_density: Literal["effective", "nominal"] = "effective"
) -> Fabric:
    """Load a fabric of the catalogue, or of a user's file.

    Parameters
    ----------
    name : name of the catalogue, or path of a .toml file
    linear_density : "effective", of the published runs if the file gives it, as in input files; or
        "nominal", of the data sheet

    Raises
    ------
    InputError : no such fabric, a wrong file, or another linear density

    Examples
    --------
    >>> wc.fabric("S-720").name
    'S-720'
    >>> round(1e3 * wc.fabric("S-720", linear_density="nominal").weave.areal_density)  # [g/m2]
    253
    """
    if linear_density not in ("effective", "nominal"):
        raise InputError(key="linear_density", value=linear_density, allowed="effective or nominal")
    return with_linear_density(catalogue.load(name), linear_density)


@explain_keywords(Keywords)
@public
def setup(
    fabric: Fabric | FilePath | None, velocity: float | str, **options: Unpack[Keywords]
) -> ImpactSetup:
    """Build the set-up of one impact, for `sweep` or `shellfabric`.

    Parameters
    ----------
    fabric : Fabric, or what `weavecell.fabric` takes; None if every dict of `ply` has its name or
        file
    velocity : [m/s] of the strike, or a text such as "92.5 m/s"
    **options : the keys of the input file (docs/reference.md), numbers in SI units or texts with a
        unit. Those of [fabric], [panel] and [run] are keywords (`weavecell.api.keywords.Keywords`):
        opening is 203 mm and end_time 800 us if not given, without snapshot_interval only the shape
        at the end is kept, ply is a list of dicts, as [[panel.ply]]: ply=[{"count": 2}, {"name":
        "S-726", "angle": "90 deg"}]. The tables [projectile], [history], [numerics] and [backing]
        are dicts: projectile={"mass": "1.1 g", "diameter": "5.4 mm", "edge_radius": "0.3 mm"},
        whose three keys are required as in the file; projectile="FSP 1.10 g" or {"name": "FSP 1.10
        g", ...} is one of `projectiles`; without it the projectile is the flat cylinder of 3 g and
        5.5 mm with an edge radius of 0.3 mm. backing="gelatine 10 %" or {"material": "gelatine 10
        %", ...} is one of `backings`. law is a CompressionLaw of both families, a pair (warp,
        weft), the path of a law.json, a dict {"a": ..., "b": ...} or a CalibrationResult; without
        it that of the fabric. surface may be a ResponseSurface, ply_contact a PlyLaw

    Returns
    -------
    ImpactSetup; each of its `notes` is a warning

    Raises
    ------
    InputError : an unknown keyword, a value that is not allowed, or a law that is missing

    Examples
    --------
    >>> wc.setup("S-720", "92.5 m/s", opening="50 mm").opening
    0.05
    """
    return build_target(fabric, velocity, options).setup
