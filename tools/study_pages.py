"""Tables and figures of the reports from the CSVs of studies in docs/reports/data (directives: study_directives.py).

    ```{study-table} edges
    :columns: name; outcome; depth [mm]
    :where: velocity = 100; outcome = stopped
    ```

A table has some columns of the rows that have these values, "a | b" standing for either, twelve at most; its
caption says of how many, and how and at which commit the file was made. {study-figure} edges draws what
[picture] of validation/studies/NAME.toml says: `x`, `y` (one column or several) and `by`, the columns whose
values tell lines apart. Where each has a single point, the Pareto-optimal ones are named.
"""

from __future__ import annotations

import csv
import tomllib
from itertools import groupby
from pathlib import Path

import measured_plots
import scored_plots

ROOT = Path(__file__).parents[1]
DATA, STUDIES = ROOT / "docs" / "reports" / "data", ROOT / "validation" / "studies"
MOST = 12  # rows of a table
NAMED, BEST = 10, "Pareto-optimal in"  # most lines with a legend; column of a chart


def read(name):
    """Read a CSV: (how it was made, rows)."""
    with open(DATA / f"{name}.csv", encoding="utf-8", newline="") as file:
        made = file.readline().removeprefix("#").strip()
        return made, list(csv.DictReader(file))


def shown(made):
    """Return what a caption says of the first line of a file: command, commit, date and processor."""
    return made.partition(";")[0]


def rows_of(name, columns="", where=""):
    """Select rows of a study: (how it was made, number of rows of the file, columns, the rows that
    are shown).

    Raises
    ------
    ValueError : a column that the file does not have, no row, or more than MOST
    """
    made, rows = read(name)
    shown = [column.strip() for column in columns.split(";")] if columns else list(rows[0])
    wanted = {
        key.strip(): value
        for key, _, value in (one.partition(" = ") for one in where.split(";") if where)
    }
    for column in (*shown, *wanted):
        if column not in rows[0]:
            raise ValueError(f"{name}.csv has no column {column!r}, but {', '.join(rows[0])}")
    chosen = [
        row
        for row in rows
        if all(row[key] in map(str.strip, text.split("|")) for key, text in wanted.items())
    ]
    if not 0 < len(chosen) <= MOST:
        raise ValueError(f"{len(chosen)} rows of {name}.csv: a report shows 1 to {MOST}")
    return made, len(rows), shown, [[row[column] for column in shown] for row in chosen]


def picture(name):
    """Return [picture] of a study, or of the one that it is like."""
    content = tomllib.loads((STUDIES / f"{name}.toml").read_text("utf-8"))
    return content.get("picture") or picture(content["like"])


def draw(name):
    """Draw the figure of a study, or of the measured or scored rows."""
    from matplotlib.figure import Figure

    if name == "scored":
        return scored_plots.draw(read(name)[1])
    if name == "measured":
        return measured_plots.draw(read(name)[1], read("measured-quantities")[1])
    asked, (_, rows) = picture(name), read(name)
    lines, by = asked["y"] if isinstance(asked["y"], list) else [asked["y"]], asked.get("by", [])
    by, x = [by] if isinstance(by, str) else by, asked["x"]
    figure = Figure(figsize=(8, 4.5), layout="constrained")
    axes = figure.subplots()
    for line in lines:
        whole = sorted(
            (row for row in rows if row[x] and row[line]), key=lambda row: [row[key] for key in by]
        )
        for label, group in groupby(whole, key=lambda row: ", ".join(row[key] for key in by)):
            points = list(group)
            at = [_number(row[x]) for row in points]
            several = len(points) > 1
            axes.plot(
                at,
                [float(row[line]) for row in points],
                "o-" if several and by else "o",
                label=label or line if several or not by else None,
            )
            if not several and points[0].get(BEST):
                axes.annotate(label, (at[0], float(points[0][line])), fontsize=7)
    logarithmic = asked.get("log", "")
    axes.set(xlabel=x, ylabel=lines[0] if len(lines) == 1 else "")
    axes.set(
        **{f"{letter}scale": "log" for letter in logarithmic}
    )  # to set "linear" would drop the names on an axis
    axes.grid(alpha=0.3)
    if 0 < len(axes.get_legend_handles_labels()[1]) <= NAMED:
        # a number in a legend says nothing without the name of its column
        axes.legend(fontsize=8, title=", ".join(by), title_fontsize=8)
    return figure


def _number(text):
    try:
        return float(text)
    except ValueError:
        return text
