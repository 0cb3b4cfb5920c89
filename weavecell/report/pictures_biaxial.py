"""Pictures of a fit to biaxial tests: measured against computed, residuals, profiles of the
constants."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from weavecell.report.pictures_style import BLUE, COLOURS, FAINT, INK

if TYPE_CHECKING:
    from unitcell3d.identify.solid_record import SolidFit
    from weavecell.studies.biaxial_fit import BiaxialFit, Comparison

WIDTH = 9.0
# rises of the sum of squares over s^2 that a profile shows
HIGHEST = 8.0


def draw_tests(pyplot: Any, found: BiaxialFit, title: str) -> Any:
    """Draw load per yarn against the fabric's strain: measured points, and the fitted cell."""
    figure, panels = pyplot.subplots(1, 2, figsize=(WIDTH, 4.8))
    for m, (axes, family) in enumerate(zip(panels, ("warp", "weft"))):
        for one, colour in zip(found.comparisons, _colours(found)):
            strain, load, computed = _curve(one, m)
            if not strain.size:
                continue
            dash = "-" if one.fitted else "--"
            axes.plot(strain, load, ".", ms=4, color=colour, alpha=0.5)
            axes.plot(strain, computed, dash, color=colour, label=f"{one.name}, {one.role}")
        axes.set(xlabel=f"strain along the {family} [%]", ylabel=f"load of a {family} yarn [N]")
        axes.axhline(0.0, color=INK, lw=0.6)
        axes.legend()
    figure.suptitle(title)
    return figure


def draw_pulls(pyplot: Any, fit: SolidFit) -> Any:
    """Draw load per yarn against the fabric's strain: measured points, the crossover with the fitted
    solid, and with that of the file."""
    figure, panels = pyplot.subplots(1, 2, figsize=(WIDTH, 4.8))
    for m, (axes, family) in enumerate(zip(panels, ("warp", "weft"))):
        for k, one in enumerate(fit.pulls):
            colour = COLOURS[k % len(COLOURS)]
            strain = 100 * one.strain[:, m]
            dash = "-" if one.fitted else "--"
            axes.plot(strain, one.load[:, m], ".", ms=4, color=colour, alpha=0.5)
            axes.plot(strain, one.before[:, m], ":", lw=1, color=colour)
            axes.plot(
                strain, one.computed[:, m], dash, color=colour, label=f"{one.name}, {one.role}"
            )
        axes.set(xlabel=f"strain along the {family} [%]", ylabel=f"load of a {family} yarn [N]")
        axes.axhline(0.0, color=INK, lw=0.6)
        axes.legend()
    return figure


def draw_residuals(pyplot: Any, found: BiaxialFit) -> Any:
    """Draw measured less computed loads against the strain."""
    figure, panels = pyplot.subplots(1, 2, figsize=(WIDTH, 3.4))
    for m, (axes, family) in enumerate(zip(panels, ("warp", "weft"))):
        for one, colour in zip(found.comparisons, _colours(found)):
            strain, load, computed = _curve(one, m)
            if not strain.size:
                continue
            marks = ".-" if one.fitted else "x--"
            axes.plot(strain, load - computed, marks, ms=4, lw=0.6, color=colour, label=one.name)
        axes.axhline(0.0, color=INK, lw=0.8)
        axes.set(xlabel=f"strain along the {family} [%]", ylabel="measured less computed [N]")
        axes.legend()
    return figure


def draw_profiles(pyplot: Any, found: BiaxialFit) -> Any:
    """Draw how far the least sum of squares rises about a and b, the other constants fitted
    again."""
    shown = found.profiles
    figure, panels = pyplot.subplots(
        1, len(shown), figsize=(WIDTH, 3.4), sharey=True, squeeze=False
    )
    for axes, (name, (places, rises)) in zip(panels[0], shown.items()):
        constant = found.values[name]
        axes.plot(1e3 * places, rises, ".-", color=BLUE)
        for end in (constant.low, constant.high):
            if np.isfinite(end):
                axes.axvline(1e3 * end, color=FAINT, ls=":")
        unit = {"a": "mm", "b": "mm N^(1/3)"}[name]
        axes.set(xlabel=f"{name} [{unit}]", ylim=(0, HIGHEST))
    panels[0, 0].set(ylabel="rise of the sum of squares / s²")
    return figure


def _curve(one: Comparison, m: int) -> tuple[Any, Any, Any]:
    """Strain [%], measured and computed load [N] of a family where it was measured."""
    known = np.isfinite(one.test.load[:, m])
    return (
        100 * one.test.strain[known, m],
        one.test.load[known, m],
        one.computed[known, m],
    )


def _colours(found: BiaxialFit) -> list[str]:
    """A colour of each test."""
    return [COLOURS[k % len(COLOURS)] for k in range(len(found.comparisons))]
