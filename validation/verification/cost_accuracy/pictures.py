"""The chart of a scene: CPU time against error, a panel for each group of quantities, its front named."""

from __future__ import annotations

from itertools import pairwise
from math import isnan, log10
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, NullFormatter

from fabrics.files import replace_whole
from meshing.pictures_style import BLUE, FAINT, INK, RED

if TYPE_CHECKING:
    from validation.verification.cost_accuracy.core import Chart

BAND = "#f1ead9"
LEAST = 1e-5  # of a value: nothing below is shown
LINE = 0.062  # of a panel's height: least distance of two names


def draw(chart: Chart, path: Path) -> None:
    """Write the chart as a PNG."""
    groups = chart.scene.groups
    figure, row = plt.subplots(1, len(groups), figsize=(8.2 * len(groups), 5.2), squeeze=False)
    for axes, group in zip(row[0], groups):
        _panel(axes, chart, group)
    figure.subplots_adjust(left=0.44 / len(groups), right=1 - 0.1 / len(groups), bottom=0.11, top=0.83, wspace=1.05)
    figure.suptitle(chart.scene.title, x=0.012, y=0.975, ha="left", fontsize=15, fontweight="bold", color=INK)
    caption = "named: beaten by none in both time and error; circles: other methods; diamond: the default"
    figure.text(0.012, 0.895, caption, fontsize=10.5, color=FAINT)
    with replace_whole(path) as beside:
        figure.savefig(beside, dpi=110)
    plt.close(figure)


def _panel(axes, chart, group):
    quantities, front = chart.scene.groups[group], chart.fronts[group]
    solved = [entry for entry in chart.entries if not isnan(entry.worst(quantities))]
    place = {id(e): (e.sample.cpu, 100 * max(e.worst(quantities), LEAST)) for e in solved}
    unsure = 100 * chart.unsure(group)
    axes.set(xscale="log", yscale="log", xlabel="CPU time [s]")
    axes.yaxis.tick_right()
    axes.yaxis.set_label_position("right")
    axes.set_ylabel("largest error [%]", color=INK)
    axes.set_title(group, loc="left", fontsize=13, color=INK)
    others = [place[id(e)] for e in solved if e not in front]
    axes.plot(*zip(*others), "o", ms=6, mfc="white", mec=FAINT, ls="")
    axes.plot(*zip(*(place[id(e)] for e in front)), "o-", ms=8, color=BLUE, lw=1.6)
    first = chart.entries[0]
    axes.plot(*place[id(first)], "D", ms=8, mfc=BLUE if first in front else "white", mec=RED, mew=1.8)
    if first not in front:
        axes.annotate("default", place[id(first)], (9, 5), textcoords="offset points", fontsize=10, color=RED)
    costs, errors = zip(*place.values())
    axes.set_xlim(min(costs) / 2, max(costs) * 2.5)
    bottom, top = log10(min(errors)) - 0.25, log10(max(errors)) + 0.2
    if unsure > 0:
        bottom = min(bottom, log10(unsure) - 0.35)
        axes.axhspan(10**bottom, unsure, color=BAND, zorder=0)
        axes.text(
            0.99, 0.015, f"reference known to ± {unsure:.2g} % ", fontsize=9.5, color="#8c7a4d", ha="right",
            va="bottom", transform=axes.transAxes,
        )  # fmt: skip
    axes.set_ylim(10**bottom, 10**top)
    _name(axes, [(entry.method.name, *place[id(entry)]) for entry in front], bottom, top)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
        axis.set_minor_formatter(NullFormatter())
    axes.grid(alpha=0.3, which="major")
    for side in ("top", "left"):
        axes.spines[side].set_visible(False)
    axes.tick_params(colors=INK, which="both", left=False)


def _name(axes, points, bottom, top):
    """Names beside the axes, at the height of their points where there is room, with a line to each.

    Left of a front and below it there is nothing, by what a front is: no line crosses a point.
    """
    heights = [(log10(error) - bottom) / (top - bottom) for _, _, error in points]
    order = sorted(range(len(points)), key=lambda i: heights[i])
    for _ in range(200):
        for below, above in pairwise(order):
            short = LINE - (heights[above] - heights[below])
            if short > 0:
                heights[above] += 0.5 * short
                heights[below] -= 0.5 * short
        for rank, i in enumerate(order):
            heights[i] = min(max(heights[i], LINE * rank), 1 - LINE * (len(order) - 1 - rank))
    for (name, cost, error), height in zip(points, heights):
        axes.annotate(
            f"{name}   {_percent(error)}", (cost, error), (-0.02, height), textcoords="axes fraction", ha="right",
            va="center", fontsize=10.5, color=INK, annotation_clip=False,
            arrowprops={"arrowstyle": "-", "color": FAINT, "lw": 0.8, "shrinkB": 5, "relpos": (1, 0.5)},
        )  # fmt: skip


def _percent(value):
    return f"{value:.2g} %"
