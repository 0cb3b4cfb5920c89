"""JSON as this package writes it: readable, whole, numbers of numpy included; summary.json of any release is read."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fabrics.checks import FilePath
from fabrics.errors import InputError
from fabrics.files import write_whole
from weavecell.results import keys
from weavecell.scenes import renamed_keys


def write(path: FilePath, content: object) -> None:
    """Write `content`; numpy numbers and arrays become numbers and lists."""
    with write_whole(path) as file:
        json.dump(content, file, indent=2, default=lambda value: value.tolist())
        file.write("\n")


def write_summary(path: FilePath, content: Mapping[str, Any]) -> None:
    """Write summary.json, its format first."""
    write(path, {"format": keys.SUMMARY_FORMAT, **content})


def read_summary(path: FilePath) -> dict[str, Any]:
    """The content of a summary.json by the keys of today; one of an older release is read with a warning.

    Raises
    ------
    InputError : no such file, not JSON, or of an unknown format
    """
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, json.JSONDecodeError) as problem:
        raise InputError(f"cannot be read; must be a summary.json ({problem})", file=path) from None
    if "format" not in content:
        renamed_keys.warn_of_format(path, 1)
        return {"format": keys.SUMMARY_FORMAT} | _upgraded(content)
    if content["format"] != keys.SUMMARY_FORMAT:
        raise InputError(file=path, key="format", value=content["format"], allowed=repr(keys.SUMMARY_FORMAT))
    return content


def _upgraded(value, path=""):
    if not isinstance(value, dict):
        return value
    found = {}
    for name, inner in value.items():
        key = f"{path}.{name}" if path else name
        new = renamed_keys.new_path(key, renamed_keys.SUMMARY_KEYS, ".").rpartition(".")[2]
        found[new] = _upgraded(inner, key)
    return found
