"""Plots of the calibrations of the catalogue: platen curves, and fitted laws beside the published ones."""

from __future__ import annotations

from typing import Any

from meshing.pictures_style import FAINT, FITTED, INK

OCTAVES = (0.125, 0.25, 0.5, 1, 2, 4, 8, 16, 32)


def laws(pyplot: Any, found: Any) -> Any:
    """Fitted over published a and b of several fabrics: value, its 95 % interval, and the fits to single paths.

    Parameters
    ----------
    found : {fabric: unitcell3d.identify.calibration.Calibration}
    """
    compared = {name: each for name, each in found.items() if each.comparison}
    figure, row = pyplot.subplots(1, 2, figsize=(11.5, 1.5 + 0.55 * max(len(compared), 1)), sharey=True)
    for axes, key in zip(row, ("a", "b")):
        axes.axvline(1, color=INK, lw=1.2, label="published")
        for place, each in enumerate(compared.values()):
            published, first = getattr(each.published, key), place == 0
            value = getattr(each.law, key) / published
            interval, spread = getattr(each.law, f"{key}_interval"), each.spread.get(key)
            if interval:
                axes.plot([end / published for end in interval], [place] * 2, color=FITTED, lw=5, alpha=0.45,
                          solid_capstyle="butt", label="95 % of the fit to all paths" if first else None)  # fmt: skip
            if spread:
                axes.plot([end / published for end in spread], [place + 0.24] * 2, "|-", color=FAINT, lw=1.2, ms=8,
                          label="fits to single paths" if first else None)  # fmt: skip
            axes.plot([value], [place], "o", ms=7, color=FITTED, label="fit to all paths" if first else None)
            axes.annotate(f"{value:.2f}", (1.01, place), xycoords=axes.get_yaxis_transform(), va="center", fontsize=11)
        axes.set(xlabel=f"{key}, fitted over published", xscale="log")
        axes.set_xticks(OCTAVES, [f"{octave:g}" for octave in OCTAVES])
        axes.set_xticks([], minor=True)
        low, high = axes.dataLim.intervalx
        axes.set_xlim(low / 1.2, 1.2 * high)
    row[0].set_yticks(range(len(compared)), list(compared))
    row[0].invert_yaxis()
    figure.legend(*row[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def platens(pyplot: Any, fits: Any) -> Any:
    """Pressure against closure of several fits, each in axes of its own.

    Parameters
    ----------
    fits : of unitcell3d.identify.solid_record.SolidFit
    """
    count = max(len(fits), 1)
    rows = -(-count // 3)
    figure, grid = pyplot.subplots(
        rows, min(count, 3), figsize=(11.5, 3.4 * rows), sharex=True, sharey=True, squeeze=False
    )
    for axes, fit in zip(grid.ravel(), fits):
        pressure = 1e-6 * fit.pressure
        axes.plot(1e6 * fit.measured, pressure, "o", ms=5, mfc="white", mec=INK, mew=1.2, label="platen law")
        axes.plot(1e6 * fit.before, pressure, "--", color=FAINT, lw=2, label="solid of the file")
        axes.plot(1e6 * fit.computed, pressure, color=FITTED, lw=2.2, label="fitted solid")
        axes.set(yscale="log")
        axes.set_title(fit.fabric.name, loc="left")
    for axes in grid.ravel()[len(fits) :]:
        axes.set_visible(False)
    for axes in grid[-1]:
        axes.set_xlabel("closed by the platens [µm]")
    for axes in grid[:, 0]:
        axes.set_ylabel("pressure [MPa]")
    grid[0, 0].legend(loc="upper left")
    return figure


def chain(pyplot: Any, ratios: Any) -> Any:
    """a and b over the published values, with the file's solid and with the fitted one.

    Parameters
    ----------
    ratios : {fabric: {"a", "b": (with the file's solid, with the fitted one, low, high)}}
    """
    figure, row = pyplot.subplots(1, 2, figsize=(11.5, 1.2 + 0.55 * max(len(ratios), 1)), sharey=True)
    for axes, key in zip(row, ("a", "b")):
        for place, name in enumerate(ratios):
            before, fitted, low, high = ratios[name][key]
            axes.plot([low, high], [place, place], color=FITTED, lw=3, alpha=0.35, solid_capstyle="butt")
            axes.plot([before], [place], "o", ms=8, mfc="white", mec=FAINT, mew=1.8, label="solid of the file")
            axes.plot([fitted], [place], "o", ms=8, color=FITTED, label="fitted solid, 95 %")
        axes.axvline(1, color=INK, lw=1.2)
        axes.set(xlabel=f"{key}, computed over published", xscale="log")
        low, high = axes.get_xlim()
        axes.set_xticks(OCTAVES, [f"{octave:g}" for octave in OCTAVES])
        axes.set_xticks([], minor=True)
        axes.set_xlim(low / 1.2, 1.2 * high)
    row[0].set_yticks(range(len(ratios)), list(ratios))
    row[0].invert_yaxis()
    handles, labels = row[0].get_legend_handles_labels()
    row[0].legend(handles[:2], labels[:2], loc="lower left", bbox_to_anchor=(0, 1.01), ncol=2)
    return figure
