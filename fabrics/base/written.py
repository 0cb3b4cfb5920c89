"""What a user has written, for messages: the text of a value, its line, and where a number comes from
that is not written.

Every TOML file of a user that is read is kept here as it was read (`keep`), the latest of `KEPT` files. An
InputError that names a file and a key asks `find` what stands there: its message then shows the user's own
text in the user's own unit, with its line, whatever the code below has made of it. A number that another
key brings, such as the diameter of a projectile by name, is told with that key (`note_fills`).
"""

from __future__ import annotations

import os
import re
import tomllib
from collections import OrderedDict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

from fabrics.base import amounts
from fabrics.base.values import is_same

# files, of which a sweep of many fabrics reads more
KEPT = 64
# how a number is known that no user has typed, as a fabric file says it
_MADE = ("fitted", "computed", "derived")


class Mark(Enum):
    """What stands in place of a value that the code does not have."""

    AS_WRITTEN = "as written"


AS_WRITTEN = Mark.AS_WRITTEN
_DOTTED = re.compile(r"(?<!\[)\b[a-z_]+(?:\.[a-z_0-9]+)+\b")


@dataclass
class Document:
    """A file as it was read.

    Parameters
    ----------
    text, table : of it
    fills : {key that is not written: key that brings its value}
    """

    text: str
    table: Mapping[str, Any]
    fills: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Found:
    """What stands in a file under a key.

    Parameters
    ----------
    key : that is written: another one where that brings the value
    value : as it is written
    line : number in the file, 0 if it cannot be told
    made : where a value comes from that was not typed, in words
    asked : key that was looked for
    """

    key: str
    value: Any
    line: int
    made: str = ""
    asked: str = ""

    def __str__(self) -> str:
        return f"{self.value}, line {self.line}" if self.line else str(self.value)

    def part(self, value: Any) -> Any:
        """Return what a message shows in place of the `value` that the code has."""
        if value is None or self.key != self.asked:
            return None if value is AS_WRITTEN else value
        if not isinstance(self.value, (Mapping, list)):
            return self.value
        if value is AS_WRITTEN:
            return None
        if isinstance(self.value, list) and isinstance(value, (list, tuple)):
            return self.value
        # of a list the part that is meant
        if isinstance(self.value, list):
            return next((one for one in self.value if amounts.is_alike(one, value)), value)
        return value


_documents: OrderedDict[str, Document] = OrderedDict()


def keep(file: object, text: str, table: Mapping[str, Any]) -> None:
    """Keep a file of a user as it was read; of the file None the keys that Python gave last."""
    _documents[_name(file)] = Document(text, table)
    _documents.move_to_end(_name(file))
    while len(_documents) > KEPT:
        _documents.popitem(last=False)


def forget_keywords() -> None:
    """Forget the keys that Python gave last: those of one call are not of the next."""
    _documents.pop(_name(None), None)


def note_fills(file: object, before: Any, after: Any, key: str) -> None:
    """Note that `key` of a file brings what the table `after` has and `before` has not."""
    document = _document(file)
    if document is None:
        return
    for name in _leaves(after):
        if _value(before, name.split(".")) is None:
            document.fills.setdefault(name, key)


def find(file: object, key: str | None, value: Any = None) -> Found | None:
    """Find what stands under a dotted key of a file that was read; None if it is not known.

    Parameters
    ----------
    value : that the code has, which tells one of several tables alike, or one part of a list
    """
    document = _document(file)
    # Python has keywords of these names, which are not of its last set-up
    if document is None or not key or (file is None and "." not in key):
        return None
    own = key.strip("[]")
    if own in document.fills and _value(document.table, own.split(".")) is None:
        own = document.fills[own]
    path, written = _locate(document.table, own.split("."), value)
    if written is None:
        return None
    made = ""
    if isinstance(written, Mapping) and "value" in written:
        if written.get("status") in _MADE:
            made = f"{written['status']}: {written.get('source', '')}"
        written = written["value"]
    return Found(own, written, line_of(document.text, path), made, key.strip("[]"))


def others_in(file: object, text: str, key: str | None) -> dict[str, Found]:
    """Find the other keys of a file that a message names: {key: what stands there}."""
    found = {}
    for name in dict.fromkeys(_DOTTED.findall(text)):
        other = find(file, name)
        if other is not None and name != key and not isinstance(other.value, (Mapping, list)):
            found[name] = other
    return found


def line_of(text: str, path: Sequence[str | int]) -> int:
    """Find the line of a TOML text on which the key at a path, of names and numbers in lists, is given;
    0 if it has none.

    It is the line behind the longest beginning of the text that is TOML and has no such key: the parser
    itself is asked, so that headings, dotted keys and values of several lines are found alike.
    """
    lines = text.split("\n")
    low, high = 0, len(lines)
    if not _has(lines, high, path):
        return 0
    while high - low > 1:
        middle = (low + high) // 2
        # a beginning that ends inside of a value is no TOML: the next one that is decides
        for at in range(middle, high):
            has = _has(lines, at, path)
            if has is not None:
                break
        else:
            has = True
        if has:
            high = middle
        else:
            low = at
    return low + 1


def _has(lines, count, path):
    """Whether the first lines have the key at a path; None if they are no TOML."""
    try:
        table: Any = tomllib.loads("\n".join(lines[:count]) + "\n")
    except (tomllib.TOMLDecodeError, RecursionError):
        return None
    for step in path:
        try:
            table = table[step]
        except (KeyError, IndexError, TypeError):
            return False
    return True


def _name(file):
    return "" if file is None else os.path.abspath(str(file))


def _document(file):
    return _documents.get(_name(file))


def _leaves(table: Any, prefix: str = "") -> Iterator[str]:
    for name, part in table.items() if isinstance(table, Mapping) else ():
        yield f"{prefix}{name}"
        yield from _leaves(part, f"{prefix}{name}.")


def _value(table, names):
    for name in names:
        if not isinstance(table, Mapping):
            return None
        table = table.get(name)
    return table


def _locate(table, names, value):
    """(path, value) of a dotted key; of tables alike that whose value is the one that is looked for, and
    no other: the first that has the key need not be the wrong one."""
    found = [(path, part) for path, part in _walk(table, tuple(names), ()) if part is not None]
    for path, part in found:
        if value is not None and is_same(part, value):
            return path, part
    return found[0] if len(found) == 1 else ((), None)


def _walk(table, names, path):
    if isinstance(table, list) and names and any(isinstance(part, Mapping) for part in table):
        for number, part in enumerate(table):
            yield from _walk(part, names, (*path, number))
    elif not names:
        yield path, table
    elif isinstance(table, Mapping) and names[0] in table:
        yield from _walk(table[names[0]], names[1:], (*path, names[0]))
