"""Scene files: one impact, described in TOML with units as text, checked before anything is computed or written."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, ConfigDict, Discriminator, Field, Tag

from fabrics import backings, projectiles
from fabrics.checks import FilePath
from fabrics.errors import InputError
from fabrics.units import si
from weavecell.scenes import supported
from weavecell.scenes.schema import (
    LAW,
    FabricTable,
    Law,
    Table,
    anchored,
    angle,
    exactly_one,
    in_unit,
    number,
    one_of,
    quantities,
    quantity,
    read_toml,
    validated,
    whole,
)

SHAPES = {  # of `shellfabric.projectile.projectile`, in words
    "flat": "a cylinder", "hemisphere": "a round-nosed cylinder", "cone": "a conical projectile", "sphere": "a sphere",
    "chisel": "a chisel-nosed fragment simulator",
}  # fmt: skip


def _name_or_size(schema):
    """The JSON Schema of [projectile] as files have it: what `projectiles` knows of a name is not required."""
    schema["required"] = ["strike_velocity"]
    schema["anyOf"] = [{"required": ["name"]}, {"required": ["mass", "diameter"]}]


class ProjectileTable(Table):
    """A projectile of one of the SHAPES, flying at the panel's centre; rigid, or a steel bar along its axis."""

    model_config = ConfigDict(json_schema_extra=_name_or_size)

    name: Annotated[str | None, Field(description="the name of a projectile")] = None
    mass: quantity("kg", "a mass above 0", "3 g", above=0.0)
    diameter: quantity("m", "a length above 0", "5.5 mm", above=0.0)
    edge_radius: quantity("m", "a length above 0", "0.3 mm", above=0.0) = None
    strike_velocity: quantity("m/s", "a speed above 0 and at most 1000 m/s", "92.5 m/s", above=0.0, at_most=1000.0)
    shape: one_of(*SHAPES) = "flat"
    length: quantity("m", "a length above 0", "8 mm", above=0.0) = None
    half_angle: angle(5, 85, "45 deg") = None
    tip_radius: quantity("m", "a length above 0", "0.5 mm", above=0.0) = None
    flat_width: quantity("m", "a length above 0", "2.5 mm", above=0.0) = None
    flat_angle: angle(5, 85, "35 deg") = None
    obliquity: angle(0, 75, "30 deg") = 0.0
    azimuth: angle(-360, 360, "90 deg") = 0.0
    yaw: angle(-75, 75, "5 deg") = 0.0
    roll: angle(-360, 360, "45 deg") = 0.0
    friction: Annotated[float, Field(ge=0.0, le=2.0, description="a number from 0 to 2")] = 0.0
    body: one_of("rigid", "elastic_bar") = "rigid"
    bore_diameter: quantity("m", "a length above 0", "4.5 mm", above=0.0) = None


class SlipTable(Table):
    """A side that slips: a friction clamp, or a prescribed pull-in (thesis section 6.4.3)."""

    clamp_force: quantity("N", "a force above 0", "20 N", above=0.0) = None
    pull_in: quantity("m", "a length above 0", "5 mm", above=0.0) = None
    start: quantity("s", "a time of at least 0", "200 us", at_least=0.0) = None
    end: quantity("s", "a time above 0", "650 us", above=0.0) = None
    zone: quantity("m", "a length above 0", "60 mm", above=0.0) = None


_SIDE = (
    '"clamped", "free", { clamp_force = ... }, { pull_in = ..., start = ..., end = ... }, '
    "or a list of two such for its ends"
)
_BOUNDARY = '"clamped", "free" or a table { warp = ..., weft = ... } of sides'


def _kind(value):
    return "inline" if isinstance(value, (dict, Table)) else "pair" if isinstance(value, (list, tuple)) else "text"


_Text = Annotated[Literal["clamped", "free"], Tag("text")]
_One = Annotated[_Text | Annotated[SlipTable, Tag("inline")], Discriminator(_kind)]
_Pair = Annotated[tuple[_One, _One], BeforeValidator(lambda value: tuple(value)), Tag("pair")]
Side = Annotated[_Text | Annotated[SlipTable, Tag("inline")] | _Pair, Discriminator(_kind)]


class BoundaryTable(Table):
    """The sides at which warp and weft yarns end."""

    warp: Annotated[Side, Field(description=_SIDE)] = "clamped"
    weft: Annotated[Side, Field(description=_SIDE)] = "clamped"


Boundary = Annotated[_Text | Annotated[BoundaryTable, Tag("inline")], Discriminator(_kind)]


def _opening(value):
    sides = [si(text, "m") for text in (value if isinstance(value, list) and len(value) == 2 else [value])]
    if min(sides) <= 0:
        raise ValueError("out of range")
    return sides[0] if len(sides) == 1 else tuple(sides)


def _opening_or_value_error(value):
    try:
        return _opening(value)
    except InputError as problem:
        raise ValueError(str(problem)) from None


def zones(value: Any) -> tuple[tuple[float, float], ...] | None:
    """Zones (until, side) [crossovers] of a grading as they stand in a file; ValueError where they are none."""
    if value is None:
        return None
    plain = isinstance(value, (list, tuple)) and all(
        isinstance(zone, (list, tuple)) and len(zone) == 2 for zone in value
    )
    if not plain or any(isinstance(x, bool) or not isinstance(x, (int, float, str)) for zone in value for x in zone):
        raise ValueError("no zones")
    return tuple((_crossovers(until), _crossovers(side)) for until, side in value)


def _crossovers(value):
    """A number of crossovers, or a fraction of one such as "1/3"."""
    if not isinstance(value, str):
        return float(value)
    over, _, under = value.partition("/")
    return int(over) / int(under)


_PLY_CONTACT = '"solid", "pressure_law", or the path of a law.json of `weavecell calibrate` or of a *.csv'


def _ply_contact(value):
    if value in (None, "solid", "pressure_law") or str(value).endswith((".json", ".csv")):
        return value
    raise ValueError("no law")


def _right_angle(text):
    degrees = round(math.degrees(si(text, "rad")), 6)
    if degrees not in (0, 90):
        raise ValueError("no right angle")
    return degrees == 90


def _right_angle_or_value_error(text):
    try:
        return _right_angle(text)
    except InputError as problem:
        raise ValueError(str(problem)) from None


MOST_PLIES = 32


def _tuple(value):
    return tuple(value) if isinstance(value, list) else value


class PlyTable(Table):
    """One ply of a lay-up, or several alike; what it leaves out is that of the table [fabric]."""

    name: Annotated[str | None, Field(description="the name of a fabric of the catalogue")] = None
    file: Annotated[str | None, Field(description="the path of a fabric file (*.toml)")] = None
    law: Annotated[Law | None, Field(description=LAW)] = None
    angle: Annotated[
        bool, BeforeValidator(_right_angle_or_value_error), in_unit("rad", '"0 deg" or "90 deg", of the warp')
    ] = False
    gap: quantity("m", "a length of at least 0", "0.12 mm", at_least=0.0) = None
    count: whole(1, MOST_PLIES) = 1


class PanelTable(Table):
    """A panel in an opening, or a pack of several plies."""

    opening: Annotated[
        float | tuple[float, float],
        BeforeValidator(_opening_or_value_error),
        in_unit("m", 'a length above 0, such as "203 mm", or a list of two, along warp and weft'),
    ]
    opening_shape: one_of("rectangular", "round") = "rectangular"
    impact_point: Annotated[
        quantities("m", "a list of two lengths", '["20 mm", "0 mm"]'), Field(min_length=2, max_length=2)
    ] = (0.0, 0.0)
    boundary: Annotated[Boundary, Field(description=_BOUNDARY)] = "clamped"
    symmetry: one_of("quarter", "half", "whole") = "quarter"
    weave_angle: angle(-89, 89, "45 deg") = 0.0
    plies: whole(1, MOST_PLIES) = 1
    ply: Annotated[tuple[PlyTable, ...], BeforeValidator(_tuple), Field(description="tables [[panel.ply]]")] = ()
    stacking: one_of("aligned", "alternating") = "aligned"
    ply_gap: quantity("m", "a length of at least 0", "0.12 mm", at_least=0.0) = None
    ply_contact: Annotated[str | None, BeforeValidator(_ply_contact), Field(description=_PLY_CONTACT)] = None
    ply_friction: Annotated[float, Field(ge=0.0, le=2.0, description="a number from 0 to 2")] = 0.0
    yarn_failure: Annotated[bool, Field(description="true or false")] = True
    grading: Annotated[
        tuple[tuple[float, float], ...] | None,
        BeforeValidator(zones),
        Field(
            description='zones [until, side] in crossovers, the last until inf, such as [[9, "1/2"], [20, 1], [inf, 2]]'
        ),
    ] = None
    crossovers: one_of("pinned", "sliding") = "pinned"
    crossover_friction: number("a number from 0 to 2", ge=0.0, le=2.0) = None
    crossover_cohesion: quantity("N", "a force of at least 0", "0.1 N", at_least=0.0) = None


_Outer = Literal["fixed", "absorbing", "free"] | None


class BackingTable(Table):
    """A block behind the panel: a material by name or by its data (defaults: thesis Table 6-1), and its mesh."""

    material: Annotated[str | None, Field(description="the name of a backing")] = None
    size: quantities("m", "a list of three lengths", '["300 mm", "300 mm", "180 mm"]') = None
    standoff: quantity("m", "a length of at least 0", "0.5 mm", at_least=0.0) = 0.0
    modulus: quantity("Pa", "a stress above 0", "100 MPa", above=0.0) = None
    density: quantity("kg/m^3", "a density above 0", "3 g/cm^3", above=0.0) = None
    poisson: number("a number from 0 to below 0.5", ge=0.0, lt=0.5) = None
    yield_stress: quantity("Pa", "a stress above 0", "20 MPa", above=0.0) = None
    hardening: quantity("Pa", "a stress of at least 0", "0 Pa", at_least=0.0) = None
    erosion_strain: number("a number above 0", gt=0.0) = None
    rate_exponent: number("a number from 0 to 1", ge=0.0, le=1.0) = None
    reference_rate: quantity("1/s", "a rate above 0", "1 / s", above=0.0) = None
    outer_boundary: Annotated[_Outer, Field(description="fixed, absorbing or free")] = None
    min_size: quantity("m", "a length above 0", "1 mm", above=0.0) = None
    refined_depth: quantity("m", "a length above 0", "8 mm", above=0.0) = None
    growth: number("a number of at least 1", ge=1.0) = None


class RunTable(Table):
    """How long, how fine, and what is written."""

    end_time: quantity("s", "a time above 0 and at most 10 ms", "250 us", above=0.0, at_most=1e-2)
    elements_per_crossover: Annotated[int | None, Field(description="a whole number from 1 to 8", ge=1, le=8)] = None
    snapshot_interval: quantity("s", "a time above 0", "10 us", above=0.0) = 1e-5
    checkpoint_interval: quantity("s", "a time above 0", "50 us", above=0.0) = 5e-5
    outputs: Annotated[
        tuple[Literal["paraview", "pictures", "report"], ...],
        BeforeValidator(lambda value: tuple(value) if isinstance(value, list) else value),
        Field(description='a list of "paraview", "pictures", "report"'),
    ] = ("paraview", "pictures", "report")


_POSITIONS = (5e-3, 20e-3, 50e-3, 80e-3)


class HistoryTable(Table):
    """What is recorded along yarns and at the edges, and reported."""

    interval: quantity("s", "a time above 0", "1 us", above=0.0) = 1e-6
    warp: quantities("m", "a list of distances of warp yarns from the impact point", '["0 mm", "10 mm"]') = (0.0,)
    weft: quantities("m", "a list of distances of weft yarns from the impact point", '["0 mm", "10 mm"]') = (0.0,)
    report_positions: quantities("m", "a list of positions along the yarns", '["5 mm", "50 mm"]') = _POSITIONS


_Share = quantity("", "a share above 0 and at most 50 %", "2 %", above=0.0, at_most=0.5)


class AccuracyTable(Table):
    """What the scene wants to know, and how well; the model is then chosen (`weavecell.analysis.fidelity`)."""

    residual_velocity: _Share = None
    absorbed_energy: _Share = None
    deflection: _Share = None
    peak_tension: _Share = None

    @property
    def targets(self) -> dict[str, float]:
        """{quantity: [-] error at most} of those that are given."""
        return {name: share for name, share in self if share is not None}


class NumericsTable(Table):
    """Numerical parameters of the shell; defaults: `shellfabric.panel.model.Numerics`."""

    cfl: number("a number above 0 and at most 1", gt=0.0, le=1.0) = None
    stretch_viscosity: number("a number from 0 to 1", ge=0.0, le=1.0) = None
    penalty: number("a number above 0", gt=0.0) = None
    contact_damping: number("a number of at least 0", ge=0.0) = None
    contact_points: Annotated[int | None, Field(description="a whole number from 1 to 64", ge=1, le=64)] = None
    precision: Annotated[Literal["double", "single"] | None, Field(description="double or single")] = None
    threads: Annotated[int | None, Field(description="a number of threads", ge=1)] = None


class Scene(Table):
    """One impact on one panel."""

    title: Annotated[str, Field(description="a text")] = ""
    fabric: Annotated[FabricTable, Field(description="a table [fabric]")]
    projectile: Annotated[ProjectileTable, Field(description="a table [projectile]")]
    panel: Annotated[PanelTable, Field(description="a table [panel]")]
    run: Annotated[RunTable, Field(description="a table [run]")]
    history: Annotated[HistoryTable | None, Field(description="a table [history]")] = None
    accuracy: Annotated[AccuracyTable | None, Field(description="a table [accuracy]")] = None
    numerics: Annotated[NumericsTable, Field(description="a table [numerics]")] = NumericsTable()
    backing: Annotated[BackingTable | None, Field(description="a table [backing]")] = None


def load(path: FilePath, support: Any = None) -> tuple[Scene, str]:
    """Read and check a scene file.

    Parameters
    ----------
    path : of the file
    support : the supported.Support of the command that reads it, or a function that gives it from the scene; None
        where any key may be set

    Returns
    -------
    scene : Scene, in SI units, its paths taken from the folder of the file
    text : the file as written, for the record

    Raises
    ------
    InputError : one line naming the file, the key, its value and what is allowed
    """
    path = Path(path)
    text, table = read_toml(path, what="scene")
    return check(table, path, support), text


def check(table: dict[str, Any], file: FilePath | None, support: Any = None) -> Scene:
    """Turn a scene's table into a checked Scene; `file`, where there is one, is named in errors and anchors relative
    paths."""
    table = _with_named_backing(_with_named_projectile(table, file), file)
    scene = _with_counted_plies(validated(Scene, table, file), file)
    _check_relations(scene, table, file)
    if support is not None:
        supported.check(scene, table, file, support(scene) if callable(support) else support)
    return scene if file is None else anchored(scene, Path(file).parent)


def _with_named_projectile(table, file):
    """The table with the data of the projectile that [projectile] names, as if they were written there."""
    given = table.get("projectile")
    if not isinstance(given, dict) or not isinstance(given.get("name"), str):
        return table
    return table | {"projectile": projectiles.table(given["name"], given, file=file, key="projectile.name")}


def _with_named_backing(table, file):
    """The table with the data of the backing that [backing] names, as if they were written there."""
    given = table.get("backing")
    if not isinstance(given, dict) or not isinstance(given.get("material"), str):
        return table
    return table | {"backing": backings.table(given["material"], given, file=file, key="backing.material")}


def _with_counted_plies(scene, file):
    """The scene with the number of plies of its tables [[panel.ply]]."""
    panel = scene.panel
    if not panel.ply:
        return scene
    for key in ("plies", "stacking"):
        if key in panel.model_fields_set:
            value = getattr(panel, key)
            raise InputError(file=file, key=f"panel.{key}", value=value, allowed="left out beside [[panel.ply]]")
    for ply in panel.ply:
        if ply.name is not None and ply.file is not None:
            raise InputError("give one of panel.ply.name and panel.ply.file", file=file, key="panel.ply")
    plies = sum(ply.count for ply in panel.ply)
    if not 2 <= plies <= MOST_PLIES:
        allowed = f"2 to {MOST_PLIES} plies in all; [fabric] alone is one ply"
        raise InputError(file=file, key="panel.ply", value=f"{plies} plies", allowed=allowed)
    return scene.model_copy(update={"panel": panel.model_copy(update={"plies": plies})})


def _check_relations(scene, table, file):
    """What no single field can know; values are shown as they were written."""
    fabric, shot, panel, run = scene.fabric, scene.projectile, scene.panel, scene.run
    exactly_one(fabric, ("name", "file"), "fabric", file)
    if shot.edge_radius is None and shot.shape != "sphere":
        allowed = ProjectileTable.model_fields["edge_radius"].description
        raise InputError("is missing", file=file, key="projectile.edge_radius", allowed=allowed)
    if shot.edge_radius is not None and shot.shape == "sphere":
        value = table["projectile"]["edge_radius"]
        raise InputError(file=file, key="projectile.edge_radius", value=value, allowed="left out for a sphere")
    if scene.accuracy is not None and not scene.accuracy.targets:
        names = ", ".join(AccuracyTable.model_fields)
        raise InputError("has no target", file=file, key="accuracy", allowed=f"at least one of {names}")
    smallest = min(panel.opening) if isinstance(panel.opening, tuple) else panel.opening
    limits = {
        ("projectile", "edge_radius"): (
            shot.edge_radius is None or shot.edge_radius < shot.diameter / 2,
            "below half of projectile.diameter",
        ),
        ("projectile", "diameter"): (shot.diameter < smallest / 2, "below half of panel.opening"),
        ("run", "snapshot_interval"): (run.snapshot_interval <= run.end_time, "at most run.end_time"),
        ("run", "checkpoint_interval"): (run.checkpoint_interval <= run.end_time, "at most run.end_time"),
    }
    for (name, key), (holds, allowed) in limits.items():
        if not holds and key in table[name]:
            raise InputError(file=file, key=f"{name}.{key}", value=table[name][key], allowed=allowed)
    if scene.backing is not None and scene.backing.size is not None and len(scene.backing.size) != 3:
        raise InputError(file=file, key="backing.size", value=table["backing"]["size"], allowed="three lengths")
    if isinstance(panel.boundary, BoundaryTable):
        for name in ("warp", "weft"):
            _check_sides(getattr(panel.boundary, name), f"panel.boundary.{name}", file)


def _check_sides(side, key, file):
    """A side that slips is either a friction clamp or pulled in."""
    for one in side if isinstance(side, tuple) else (side,):
        if not isinstance(one, SlipTable):
            continue
        given = {name for name, value in one if value is not None}
        if given != {"clamp_force"} and given - {"zone"} != {"pull_in", "start", "end"}:
            raise InputError("give clamp_force alone, or pull_in with start and end (and zone)", file=file, key=key)
        if one.clamp_force is None and one.end <= one.start:
            raise InputError("must end after its start", file=file, key=key)
