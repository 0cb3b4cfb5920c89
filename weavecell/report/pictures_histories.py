"""Plots of what was recorded along yarns, from arrays in SI units to matplotlib figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from weavecell.report.pictures_style import (
    COLOURS,
    INK,
    ORANGE,
    RED,
    WARP,
    WEFT,
    legend_beside,
    tension_map,
)
from weavecell.results.display import MM, US
from weavecell.results.keys import find_axis

if TYPE_CHECKING:
    from shellfabric.loop.histories import YarnHistory

TIME = find_axis("time", "histories")
PLACE, TENSION, STRAIN = (find_axis(name, "yarn") for name in ("X", "tension", "strain"))
# at which the strain along a yarn is drawn
_INSTANTS = 8
_WAVES = {"longitudinal": INK, "transverse": RED}


def tensions(pyplot: Any, t: np.ndarray, yarns: Any, places: Sequence[float]) -> Any:
    """Draw tension and strain through time at positions along yarns, one panel a yarn.

    Parameters
    ----------
    t : (n,) [s]
    yarns : sequence of shellfabric.loop.histories.YarnHistory
    places : [m] along the yarns, from the impact point
    """
    figure, grid = _panels(pyplot, len(yarns), 3.6)
    figure.get_layout_engine().set(wspace=0.06)
    for axes, yarn in zip(grid, yarns):
        for place, colour in zip(places, (COLOURS * 3)):
            k = yarn.element_at(place)
            axes.plot(
                US * t, yarn.tension[:, k], color=colour, lw=1.8, label=f"{MM * yarn.X[k]:.1f} mm"
            )
        axes.set(title=name(yarn), xlabel=TIME.label, ylabel=TENSION.label)
        axes.set_xlim(0, US * t[-1])
        axes.set_ylim(bottom=0)
        strain = axes.secondary_yaxis("right", functions=_percent(yarn.EA))
        strain.set_ylabel(STRAIN.label)
        strain.spines["right"].set_visible(True)
        axes.legend(loc="upper left", title="from the impact point", fontsize=10, title_fontsize=10)
    return figure


def _percent(EA):
    return (lambda tension: 100 * tension / EA), (lambda strain: 0.01 * strain * EA)


def fronts(pyplot: Any, t: np.ndarray, yarns: Any, waves: Any) -> Any:
    """Draw tension over place and time, with the fronts and the lines through them, one panel a
    yarn.

    Parameters
    ----------
    t, yarns : as in `tensions`
    waves : sequence of weavecell.results.wave_fronts.Front
    """
    figure, grid = _panels(pyplot, len(yarns), 4.6)
    top = max(float(np.max(yarn.tension)) for yarn in yarns)
    for axes, yarn in zip(grid, yarns):
        side = yarn.X > 0
        X = MM * yarn.X[side]
        image = axes.pcolormesh(
            X,
            US * t,
            yarn.tension[:, side],
            cmap=tension_map(),
            vmin=0,
            vmax=top,
            rasterized=True,
            shading="nearest",
        )
        for wave in waves:
            if wave.family != yarn.family or wave.time.size == 0:
                continue
            axes.plot(MM * wave.place, US * wave.time, ".", ms=4, color=_WAVES[wave.kind])
            if np.isfinite(wave.speed):
                ends = np.array([0.0, MM * wave.place.max()])
                label = f"{wave.kind}, {wave.speed:.0f} m/s"
                axes.plot(ends, US * (wave.start + ends / MM / wave.speed), color=ORANGE, lw=1.6)
                axes.plot([], [], color=_WAVES[wave.kind], marker=".", ls="-", label=label)
        axes.set(
            title=name(yarn),
            xlabel=PLACE.label,
            ylabel=TIME.label,
        )
        axes.set(xlim=(0, X[-1]), ylim=(0, US * t[-1]))
        axes.grid(False)
        axes.legend(loc="lower center", bbox_to_anchor=(0.5, -0.3), ncols=2, fontsize=10)
    bar = figure.colorbar(image, ax=list(grid), shrink=0.9, pad=0.01, label=TENSION.label)
    bar.outline.set_visible(False)
    return figure


def strains(pyplot: Any, t: np.ndarray, yarns: Any) -> Any:
    """Draw the strain of the fibres along yarns at instants from the first record to the last, one panel
    a yarn, with the foot of the cone at each instant. All panels have one scale of strain and one of
    time.

    Parameters
    ----------
    t, yarns : as in `tensions`
    """
    figure, grid = _panels(pyplot, len(yarns), 4.2)
    chosen = np.unique(np.linspace(0, len(t) - 1, _INSTANTS + 1).round().astype(int)[1:])
    # from light to dark as time goes on
    scale = pyplot.cm.ScalarMappable(
        pyplot.Normalize(-0.25 * US * t[-1], US * t[-1]), tension_map()
    )
    top = 0.0
    for axes, yarn in zip(grid, yarns):
        radius = yarn.cone_radius
        side = yarn.X > 0
        X = MM * yarn.X[side]
        for k in chosen:
            strain = 100 * yarn.strain[k, side]
            top = max(top, float(strain.max()))
            colour = scale.to_rgba(US * t[k])
            axes.plot(X, strain, color=colour, lw=1.6, label=f"{US * t[k]:.0f} µs")
            if np.isfinite(radius[k]):
                foot = float(np.interp(MM * radius[k], X, strain))
                axes.plot(MM * radius[k], foot, "o", ms=6, mfc=ORANGE, mec=colour)
        fails = 100 * yarn.strength / yarn.EA
        axes.axhline(fails, color=RED, lw=1.2, ls="--", label="at the strength")
        top = max(top, fails)
        axes.set(title=name(yarn), xlabel=PLACE.label, xlim=(0, X[-1]))
        axes.set_ylabel(STRAIN.label)
    for axes in grid:
        axes.set_ylim(0, 1.08 * top)
    axes.plot([], [], "o", ms=6, mfc=ORANGE, mec=INK, label="foot of the cone")
    legend_beside(axes, fontsize=10)
    return figure


def cone(pyplot: Any, radii: Mapping[str, tuple[np.ndarray, np.ndarray]]) -> Any:
    """Draw the radius of the cone about the nose over time.

    Parameters
    ----------
    radii : {label: (times (n,) [s], radii (n,) [m], not a number before there is a cone)}
    """
    figure, axes = pyplot.subplots(figsize=(6.4, 4.2))
    for (label, (t, radius)), colour in zip(radii.items(), (WARP, WEFT)):
        axes.plot(US * t, MM * radius, ".-", color=colour, lw=1.6, ms=5, label=label)
    axes.set(xlabel=TIME.label, ylabel=find_axis("cone_radius", "yarn").label)
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)
    axes.legend(loc="upper left")
    return figure


def name(yarn: YarnHistory) -> str:
    """Name a yarn in words."""
    return f"{yarn.family}, {MM * yarn.offset:.1f} mm off centre"


def _panels(pyplot, count, height):
    across = min(2, count)
    down = -(-count // across)
    size = (10.4 if across == 2 else 6.4, 0.3 + height * down)
    figure, grid = pyplot.subplots(down, across, figsize=size, squeeze=False)
    for axes in grid.flat[count:]:
        axes.set_visible(False)
    return figure, grid.flat[:count]
