"""Text of the class `Keywords` of weavecell/api/keywords.py: the keys of input files with their types and meanings."""

from __future__ import annotations

import re
import textwrap
from types import NoneType
from typing import Any, Literal, get_args, get_origin

from pydantic import WithJsonSchema

from fabrics.base.schema import MayHaveRange, mark, unit_of
from weavecell.api import keywords
from weavecell.scenes import scene_text
from weavecell.scenes.impact import Scene

HEAD = '''class Keywords(TypedDict, total=False):
    """Keywords of `weavecell.setup` and what takes its keywords; docs/reference.md says more.
'''
PAIR = "tuple[Quantity, Quantity] | list[Quantity]"
# types that do not follow from the schema, since Python may give objects, lists and names
TYPES = {
    "law": "Law | Mapping[str, Quantity]",
    "surface": "ResponseSurface | FilePath | None",
    "ply_contact": "PlyLaw | FilePath | None",
    "weaving_damage": "Mapping[str, Number | str] | None",
    "boundary": 'Literal["clamped", "free"] | Mapping[str, Side | Quantity]',
    "opening": f"Quantity | {PAIR}",
    "impact_point": PAIR,
    "ply": "list[Mapping[str, Any]] | tuple[Mapping[str, Any], ...]",
    "strength": "Mapping[str, Quantity] | None",
    "parts": "Mapping[str, Mapping[str, Quantity]] | None",
    "grading": "list[list[Number | str]] | tuple[tuple[Number | str, Number | str], ...] | None",
    "snapshot_interval": "Quantity | None",
    "projectile": "Mapping[str, Quantity] | str | None",
    "history": "Mapping[str, Any] | None",
    "numerics": "Mapping[str, Number | str] | None",
    "backing": "Mapping[str, Any] | str | None",
}
# meanings of what is a table of its own in a file
OF_TABLES = {
    "weaving_damage": "shares of modulus and strength that are left after weaving",
    "strength": "yarns that differ in strength",
    "ply": "plies one by one, in place of `plies`",
    "parts": "parts of each ply that installed packages add, by name",
}


def text() -> str:
    """Write the class between its marks."""
    meanings = []
    types = []
    for key, table in ordered():
        field = None
        if table:
            field = scene_text.fields_of(Scene, table)[key]
        entry = f"{key} : {meaning(key, field)}"
        wrapped = textwrap.fill(
            entry, 100, initial_indent=" " * 4, subsequent_indent=" " * 8, break_on_hyphens=False
        )
        meanings.append(wrapped)
        types.append(f"    {key}: {kind(key, field)}")
    end = '\n    """\n\n'
    return "\n" + HEAD + "\n" + "\n".join(meanings) + end + "\n".join(types) + "\n\n\n# "


def ordered() -> list[tuple[str, str]]:
    """List (keyword, table) in the order of the tables of an input file."""
    found = []
    of_table = keywords.tables()
    for name in Scene.model_fields:
        if of_table.get(name) == "":
            found.append((name, ""))
        found += [(key, table) for key, table in of_table.items() if table == name]
    return found


def meaning(key: str, field: Any) -> str:
    """Say what a keyword means, its unit, and what is allowed."""
    if field is None:
        return f"the table [{key}] of the input file, as a dict"
    words = OF_TABLES.get(key) or field.title
    words = re.sub(r"\s*\(\[.*?\]\(.*?\)\)", "", words)
    unit = unit_of(field)
    if unit not in (None, "1"):
        words += f" [{unit}]"
    return f"{words}; {field.description}"


def list_choices(field: Any) -> list[str]:
    """List the texts of which a field is one (`one_of`, `named` of `fabrics.base.schema`); none of others."""
    if get_origin(field.annotation) is Literal:
        return list(get_args(field.annotation))
    written = mark(field, WithJsonSchema)
    if written is None:
        return []
    return list((written.json_schema or {}).get("enum", []))


def kind(key: str, field: Any) -> str:
    """Return the type of a keyword, as it is written."""
    if key in TYPES:
        return TYPES[key]
    chosen = list_choices(field)
    if chosen:
        names = ", ".join(f'"{name}"' for name in chosen)
        return f"Literal[{names}]"
    (single,) = set(get_args(field.annotation) or (field.annotation,)) - {NoneType}
    written = single.__name__
    if written == "float":
        written = "Number"
        if unit_of(field) or mark(field, MayHaveRange):
            written = "Quantity"
    if field.default is None:
        written += " | None"
    return written
