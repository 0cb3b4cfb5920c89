"""The chart of a scene: CPU time against error, a panel for each group of quantities, with three methods named."""

from __future__ import annotations

from math import isnan, log10
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING

from matplotlib.ticker import FuncFormatter, NullFormatter

from fabrics.files import replace_whole
from meshing.pictures_style import BLUE, FAINT, GREEN, ORANGE, plots
from validation.verification.cost_accuracy.core import AIMED, ALIKE

if TYPE_CHECKING:
    from validation.verification.cost_accuracy.core import Chart

BAND = "#eef2f5"
LEAST = 1e-5  # of a value: an error below it is drawn there, and said to be below
MARKS = (("default", "D", ORANGE), (f"cheapest within {100 * AIMED:g} %", "s", BLUE), ("most accurate", "o", GREEN))


def draw(chart: Chart, path: Path) -> None:
    """Write the chart as a PNG."""
    groups = chart.scene.groups
    with plots() as pyplot:
        figure, row = pyplot.subplots(1, len(groups), figsize=(5.4 * len(groups), 5.6), squeeze=False)
        for axes, group in zip(row[0], groups):
            _panel(axes, chart, group)
        with replace_whole(path) as beside:
            figure.savefig(beside, format="png", dpi=100)


def _panel(axes, chart, group):
    """The points of all methods; those of `_named` with a mark, and below the axes their names, costs and errors."""
    quantities = chart.scene.groups[group]
    solved = [entry for entry in chart.entries if not isnan(entry.worst(quantities))]
    place = {id(e): (e.sample.cpu, 100 * max(e.worst(quantities), LEAST)) for e in solved}
    unsure = 100 * chart.unsure(group)
    chosen = _named(chart, group)
    others = [place[id(e)] for e in solved if not any(e is one for one in chosen if one)]
    axes.plot(*zip(*others), "o", ms=4.5, mfc="white", mec=FAINT, mew=0.9, label="other methods")
    for (what, mark, colour), entry, size in zip(MARKS, chosen, (13, 9, 6)):
        if entry is not None:
            text = fill(f"{what}: {_name(entry)}{_found(place[id(entry)])}", 46, subsequent_indent="   ")
            axes.plot(*place[id(entry)], mark, ms=size, color=colour, mec="white", mew=0.8, label=text)
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
    handles, labels = axes.get_legend_handles_labels()
    order = [*range(1, len(labels) - 1), 0, len(labels) - 1]
    shown = [handles[k] for k in order], [labels[k] for k in order]
    axes.legend(*shown, loc="upper left", bbox_to_anchor=(-0.12, -0.16), fontsize=10)


def _named(chart, group):
    """(default, cheapest within `AIMED`, most accurate on the front): entries, None where there is none."""
    quantities, front = chart.scene.groups[group], chart.fronts[group]
    good = [entry for entry in front if entry.worst(quantities) <= AIMED]
    return chart.entries[0], good[0] if good else None, front[-1]


def _name(entry):
    name = entry.method.name.removeprefix("default").removeprefix(": ")
    return f"{name}, " if name else ""


def _found(place):
    cost, error = place
    return f"{cost:.2g}\N{NO-BREAK SPACE}s, {'below ' if error <= 100 * LEAST else ''}{error:.2g}\N{NO-BREAK SPACE}%"
