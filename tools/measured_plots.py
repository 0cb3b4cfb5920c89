"""The figure "measured" of the reports: computed against measured, a plot a quantity, both axes logarithmic."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from textwrap import fill

import numpy as np
from matplotlib.figure import Figure

from weavecell.report.pictures_style import BLUE, FAINT, INK, ORANGE

COLUMNS = 4


def draw(table: Sequence[Mapping[str, str]], quantities: Sequence[Mapping[str, str]]) -> Figure:
    """A plot of each quantity with a bias: rows, equality with 2 sigma of tests, bias with 2 sigma of the model."""
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
        cells = [(row["measured"], row["computed"] or row["coarse"], row["sigma"]) for row in of]
        x, y, sigma = np.array(cells, float).T
        ends = np.array([0.8 * min(x.min(), y.min()), 1.25 * max(x.max(), y.max())])
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
        axes.errorbar(x, y, xerr=sigma, fmt="o", color=BLUE, ms=6, lw=1)
        ticks = [float(f"{x:.2g}") for x in np.geomspace(1.1 * ends[0], 0.9 * ends[1], 3)]
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_ticks(ticks, labels=[f"{x:g}" for x in ticks])
            axis.set_ticks([], minor=True)
        axes.set(xlabel=f"measured [{of[0]['unit']}]", ylabel="computed", xlim=ends, ylim=ends)
        axes.set_title(fill(f"{one['quantity']}, n = {one['n']}", 26), fontsize=11)
    for axes in list(grid.flat)[len(drawn) :]:
        axes.remove()
    return figure
