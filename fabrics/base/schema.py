"""Tables of input and data files by pydantic: quantities with units as text, and the one line of each
error: file, key, value as written, what is allowed.

A field of a table says all of its key: type, unit, limits, default, meaning (`title`) and what is
allowed (`description`); marks beside its type, `Annotated[string(...), FileOnly()]`, say how Python
gives it and which models and functions read it. What keys mean to each other is said by validators
of their table. A table's docstring is a sentence and, after an empty line, an example. The page of
keys, the JSON Schemas and what Python takes are made from them.

With `PYTHON` as the context plain numbers are quantities in SI units, and objects may stand where a
file names one.
"""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from itertools import accumulate
from typing import Annotated, Any, ClassVar, Literal, TypeVar, get_args, get_type_hints

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    WithJsonSchema,
    WrapValidator,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic_core import InitErrorDetails

from fabrics.base import range_texts
from fabrics.base import written as written_texts
from fabrics.base.assumed_number import Assumed
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError, nearest, share_word, together
from fabrics.base.files import control_character, parse_toml, read_text
from fabrics.base.units import refused, si
from fabrics.base.values import is_same

# context of values given in Python, which are not read from a file
PYTHON = {"python": True}


class Table(BaseModel):
    """A table of a file: nothing but its own keys, each of its own type."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    # what users call a key: {their word: the key}
    synonyms: ClassVar[Mapping[str, str]] = {}

    @classmethod
    def __pydantic_init_subclass__(cls, **options: Any) -> None:
        """Put keys that a dataclass declares (`key`) behind the table's own; pydantic begins with what
        is inherited."""
        late: set[str] = set()
        for base in cls.__mro__:
            late |= vars(base).get("__dataclass_fields__", {}).keys()
        found = cls.__pydantic_fields__
        cls.__pydantic_fields__ = dict(sorted(found.items(), key=lambda item: item[0] in late))

    def sets(self, key: str) -> bool:
        """Tell whether a key is set to something other than its default."""
        return getattr(self, key) != type(self).model_fields[key].get_default(
            call_default_factory=True
        )

    def refuse(self, keys: str, allowed: str) -> None:
        """Raise an InputError for the first of some keys, in one text, that is set to something
        other than its default."""
        for key in keys.split():
            if self.sets(key):
                raise InputError(key=key, allowed=allowed)

    @classmethod
    def required_by(cls, given: Mapping[str, Any]) -> tuple[str, ...]:
        """Return the keys that the given ones make required, such as what a shape needs."""
        return ()

    @model_validator(mode="wrap")
    @classmethod
    def _require(cls, given, handler):
        """Name keys that others make required beside all else that is wrong, not in a second round."""
        missing: list[InitErrorDetails] = []
        if isinstance(given, Mapping):
            for key in cls.required_by(given):
                if given.get(key) is None:
                    missing.append({"type": "missing", "loc": (key,), "input": given})
        try:
            made = handler(given)
        except ValidationError as problem:
            if not missing:
                raise
            found = [_again(error) for error in problem.errors(include_url=False)]
            raise ValidationError.from_exception_data(cls.__name__, [*found, *missing]) from None
        if missing:
            raise ValidationError.from_exception_data(cls.__name__, missing)
        return made

    @classmethod
    def unknown(cls, key: str, near: str | None) -> tuple[str | None, str | None]:
        """Return (message, what is allowed) for a key that the table has not, and that may be meant
        for one `near` it.

        Without a message the line has the value of the key.
        """
        hint = ";"
        if near:
            hint = f', did you mean "{near}"?'
        return f"unknown key{hint} allowed here: {', '.join(cls.model_fields)}", None


def _again(error):
    """An error of pydantic, as a new ValidationError takes it."""
    kept = ("type", "loc", "input", "ctx")
    return {name: error[name] for name in kept if name in error}


Kind = TypeVar("Kind", bound=Table)
Mark = TypeVar("Mark")


@dataclass(frozen=True)
class AsKeywords:
    """Mark a table whose keys are keywords of their own in Python."""


@dataclass(frozen=True)
class AsDict:
    """Mark a table that Python gives as a dict.

    Parameters
    ----------
    named_by : key whose value a text in place of the dict is, or None if there is no such key
    """

    named_by: str | None = None


@dataclass(frozen=True)
class FileOnly:
    """Mark a key of the input file that Python has not among its keywords."""


@dataclass(frozen=True)
class MayBeObject:
    """Mark a key whose value may be an object in Python, which no file can hold."""


@dataclass(frozen=True)
class StandardShot:
    """Mark a key that files have to give, with its value where a fabric is named alone.

    Parameters
    ----------
    value : as it stands in a file
    """

    value: str


@dataclass(frozen=True)
class ReadBy:
    """Mark a number with the models that read it; others refuse it (`refuse_unread`).

    Parameters
    ----------
    models : their names, between blanks
    """

    models: str


@dataclass(frozen=True)
class Unread:
    """Mark a key or a table with functions that do not read it (`refuse_passed_over`); all others do.

    Parameters
    ----------
    by : their names, between blanks
    allowed : completes "must be ..." of a key that is refused; "" of one that means nothing to them by
        their definition, such as the strike velocity to a search for the limit
    """

    by: str
    allowed: str = ""


@dataclass(frozen=True)
class MayHaveRange:
    """Mark a number that may be given with a range (`fabrics.base.range_texts`): it is then an `Assumed`,
    from which shots are drawn."""


@dataclass(frozen=True)
class NoPlace:
    """Mark a key or a table that a function reads and has no place for in what it writes: it says so
    (`without_place`), and writes the rest.

    Parameters
    ----------
    by : names of functions, between blanks
    follows : what follows from that, in words; "" if the key itself says it
    """

    by: str
    follows: str = ""


def mark(entry: FieldInfo, kind: type[Mark]) -> Mark | None:
    """Return the mark of a kind that a field has, or None."""
    for part in entry.metadata:
        if isinstance(part, kind):
            return part
    return None


def marked(table: type[Table], kind: type[Mark]) -> dict[str, Mark]:
    """Return {key: its mark} of the keys of a table that have a mark of a kind."""
    found = {}
    for key, entry in table.model_fields.items():
        own = mark(entry, kind)
        if own is not None:
            found[key] = own
    return found


def key(kind: Any, read_by: str) -> FieldInfo:
    """Declare a number of a dataclass, `name: Annotated[float, key(number(...), "models")] = 0.0`: all
    that is said of it is said there, and a Table that inherits from the dataclass has it as a key.

    Parameters
    ----------
    kind : what the field of a Table would be annotated with
    read_by : models that read it, see `ReadBy`
    """
    field = FieldInfo.from_annotation(kind)
    field.metadata.append(ReadBy(read_by))
    return field


@cache
def declared(kind: type) -> dict[str, FieldInfo]:
    """Return {name: field} of the numbers that a dataclass declares (`key`)."""
    hints = get_type_hints(kind, include_extras=True)
    names = [entry.name for entry in dataclasses.fields(kind)]
    return {name: FieldInfo.from_annotation(hints[name]) for name in names}


def list_unread(kind: type, values: Any, model: str) -> Iterator[tuple[str, str]]:
    """List the numbers that a dataclass `kind` declares, that `values` sets to something other than
    their default, and that a model does not read: (name, models that do)."""
    usual = kind()
    for name, field in declared(kind).items():
        read = mark(field, ReadBy)
        differs = getattr(values, name) != getattr(usual, name)
        if read and differs and model not in read.models.split():
            yield name, read.models


def list_read(kind: type, model: str) -> list[str]:
    """List the numbers that a dataclass `kind` declares and that a model reads."""
    marks = {name: mark(field, ReadBy) for name, field in declared(kind).items()}
    return [name for name, read in marks.items() if read and model in read.models.split()]


def refuse_unread(kind: type, values: Any, model: str, words: str) -> None:
    """Raise an InputError for the first number that a dataclass `kind` declares, that `values` sets
    to something other than its default, and that a model does not read.

    Parameters
    ----------
    words : the model in words, for the message
    """
    for name, _ in list_unread(kind, values, model):
        raise InputError(key=name, value=getattr(values, name), allowed=f"left out with {words}")


def described(
    meaning: str, allowed: str, unit: str | None = None, example: Any = None, **limits: Any
) -> Any:
    """Return a Field whose `title` is what the key means, its `description` what is allowed, its
    extra "unit" the SI unit.

    `unit` is None if it is not a quantity; `example` is as it stands in a file.
    """
    extra: Any = None if unit is None else {"unit": unit or "1"}
    examples = None
    if example is not None:
        examples = [example]
    return Field(
        title=meaning, description=allowed, examples=examples, json_schema_extra=extra, **limits
    )


TEXT = {"type": "string"}
TEXT_OR_TWO = {
    "anyOf": [TEXT, {"type": "array", "prefixItems": [TEXT, TEXT], "minItems": 2, "maxItems": 2}]
}


def from_text(
    kind: Any,
    convert: Callable[[Any, Callable[[Any, str], float]], Any],
    meaning: str,
    allowed: str,
    unit: str,
    example: Any = None,
    written: dict[str, Any] = TEXT,
) -> Any:
    """Declare a `kind` in SI `unit` that convert(value, read) makes of what stands in a file, by
    read(text, unit) of its parts; `written` is the JSON Schema of what stands there."""

    def validate(value, info):
        try:
            return convert(value, reader(info))
        # a whole number of hundreds of digits is no float
        except (InputError, OverflowError):
            # the type does not know the limits that its key adds
            raise ValueError("not allowed") from None

    field = described(meaning, allowed, unit, example)
    return Annotated[kind, BeforeValidator(validate), WithJsonSchema(written), field]


def in_python(info: ValidationInfo) -> bool:
    """Tell whether a value that is validated was given in Python, and not read from a file."""
    return bool(info.context and info.context.get("python"))


def reader(info: ValidationInfo) -> Callable[[Any, str], float]:
    """Return the function that converts a text to a float in a SI unit; what is given in Python may
    be a plain number too."""

    def read(value, unit):
        number = (
            isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
        )
        if number and in_python(info):
            return float(value)
        return si(value, unit)

    return read


_KINDS = {
    "": "a strain",
    "kg": "a mass",
    "m": "a length",
    "s": "a time",
    "m/s": "a speed",
    "N": "a force",
    "Pa": "a stress",
    "1/s": "a rate",
    "kg/m^3": "a density",
    "N m^2": "a bending stiffness",
}


def quantity(
    meaning: str,
    unit: str,
    example: str,
    *,
    zero: bool = False,
    most: str | None = None,
    kind: str | None = None,
    ranged: bool = False,
) -> Any:
    """Declare a float in SI `unit`, written as text: above 0, or of at least 0 with `zero`, and at
    most `most`.

    `kind` is what it is, in words with {} for these limits; None takes what its unit says. `ranged` is
    as of `number`.
    """
    if most is None:
        highest = math.inf
    else:
        highest = si(most, unit)

    def convert(text, read):
        value = read(text, unit)
        if not (value >= 0 if zero else value > 0) or value > highest:
            raise ValueError("out of range")
        return value

    bounds = ("of at least 0" if zero else "above 0") + (f" and at most {most}" if most else "")
    words = (kind or f"{_KINDS.get(unit, f'a value in {unit}')} {{}}").format(bounds)
    allowed = f'{words}, such as "{example}"'
    if not ranged:
        return from_text(float, convert, meaning, allowed, unit, example)
    allowed += f', or a range such as "{example} ± 5 %"'
    return _with_range(from_text(float, convert, meaning, allowed, unit, example), str, TEXT)


def angle(meaning: str, low: float, high: float, example: str) -> Any:
    """Declare an angle [rad], written as text, from `low` to `high` [deg]."""

    def convert(text, read):
        value = read(text, "rad")
        if not math.radians(low) <= value <= math.radians(high):
            raise ValueError("out of range")
        return value

    allowed = f'an angle from {low} to {high} deg, such as "{example}"'
    return from_text(float, convert, meaning, allowed, "rad", example)


def quantities(meaning: str, unit: str, what: str, example: str) -> Any:
    """Declare a tuple of floats in SI `unit`, written as a list of texts."""

    def convert(texts, read):
        if not isinstance(texts, (list, tuple)):
            raise ValueError("not a list")
        return tuple(read(text, unit) for text in texts)

    written = {"type": "array", "items": TEXT}
    allowed = f"{what}, such as {example}"
    return from_text(
        tuple[float, ...], convert, meaning, allowed, unit, json.loads(example), written
    )


def number(meaning: str, example: float, *, ranged: bool = False, **limits: Any) -> Any:
    """Declare a plain number within pydantic's limits gt, ge, lt, le; finite, unless allow_inf_nan; one
    that is `ranged` may be given with a range."""
    limits.setdefault("allow_inf_nan", False)
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
    allowed = f"a number {bounds}"
    if not ranged:
        return Annotated[float, described(meaning, allowed, example=example, **limits)]
    allowed += f", or a range such as {range_texts.EXAMPLE}"
    kind = Annotated[float, described(meaning, allowed, example=example, **limits)]
    return _with_range(kind, float, {"anyOf": [{"type": "number", **_json_limits(limits)}, TEXT]})


def _json_limits(limits):
    """Return the limits of pydantic by their names in a JSON Schema."""
    names = {"gt": "exclusiveMinimum", "ge": "minimum", "lt": "exclusiveMaximum", "le": "maximum"}
    return {names[name]: value for name, value in limits.items() if name in names}


def _with_range(kind, part, written):
    """Return the kind of a number that may be given with a range, whose value and ends its own
    validator takes as part(text)."""

    def validate(value: Any, handler: ValidatorFunctionWrapHandler) -> Any:
        if isinstance(value, Assumed):
            ends, deviations = value.parts[:3], value.deviation and range_texts.CUT_OFF
        elif (found := range_texts.read(value)) is None:
            return handler(value)
        else:
            # of a number a text with a unit is no float
            ends, deviations = tuple(map(part, found.texts.values())), found.deviations
        middle = handler(ends[0])
        try:
            low, high = map(handler, ends[1:])
        except ValidationError:
            reach = (
                "a value ± a standard deviation, of which twice" if deviations else "a range that"
            )
            raise InputError(value=value, allowed=f"{reach} stays within what is allowed") from None
        deviation = (high - middle) / deviations if deviations else 0.0
        return Assumed(middle, low, high, deviation, given=True)

    return Annotated[kind, WrapValidator(validate), WithJsonSchema(written), MayHaveRange()]


def whole(meaning: str, low: int, high: int, example: int = 2) -> Any:
    """Declare a whole number from `low` to `high`."""
    return Annotated[
        int,
        described(
            meaning, f"a whole number from {low} to {high}", example=example, ge=low, le=high
        ),
    ]


def one_of(meaning: str, *names: str) -> Any:
    """Declare a choice of one of some texts."""
    return Annotated[
        Literal[names], described(meaning, f"one of {_quoted(names)}", example=names[-1])
    ]


def named(meaning: str, *names: str, kind: type | None = None) -> Any:
    """Declare a choice of one of some texts, for a field of a dataclass that holds objects too.

    Parameters
    ----------
    kind : of the objects that the Python interface may give in place of a text
    """

    def validate(value, info):
        if isinstance(value, str) and value in names:
            return value
        if info.context and kind is not None and isinstance(value, kind):
            return value
        raise ValueError("not allowed")

    field = described(meaning, f"one of {_quoted(names)}", example=names[-1])
    written = {"type": "string", "enum": list(names)}
    return Annotated[Any, BeforeValidator(validate), WithJsonSchema(written), field]


def some_of(meaning: str, *names: str) -> Any:
    """Declare a choice of any of some texts, written as a list."""
    field = described(meaning, f"a list of {_quoted(names)}")
    return Annotated[tuple[Literal[names], ...], BeforeValidator(as_tuple), field]


def string(meaning: str, allowed: str) -> Any:
    """Declare a text."""
    return Annotated[str, described(meaning, allowed)]


def flag(meaning: str) -> Any:
    """Declare a flag, true or false."""
    return Annotated[bool, described(meaning, "true or false")]


def as_tuple(value: Any) -> Any:
    """Convert a list to a tuple, and return all else as it is."""
    if isinstance(value, list):
        return tuple(value)
    return value


def _quoted(names):
    return ", ".join(f'"{name}"' for name in names)


def read_toml(path: FilePath, *, what: str) -> tuple[str, dict[str, Any]]:
    """Read a TOML file as (text, table); InputError if it is missing, not text or not TOML."""
    text = read_source(path, what=what)
    return text, parse_source(text, path)


def read_source(path: FilePath, *, what: str) -> str:
    """Read the text of an input file; InputError if it is missing or not text."""
    try:
        return read_text(path)
    except OSError as problem:
        raise InputError(
            f"the {what} file cannot be read ({problem.strerror})", file=path
        ) from None


def parse_source(text: str, path: FilePath) -> dict[str, Any]:
    """Return the table of the text of a file; InputError if it is not TOML, or empty."""
    try:
        table = parse_toml(text)
    except ValueError as problem:
        raise InputError(f"not valid TOML ({problem})", file=path) from None
    if not table:
        raise InputError("is empty", file=path)
    for key, value in _texts(table):
        if (control := control_character(value)) is not None:
            raise InputError(f"has the control character {control}", file=path, key=key)
    written_texts.keep(path, text, table)
    return table


def _texts(table):
    """(key, text) of all texts in a table, those that are keys with the table's own."""
    waiting: list[tuple[str, Any]] = [("", table)]
    while waiting:
        name, value = waiting.pop()
        if isinstance(value, str):
            yield name, value
        elif isinstance(value, list):
            waiting += [(name, part) for part in value]
        elif isinstance(value, dict):
            for key, part in value.items():
                yield name, key
                waiting.append((f"{name}.{key}".lstrip("."), part))


def validated(model: type[Kind], table: Any, file: FilePath | None, context: Any = None) -> Kind:
    """Validate the table of a file as a `model`; an InputError has a line for each thing that is
    wrong with it.

    Parameters
    ----------
    context : of pydantic, `PYTHON` or None
    """
    try:
        return model.model_validate(table, context=context)
    except ValidationError as problem:
        raise together(_problems(problem, model, table, file, bool(context))) from None


def _problems(problem, model, given, file, in_python):
    """An InputError for each key of a pydantic ValidationError; unknown keys go first.

    A mistyped key leaves the right one missing, which is not reported again. What a validator
    raises as an InputError names a key of its table, or none, and says itself what is allowed.
    """
    problems: dict[str, InputError] = {}
    meant = set()

    for error in sorted(
        problem.errors(include_url=False), key=lambda error: error["type"] != "extra_forbidden"
    ):
        names, field, table = _locate(model, error["loc"])
        key = ".".join(names)
        cause = error.get("ctx", {}).get("error")
        if error["type"] == "extra_forbidden":
            near = _meant(names[-1], error["input"], table)
            homes = _homes(model, names[-1])
            # what a word means in its own table goes before tables that have it as a key
            if names[-1] in table.synonyms:
                near = table.synonyms[names[-1]]
                homes = ""
            meant |= {".".join((*names[:-1], near))} if near and not homes else set()
            message, allowed = table.unknown(names[-1], near)
            if homes:
                message = f"unknown key here, it is a key of {homes}"
                own = share_word(names[-1], table.model_fields)
                if own and "_" not in names[-1]:
                    message += f"; here {', '.join(own)}"
                # one of several tables alike, such as plies, repeats no other table
                if any(isinstance(step, int) for step in error["loc"]):
                    message += f"; allowed here: {', '.join(table.model_fields)}"
                allowed = None
            value = None
            if message is None:
                value = error["input"]
            line = InputError(message, file=file, key=key, value=value, allowed=allowed)
        elif error["type"] == "missing" and key in meant:
            continue
        elif error["type"] == "missing":
            heading = (field.json_schema_extra or {}).get("heading", key)
            line = InputError("is missing", file=file, key=heading, allowed=field.description)
        elif isinstance(cause, InputError):
            for part in getattr(cause, "problems", (cause,)):
                key = ".".join(filter(None, (*names, part.key)))
                if part.message is None and part.value is None:
                    value = written(given, key)
                else:
                    value = part.value
                line = InputError(
                    part.message,
                    file=file,
                    key=key or None,
                    value=value,
                    allowed=part.allowed,
                )
                problems.setdefault(key, line)
            continue
        else:
            # in Python a number is a quantity in SI units
            needs_unit = (unit_of(field) or "1") != "1"
            if in_python and not isinstance(error["input"], str):
                needs_unit = False
            allowed = field.description
            if mark(field, MayHaveRange) is None and range_texts.looks_like_one(error["input"]):
                allowed = f"{allowed}, without a range: shots draw {_drawn_keys(model)} alone"
            line = refused(
                error["input"],
                allowed,
                file=file,
                key=key,
                needs_unit=needs_unit,
                units=(unit_of(field) or "",) if needs_unit else (),
            )
        problems.setdefault(key, line)
    return list(problems.values())


def _drawn_keys(model):
    """Return the keys that may be given with a range, in words."""
    keys = [key for key, field in entries(model).items() if mark(field, MayHaveRange)]
    return ", ".join(keys) or "none of its numbers"


def _meant(key, value, table):
    """The key of a table that a mistyped one may stand for; not one that holds tables, if its value
    is none."""
    holds_tables = isinstance(value, (dict, list))
    known = [name for name, field in table.model_fields.items() if field.title or holds_tables]
    word = nearest(key, table.synonyms)
    return nearest(key, known) or (table.synonyms[word] if word else None)


def _homes(model, key):
    """The tables of a schema that have a key, in words; an empty text if none has it."""
    names = [name for name, table in tables(model).items() if key in table.model_fields]
    return ", ".join(f"[{name}]" if name else "the top of the file" for name in names)


def _locate(model, location):
    """Follow an error's location to (the key's names, the field it belongs to, the table that holds
    it)."""
    names = []
    field = None
    table = model
    for step in location:
        if field is None:
            tables = [model]
        else:
            tables = list(tables_in(field.annotation))
        inner = next(
            (one for one in tables if step in one.model_fields), tables[0] if tables else None
        )
        if isinstance(step, int) or step in (
            "text",
            "inline",
            "pair",
        ):  # list index, tag of a union
            continue
        if inner is None:
            break
        table = inner
        names.append(step)
        field = table.model_fields.get(step)
        if field is None:
            break
    return names, field, table


def unit_of(entry: Any) -> str | None:
    """Return the SI unit of a field, "1" of a ratio; None if it is not a quantity, or not a
    field."""
    return (getattr(entry, "json_schema_extra", None) or {}).get("unit")


def tables_in(kind: Any) -> Iterator[type[Table]]:
    """Yield the tables in a type, through its unions and tuples."""
    if isinstance(kind, type) and issubclass(kind, Table):
        yield kind
    for part in get_args(kind):
        yield from tables_in(part)


def changed(scene: Table, prefix: str = "") -> Iterator[str]:
    """Yield the keys that a scene sets to something other than their default, in the order of the
    schema."""
    for name, entry in type(scene).model_fields.items():
        if name not in scene.model_fields_set:
            continue
        value = getattr(scene, name)
        key = prefix + name
        inner = [
            part
            for part in (value if isinstance(value, tuple) else (value,))
            if isinstance(part, Table)
        ]
        keys_below = [below for part in inner for below in changed(part, f"{key}.")]
        yield from dict.fromkeys(keys_below)
        usual = entry.get_default(call_default_factory=True)
        differs = entry.is_required() or not is_same(value, usual)
        if not keys_below and differs and not (inner and entry.is_required()):
            yield key


def keys(model: type[Table]) -> tuple[str, ...]:
    """Return all keys of a schema, without the tables that hold them."""
    return tuple(entries(model))


def tables(model: type[Table], name: str = "") -> dict[str, type[Table]]:
    """Return the tables of a schema by dotted name, {name: table}; "" is the schema itself."""
    named = {name: model}
    for key, entry in model.model_fields.items():
        for kind in dict.fromkeys(tables_in(entry.annotation)):
            named |= tables(kind, f"{name}.{key}".lstrip("."))
    return named


def entries(model: type[Table]) -> dict[str, FieldInfo]:
    """Return all keys of a schema, {key: its field}: the fields that have a meaning, not those that
    only hold tables."""
    fields = {}
    for name, table in tables(model).items():
        for key, entry in table.model_fields.items():
            if entry.title:
                fields[f"{name}.{key}".lstrip(".")] = entry
    return fields


@cache
def unread(model: type[Table], reader: str) -> dict[str, str]:
    """Return {key or table: what is allowed} of what a function does not read (`Unread`), "" of what is
    passed over in silence."""
    return {name: own.allowed for name, own in _marks_of(model, Unread, reader)}


def without_place(model: type[Table], writer: str) -> dict[str, str]:
    """Return {key or table: what follows} of what a function has no place for (`NoPlace`)."""
    return {name: own.follows for name, own in _marks_of(model, NoPlace, writer)}


def _marks_of(model, kind, function):
    """(dotted name, mark) of the keys and tables that have a mark of a kind for a function."""
    for name, table in tables(model).items():
        for key, entry in table.model_fields.items():
            for own in entry.metadata:
                if isinstance(own, kind) and function in own.by.split():
                    yield f"{name}.{key}".lstrip("."), own


def refuse_passed_over(
    scene: Table, table: Mapping[str, Any], file: FilePath | None, reader: str
) -> None:
    """Raise an InputError for the first key that a scene sets and a function does not read.

    A key at its default counts as not set: every function does what the defaults of the keys that it
    refuses describe (one ply, no block, no [history]).

    Parameters
    ----------
    scene : checked
    table : the same as it is written, for the value in the message
    """
    words = unread(type(scene), reader)
    for key in changed(scene):
        for name in with_tables(key):
            if words.get(name):
                raise InputError(
                    file=file, key=name, value=written(table, name), allowed=words[name]
                )


def with_tables(key: str) -> list[str]:
    """List the tables that a dotted key is in, from the outermost, and the key."""
    return list(accumulate(key.split("."), "{}.{}".format))


def written(table: Any, key: str) -> Any:
    """Return the value of a key as it stands in the file; None of a table, and of what cannot be
    found."""
    for part in key.split("."):
        if isinstance(table, dict):
            table = table.get(part)
        else:
            table = None
    if isinstance(table, dict):
        return None
    return table
