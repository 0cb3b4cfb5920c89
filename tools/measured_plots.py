"""The figure "measured" of the reports: computed against measured, a plot a quantity, both axes logarithmic.

    python tools/measured_plots.py measured.svg

writes it from docs/reports/data.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from textwrap import fill

import numpy as np
from matplotlib.figure import Figure

from weavecell.report.pictures_style import BLUE, FAINT, INK, ORANGE

COLUMNS = 4


def draw(table: Sequence[Mapping[str, str]], quantities: Sequence[Mapping[str, str]]) -> Figure:
    """Plot each quantity with a bias: rows with 2 sigma of the test and of the computed value,
    equality with 2 sigma of tests, bias with 2 sigma of the model."""
    drawn = [one for one in quantities if one["bias"]]
    rows = -(-len(drawn) // COLUMNS)
    figure = Figure(figsize=(12.4, 3.5 * rows), layout="constrained")
    grid = figure.subplots(rows, COLUMNS, squeeze=False)
    for axes, one in zip(grid.flat, drawn):
        of = [
            row
            for row in table
            if row["quantity"] == one["quantity"] and (row["computed"] or row["coarse"])
        ]
        cells = []
        for row in of:
            value = row["computed"] or row["coarse"]
            cells.append((row["measured"], value, row["sigma"], row["u_num"], row["u_input"]))
        x, y, sigma, u_num, u_input = np.array(cells, float).T
        spread = 2 * np.hypot(u_num, u_input)
        # an interval may reach below zero, which a logarithmic axis cannot show
        lowest = np.maximum(np.minimum(x - 2 * sigma, y - spread), 0.5 * np.minimum(x, y))
        ends = np.array([0.8 * lowest.min(), 1.25 * max((x + 2 * sigma).max(), (y + spread).max())])
        test, model, bias = (
            float(one["sigma_test"]),
            float(one["sigma_model"] or 0),
            float(one["bias"]),
        )
        axes.loglog(ends, ends, color=INK, lw=1)
        axes.fill_between(
            ends, ends * np.exp(-2 * test), ends * np.exp(2 * test), color=FAINT, alpha=0.3, lw=0
        )
        axes.loglog(ends, bias * ends, color=ORANGE, lw=1.5)
        for sign in (-2, 2) if model else ():
            axes.loglog(ends, bias * np.exp(sign * model) * ends, color=ORANGE, lw=1, ls="--")
        axes.errorbar(x, y, xerr=2 * sigma, yerr=spread, fmt="o", color=BLUE, ms=6, lw=1)
        ticks = [float(f"{x:.2g}") for x in np.geomspace(1.1 * ends[0], 0.9 * ends[1], 3)]
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_ticks(ticks, labels=[f"{x:g}" for x in ticks])
            axis.set_ticks([], minor=True)
        axes.set(xlabel=f"measured [{of[0]['unit']}]", ylabel="computed", xlim=ends, ylim=ends)
        axes.set_title(fill(f"{one['quantity']}, n = {one['n']}", 26), fontsize=11)
    for axes in list(grid.flat)[len(drawn) :]:
        axes.remove()
    return figure


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[1]))
    from validation import csv_file

    names = ("measured", "measured-quantities")
    draw(*(csv_file.read(csv_file.DATA / f"{name}.csv")[1] for name in names)).savefig(sys.argv[1])
