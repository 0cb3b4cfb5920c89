"""Pictures of two panels side by side."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from weavecell.report.pictures_style import BLUE, FAINT, INK, ORANGE, legend_beside
from weavecell.report.pictures_style import COLOURS as COLOURS_OF_MANY
from weavecell.results.keys import find_axis

if TYPE_CHECKING:
    from weavecell.studies.interval_difference import IntervalDifference

COLOURS = {"A": BLUE, "B": ORANGE}


def difference(pyplot: Any, result: Any) -> Any:
    """Draw the outcomes of the shots at A and B with the curves of V50, or residual velocities about
    the limits; below the difference with what widens it.

    Parameters
    ----------
    result : weavecell.api.comparison.ComparisonResult
    """
    figure, (axis, lower) = pyplot.subplots(2, 1, figsize=(9, 7.4), height_ratios=(2.2, 1))
    for name, one in zip(result.names, (result.a, result.b)):
        colour = COLOURS[name[0]]
        if result.quantity == "v50":
            _draw_probability(axis, one, name, colour)
        else:
            _draw_residuals(axis, one, name, colour)
    axis.set(xlabel=find_axis("strike_velocity_m_s").label)
    legend_beside(axis)
    found = result.difference
    bars = {"by the shots": (found.low, found.high)}
    around = result.assumed_range
    if around is not None:
        bars["with what is assumed"] = result.interval
    for row, ends in enumerate(bars.values()):
        if np.isfinite(ends).all():
            lower.plot(ends, [row, row], lw=7, color=FAINT, alpha=0.6, solid_capstyle="butt")
        lower.plot(found.value, row, "D", color=INK)
    lower.axvline(0, color=INK, lw=1)
    lower.set_yticks(range(len(bars)), bars)
    lower.set_ylim(len(bars) - 0.4, -0.6)
    lower.grid(axis="y", visible=False)
    lower.set(xlabel="A less B [m/s]: above 0, A is better")
    return figure


def draw_pairs(pyplot: Any, difference: IntervalDifference) -> Any:
    """Draw the difference of each pair of runs, with places and frictions at its side, and the band of
    all."""
    pairs = difference.pairs
    figure, axes = pyplot.subplots(figsize=(9, 1.8 + 0.62 * len(pairs)))
    for row, pair in enumerate(pairs):
        found = pair.subtract()
        if found is not None:
            value, *ends = found
            axes.plot(ends, [row, row], lw=7, color=FAINT, alpha=0.6, solid_capstyle="butt")
            axes.plot(value, row, "D", color=INK)
    if (span := difference.span()) is not None:
        axes.axvspan(*span, color=FAINT, alpha=0.15, lw=0)
    axes.axvline(0, color=INK, lw=1)
    names = []
    for pair in pairs:
        of_a, of_b = pair.a.name, pair.b.name
        alike = of_a == of_b
        names.append(of_a if alike else f"A: {of_a}\nB: {of_b}")
    axes.set_yticks(range(len(pairs)), names)
    axes.set_ylim(len(pairs) - 0.4, -0.6)
    axes.grid(axis="y", visible=False)
    axes.set(xlabel="A less B [m/s]: above 0, A is better")
    return figure


def _draw_probability(axis, result, name, colour):
    """The fitted curve, stops below and perforations above it."""
    shots = result.study.shots
    V = np.array([shot.velocity for shot in shots])
    hit = np.array([shot.perforated for shot in shots])
    lift = 0.05 if name[0] == "B" else 0.0
    curve = result.study.curves["probit"]
    label = f"{name}: V50 {curve.V50:.1f} m/s"
    if curve.reason:
        axis.plot([], [], color=colour, label=f"{name}: no V50")
    else:
        grid = np.linspace(V.min(), V.max(), 300)
        axis.plot(grid, curve.probability(grid), color=colour, label=label)
    axis.plot(V[~hit], np.full((~hit).sum(), -0.05 - lift), "o", ms=5, mfc="none", color=colour)
    axis.plot(V[hit], np.full(hit.sum(), 1.05 + lift), "s", ms=4.5, color=colour)
    axis.set(ylabel="probability of perforation [-]", ylim=(-0.16, 1.16))


def _draw_residuals(axis, result, name, colour):
    """Residual velocities, and the bracket or the zone of mixed outcomes."""
    V = [shot.strike_velocity for shot in result.shots]
    residual = [shot.residual_velocity for shot in result.shots]
    axis.plot(V, residual, "o", ms=5, color=colour, label=name)
    axis.axvspan(*(result.mixed_zone or result.bracket), color=colour, alpha=0.35, lw=1)
    axis.set(ylabel=find_axis("residual_velocity_m_s").label)


def draw_shots(pyplot: Any, shots: Mapping[str, Any]) -> Any:
    """Draw velocity, deflection and contact force of several shots over time.

    Parameters
    ----------
    shots : {name: ShotResult}
    """
    figure, axes = pyplot.subplots(3, 1, figsize=(9, 9), sharex=True)
    time, *others = (
        find_axis(name, "histories") for name in ("time", "velocity", "deflection", "contact_force")
    )
    for number, (name, shot) in enumerate(shots.items()):
        looks = {"color": COLOURS_OF_MANY[number % len(COLOURS_OF_MANY)], "label": name}
        histories = shot.velocity, shot.deflection, shot.contact_force
        for axis, shown, values in zip(axes, others, histories):
            axis.plot(time.factor * shot.time, shown.factor * values, **looks)
    for axis, shown in zip(axes, others):
        axis.set(ylabel=shown.label)
    axes[-1].set(xlabel=time.label)
    legend_beside(axes[0])
    return figure


def draw_residuals(pyplot: Any, tables: Mapping[str, tuple[Any, Any]]) -> Any:
    """Draw residual against strike velocity [m/s] of several results.

    Parameters
    ----------
    tables : {name: (strike, residual velocities)} [m/s]
    """
    figure, axis = pyplot.subplots(figsize=(9, 5))
    for number, (name, (strike, residual)) in enumerate(tables.items()):
        colour = COLOURS_OF_MANY[number % len(COLOURS_OF_MANY)]
        axis.plot(strike, residual, "o", ms=5, color=colour, label=name)
    strike_axis, residual_axis = map(find_axis, ("strike_velocity_m_s", "residual_velocity_m_s"))
    axis.set(xlabel=strike_axis.label, ylabel=residual_axis.label)
    legend_beside(axis)
    return figure
