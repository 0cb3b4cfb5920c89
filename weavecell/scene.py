"""Scene files: one impact, told in TOML with units as text, checked before anything is computed or written.

Each field carries, as its description, what is allowed in it. Whatever is wrong with a value, the user is told in one
line: the file, the key, the value as written, and that description.
"""

from __future__ import annotations

import difflib
import math
import os
import tomllib
from pathlib import Path
from typing import Annotated, Literal, get_args

from pydantic import BaseModel, BeforeValidator, ConfigDict, Discriminator, Field, Tag, ValidationError

from fabrics.errors import InputError
from fabrics.units import si


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


def _quantity(unit, what, example, *, above=None, at_least=None, at_most=None):
    """A float in SI `unit`, written as text; `what` says in words which values are allowed."""

    def convert(text):
        try:
            number = si(text, unit)
        except InputError as problem:
            raise ValueError(str(problem)) from None
        low = (above is not None and number <= above) or (at_least is not None and number < at_least)
        if low or (at_most is not None and number > at_most):
            raise ValueError("out of range")
        return number

    return Annotated[float, BeforeValidator(convert), Field(description=f'{what}, such as "{example}"')]


def _quantities(unit, what, example):
    """A tuple of floats in SI `unit`, written as a list of texts."""

    def convert(texts):
        if not isinstance(texts, list):
            raise ValueError("not a list")
        try:
            return tuple(si(text, unit) for text in texts)
        except InputError as problem:
            raise ValueError(str(problem)) from None

    return Annotated[tuple[float, ...], BeforeValidator(convert), Field(description=f"{what}, such as {example}")]


def _whole(low, high):
    return Annotated[int, Field(ge=low, le=high, description=f"a whole number from {low} to {high}")]


def _one_of(*names):
    return Annotated[Literal[names], Field(description="one of " + ", ".join(f'"{name}"' for name in names))]


class InlineLaw(_Table):
    """A compression law given by its two parameters (thesis eq. 4-12; erratum E-05 for the regularised form)."""

    a: _quantity("m", "a length of at least 0", "0.045 mm", at_least=0.0)
    b: _quantity("m N^(1/3)", "a value of at least 0 in mm N^(1/3)", "0.058 mm N^(1/3)", at_least=0.0)
    form: _one_of("regularised", "printed") = "regularised"


_LAW = '"published", the path of a law written by `weavecell calibrate` (*.json), or a table { a = ..., b = ... }'


def _law_kind(value):
    return "inline" if isinstance(value, (dict, InlineLaw)) else "text"


def _law_text(value):
    if isinstance(value, str) and (value == "published" or value.endswith(".json")):
        return value
    raise ValueError("not a law")


Law = Annotated[
    Annotated[str, BeforeValidator(_law_text), Tag("text")] | Annotated[InlineLaw, Tag("inline")],
    Discriminator(_law_kind),
]


class FabricTable(_Table):
    """Which fabric, with which compression law and which model of its cell."""

    name: Annotated[str | None, Field(description="the name of a fabric of the catalogue")] = None
    file: Annotated[str | None, Field(description="the path of a fabric file (*.toml)")] = None
    linear_density: _one_of("effective", "nominal") = "effective"
    law: Annotated[Law, Field(description=_LAW)] = "published"
    cell_model: _one_of("compressible", "incompressible", "decoupled") = "compressible"
    gap: _quantity("m", "a length of at least 0", "0 mm", at_least=0.0) = 0.0


def _angle(low, high, example):
    what = f"an angle from {low} to {high} deg"
    return _quantity("rad", what, example, at_least=math.radians(low), at_most=math.radians(high))


class ProjectileTable(_Table):
    """A rigid projectile of one of five shapes, flying at the panel's centre."""

    mass: _quantity("kg", "a mass above 0", "3 g", above=0.0)
    diameter: _quantity("m", "a length above 0", "5.5 mm", above=0.0)
    edge_radius: _quantity("m", "a length above 0", "0.3 mm", above=0.0) = None
    strike_velocity: _quantity("m/s", "a speed above 0 and at most 1000 m/s", "92.5 m/s", above=0.0, at_most=1000.0)
    shape: _one_of("flat", "hemisphere", "cone", "sphere", "chisel") = "flat"
    length: _quantity("m", "a length above 0", "8 mm", above=0.0) = None
    half_angle: _angle(5, 85, "45 deg") = None
    tip_radius: _quantity("m", "a length above 0", "0.5 mm", above=0.0) = None
    flat_width: _quantity("m", "a length above 0", "2.5 mm", above=0.0) = None
    flat_angle: _angle(5, 85, "35 deg") = None
    obliquity: _angle(0, 75, "30 deg") = 0.0
    azimuth: _angle(-360, 360, "90 deg") = 0.0
    yaw: _angle(-75, 75, "5 deg") = 0.0
    roll: _angle(-360, 360, "45 deg") = 0.0
    friction: Annotated[float, Field(ge=0.0, le=2.0, description="a number from 0 to 2")] = 0.0


class SlipTable(_Table):
    """A side that slips: gripped up to a force per yarn, or led in by a pull-in (thesis section 6.4.3)."""

    grip: _quantity("N", "a force above 0", "20 N", above=0.0) = None
    pull_in: _quantity("m", "a length above 0", "5 mm", above=0.0) = None
    start: _quantity("s", "a time of at least 0", "200 us", at_least=0.0) = None
    end: _quantity("s", "a time above 0", "650 us", above=0.0) = None
    zone: _quantity("m", "a length above 0", "60 mm", above=0.0) = None


_SIDE = (
    '"clamped", "free", { grip = ... }, { pull_in = ..., start = ..., end = ... }, or a list of two such for its ends'
)
_BOUNDARY = '"clamped", "free" or a table { warp = ..., weft = ... } of sides'


def _kind(value):
    return "inline" if isinstance(value, (dict, _Table)) else "pair" if isinstance(value, (list, tuple)) else "text"


_Text = Annotated[Literal["clamped", "free"], Tag("text")]
_One = Annotated[_Text | Annotated[SlipTable, Tag("inline")], Discriminator(_kind)]
_Pair = Annotated[tuple[_One, _One], BeforeValidator(lambda value: tuple(value)), Tag("pair")]
Side = Annotated[_Text | Annotated[SlipTable, Tag("inline")] | _Pair, Discriminator(_kind)]


class BoundaryTable(_Table):
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


class PanelTable(_Table):
    """A panel in a rectangular opening."""

    opening: Annotated[
        float | tuple[float, float],
        BeforeValidator(_opening_or_value_error),
        Field(description='a length above 0, such as "203 mm", or a list of two, along warp and weft'),
    ]
    boundary: Annotated[Boundary, Field(description=_BOUNDARY)] = "clamped"
    symmetry: _one_of("quarter", "half", "whole") = "quarter"
    weave_angle: _angle(-89, 89, "45 deg") = 0.0


class RunTable(_Table):
    """How long, how fine, and what is written."""

    end_time: _quantity("s", "a time above 0 and at most 10 ms", "250 us", above=0.0, at_most=1e-2)
    elements_per_crossover: _whole(1, 8) = 1
    snapshot_interval: _quantity("s", "a time above 0", "10 us", above=0.0) = 1e-5
    checkpoint_interval: _quantity("s", "a time above 0", "50 us", above=0.0) = 5e-5
    outputs: Annotated[
        tuple[Literal["paraview", "pictures", "report"], ...],
        BeforeValidator(lambda value: tuple(value) if isinstance(value, list) else value),
        Field(description='a list of "paraview", "pictures", "report"'),
    ] = ("paraview", "pictures", "report")


class MeasureTable(_Table):
    """What is recorded along yarns and at the edges, and reported."""

    interval: _quantity("s", "a time above 0", "1 us", above=0.0) = 1e-6
    warp: _quantities("m", "a list of distances of warp yarns from the impact point", '["0 mm", "10 mm"]') = (0.0,)
    weft: _quantities("m", "a list of distances of weft yarns from the impact point", '["0 mm", "10 mm"]') = (0.0,)
    places: _quantities("m", "a list of places along the yarns", '["5 mm", "50 mm"]') = (5e-3, 20e-3, 50e-3, 80e-3)


def _number(what, **limits):
    return Annotated[float | None, Field(description=what, **limits)]


class NumericsTable(_Table):
    """Numerical knobs of the shell; what is not given takes the value that `shellfabric.panel.Numerics` explains."""

    safety: _number("a number above 0 and at most 1", gt=0.0, le=1.0) = None
    stretch_viscosity: _number("a number from 0 to 1", ge=0.0, le=1.0) = None
    penalty: _number("a number above 0", gt=0.0) = None
    contact_damping: _number("a number of at least 0", ge=0.0) = None
    threads: Annotated[int | None, Field(description="a number of threads", ge=1)] = None


class Scene(_Table):
    """One impact on one panel."""

    title: Annotated[str, Field(description="a text")] = ""
    fabric: Annotated[FabricTable, Field(description="a table [fabric]")]
    projectile: Annotated[ProjectileTable, Field(description="a table [projectile]")]
    panel: Annotated[PanelTable, Field(description="a table [panel]")]
    run: Annotated[RunTable, Field(description="a table [run]")]
    measure: Annotated[MeasureTable | None, Field(description="a table [measure]")] = None
    numerics: Annotated[NumericsTable, Field(description="a table [numerics]")] = NumericsTable()


def load(path):
    """Read and check a scene file.

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
    return check(table, path), text


def read_toml(path, *, what):
    """Read a TOML file as (text, table); InputError if it is missing, not text or not TOML."""
    path = Path(path)
    try:
        text = path.read_bytes().decode("utf-8")
    except OSError as problem:
        raise InputError(f"the {what} file cannot be read ({problem.strerror})", file=path) from None
    except UnicodeDecodeError:
        raise InputError(f"the {what} file is not UTF-8 text", file=path) from None
    try:
        return text, tomllib.loads(text)
    except tomllib.TOMLDecodeError as problem:
        raise InputError(f"not valid TOML ({problem})", file=path) from None


def check(table, file):
    """Turn a scene's table into a checked Scene; `file` is named in errors and anchors relative paths."""
    try:
        scene = Scene.model_validate(table)
    except ValidationError as problem:
        raise one_line(problem, Scene, file) from None
    _check_relations(scene, table, file)
    return _anchored(scene, Path(file).parent)


def _check_relations(scene, table, file):
    """What no single field can know; values are shown as they were written."""
    fabric, shot, panel, run = scene.fabric, scene.projectile, scene.panel, scene.run
    if (fabric.name is None) == (fabric.file is None):
        raise InputError("give exactly one of fabric.name and fabric.file", file=file, key="fabric")
    if shot.edge_radius is None and shot.shape != "sphere":
        allowed = ProjectileTable.model_fields["edge_radius"].description
        raise InputError("is missing", file=file, key="projectile.edge_radius", allowed=allowed)
    if shot.edge_radius is not None and shot.shape == "sphere":
        value = table["projectile"]["edge_radius"]
        raise InputError(file=file, key="projectile.edge_radius", value=value, allowed="left out for a sphere")
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
    if isinstance(panel.boundary, BoundaryTable):
        for name in ("warp", "weft"):
            _check_sides(getattr(panel.boundary, name), f"panel.boundary.{name}", table, file)


def _check_sides(side, key, table, file):
    """A side that slips is either gripped or led in."""
    for one in side if isinstance(side, tuple) else (side,):
        if not isinstance(one, SlipTable):
            continue
        given = {name for name, value in one if value is not None}
        if given != {"grip"} and given - {"zone"} != {"pull_in", "start", "end"}:
            raise InputError("give either grip alone, or pull_in with start and end (and zone)", file=file, key=key)
        if one.grip is None and one.end <= one.start:
            raise InputError("must end after its start", file=file, key=key)


def _anchored(scene, folder):
    """The scene with its relative paths taken from the folder of the scene file."""
    changes = {}
    if scene.fabric.file is not None:
        changes["file"] = os.path.normpath(folder / scene.fabric.file)
    if isinstance(scene.fabric.law, str) and scene.fabric.law != "published":
        changes["law"] = os.path.normpath(folder / scene.fabric.law)
    return scene.model_copy(update={"fabric": scene.fabric.model_copy(update=changes)})


def one_line(problem, model, file):
    """One error of a pydantic ValidationError as an InputError; the others are counted.

    A key that is not known goes first, since a mistyped name also leaves the right one missing.
    """
    errors = sorted(problem.errors(include_url=False), key=lambda error: error["type"] != "extra_forbidden")
    first = errors[0]
    names, field, table = _locate(model, first["loc"])
    more = f" (+{len(errors) - 1} more)" if len(errors) > 1 else ""
    key = ".".join(names)
    if first["type"] == "missing":
        return InputError("is missing", file=file, key=key, allowed=field.description + more)
    if first["type"] == "extra_forbidden":
        near = difflib.get_close_matches(names[-1], table.model_fields, n=1, cutoff=0.75)
        hint = f', did you mean "{near[0]}"?' if near else ";"
        known = ", ".join(table.model_fields)
        return InputError(f"unknown key{hint} allowed here: {known}{more}", file=file, key=key)
    return InputError(file=file, key=key, value=first["input"], allowed=field.description + more)


def _locate(model, location):
    """Follow an error's location to (the key's names, the field it belongs to, the table that holds it)."""
    names, field, table = [], None, model
    for step in location:
        inner = _inner(field) if field is not None else model
        if isinstance(step, int) or step in ("text", "inline", "pair"):  # list index, tag of a union
            continue
        if inner is None:
            break
        table = inner
        names.append(step)
        field = table.model_fields.get(step)
        if field is None:
            break
    return names, field, table


def _inner(field):
    """The table that a field holds, if it holds one."""
    for kind in (field.annotation, *get_args(field.annotation)):
        if isinstance(kind, type) and issubclass(kind, _Table):
            return kind
    return {_LAW: InlineLaw, _SIDE: SlipTable, _BOUNDARY: BoundaryTable}.get(field.description)
