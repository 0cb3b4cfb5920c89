"""Reference of the scene files: the meaning of every key, and JSON Schemas with which editors complete and check."""

from __future__ import annotations

import tomllib
from importlib.resources import files
from typing import Any

from weavecell.scenes import supported
from weavecell.scenes.impact import Scene
from weavecell.scenes.schema import Table


def meanings(model: type[Table]) -> dict[str, str]:
    """{dotted key: meaning} of a scene's schema, from meanings.toml.

    Parameters
    ----------
    model : Scene or CouponScene

    Raises
    ------
    KeyError : a key of the schema has no meaning there
    """
    known = _known(model, "")
    return {key: known[key] for key in supported.keys(model)}


def tables(model: type[Table]) -> dict[str, dict[str, str]]:
    """{table: {"about": what it is, "example": lines of TOML}} of an input file, from meanings.toml.

    Parameters
    ----------
    model : Scene or CouponScene
    """
    return _known(model, "_tables")


def _known(model, kind):
    read = tomllib.loads((files(__package__) / "meanings.toml").read_text("utf-8"))
    return read[f"impact{kind}"] | ({} if model is Scene else read[f"coupon{kind}"])


def json_schema(model: type[Table]) -> dict[str, Any]:
    """The JSON Schema of a scene file as it is written: quantities are texts with a unit.

    Parameters
    ----------
    model : Scene or CouponScene

    Raises
    ------
    KeyError : as `meanings`
    """
    schema = model.model_json_schema()
    words = meanings(model)
    _describe(schema, schema, "", words, set())
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema"
    return schema


def _describe(node, schema, prefix, words, seen):
    """Put meaning and unit into the properties of a table and of those below it, once where two keys share a table."""
    if id(node) in seen:
        return
    seen.add(id(node))
    for name, entry in node.get("properties", {}).items():
        key = prefix + name
        if "unit" in entry:
            _as_text(entry)
        if name == "grading":
            _sides_as_text(entry)
        for kind in _tables(entry, schema):
            _describe(kind, schema, f"{key}.", words, seen)
        if key in words:
            unit = entry.pop("unit", "")
            ends = f" [{unit}]" if unit else ""
            entry["description"] = f"{words[key]}{ends}; {entry.get('description', '')}"


def _tables(entry, schema):
    """The definitions that an entry refers to."""
    if "$ref" in entry:
        yield schema["$defs"][entry["$ref"].rpartition("/")[2]]
    items = [entry["items"]] if isinstance(entry.get("items"), dict) else []
    for part in (*entry.get("anyOf", ()), *entry.get("oneOf", ()), *entry.get("prefixItems", ()), *items):
        yield from _tables(part, schema)


def _as_text(entry):
    """Numbers of a quantity, or what is made of an angle, become texts with a unit; defaults are left out."""
    if entry.get("type") in ("number", "boolean"):
        entry["type"] = "string"
        for limit in ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum"):
            entry.pop(limit, None)
    entry.pop("default", None)
    items = [entry["items"]] if isinstance(entry.get("items"), dict) else []
    for part in (*entry.get("anyOf", ()), *entry.get("prefixItems", ()), *items):
        _as_text(part)


def _sides_as_text(entry):
    """Sides of elements in a grading may be fractions, such as "1/2"."""
    for part in entry.get("anyOf", [entry]):
        if part.get("type") == "array":
            part["items"]["prefixItems"] = [{"type": ["number", "string"]}] * 2
