"""A scene as TOML text, for scenes that a program puts together (the standard library only reads TOML)."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any


def dumps(table: Mapping[str, Any]) -> str:
    """TOML of a dict of texts, numbers, booleans, lists of those, and dicts of the same, one level of [tables]."""
    loose = [_line(key, value) for key, value in table.items() if not isinstance(value, dict)]
    parts = ["\n".join(loose)] if loose else []
    for name, inner in table.items():
        if isinstance(inner, dict):
            parts.append("\n".join([f"[{name}]", *(_line(key, value) for key, value in inner.items())]))
    return "\n\n".join(parts) + "\n"


def _line(key, value):
    # JSON's texts, numbers, booleans and lists are TOML's
    return f"{key} = {json.dumps(value, ensure_ascii=False)}"
