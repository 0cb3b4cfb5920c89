"""The file law.json: a compression law, and the contact law of plies beside it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.files import write_whole

FORMAT = "weavecell compression law 1"


def read(path: FilePath) -> dict[str, Any]:
    """The content of a law.json.

    Raises
    ------
    InputError : no such file, not JSON, or another format
    """
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8-sig"))
    except OSError as problem:
        raise InputError(
            "cannot be read", file=path, allowed=f"a compression law ({problem.strerror})"
        ) from problem
    except ValueError as problem:
        raise InputError(
            "is not JSON", file=path, allowed=f"a compression law ({problem})"
        ) from problem
    found = None
    if isinstance(content, dict):
        found = content.get("format")
    if found != FORMAT:
        raise InputError(file=path, key="format", value=found, allowed=repr(FORMAT))
    return content


def write(path: FilePath, content: Mapping[str, Any]) -> None:
    """Write a law.json, whole or not at all."""
    with write_whole(path) as file:
        json.dump({"format": FORMAT, **content}, file, indent=2)
        file.write("\n")
