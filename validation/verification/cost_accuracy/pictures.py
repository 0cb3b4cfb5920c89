"""The chart of a scene: CPU time against error, a panel for each group of quantities, the Pareto front numbered."""

from __future__ import annotations

from math import isnan, log10
from pathlib import Path
from typing import TYPE_CHECKING

from matplotlib.ticker import FuncFormatter, NullFormatter

from fabrics.files import replace_whole
from meshing.pictures_style import BLUE, FAINT, INK, RED, plots
from validation.verification.cost_accuracy.core import ALIKE

if TYPE_CHECKING:
    from validation.verification.cost_accuracy.core import Chart

BAND = "#f1ead9"
LEAST = 1e-5  # of a value: an error below it is drawn there, and said to be below


def draw(chart: Chart, path: Path) -> None:
    """Write the chart as a PNG."""
    groups = chart.scene.groups
    with plots() as pyplot:
        figure, row = pyplot.subplots(1, len(groups), figsize=(8.4 * len(groups), 5.0), squeeze=False)
        for axes, group in zip(row[0], groups):
            _panel(axes, chart, group)
        figure.suptitle(chart.scene.title, x=0.01, ha="left", fontsize=15, fontweight="bold", color=INK)
        with replace_whole(path) as beside:
            figure.savefig(beside, format="png", dpi=100)


def _panel(axes, chart, group):
    quantities, front = chart.scene.groups[group], chart.fronts[group]
    solved = [entry for entry in chart.entries if not isnan(entry.worst(quantities))]
    place = {id(e): (e.sample.cpu, 100 * max(e.worst(quantities), LEAST)) for e in solved}
    unsure = 100 * chart.unsure(group)
    first, others = chart.entries[0], [place[id(e)] for e in solved if e not in front]
    axes.plot(*zip(*others), "o", ms=6, mfc="white", mec=FAINT, label="other methods")
    points = [place[id(e)] for e in front]
    axes.plot(*zip(*points), "o", ms=9, color=BLUE, label="Pareto-optimal, numbered")
    axes.plot(*zip(*points), drawstyle="steps-post", color=BLUE, lw=1.2, alpha=0.6)
    axes.plot(*place[id(first)], "D", ms=9, mfc="none", mec=RED, mew=1.8, label="default")
    for number, point in enumerate(points, 1):
        axes.annotate(f"{number}", point, (-5, -6), textcoords="offset points", ha="right", va="top", color=BLUE)
    costs, errors = zip(*place.values())
    bottom, top = log10(min(errors)) - 0.3, log10(max(errors)) + 0.2
    alike = max(100 * ALIKE, unsure)
    bottom = min(bottom, log10(alike) - 0.35)
    words = f"reference known to ± {unsure:.2g} %" if unsure > 100 * ALIKE else f"errors below {alike:.2g} %, equal"
    axes.axhspan(10**bottom, alike, color=BAND, zorder=0, label=words)
    axes.set(xscale="log", yscale="log", xlabel="CPU time [s]", ylabel="largest error [%]", title=group)
    axes.set(xlim=(min(costs) / 2, max(costs) * 2), ylim=(10**bottom, 10**top))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
        axis.set_minor_formatter(NullFormatter())
    key = "\n".join(
        f"{number}  {entry.method.name}\n    {_found(place[id(entry)])}" for number, entry in enumerate(front, 1)
    )
    axes.text(1.02, 1.0, key, transform=axes.transAxes, va="top", fontsize=10, color=INK, linespacing=1.35)
    axes.legend(loc="upper left", bbox_to_anchor=(0.0, -0.14), ncols=2, fontsize=10)


def _found(place):
    cost, error = place
    return f"{cost:.2g} s, {'below ' if error <= 100 * LEAST else ''}{error:.2g} %"
