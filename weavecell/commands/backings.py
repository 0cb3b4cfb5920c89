"""The backings on the terminal: all in one table, or one with the source of each number."""

from __future__ import annotations

import csv
from pathlib import Path

from fabrics import backings
from fabrics.files import write_whole
from weavecell.commands.fabrics import print_table

_KEYS = ("density", "modulus", "yield_stress", "rate_exponent", "erosion_strain")


def show_all(out: Path | None = None) -> None:
    """Print the backings, one line each; with `out`, also write them as CSV."""
    heads = ("backing", *_KEYS, "wave speed [m/s]", "status of the yield stress")
    rows = []
    for name in backings.list_names():
        data = backings.entry(name)
        speed = f"{backings.load(name).wave_speed:.0f}"
        rows.append((name, *(data[key]["value"] for key in _KEYS), speed, data["yield_stress"]["status"]))
    if out is not None:
        with write_whole(out) as file:
            csv.writer(file).writerows([heads, *rows])
    print_table("Backings", heads, rows, numeric=False)


def show(name: str) -> None:
    """Print one backing: each number with its source."""
    rows = [
        (key, one["value"], one["status"], one["source"])
        for key, one in backings.entry(name, key="BACKING").items()
    ]  # fmt: skip
    print_table(name, ("key", "value", "status", "source"), rows, numeric=False)
