"""Pictures of two panels side by side."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from weavecell.report.pictures_style import BLUE, FAINT, INK, ORANGE, legend_below, legend_beside
from weavecell.report.pictures_style import COLOURS as COLOURS_OF_MANY
from weavecell.results.keys import find_axis

COLOURS = {"A": BLUE, "B": ORANGE}


def difference(pyplot: Any, result: Any) -> Any:
    """Draw the outcomes of the shots at A and B with the shares that pass; below the difference.

    Parameters
    ----------
    result : weavecell.answers.comparison.ComparisonResult
    """
    figure, (axis, lower) = pyplot.subplots(2, 1, figsize=(5.6, 6), height_ratios=(3, 1))
    for name, one in zip(result.names, (result.a, result.b)):
        colour = COLOURS[name[0]]
        _draw_probability(axis, one, name, colour)
    axis.set(xlabel=find_axis("strike_velocity_m_s").label)
    legend_below(axis, columns=1)
    found = result.difference
    ends = found.span.low, found.span.high
    if np.isfinite(ends).all():
        lower.plot(ends, [0, 0], lw=7, color=FAINT, alpha=0.6, solid_capstyle="butt")
    lower.plot(found.value, 0, "D", color=INK)
    lower.axvline(0, color=INK, lw=1)
    lower.set_yticks([])
    lower.grid(axis="y", visible=False)
    lower.set(xlabel="A less B [m/s]: above 0, A is better")
    return figure


def _draw_probability(axis, result, name, colour):
    """The fitted curve, stops below and perforations above it."""
    shots = result.study.shots
    V = np.array([shot.velocity for shot in shots])
    hit = np.array([shot.perforated for shot in shots])
    lift = 0.05 if name[0] == "B" else 0.0
    label = f"{name}: V50 {result.v50:.3g} m/s"
    posterior = result.study.posterior
    if posterior is None:
        axis.plot([], [], color=colour, label=f"{name}: no V50")
    else:
        grid = np.linspace(V.min(), V.max(), 41)
        axis.plot(grid, [span.value for span in posterior.passing(grid)], color=colour, label=label)
    axis.plot(V[~hit], np.full((~hit).sum(), -0.05 - lift), "o", ms=5, mfc="none", color=colour)
    axis.plot(V[hit], np.full(hit.sum(), 1.05 + lift), "s", ms=4.5, color=colour)
    axis.set(ylabel="share that passes [-]", ylim=(-0.16, 1.16))


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
