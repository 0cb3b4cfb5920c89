"""Which keys of a scene a command supports. A key that is set and not supported is rejected; none is passed over.

Each command declares, beside its code, a `Support`: what it ignores and what it rejects of the scene's schema; it
supports all other keys, a new one too. A test finds a supported key that does not reach the solver. Keys are dotted
("panel.boundary.warp.clamp_force"); a table may be named as a whole ("history"). `check` runs before anything is
computed or written.

A key at its default value counts as not set: it changes nothing, since every command does what the defaults of the keys
that it rejects describe (one ply, no block, no [history]).

Ignored are keys that mean nothing to a command by its definition, such as the strike velocity of a scene whose
ballistic limit is computed. The help of the command names each of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import accumulate
from typing import Any

from pydantic.fields import FieldInfo

from fabrics.checks import FilePath
from fabrics.errors import InputError
from weavecell.scenes.schema import Table, tables_in


@dataclass(frozen=True)
class Rule:
    """A key that is rejected in some scenes.

    Parameters
    ----------
    key : dotted
    applies : called with the scene; whether the key is rejected in it
    allowed : what is allowed there, completing "must be ..."
    """

    key: str
    applies: Callable[[Any], bool]
    allowed: str


@dataclass(frozen=True)
class Support:
    """What a command does with each key of a scene.

    Parameters
    ----------
    model : the Table of its scenes
    ignored : keys or tables that mean nothing to it, each key named in its help
    rejected : {key or table: what is allowed}, completing "must be ..."
    rules : rejections that depend on other keys
    """

    model: type[Table]
    ignored: tuple[str, ...] = ()
    rejected: Mapping[str, str] = field(default_factory=dict)
    rules: tuple[Rule, ...] = ()

    def use_of(self, key: str) -> str:
        """What it does with a key: "used", "ignored" or "refused" (in any scene)."""
        named = with_tables(key)
        if any(name in self.rejected for name in named):
            return "refused"
        return "ignored" if any(name in self.ignored for name in named) else "used"

    @property
    def supported(self) -> tuple[str, ...]:
        """Keys that it honours: all that it neither ignores nor rejects."""
        return tuple(key for key in keys(self.model) if self.use_of(key) == "used")


def of(table: str, names: str) -> tuple[str, ...]:
    """Dotted keys of a table from their names in one text."""
    return tuple(f"{table}.{name}" for name in names.split())


def check(scene: Any, table: dict[str, Any], file: FilePath | None, support: Support) -> None:
    """Reject what a scene sets and a command does not support.

    Parameters
    ----------
    scene : the checked scene
    table : the same as it is written, for the values in messages
    file : named in messages
    support : of the command

    Raises
    ------
    InputError : one line naming the file, the first such key, its value and what is allowed
    """
    for name in (name for key in changed(scene) for name in with_tables(key)):
        allowed = support.rejected.get(name) or _ruled(scene, name, support.rules)
        if allowed:
            raise InputError(file=file, key=name, value=_written(table, name), allowed=allowed)


def with_tables(key: str) -> list[str]:
    """The tables that a dotted key is in, from the outermost, and the key."""
    return list(accumulate(key.split("."), "{}.{}".format))


def _ruled(scene, key, rules):
    return next((rule.allowed for rule in rules if rule.key == key and rule.applies(scene)), None)


def changed(scene: Table, prefix: str = "") -> Iterator[str]:
    """The keys that a scene sets to something other than their default, in the order of the schema."""
    for name, entry in type(scene).model_fields.items():
        if name not in scene.model_fields_set:
            continue
        value, key = getattr(scene, name), prefix + name
        inner = [part for part in (value if isinstance(value, tuple) else (value,)) if isinstance(part, Table)]
        found = [below for part in inner for below in changed(part, f"{key}.")]
        yield from dict.fromkeys(found)
        differs = entry.is_required() or value != entry.get_default(call_default_factory=True)
        if not found and differs and not (inner and entry.is_required()):
            yield key


def keys(model: type[Table]) -> tuple[str, ...]:
    """All keys of a schema, without the tables that hold them."""
    return tuple(entries(model))


def tables(model: type[Table], name: str = "") -> dict[str, type[Table]]:
    """{dotted name: table} of a schema, "" for the schema itself."""
    found = {name: model}
    for key, entry in model.model_fields.items():
        for kind in dict.fromkeys(tables_in(entry.annotation)):
            found |= tables(kind, f"{name}.{key}".lstrip("."))
    return found


def entries(model: type[Table]) -> dict[str, FieldInfo]:
    """{key: its field} of all keys of a schema: the fields that have a meaning, not those that only hold tables."""
    return {
        f"{name}.{key}".lstrip("."): entry
        for name, table in tables(model).items()
        for key, entry in table.model_fields.items()
        if entry.title
    }


def _written(table, key):
    """The value of a key as it stands in the file; None of a table, and of what cannot be found."""
    for part in key.split("."):
        table = table.get(part) if isinstance(table, dict) else None
    return None if isinstance(table, dict) else table
