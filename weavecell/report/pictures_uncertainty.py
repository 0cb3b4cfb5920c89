"""Pictures of scatter and of assumptions: tornado plot, probability of perforation with its shots,
sweeps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from weavecell.report.pictures_style import (
    BLUE,
    COLOURS,
    GREEN,
    INK,
    ORANGE,
    RED,
    legend_below,
)
from weavecell.results.keys import find_axis
from weavecell.runs.go_no_go import LEVELS
from weavecell.runs.measurement import Count
from weavecell.studies.unknown import FRICTIONS

if TYPE_CHECKING:
    from pandas import DataFrame

    from weavecell.runs.passing import Passing
    from weavecell.runs.sweep import Quantity
    from weavecell.runs.v50 import Study

NARROW = (
    5.6  # inch: of a picture that a page shows beside its answer, and a phone as wide as itself
)


def perforation(pyplot: Any, study: Study) -> Any:
    """Draw the share that passes over velocity with its interval, and the shots by outcome."""
    V = np.array([shot.velocity for shot in study.shots])
    hit = np.array([shot.perforated for shot in study.shots])
    figure, axis = pyplot.subplots(figsize=(NARROW, 4.6))
    if study.posterior is not None:
        ends = np.array([*study.posterior.velocities.values()])
        grid = np.linspace(min(V.min(), ends.min()), max(V.max(), ends.max()), 41)
        middle, low, high = np.array(study.posterior.passing(grid)).T
        axis.fill_between(grid, low, high, color=BLUE, alpha=0.18, lw=0, label="90 % interval")
        axis.plot(grid, middle, color=BLUE, label="share that passes")
        for level, (name, span) in zip(LEVELS, study.posterior.velocities.items()):
            axis.plot([span.low, span.high], [level, level], color=ORANGE, lw=3, alpha=0.8)
            axis.plot(span.value, level, "D", color=ORANGE)
            place = {"xytext": (0, 8), "textcoords": "offset points", "ha": "right"}
            axis.annotate(f"{name} {span.value:.3g} ", (span.value, level), **place)
    lift = 0.012 * (np.arange(V.size) % 5)
    axis.plot(V[~hit], (-0.03 - lift)[~hit], "o", ms=5, mfc="none", color=INK, label="stopped")
    axis.plot(V[hit], (1.03 + lift)[hit], "s", ms=4.5, color=RED, label="perforated")
    axis.set(xlabel=find_axis("strike_velocity_m_s").label, ylabel="share that passes [-]")
    axis.set(ylim=(-0.12, 1.12), yticks=np.linspace(0, 1, 6))
    axis.margins(x=0.08)
    legend_below(axis)
    return figure


def plies(pyplot: Any, shares: DataFrame, counts: DataFrame, sure: float) -> Any:
    """Draw the share that stops over the number of plies, a panel a fabric: by the model, and with what tests say
    of it, each with its 90 % interval.

    Parameters
    ----------
    shares, counts : `shares` and `to_dataframe()` of a PliesResult
    sure : share that is asked for
    """
    rows = max(shares["fabric"].nunique(), 1)
    figure, axes = pyplot.subplots(rows, 1, figsize=(NARROW, 1.4 + 2.4 * rows), squeeze=False)
    found = counts.set_index("fabric")
    for axis, (name, one) in zip(axes[:, 0], shares.groupby("fabric", sort=False)):
        words = []
        for colour, label, what, column in (
            (ORANGE, "with what tests say of the model", "tested", "plies"),
            (BLUE, "by the model alone", "model", "plies_by_model"),
        ):
            low, high = one[f"{what}_low"], one[f"{what}_high"]
            axis.fill_between(one["plies"], low, high, color=colour, alpha=0.2, lw=0)
            axis.plot(one["plies"], one[what], "o-", ms=3, color=colour, label=label)
            count = Count(*(int(found[f"{column}{end}"][name]) for end in ("", "_low", "_high")))
            axis.axvline(count.plies, color=colour, lw=0.8, ls="--")
            words.append(count.words())
        axis.axhline(sure, color=INK, lw=0.8, ls=":", label="asked for")
        axis.set_title(f"{name}: plies {words[0]}, by the model {words[1]}", fontsize="medium")
        axis.set(ylabel="share that stops [-]", ylim=(-0.05, 1.05))
        axis.xaxis.get_major_locator().set_params(integer=True)
    axes[-1, 0].set(xlabel="plies [-]")
    legend_below(axes[0, 0])
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
    figure, axes = pyplot.subplots(figsize=(NARROW, 4.2))
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


def draw_passing(pyplot: Any, found: Passing) -> Any:
    """Draw drawn shots over the first two frictions that nobody gave, with what is left of those that
    pass [m/s]; over one friction or their numbers, against residual velocity."""
    known = [FRICTIONS[name] for name in found.unknown][:2]
    hit = np.array([shot.perforated for shot in found.shots])
    left = np.where(hit, [shot.residual for shot in found.shots], 0.0)
    columns = [[shot.drawn[one.column] for shot in found.shots] for one in known]
    labels = [f"{one.words} [-]" for one in known]
    if not known:
        columns, labels = [[shot.number for shot in found.shots]], ["number of the draw"]
    if len(columns) == 1:
        columns, labels = (
            [*columns, left.tolist()],
            [*labels, find_axis("residual_velocity_m_s").label],
        )
    x, y = np.array(columns, float)
    figure, axis = pyplot.subplots(figsize=(NARROW, 4.6))
    axis.plot(x[~hit], y[~hit], "o", ms=9, mfc="none", mew=1.8, color=GREEN, label="stopped")
    label = "perforated"
    if len(known) == 2:
        label = "perforated, with m/s left"
        for at, velocity in zip(zip(x[hit], y[hit]), left[hit]):
            axis.annotate(f"{velocity:.0f}", at, xytext=(7, 4), textcoords="offset points")
        axis.set(xlim=_pad(found, 0), ylim=_pad(found, 1))
    axis.plot(x[hit], y[hit], "s", ms=8, color=RED, label=label)
    axis.set(xlabel=labels[0], ylabel=labels[1])
    axis.locator_params(nbins=5)
    legend_below(axis)
    return figure


def _pad(found, axis):
    """Return the range of a friction, with room for marks at its ends."""
    low, high = [*found.unknown.values()][axis]
    room = 0.06 * (high - low)
    return low - room, high + room
