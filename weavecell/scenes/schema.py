"""What all scenes are made of: tables of quantities with units as text, the fabric's table, the one line of an error.

A field of a table is all that is said of its key: type, unit, limits, default, what it means (`title`) and what is
allowed (`description`). For each value that is wrong the user gets one line: the file, the key, the value as written,
and what is allowed. The docstring of a table is a sentence about it and, after an empty line, an example. The page of
keys, the JSON Schemas and what Python takes are made from them.
"""

from __future__ import annotations

import difflib
import json
import math
import os
import tomllib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar, get_args

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    ValidationError,
    WithJsonSchema,
)

from fabrics.checks import FilePath
from fabrics.errors import InputError, together
from fabrics.units import refused, si
from fabrics.yarn import STATUSES


class Table(BaseModel):
    """A table of a scene: nothing but its own keys, each of its own type."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


Kind = TypeVar("Kind", bound=Table)


def described(meaning: str, allowed: str, unit: str | None = None, example: Any = None, **limits: Any) -> Any:
    """A Field whose `title` is what the key means, its `description` what is allowed, its extra "unit" the SI unit.

    `unit` is None of what is no quantity; `example` is as it stands in a file.
    """
    extra: Any = None if unit is None else {"unit": unit or "1"}
    examples = None if example is None else [example]
    return Field(title=meaning, description=allowed, examples=examples, json_schema_extra=extra, **limits)


TEXT = {"type": "string"}
TEXT_OR_TWO = {"anyOf": [TEXT, {"type": "array", "prefixItems": [TEXT, TEXT], "minItems": 2, "maxItems": 2}]}


def from_text(
    kind: Any, convert: Callable[[Any], Any], meaning: str, allowed: str, unit: str, example: Any = None,
    written: dict[str, Any] = TEXT,
) -> Any:  # fmt: skip
    """A `kind` in SI `unit` that `convert` makes of what stands in a file, of which `written` is the JSON Schema."""

    def value_error(text):
        try:
            return convert(text)
        except InputError as problem:
            raise ValueError(str(problem)) from None

    field = described(meaning, allowed, unit, example)
    return Annotated[kind, BeforeValidator(value_error), WithJsonSchema(written), field]


_KINDS = {
    "": "a strain", "kg": "a mass", "m": "a length", "s": "a time", "m/s": "a speed", "N": "a force", "Pa": "a stress",
    "1/s": "a rate", "kg/m^3": "a density", "N m^2": "a bending stiffness",
}  # fmt: skip


def quantity(
    meaning: str, unit: str, example: str, *, zero: bool = False, most: str | None = None, kind: str | None = None
) -> Any:
    """A float in SI `unit`, written as text: above 0, or of at least 0 where `zero`, and at most `most`.

    `kind` is what it is, in words with {} for these limits; None takes what its unit says.
    """
    highest = math.inf if most is None else si(most, unit)

    def convert(text):
        value = si(text, unit)
        if not (value >= 0 if zero else value > 0) or value > highest:
            raise ValueError("out of range")
        return value

    bounds = ("of at least 0" if zero else "above 0") + (f" and at most {most}" if most else "")
    words = (kind or f"{_KINDS[unit]} {{}}").format(bounds)
    return from_text(float, convert, meaning, f'{words}, such as "{example}"', unit, example)


def angle(meaning: str, low: float, high: float, example: str) -> Any:
    """An angle [rad], written as text, from `low` to `high` [deg]."""

    def convert(text):
        value = si(text, "rad")
        if not math.radians(low) <= value <= math.radians(high):
            raise ValueError("out of range")
        return value

    allowed = f'an angle from {low} to {high} deg, such as "{example}"'
    return from_text(float, convert, meaning, allowed, "rad", example)


def quantities(meaning: str, unit: str, what: str, example: str) -> Any:
    """A tuple of floats in SI `unit`, written as a list of texts."""

    def convert(texts):
        if not isinstance(texts, list):
            raise ValueError("not a list")
        return tuple(si(text, unit) for text in texts)

    written = {"type": "array", "items": TEXT}
    allowed = f"{what}, such as {example}"
    return from_text(tuple[float, ...], convert, meaning, allowed, unit, json.loads(example), written)


def number(meaning: str, example: float, **limits: Any) -> Any:
    """A plain number within pydantic's limits gt, ge, lt, le."""
    match limits:
        case {"gt": low, "le": high}:
            bounds = f"above {low:g} and at most {high:g}"
        case {"gt": low}:
            bounds = f"above {low:g}"
        case {"ge": low, "le": high}:
            bounds = f"from {low:g} to {high:g}"
        case {"ge": low, "lt": high}:
            bounds = f"from {low:g} to below {high:g}"
        case _:
            bounds = f"of at least {limits['ge']:g}"
    return Annotated[float, described(meaning, f"a number {bounds}", example=example, **limits)]


def whole(meaning: str, low: int, high: int, example: int = 2) -> Any:
    """A whole number from `low` to `high`."""
    return Annotated[int, described(meaning, f"a whole number from {low} to {high}", example=example, ge=low, le=high)]


def one_of(meaning: str, *names: str) -> Any:
    """One of some texts."""
    return Annotated[Literal[names], described(meaning, f"one of {_quoted(names)}", example=names[-1])]


def some_of(meaning: str, *names: str) -> Any:
    """Any of some texts, written as a list."""
    field = described(meaning, f"a list of {_quoted(names)}")
    return Annotated[tuple[Literal[names], ...], BeforeValidator(as_tuple), field]


def string(meaning: str, allowed: str) -> Any:
    """A text."""
    return Annotated[str, described(meaning, allowed)]


def flag(meaning: str) -> Any:
    """True or false."""
    return Annotated[bool, described(meaning, "true or false")]


def as_tuple(value: Any) -> Any:
    """A list as a tuple, all else as it is."""
    return tuple(value) if isinstance(value, list) else value


def _quoted(names):
    return ", ".join(f'"{name}"' for name in names)


class InlineLaw(Table):
    """Compression law given by its two coefficients, in place of `law = ...`, for both families.

    [fabric.law]
    a = "0.045 mm"
    b = "0.058 mm N^(1/3)"
    """

    a: quantity("thickness reduction of a yarn at large contact force, thesis eq. 4-12", "m", "0.045 mm", zero=True)
    b: quantity(
        "coefficient of the cube root of the contact force, thesis eq. 4-12",
        "m N^(1/3)", "0.058 mm N^(1/3)", zero=True, kind="a value {} in mm N^(1/3)",
    )  # fmt: skip
    form: one_of(
        "behaviour at zero contact force: `regularised` (finite stiffness, erratum E-05) or as `printed` in the "
        "thesis", "regularised", "printed",
    ) = "regularised"  # fmt: skip


_NAMED_LAWS = "published", "solid", "pressure_law"
LAW = '"published", the path of a law written by `weavecell calibrate` (*.json), or a table { a = ..., b = ... }'


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


def _toe(value):
    pair = isinstance(value, (list, tuple))
    toes = [si(part, "") for part in (value if pair else (value,))]
    if len(toes) != 1 + pair or not all(0 <= toe <= 0.1 for toe in toes):
        raise ValueError("out of range")
    return tuple(toes) if pair else toes[0]


class WeavingDamageTable(Table):
    """Modulus and strength of the woven yarn over those of the virgin yarn (thesis section 5.2.3), where yarns drawn
    from the fabric were tested.

    [fabric.weaving_damage]
    modulus = 0.95
    strength = 0.9
    source = "yarns drawn from the fabric, 20 tests"
    status = "measured"
    """

    modulus: number("modulus of the woven yarn over that of the virgin yarn", 0.9, gt=0.0, le=1.0) = 1.0
    strength: number("strength of the woven yarn over that of the virgin yarn", 0.8, gt=0.0, le=1.0) = 1.0
    source: Annotated[str, described(
        "origin of the two ratios, kept in the results", "a text: where the shares come from", min_length=1,
    )]  # fmt: skip
    status: one_of("whether the ratios are measured or assumed, kept in the results", *STATUSES) = "assumed"


class FabricTable(Table):
    """The fabric of all plies that name no other, its compression law and the model of its unit cell. The first two
    lines are all that most input files need.

    [fabric]
    name = "S-728"
    law = "published"
    """

    name: string(
        "fabric of the catalogue (`weavecell fabrics list`); either this or `fabric.file`",
        "the name of a fabric of the catalogue",
    ) = None  # fmt: skip
    file: string("fabric file of the user; either this or `fabric.name`", "the path of a fabric file (*.toml)") = None
    linear_density: one_of(
        "the linear density that is used where a fabric file has two: `effective`, from the areal density of the runs "
        "of the thesis (erratum E-07), or `nominal`, of the data sheet", "effective", "nominal",
    ) = "effective"  # fmt: skip
    weaving_damage: Annotated[
        WeavingDamageTable | None, Field(description='a table { modulus = 0.9, strength = 0.8, source = "..." }')
    ] = None
    law: Annotated[Law, described(
        "compression law of warp and weft; needed for a fabric without a published one, such as your own", LAW,
    )] = "published"  # fmt: skip
    cell_model: one_of(
        "unit cell: yarns that compress, incompressible yarns, or warp and weft without interaction",
        "compressible", "incompressible", "decoupled",
    ) = "compressible"  # fmt: skip
    cell_formulation: one_of(
        "how forces follow from the state of the cell: gradient of the stored energy (`variational`), force "
        "equilibrium as in the thesis (`equilibrium`), or interpolated tensions of a response surface (`direct`)",
        "variational", "equilibrium", "direct",
    ) = "variational"  # fmt: skip
    cell_profile: one_of("centre line of a crimped yarn in the cell", "cosine", "straight") = "cosine"
    fibre_slack: from_text(
        float | tuple[float, float], _toe,
        "mean slack of the fibres of a yarn, which become taut one after another (toe of the tensile curve)",
        'a strain from 0 to 10 %, such as "0.1 %", or a list of two, of warp and weft', "", "0.1 %", TEXT_OR_TWO,
    ) = 0.0  # fmt: skip
    surface: string(
        "response surface of the 3D crossover, which replaces the analytical cell and `fabric.law`",
        "the path of a surface written by `weavecell surface`",
    ) = None  # fmt: skip
    crossover_gap: quantity("play between warp and weft at a crossover before they touch", "m", "0 mm", zero=True) = 0.0
    bending: quantity("bending stiffness of one yarn", "N m^2", "1e-6 N m^2", zero=True) = 0.0


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
    if int(under) == 0:
        raise ValueError("divided by 0")
    return int(over) / int(under)


def read_toml(path: FilePath, *, what: str) -> tuple[str, dict[str, Any]]:
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


def validated(model: type[Kind], table: dict[str, Any], file: FilePath | None) -> Kind:
    """The table of a file as a `model`; InputError, a line for each thing that is wrong with it."""
    try:
        return model.model_validate(table)
    except ValidationError as problem:
        raise together(_problems(problem, model, file)) from None


def exactly_one(table: BaseModel, names: Sequence[str], key: str, file: FilePath) -> None:
    """Check that one of the entries `names` of a table is given and no other."""
    if sum(getattr(table, name) is not None for name in names) != 1:
        paths = [f"{key}.{name}" if key else name for name in names]
        raise InputError(f"give exactly one of {', '.join(paths[:-1])} and {paths[-1]}", file=file, key=key or None)


def anchored(scene: Any, file: FilePath) -> Any:
    """The scene with its relative paths taken from the folder of the scene file.

    Raises
    ------
    InputError : a path that is not that of a file
    """

    def of(name, table, keys):
        """The table [name] whose paths, all texts but the names of laws, are taken from that folder."""
        given = {key: getattr(table, key) for key in keys}
        texts = {key: text for key, text in given.items() if isinstance(text, str) and text not in _NAMED_LAWS}
        paths = {key: os.path.normpath(Path(file).parent / text) for key, text in texts.items()}
        for key, path in paths.items():
            if not os.path.isfile(path):
                allowed = type(table).model_fields[key].description
                raise InputError(
                    f"there is no file {path}", file=file, key=f"{name}.{key}", value=texts[key], allowed=allowed
                )
        return table.model_copy(update=paths)

    updates: dict[str, Any] = {"fabric": of("fabric", scene.fabric, ("file", "law", "surface"))}
    shot, panel = getattr(scene, "projectile", None), getattr(scene, "panel", None)
    if shot is not None:
        updates["projectile"] = of("projectile", shot, ("stl",))
    if panel is not None:
        plies = tuple(of("panel.ply", ply, ("file", "law")) for ply in panel.ply)
        updates["panel"] = of("panel", panel, ("ply_contact",)).model_copy(update={"ply": plies})
    return scene.model_copy(update=updates)


def _problems(found, model, file):
    """An InputError for each key of a pydantic ValidationError; unknown keys go first.

    A mistyped key leaves the right one missing, which is not reported again.
    """
    problems: dict[str, InputError] = {}
    meant = set()
    for error in sorted(found.errors(include_url=False), key=lambda error: error["type"] != "extra_forbidden"):
        names, field, table = _locate(model, error["loc"])
        key = ".".join(names)
        if error["type"] == "extra_forbidden":
            near = difflib.get_close_matches(names[-1], table.model_fields, n=1, cutoff=0.75)
            meant |= {".".join((*names[:-1], *near))} if near else set()
            hint = f', did you mean "{near[0]}"?' if near else ";"
            line = InputError(f"unknown key{hint} allowed here: {', '.join(table.model_fields)}", file=file, key=key)
        elif error["type"] == "missing" and key in meant:
            continue
        elif error["type"] == "missing":
            line = InputError("is missing", file=file, key=key, allowed=field.description)
        else:
            line = refused(error["input"], field.description, file=file, key=key)
        problems.setdefault(key, line)
    return list(problems.values())


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
    return next(tables_in(field.annotation), None)


def unit_of(entry: Any) -> str | None:
    """SI unit of a field, "1" of a ratio; None of one that is no quantity, or of no field."""
    return (getattr(entry, "json_schema_extra", None) or {}).get("unit")


def tables_in(kind: Any) -> Iterator[type[Table]]:
    """The tables in a type, through its unions and tuples."""
    if isinstance(kind, type) and issubclass(kind, Table):
        yield kind
    for part in get_args(kind):
        yield from tables_in(part)
