"""What all scenes are made of: tables of quantities with units as text, the fabric's table, the one line of an error.

Each field carries, as its description, what is allowed in it. For each value that is wrong the user gets one line: the
file, the key, the value as written, and that description.
"""

from __future__ import annotations

import difflib
import math
import os
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar, get_args

from pydantic import BaseModel, BeforeValidator, ConfigDict, Discriminator, Field, Tag, ValidationError

from fabrics.checks import FilePath
from fabrics.errors import InputError, together
from fabrics.units import si
from fabrics.yarn import STATUSES


class Table(BaseModel):
    """A table of a scene: nothing but its own keys, each of its own type."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


Kind = TypeVar("Kind", bound=Table)


def in_unit(unit: str, description: str) -> Any:
    """A Field whose value is in SI `unit`; the unit is for docs/reference/input.md."""
    return Field(description=description, json_schema_extra={"unit": unit or "1"})


def quantity(
    unit: str, what: str, example: str, *, above: float | None = None, at_least: float | None = None,
    at_most: float | None = None,
) -> Any:  # fmt: skip
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

    return Annotated[float, BeforeValidator(convert), in_unit(unit, f'{what}, such as "{example}"')]


def quantities(unit: str, what: str, example: str) -> Any:
    """A tuple of floats in SI `unit`, written as a list of texts."""

    def convert(texts):
        if not isinstance(texts, list):
            raise ValueError("not a list")
        try:
            return tuple(si(text, unit) for text in texts)
        except InputError as problem:
            raise ValueError(str(problem)) from None

    return Annotated[tuple[float, ...], BeforeValidator(convert), in_unit(unit, f"{what}, such as {example}")]


def whole(low: int, high: int) -> Any:
    """A field for a whole number."""
    return Annotated[int, Field(ge=low, le=high, description=f"a whole number from {low} to {high}")]


def one_of(*names: str) -> Any:
    """A field for one of some texts."""
    return Annotated[Literal[names], Field(description="one of " + ", ".join(f'"{name}"' for name in names))]


class InlineLaw(Table):
    """A compression law given by its two parameters (thesis eq. 4-12; erratum E-05 for the regularised form)."""

    a: quantity("m", "a length of at least 0", "0.045 mm", at_least=0.0)
    b: quantity("m N^(1/3)", "a value of at least 0 in mm N^(1/3)", "0.058 mm N^(1/3)", at_least=0.0)
    form: one_of("regularised", "printed") = "regularised"


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
    try:
        toes = [si(part, "") for part in (value if pair else (value,))]
    except InputError as problem:
        raise ValueError(str(problem)) from None
    if len(toes) != 1 + pair or not all(0 <= toe <= 0.1 for toe in toes):
        raise ValueError("out of range")
    return tuple(toes) if pair else toes[0]


_SHARE = Annotated[float, Field(gt=0.0, le=1.0, description="a number above 0, at most 1")]


class WeavingDamageTable(Table):
    """What weaving leaves of modulus and strength of the yarns: `fabrics.yarn.WeavingDamage` (thesis section 5.2.3)."""

    modulus: _SHARE = 1.0
    strength: _SHARE = 1.0
    source: Annotated[str, Field(min_length=1, description="a text: where the shares come from")]
    status: one_of(*STATUSES) = "assumed"


class FabricTable(Table):
    """Which fabric, with which compression law and which model of its cell."""

    name: Annotated[str | None, Field(description="the name of a fabric of the catalogue")] = None
    file: Annotated[str | None, Field(description="the path of a fabric file (*.toml)")] = None
    linear_density: one_of("effective", "nominal") = "effective"
    weaving_damage: Annotated[
        WeavingDamageTable | None, Field(description='a table { modulus = 0.9, strength = 0.8, source = "..." }')
    ] = None
    law: Annotated[Law, Field(description=LAW)] = "published"
    cell_model: one_of("compressible", "incompressible", "decoupled") = "compressible"
    cell_formulation: one_of("variational", "equilibrium", "direct") = "variational"
    cell_profile: one_of("cosine", "straight") = "cosine"
    fibre_slack: Annotated[
        float | tuple[float, float],
        BeforeValidator(_toe),
        in_unit("", 'a strain from 0 to 10 %, such as "0.1 %", or a list of two, of warp and weft'),
    ] = 0.0
    surface: Annotated[str | None, Field(description="the path of a surface written by `weavecell surface`")] = None
    crossover_gap: quantity("m", "a length of at least 0", "0 mm", at_least=0.0) = 0.0
    bending: quantity("N m^2", "a bending stiffness of at least 0", "1e-6 N m^2", at_least=0.0) = 0.0


def angle(low: float, high: float, example: str) -> Any:
    """A field for an angle, low to high [deg], written as text."""
    what = f"an angle from {low} to {high} deg"
    return quantity("rad", what, example, at_least=math.radians(low), at_most=math.radians(high))


def number(what: str, **limits: Any) -> Any:
    """A field for a plain number, or for none."""
    return Annotated[float | None, Field(description=what, **limits)]


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


def anchored(scene: Any, folder: Path) -> Any:
    """The scene with its relative paths taken from the folder of the scene file."""
    updates: dict[str, Any] = {"fabric": _anchored(scene.fabric, folder, ("file", "law", "surface"))}
    panel = getattr(scene, "panel", None)
    if panel is not None:
        plies = tuple(_anchored(ply, folder, ("file", "law")) for ply in panel.ply)
        updates["panel"] = _anchored(panel, folder, ("ply_contact",)).model_copy(update={"ply": plies})
    return scene.model_copy(update=updates)


def _anchored(table, folder, keys):
    """A table whose paths, all texts but the names of laws, are taken from a folder."""
    given = {key: getattr(table, key) for key in keys}
    paths = {key: text for key, text in given.items() if isinstance(text, str) and text not in _NAMED_LAWS}
    return table.model_copy(update={key: os.path.normpath(folder / text) for key, text in paths.items()})


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
            line = InputError(file=file, key=key, value=error["input"], allowed=field.description)
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


def tables_in(kind: Any) -> Iterator[type[Table]]:
    """The tables in a type, through its unions and tuples."""
    if isinstance(kind, type) and issubclass(kind, Table):
        yield kind
    for part in get_args(kind):
        yield from tables_in(part)
