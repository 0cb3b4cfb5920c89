"""Plots of what was recorded along yarns, from arrays in SI units to matplotlib figures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from weavecell.report.pictures_style import (
    COLOURS,
    INK,
    ORANGE,
    RED,
    tension_map,
)
from weavecell.results.display import MM, US

if TYPE_CHECKING:
    from shellfabric.loop.histories import YarnHistory

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
        axes.set(title=name(yarn), xlabel="time after strike [µs]", ylabel="tension [N]")
        axes.set_xlim(0, US * t[-1])
        axes.set_ylim(bottom=0)
        strain = axes.secondary_yaxis("right", functions=_percent(yarn.EA))
        strain.set_ylabel("fibre strain [%]")
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
            xlabel="from the impact point, at rest [mm]",
            ylabel="time after strike [µs]",
        )
        axes.set(xlim=(0, X[-1]), ylim=(0, US * t[-1]))
        axes.grid(False)
        axes.legend(loc="lower center", bbox_to_anchor=(0.5, -0.3), ncols=2, fontsize=10)
    bar = figure.colorbar(image, ax=list(grid), shrink=0.9, pad=0.01, label="tension [N]")
    bar.outline.set_visible(False)
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
