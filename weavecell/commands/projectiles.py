"""The projectiles on the terminal: all in one table, or one with the source of each number."""

from __future__ import annotations

import csv
from pathlib import Path

from fabrics import projectiles
from fabrics.files import write_whole
from weavecell.commands.fabrics import print_table
from weavecell.scenes.impact import SHAPES

_KEYS = ("mass", "diameter", "length")


def show_all(out: Path | None = None) -> None:
    """Print the projectiles, one line each; with `out`, also write them as CSV."""
    heads = ("projectile", "nose", *_KEYS, "source of the diameter")
    rows = []
    for name in projectiles.list_names():
        shape, data = projectiles.entry(name)
        given = [data[key]["value"] if key in data else "" for key in _KEYS]
        rows.append((name, shape, *given, f"{data['diameter']['status']}: {data['diameter']['source']}"))
    if out is not None:
        with write_whole(out) as file:
            csv.writer(file).writerows([heads, *rows])
    print_table("Projectiles", heads, rows, numeric=False)


def show(name: str) -> None:
    """Print one projectile: each number with its source."""
    shape, data = projectiles.entry(name, key="PROJECTILE")
    rows = [(key, one["value"], one["status"], one["source"]) for key, one in data.items()]
    title = f"{name}, {SHAPES[shape]} of steel of {1e-3 * projectiles.density():g} g/cm³"
    print_table(title, ("key", "value", "status", "source"), rows, numeric=False)
