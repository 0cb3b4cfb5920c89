"""Plots of what was recorded along yarns and at the edges, from arrays in SI units to matplotlib figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from weavecell.report.pictures_style import (
    COLOURS,
    DASHES,
    FAINT,
    INK,
    ORANGE,
    RED,
    WARP,
    WEFT,
    tension_map,
)
from weavecell.results.display import MM, US

if TYPE_CHECKING:
    from shellfabric.output.histories import YarnHistory

_WAVES = {"longitudinal": INK, "transverse": RED}
_CURVES = 8  # deflection profiles drawn


def tensions(pyplot: Any, t: np.ndarray, yarns: Any, places: Sequence[float]) -> Any:
    """Tension and strain through time at places along yarns, one panel a yarn.

    Parameters
    ----------
    t : (n,) [s]
    yarns : sequence of shellfabric.output.histories.YarnHistory
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
    """Tension over place and time, with the fronts and the lines through them, one panel a yarn.

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


def profiles(pyplot: Any, t: np.ndarray, yarns: Any) -> Any:
    """Deflection along warp and weft at evenly spaced instants, one panel a yarn."""
    figure, grid = _panels(pyplot, len(yarns), 3.4)
    chosen = np.unique(np.linspace(0, t.size - 1, _CURVES + 1).round().astype(int)[1:])
    for axes, yarn in zip(grid, yarns):
        for number, k in enumerate(chosen):
            shade = 0.25 + 0.75 * number / max(1, chosen.size - 1)
            colour = WARP if yarn.family == "warp" else WEFT
            label = f"{US * t[k]:.0f} µs" if k in (chosen[0], chosen[-1]) else None
            axes.plot(
                MM * yarn.place[k],
                MM * yarn.deflection[k],
                color=colour,
                alpha=shade,
                lw=1.8,
                label=label,
            )
        axes.set(
            title=f"along the {yarn.family}",
            xlabel="from the impact point [mm]",
            ylabel="deflection [mm]",
        )
        axes.set_xlim(MM * min(0.0, yarn.X[0]), MM * yarn.X[-1])
        axes.legend(
            loc="upper right",
            title=f"every {US * (t[chosen[1]] - t[chosen[0]]):.0f} µs" if chosen.size > 1 else None,
        )
    return figure


def edges(pyplot: Any, t: np.ndarray, sides: Mapping[str, np.ndarray]) -> Any:
    """Force of the fabric on the edges through time: the pull inwards, and the lift along the flight.

    Parameters
    ----------
    sides : {name: (n, 2)} [N]
    """
    figure, (pull, lift) = pyplot.subplots(1, 2, figsize=(10.4, 3.6))
    for family, colour in (("warp", WARP), ("weft", WEFT)):
        ends = {f"{family} yarns, {end} end": sides[f"{family}_{end}"] for end in ("high", "low")}
        high, low = ends.values()
        if np.array_equal(high, low):  # mirrored
            ends = {f"{family} yarns, either end": sides[f"{family}_high"]}
        for (label, forces), dash in zip(ends.items(), DASHES):
            for column, axes in enumerate((pull, lift)):
                axes.plot(US * t, forces[:, column], dash, color=colour, lw=1.8, label=label)
    pull.set(title="pull inwards", xlabel="time after strike [µs]", ylabel="force on an edge [N]")
    lift.set(title="lift along the flight", xlabel="time after strike [µs]")
    for axes in (pull, lift):
        axes.set_xlim(0, US * t[-1])
        axes.axhline(0, color=FAINT, lw=0.8)
    pull.legend(loc="upper left", fontsize=10)
    return figure


def name(yarn: YarnHistory) -> str:
    """Which yarn, in words."""
    return f"{yarn.family}, {MM * yarn.offset:.1f} mm off centre"


def _panels(pyplot, count, height):
    across = min(2, count)
    down = -(-count // across)
    size = (10.4 if across == 2 else 6.4, 0.3 + height * down)
    figure, grid = pyplot.subplots(down, across, figsize=size, squeeze=False)
    for axes in grid.flat[count:]:
        axes.set_visible(False)
    return figure, grid.flat[:count]
