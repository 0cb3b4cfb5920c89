"""The file law.json: a compression law, and the contact law of plies beside it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from fabrics.base.checks import FilePath
from fabrics.base.files import write_whole
from fabrics.base.read_formats import read_json

FORMAT = "weavecell compression law 1"


def read(path: FilePath) -> dict[str, Any]:
    """Read a law.json.

    Raises
    ------
    InputError : no such file, not JSON, or another format
    """
    return read_json(path, FORMAT, what="a compression law")


def write(path: FilePath, content: Mapping[str, Any]) -> None:
    """Write a law.json, whole or not at all."""
    with write_whole(path) as file:
        json.dump({"format": FORMAT, **content}, file, indent=2)
        file.write("\n")
