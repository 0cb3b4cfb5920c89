"""The picture of a map: a cell for each point, coloured by what happened, the default and its margin."""

from __future__ import annotations

from pathlib import Path
from textwrap import wrap

import matplotlib

from validation.verification.stability.core import Found

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.patches import Patch

from fabrics.files import replace_whole
from meshing.pictures_style import BLUE, FAINT, INK
from validation.verification.stability.core import FAILED, STABLE, WRONG

KINDS = {STABLE: "#cfe8dc", WRONG: "#f5d998", FAILED: "#eda58c"}
CELL = 0.62, 0.46  # inches


def draw(found: Found, path: Path) -> None:
    """Write the map as a PNG."""
    chart, outcomes = found.map, found.outcomes
    columns, rows = len(chart.x.values), len(chart.y.values)
    small = columns > 14
    labels = max(len(chart.y.label(y)) for y in chart.y.values)
    left = 0.55 + 0.085 * labels
    width, height = max(CELL[0] * columns, 4.6), max(CELL[1] * rows, 1.75) if not small else 0.3 * rows
    if small:
        width = 0.42 * columns
    total = max(left + width + 0.4, 8.8), 1.5 + height + 1.15
    figure = plt.figure(figsize=total)
    axes = figure.add_axes((left / total[0], 1.5 / total[1], width / total[0], height / total[1]))
    order = list(KINDS)
    numbers = [[order.index(outcomes[x, y].kind) for x in chart.x.values] for y in chart.y.values]
    colours = ListedColormap(list(KINDS.values()))
    axes.pcolormesh(numbers, cmap=colours, norm=BoundaryNorm([-0.5, 0.5, 1.5, 2.5], 3), edgecolors="white", lw=1.5)
    for j, y in enumerate(chart.y.values):
        for i, x in enumerate(chart.x.values):
            outcome = outcomes[x, y]
            text = "" if outcome.value is None else _number(outcome.value)
            axes.text(i + 0.5, j + 0.5, text, ha="center", va="center", fontsize=7.5 if small else 9, color=INK)
    axes.set_xticks([i + 0.5 for i in range(columns)], [chart.x.label(x) for x in chart.x.values])
    axes.set_yticks([j + 0.5 for j in range(rows)], [chart.y.label(y) for y in chart.y.values])
    axes.set_xlabel(chart.x.name, color=INK)
    axes.set_ylabel(chart.y.name, color=INK)
    axes.tick_params(length=0, colors=INK, labelsize=9 if small else 10)
    for side in axes.spines.values():
        side.set_visible(False)
    if chart.default is not None:
        _default(axes, found)
    figure.text(0.015, 1 - 0.3 / total[1], chart.title, fontsize=14, fontweight="bold", color=INK, va="center")
    caption = f"numbers: {chart.number}" if chart.number else ""
    figure.text(0.015, 1 - 0.62 / total[1], caption, fontsize=10, color=FAINT, va="center")
    there = [kind for kind in KINDS if found.count(kind)]
    names = {STABLE: "stable", WRONG: f"wrong: {chart.wrong}", FAILED: f"failed: {chart.failed}"}
    handles = [Patch(color=KINDS[kind], label="\n".join(wrap(names[kind], 105))) for kind in there]
    figure.legend(
        handles=handles, loc="lower left", bbox_to_anchor=(0.005, 0.0), frameon=False, fontsize=10, labelcolor=INK,
        labelspacing=0.3,
    )  # fmt: skip
    with replace_whole(path) as beside:
        figure.savefig(beside, dpi=110)
    plt.close(figure)


def _default(axes, found):
    """A frame about the default, and its margins."""
    chart, (x, y) = found.map, found.map.default
    i, j = chart.x.values.index(x), chart.y.values.index(y)
    axes.add_patch(plt.Rectangle((i + 0.05, j + 0.07), 0.9, 0.86, fill=False, ec=BLUE, lw=2.2))
    notes = [
        f"margin {edge.side} {'' if edge.met else 'at least '}{edge.margin:.3g}" for edge in found.edges if edge.y == y
    ]
    axes.text(
        1.0, 1.02, "framed: the default" + "".join(f"; {text}" for text in notes), transform=axes.transAxes, ha="right",
        va="bottom", fontsize=10, color=BLUE,
    )  # fmt: skip


def _number(value):
    if isinstance(value, int):
        return str(value)
    return f"{value:.0f}" if abs(value) >= 9.95 else f"{value:.1f}" if abs(value) >= 0.05 else "0"
