"""The figure "scored" of the reports: predicted over measured of each test, by rank, and the outcomes below.

    python tools/scored_plots.py scored.svg [scored.csv]

writes it from docs/reports/data, or from another scored.csv.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from weavecell.report.pictures_style import BLUE, FAINT, INK, ORANGE

QUANTILES = ("5 %", "25 %", "50 %", "75 %", "95 %")


def draw(table: Sequence[Mapping[str, str]]) -> Figure:
    """Plot numbers over what was measured, sorted by rank, and the shares of shots that perforate below."""
    numbers = [row for row in table if row["rank"] and float(row["measured"])]
    numbers.sort(key=lambda row: float(row["rank"]))
    outcomes = [row for row in table if row["Brier"]]
    outcomes.sort(key=lambda row: float(row["50 %"]))
    heights = [max(2, len(numbers)), max(2, len(outcomes))]
    figure = Figure(figsize=(9, 2.2 + 0.27 * sum(heights)), layout="constrained")
    above, below = figure.subplots(2, gridspec_kw={"height_ratios": heights})
    _plot_numbers(above, numbers)
    _plot_outcomes(below, outcomes)
    return figure


def _plot_numbers(axes, rows):
    """Draw the intervals of numbers over the measured ones; those of the tests are grey."""
    axes.axvline(1, color=INK, lw=1)
    for place, row in enumerate(rows):
        measured = float(row["measured"])
        error = float(row["sigma"]) / measured
        axes.barh(place, 3.29 * error, 0.9, left=1 - 1.645 * error, color=FAINT, alpha=0.35)
        inside = row["inside 90 %"] == "yes"
        _plot_interval(axes, place, [float(row[name]) / measured for name in QUANTILES], inside)
        if row["single run"]:
            single = float(row["single run"]) / measured
            axes.plot(single, place, "x", color=INK, ms=6)
    axes.set_xlabel("predicted over measured; x: single run; grey: 90 % of the test")
    _name(axes, rows, lambda row: f"{row['id']}  ({float(row['rank']):.2f}, n {row['shots']})")
    axes.set_title("numbers, by rank (rank, shots); orange: outside 90 %", fontsize=10)


def _plot_outcomes(axes, rows):
    """Draw the intervals of the share that perforates; what was seen is at an end."""
    for place, row in enumerate(rows):
        perforated = row["measured"] == "perforated"
        share = float(row["50 %"])
        right = (share > 0.5) == perforated
        _plot_interval(axes, place, [float(row[name]) for name in QUANTILES], right)
        fill = "none" if row["quantity"].startswith("inferred") else INK
        axes.plot(float(perforated), place, "D", color=INK, mfc=fill, ms=6)
    axes.set(xlim=(-0.03, 1.03))
    axes.set_xlabel("share of drawn shots that perforate; diamond: seen, hollow: inferred")
    _name(axes, rows, lambda row: f"{row['id']}  ({float(row['Brier']):.2f}, n {row['shots']})")
    axes.set_title("outcomes (Brier, coin 0.25; shots); orange: on the wrong side", fontsize=10)


def _plot_interval(axes: Axes, place: int, values: Sequence[float], good: bool) -> None:
    """Draw the 90 % interval as a line, that of 50 % as a bar, and the median."""
    low, first, middle, third, high = values
    color = BLUE if good else ORANGE
    axes.plot([low, high], [place, place], color=color, lw=1.2)
    axes.plot([first, third], [place, place], color=color, lw=5, alpha=0.6, solid_capstyle="butt")
    axes.plot(middle, place, "o", color=color, ms=5)


def _name(axes, rows, words):
    axes.set_yticks(np.arange(len(rows)), labels=[words(row) for row in rows], fontsize=8)
    axes.set_ylim(-0.6, len(rows) - 0.4)
    axes.grid(axis="x", alpha=0.3)
    if not rows:
        axes.text(0.5, 0.5, "nothing is drawn yet", transform=axes.transAxes, ha="center")


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[1]))
    from validation import csv_file

    file, *tables = sys.argv[1:]
    path = Path(tables[0]) if tables else csv_file.DATA / "scored.csv"
    draw(csv_file.read(path)[1]).savefig(file)
