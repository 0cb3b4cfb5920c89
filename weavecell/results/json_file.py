"""JSON as this package writes it: readable, whole, numbers of numpy included."""

from __future__ import annotations

import json

from fabrics.files import write_whole


def write(path, content):
    """Write `content`; numpy numbers and arrays become numbers and lists."""
    with write_whole(path) as file:
        json.dump(content, file, indent=2, default=lambda value: value.tolist())
        file.write("\n")
