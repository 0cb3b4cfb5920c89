"""The picture of a map: a cell for each point, coloured by what happened, the default and its margin."""

from __future__ import annotations

from pathlib import Path
from textwrap import wrap
from typing import Any

from fabrics.files import replace_whole
from meshing.pictures_style import BLUE, FAINT, INK, plots
from validation.verification.stability.core import FAILED, STABLE, WRONG, Found

KINDS = {STABLE: "#cfe2ef", WRONG: "#f5d998", FAILED: "#d98468"}
CELL = 0.62, 0.46  # inches
DENSE = 14  # columns from which on cells have no numbers


def pictured(found: Found) -> bool:
    """Whether a map says more as a picture: not one of a kind, and not one of one or two rows."""
    return len(found.map.y.values) > 2 and found.count(STABLE) < len(found.outcomes)


def draw(found: Found, path: Path) -> None:
    """Write the map as a PNG."""
    with plots() as pyplot:
        figure = compose(pyplot, found)
        with replace_whole(path) as beside:
            figure.savefig(beside, format="png", dpi=110)


def compose(pyplot: Any, found: Found) -> Any:
    """The figure of a map; a cell that is wrong by a criterion other than its number's has a mark."""
    chart, outcomes = found.map, found.outcomes
    columns, rows = len(chart.x.values), len(chart.y.values)
    dense = columns > DENSE
    labels = 0.1 * max(len(chart.y.label(y)) for y in chart.y.values)
    width, height = (0.3 * columns, 0.24 * rows) if dense else (CELL[0] * columns, CELL[1] * rows)
    figure, axes = pyplot.subplots(figsize=(max(1.4 + labels + width, 7.2), 2.5 + height))
    order = list(KINDS)
    numbers = [[order.index(outcomes[x, y].kind) for x in chart.x.values] for y in chart.y.values]
    axes.pcolormesh(numbers, cmap=pyplot.matplotlib.colors.ListedColormap(list(KINDS.values())), vmin=0, vmax=2,
                    edgecolors="white", lw=0.5 if dense else 1.5)  # fmt: skip
    marked = []
    for j, y in enumerate(chart.y.values):
        for i, x in enumerate(chart.x.values):
            outcome = outcomes[x, y]
            if outcome.value is not None and not dense:
                axes.text(i + 0.5, j + 0.5, number(outcome.value), ha="center", va="center", fontsize=10)
            if outcome.kind == WRONG and outcome.message and not dense:
                marked.append((i + 0.87, j + 0.78))
    if marked:
        axes.plot(*zip(*marked), "D", ms=4, color=INK, ls="")
    skipped = 2 if dense else 1
    for name, axis in (("x", chart.x), ("y", chart.y)):
        places = [k + 0.5 for k in range(len(axis.values))]
        getattr(axes, f"set_{name}ticks")(places[::skipped], [axis.label(v) for v in axis.values[::skipped]])
    axes.set(xlabel=chart.x.name, ylabel=chart.y.name)
    axes.tick_params(length=0)
    axes.grid(False)
    axes.spines[:].set_visible(False)
    note = f"numbers: {chart.number}" if chart.number and not dense else ""
    axes.set_title(chart.title, pad=40)
    axes.text(0, 1.02, note, transform=axes.transAxes, va="bottom", fontsize=10, color=FAINT)
    if chart.default is not None:
        _default(pyplot, axes, found)
    _legend(pyplot, figure, found, bool(marked))
    return figure


def _legend(pyplot, figure, found, marked):
    """What the colours mean, and the mark."""
    chart = found.map
    words = {STABLE: "stable", WRONG: f"wrong: {chart.wrong}", FAILED: f"failed: {chart.failed}"}
    if len(chart.x.values) > DENSE:  # cells without numbers
        words = {kind: f"{found.count(kind)} of {len(found.outcomes)} points {text}" for kind, text in words.items()}
    handles = [
        pyplot.matplotlib.patches.Patch(color=KINDS[kind], label="\n".join(wrap(words[kind], 80)))
        for kind in KINDS
        if found.count(kind)
    ]
    if marked:
        first = next(o.message for o in found.outcomes.values() if o.kind == WRONG and o.message)
        text = "\n".join(wrap(f"with a criterion other than the number, such as: {first}", 80))
        handles.append(pyplot.Line2D([], [], marker="D", ms=5, color=INK, ls="", label=text))
    figure.legend(handles=handles, loc="outside lower left", fontsize=10, labelspacing=0.3)


def _default(pyplot, axes, found):
    """A frame about the default, and its margins."""
    chart, (x, y) = found.map, found.map.default
    i, j = chart.x.values.index(x), chart.y.values.index(y)
    axes.add_patch(pyplot.Rectangle((i + 0.05, j + 0.07), 0.9, 0.86, fill=False, ec=BLUE, lw=2.2))
    notes = [
        f"margin {edge.side} {'' if edge.met else 'at least '}{edge.margin:.3g}" for edge in found.edges if edge.y == y
    ]
    text = "framed: the default" + "".join(f"; {each}" for each in notes)
    axes.text(0, 1.02, text + "\n", transform=axes.transAxes, va="bottom", fontsize=10, color=BLUE)


def number(value: float) -> str:
    """The value of a point as a short text."""
    if isinstance(value, int):
        return str(value)
    return f"{value:.0f}" if abs(value) >= 9.95 else f"{value:.1f}" if abs(value) >= 0.05 else "0"
