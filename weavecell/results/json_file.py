"""JSON as this package writes it: readable, whole, numbers of numpy included."""

from __future__ import annotations

import json
from collections.abc import Mapping
from math import isfinite
from typing import Any

from fabrics.base.checks import FilePath
from fabrics.base.files import write_whole
from weavecell.results import keys


def write(path: FilePath, content: object) -> None:
    """Write `content`, as `finite` makes it."""
    with write_whole(path) as file:
        json.dump(finite(content), file, indent=2, allow_nan=False)
        file.write("\n")


def finite(content: Any) -> Any:
    """Convert numpy numbers and arrays in some content to numbers and lists, and what is not finite
    to None."""
    if isinstance(content, Mapping):
        return {key: finite(value) for key, value in content.items()}
    if isinstance(content, (list, tuple)):
        return [finite(value) for value in content]
    if hasattr(content, "tolist"):
        return finite(content.tolist())
    if isinstance(content, float) and not isfinite(content):
        return None
    return content


def write_summary(path: FilePath, content: Mapping[str, Any]) -> None:
    """Write summary.json, its format first."""
    write(path, {"format": keys.SUMMARY_FORMAT, **content})
