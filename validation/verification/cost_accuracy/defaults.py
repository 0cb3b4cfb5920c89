"""Errors of the default model in the standard shots, computed anew against the references of docs/reports/charts.md.

    python -m validation.verification.cost_accuracy.defaults [--out results/defaults] [--page docs/limits.md]

Writes default-errors.csv: one row a shot and group of quantities, the largest error of the group and what its reference
is known to. With --page the table goes into that page, between its marks, and the file into docs/reports/data/.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

from validation.marked_page import markdown
from validation.program import program, publish, write_csv
from validation.verification.cost_accuracy import study, tables

SHOTS = {"ply-stopped": "one ply, stopped", "ply-perforated": "one ply, perforated", "four-ply-pack": "four plies"}
MARKS = "<!-- table of validation.verification.cost_accuracy.defaults -->", "<!-- end of the table -->"
HEAD = ("shot", "quantity", "error of the default, %", "reference known to, %")
FILE = "default-errors.csv"


def errors(key: str) -> list[tuple[Any, ...]]:
    """Rows of one standard shot, as texts: its default is run, and compared with the stored references."""
    scene = study.load(key)
    chart, _ = tables.read(scene, Path(str(resources.files("validation.verification.cost_accuracy"))) / "measured")
    values, _ = scene.run(scene.methods[0].case)
    rows = []
    for group, quantities in scene.groups.items():
        worst = max(abs(values[q.name] / chart.references[q.name].value - 1) for q in quantities)
        names = ", ".join(dict.fromkeys(q.name for q in quantities)) if group == "motion" else group
        title = f"{SHOTS[key]}: {scene.title.split(': ', 1)[1]}"
        rows.append((title, names, f"{100 * worst:.2g}", f"± {100 * chart.unsure(group):.2g}"))
    return rows


def read(path: Path) -> list[tuple[Any, ...]]:
    """Rows of a table written by `main`, without its head."""
    with open(path, encoding="utf-8", newline="") as file:
        return [tuple(row) for row in csv.reader(file)][1:]


def table(rows: Iterable[Sequence[str]]) -> str:
    """The rows in Markdown."""
    return markdown([list(HEAD), *map(list, rows)])


def main(*, out: Path = Path("results/defaults"), page: Path | None = None) -> None:
    rows = [row for key in SHOTS for row in errors(key)]
    folders = [out] if page is None else [out, page.parent / "reports" / "data"]
    for folder in folders:
        write_csv(folder / FILE, [HEAD, *rows])
    publish(table(rows), page, MARKS)


if __name__ == "__main__":
    program(main)
