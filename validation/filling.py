"""Tables of TOML files: changes merged into them, and values filled into their texts."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any

from validation.csv_file import Record, text


def merged(first: Record, changes: Record) -> Record:
    """Merge changes into a table; tables in it are merged as well."""
    both = dict(first)
    for key, value in changes.items():
        inner = both.get(key)
        if isinstance(value, dict) and isinstance(inner, dict):
            value = merged(inner, value)
        both[key] = value
    return both


def filled(
    entry: Any,
    chosen: Record,
    used: set[str] | None = None,
    shown: Callable[[Any], str] | None = None,
) -> Any:
    """Fill the values of {key} into the texts of an entry, as `shown`; a text of a key alone
    becomes its value."""
    if isinstance(entry, Mapping):
        return {
            filled(key, chosen, used, shown): filled(value, chosen, used, shown)
            for key, value in entry.items()
        }
    if isinstance(entry, list):
        return [filled(value, chosen, used, shown) for value in entry]
    if not isinstance(entry, str):
        return entry
    found = [key for key in re.findall(r"\{([\w. -]*)\}", entry) if key in chosen]
    if used is not None:
        used.update(found)
    if found and entry == f"{{{found[0]}}}":
        return chosen[found[0]]
    for key in found:
        entry = entry.replace(f"{{{key}}}", (shown or text)(chosen[key]))
    return entry
