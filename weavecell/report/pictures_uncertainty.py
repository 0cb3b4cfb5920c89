"""Pictures of scatter and of assumptions: tornado plot, probability of perforation with its shots,
sweeps."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base.counted import counted
from weavecell.report.pictures_style import (
    BLUE,
    COLOURS,
    FAINT,
    GREEN,
    INK,
    ORANGE,
    RED,
    legend_beside,
)
from weavecell.results.keys import find_axis
from weavecell.studies import probit

if TYPE_CHECKING:
    from pandas import DataFrame

    from weavecell.studies.assumed_range import AssumedRange
    from weavecell.studies.interval import Interval
    from weavecell.studies.sweep import Quantity
    from weavecell.studies.v50 import Study

ANSWER = 84  # letters of a line of the title of an interval
LINE = 0.26  # inch: of such a line

_PROBABILITIES = np.linspace(0.01, 0.99, 33)


def tornado(pyplot: Any, around: AssumedRange, title: str) -> Any:
    """Draw the lowest and highest velocity over each assumed range alone, the widest on top, with
    its share; all together."""
    nominal = around.rows[0].velocity or 0.0
    y = np.arange(len(around.widths))
    low, high = np.array(list(around.widths.values())).T
    figure, axis = pyplot.subplots(figsize=(9, 1.8 + 0.42 * y.size))
    axis.axvspan(around.low, around.high, color=FAINT, alpha=0.25, lw=0, label="all runs")
    for ends, colour, label in ((low, BLUE, "below nominal"), (high, ORANGE, "above nominal")):
        axis.barh(y, ends - nominal, 0.62, left=nominal, color=colour, label=label)
    axis.axvline(nominal, color=INK, lw=1.2, label=f"nominal, {nominal:.1f} m/s")
    axis.set_yticks(y, [f"{name}, {100 * share:.0f} %" for name, share in around.shares.items()])
    axis.invert_yaxis()
    axis.grid(axis="y", visible=False)
    axis.set(xlabel=f"{around.quantity} [m/s]", title=title)
    legend_beside(axis)
    return figure


def perforation(pyplot: Any, study: Study, title: str) -> Any:
    """Draw the fitted curves with the interval of the probit, shots, and limit without scatter;
    residual velocities below."""
    V = np.array([shot.velocity for shot in study.shots])
    hit = np.array([shot.perforated for shot in study.shots])
    curve = study.curves["probit"]
    figure, (axis, lower) = pyplot.subplots(
        2, 1, figsize=(9, 9.4), sharex=True, height_ratios=(1.3, 1)
    )
    left = V.min() - 2
    right = V.max() + 2
    if not curve.reason:
        edges = probit.band(V, hit, curve, _PROBABILITIES)
        ends = np.maximum(edges[:, 0], left), np.minimum(edges[:, 1], right)
        label = f"{100 * curve.confidence:g} % of the probit, with a prior"
        axis.fill_betweenx(_PROBABILITIES, *ends, color=BLUE, alpha=0.18, lw=0, label=label)
        grid = np.linspace(left, right, 400)
        logit = study.curves["logit"].probability(grid)
        axis.plot(grid, curve.probability(grid), color=BLUE, label="probit")
        axis.plot(grid, logit, color=GREEN, ls="--", label="logit")
    lift = 0.012 * (np.arange(V.size) % 5)
    residual = np.array([shot.residual for shot in study.shots])
    for axes, stopped, through in (
        (axis, -0.03 - lift, 1.03 + lift),
        (lower, residual, residual),
    ):
        axes.plot(V[~hit], stopped[~hit], "o", ms=5, mfc="none", color=INK, label="stopped")
        axes.plot(V[hit], through[hit], "s", ms=4.5, color=RED, label="perforated")
    parts = np.array_split(np.argsort(V), max(1, V.size // 10))
    places = [V[part].mean() for part in parts]
    shares = [hit[part].mean() for part in parts]
    if parts[1:]:
        label = f"share of {counted(len(parts[-1]), 'shot')}"
    else:
        label = f"share of all {counted(V.size, 'shot')}"
    axis.plot(places, shares, "D", ms=6, color=FAINT, label=label)
    axis.axvspan(
        *study.deterministic,
        color=ORANGE,
        alpha=0.8,
        lw=1,
        label="limit without scatter",
    )
    axis.set(ylabel="probability of perforation [-]", title=title)
    axis.set(xlim=(left, right), ylim=(-0.12, 1.12), yticks=np.linspace(0, 1, 6))
    legend_beside(axis)
    fit = study.lambert_jonas
    if not fit.reason:
        lower.plot(*fit.sample(right), color=BLUE, label="Lambert-Jonas")
    lower.set(
        xlabel=find_axis("strike_velocity_m_s").label,
        ylabel=find_axis("residual_velocity_m_s").label,
    )
    legend_beside(lower)
    return figure


def label_quantity(quantity: Quantity) -> str:
    """Write the label of the axis of what a sweep computes."""
    return find_axis(quantity.column).label + quantity.note


def sweep(
    pyplot: Any,
    x: Sequence[Any],
    label: str,
    table: DataFrame,
    others: Sequence[str],
    quantity: Quantity,
) -> Any:
    """Draw a quantity against the first key of a sweep, a line for each combination of the other
    keys.

    Parameters
    ----------
    x, label : values of the first key, numbers or texts, of each row, and the label of the axis
    table : a row each
    others : the other keys, columns of the table
    """
    figure, axes = pyplot.subplots(figsize=(9, 5))
    table = table.reindex(
        columns=list(dict.fromkeys((*table, quantity.column, *(quantity.ends or ()))))
    )
    table = table.assign(x=x)
    # mixed outcomes, and what nobody knows, have no single value: bars about the middle stand for it
    if quantity.ends is not None:
        middle = table[list(quantity.ends)].astype(float).mean(axis=1)
        table[quantity.column] = table[quantity.column].astype(float).fillna(middle)
    table = table.dropna(subset=[quantity.column])
    groups = table.groupby(list(others) or (lambda _: 0), sort=False)
    for number, (values, rows) in enumerate(groups):
        y = rows[quantity.column]
        error = None
        if quantity.ends is not None:
            low, high = (rows[end] for end in quantity.ends)
            error = np.maximum([y - low, high - y], 0)
        given = np.atleast_1d(np.array(values, object))
        name = ", ".join(f"{key} = {value}" for key, value in zip(others, given))
        # nothing lies between two texts, such as names of fabrics
        line = "o" if isinstance(x[0], str) else "o-"
        if quantity.is_span:
            line = "none"
        look: dict[str, Any] = {"fmt": line, "ms": 6, "capsize": 4, "label": name or None}
        if quantity.is_span:
            # bars at one place: each is drawn within the one before
            colour = COLOURS[number % len(COLOURS)]
            look |= {"color": colour, "elinewidth": max(12 - 4 * number, 2), "capsize": 7}
        axes.errorbar(rows["x"], y, yerr=error, **look)
    axes.set(xlabel=label, ylabel=label_quantity(quantity))
    _, top = axes.get_ylim()
    axes.set_ylim(0, 1.05 * top)
    axes.margins(x=0.05)
    if others:
        axes.legend(loc="best")
    return figure


def one_at_a_time(pyplot: Any, changes: Sequence[str], table: DataFrame, quantity: Quantity) -> Any:
    """Draw a quantity of each row of a sweep, with what the row changes at its side; the first row
    changes nothing."""
    figure, axes = pyplot.subplots(figsize=(9, 1.8 + 0.42 * len(changes)))
    if quantity.is_span:
        assert quantity.ends is not None
        low, high = (table[end].astype(float) for end in quantity.ends)
        axes.hlines(range(len(changes)), low, high, color=BLUE, lw=5)
        # of two ends that are one
        axes.plot(low, range(len(changes)), "|", color=BLUE, ms=12, mew=2)
        axes.axvspan(low[0], high[0], color=FAINT, alpha=0.25, lw=0)
    else:
        values = table.reindex(columns=[quantity.column])[quantity.column].astype(float)
        axes.plot(values, range(len(changes)), "o", color=BLUE)
        axes.axvline(values[0], color=FAINT, lw=1)
    axes.set_yticks(range(len(changes)), changes)
    axes.invert_yaxis()
    axes.set(xlabel=label_quantity(quantity))
    return figure


def draw_interval(pyplot: Any, interval: Interval, label: str) -> Any:
    """Draw the value of each run of an interval below its answer, with place and frictions at its
    side; a ring is a stop, and the band all runs.

    Parameters
    ----------
    label : of the axis of velocities
    """
    runs = interval.runs
    answer = textwrap.wrap(interval.words(), ANSWER)
    height = 1.8 + 0.42 * len(runs) + LINE * len(answer)
    figure, axes = pyplot.subplots(figsize=(9, height))
    figure.suptitle("\n".join(answer))
    for row, run in enumerate(runs):
        look: dict[str, Any] = {"color": BLUE}
        if run.outcome == "stopped":
            look = {"mfc": "white", "mec": GREEN, "mew": 1.8}
        elif run.outcome == "perforated":
            look = {"color": RED}
        ends = [run.row.get(name) for name in ("lower_m_s", "upper_m_s")]
        if None not in ends:
            axes.plot(ends, [row, row], "-", color=BLUE, lw=1.5)
        if run.value is not None:
            axes.plot([run.value], [row], "o", ms=7, **look)
    if interval.low is not None and interval.high is not None:
        axes.axvspan(interval.low, interval.high, color=FAINT, alpha=0.25, lw=0)
    axes.set_yticks(range(len(runs)), [run.name for run in runs])
    axes.set_ylim(len(runs) - 0.5, -0.5)
    axes.set(xlabel=label)
    return figure
