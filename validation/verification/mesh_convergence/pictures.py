"""Picture of the study: cost of a shot against the error of its absorbed energy, one panel a number of plies."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot
from typing import TYPE_CHECKING, Any

from meshing.pictures_style import COLOURS, FAINT

if TYPE_CHECKING:
    from validation.verification.mesh_convergence.study import Measured

PLIES = 1, 4  # that are drawn, where they are there
TIMES = 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100  # [s] ticks
MARKERS = {"coarser": "v", "default": "o", "finer": "^"}


def compose(pyplot: Any, groups: Sequence[Sequence[Measured]], targets: Sequence[float]) -> Any:
    """Deviation of the mean absorbed energy from that of the finest mesh against the CPU time of a shot.

    The scale of the deviation is linear within the target and logarithmic beyond; bars are standard errors.
    Markers: a triangle down for one element per crossover, a circle for the default, a triangle up for the finest.

    Parameters
    ----------
    groups : the meshes of one fabric and number of plies, the finest last
    targets : [%] of one ply and of packs
    """
    every = sorted({group[0].case.plies for group in groups})
    drawn = [plies for plies in every if plies in PLIES] or every
    fabrics = list(dict.fromkeys(group[0].case.fabric for group in groups))
    figure, grid = pyplot.subplots(1, len(drawn), figsize=(6.5 * len(drawn), 5), squeeze=False)
    for axes, plies in zip(grid.flat, drawn):
        target = targets[plies > 1]
        axes.axhspan(-target, target, color="#e8eef4", lw=0)
        axes.axhline(0, color=FAINT, lw=0.8)
        for group in (group for group in groups if group[0].case.plies == plies):
            colour = COLOURS[fabrics.index(group[0].case.fabric) % len(COLOURS)]
            energies = [measured.mean("absorbed_energy") for measured in group]
            finest, error_of_finest = energies[-1]
            off = [100 * (energy / finest - 1) for energy, _ in energies]
            bars = [100 * hypot(error, error_of_finest) / finest for _, error in energies[:-1]] + [0.0]
            cost = [measured.cpu for measured in group]
            axes.errorbar(cost, off, bars, color=colour, lw=1.4, capsize=3, label=group[0].case.fabric)
            for measured, x, y in zip(group, cost, off):
                axes.plot(x, y, MARKERS[measured.case.mesh], color=colour, ms=7)
        axes.set_xscale("log")
        limits = axes.get_xlim()
        axes.set_xticks(TIMES, labels=[f"{time:g}" for time in TIMES])
        axes.set_xticks([], minor=True)
        axes.set_yscale("symlog", linthresh=target)
        ticks = (-100, -10, -target, 0, target, 10, 100)
        axes.set_yticks(ticks, labels=[f"{tick:g}" for tick in ticks])
        axes.set(xlim=limits, ylim=(-100, 100), xlabel="CPU time of a shot [s]", title=f"plies: {plies}")
        axes.legend(fontsize=9)
    grid[0, 0].set_ylabel("absorbed energy, deviation from the finest mesh [%]")
    return figure
