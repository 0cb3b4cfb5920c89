"""Projectiles and backings on the terminal: all of a kind in one table, or one with the source of each number."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fabrics import backings as backing_data
from fabrics import projectiles as projectile_data
from fabrics.files import write_whole
from weavecell.commands.fabrics import print_table
from weavecell.scenes.impact import SHAPES

_PROJECTILE = ("mass", "diameter", "length")
_BACKING = ("density", "modulus", "yield_stress", "rate_exponent", "erosion_strain")


def projectiles(out: Path | None = None) -> None:
    """Print the projectiles, one line each; with `out`, also write them as CSV."""
    rows = []
    for name in projectile_data.list_names():
        shape, data = projectile_data.entry(name)
        given = [data[key]["value"] if key in data else "" for key in _PROJECTILE]
        rows.append((name, shape, *given, f"{data['diameter']['status']}: {data['diameter']['source']}"))
    _all("Projectiles", ("projectile", "nose", *_PROJECTILE, "source of the diameter"), rows, out)


def backings(out: Path | None = None) -> None:
    """Print the backings, one line each; with `out`, also write them as CSV."""
    rows = []
    for name in backing_data.list_names():
        data, speed = backing_data.entry(name), f"{backing_data.load(name).wave_speed:.0f}"
        rows.append((name, *(data[key]["value"] for key in _BACKING), speed, data["yield_stress"]["status"]))
    _all("Backings", ("backing", *_BACKING, "wave speed [m/s]", "status of the yield stress"), rows, out)


def projectile(name: str) -> None:
    """Print one projectile: each number with its source."""
    shape, data = projectile_data.entry(name, key="PROJECTILE")
    _one(f"{name}, {SHAPES[shape]} of steel of {1e-3 * projectile_data.density():g} g/cm³", data)


def backing(name: str) -> None:
    """Print one backing: each number with its source."""
    _one(name, backing_data.entry(name, key="BACKING"))


def _all(title: str, heads: Sequence[str], rows: Sequence[Sequence[str]], out: Path | None) -> None:
    if out is not None:
        with write_whole(out) as file:
            csv.writer(file).writerows([heads, *rows])
    print_table(title, heads, rows, numeric=False)


def _one(title: str, data: Mapping[str, Any]) -> None:
    rows = [(key, one["value"], one["status"], one["source"]) for key, one in data.items()]
    print_table(title, ("key", "value", "status", "source"), rows, numeric=False)
