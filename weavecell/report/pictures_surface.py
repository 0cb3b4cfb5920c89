"""Plots of a response surface, from plain arrays in SI units to matplotlib figures."""

from __future__ import annotations

from typing import Any

import numpy as np

from fabrics.surface import ResponseSurface
from weavecell.report.pictures_style import (
    COLOURS,
    DASHES,
    FAINT,
    INK,
    ORANGE,
    WARP,
    WEFT,
    tension_map,
)

UM = 1e6
FORCES = (("T1", "warp tension"), ("T2", "weft tension"), ("F_c", "contact force"))
HEIGHTS = (("h1", "warp height"), ("h2", "weft height"))


def surfaces(pyplot: Any, interpolant: Any) -> Any:
    """Draw the three forces above the (d1, d2) plane: interpolant as a surface, samples as
    lines."""
    surface = interpolant.surface
    x, y = (np.linspace(axis[0], axis[-1], 61) for axis in (surface.d1, surface.d2))
    figure = pyplot.figure(figsize=(10.4, 3.7))
    top = max(float(np.max(getattr(surface, name))) for name, _ in FORCES[:2])
    for place, (name, title) in enumerate(FORCES, 1):
        axes = figure.add_subplot(1, 3, place, projection="3d")
        values = interpolant(name, x[:, None], y[None, :])
        axes.plot_surface(
            UM * x[:, None],
            UM * y[None, :],
            values,
            cmap="cividis",
            lw=0,
            rcount=61,
            ccount=61,
            antialiased=True,
        )
        d1, d2 = np.meshgrid(UM * surface.d1, UM * surface.d2, indexing="ij")
        samples = np.stack([d1, d2, getattr(surface, name)])
        # lines along d2, then along d1
        for lines in (samples, samples.transpose(0, 2, 1)):
            for n in np.unique(np.linspace(0, lines.shape[1] - 1, 6).astype(int)):
                axes.plot(*lines[:, n], color="w", lw=0.8)
        axes.set_title(f"{title} [N]", y=0.98)
        axes.set_xlabel("d$_1$ [µm]", fontsize=10)
        axes.set_ylabel("d$_2$ [µm]", fontsize=10)
        axes.set_zlim(0, top if name != "F_c" else None)
        axes.tick_params(labelsize=9, pad=0)
        axes.locator_params(nbins=4)
        axes.view_init(24, -128)
        axes.set_box_aspect((1, 1, 0.8), zoom=0.88)
    return figure


def contours(pyplot: Any, interpolant: Any) -> Any:
    """Draw levels of the forces and heights over (d1, d2), with the samples."""
    from matplotlib.ticker import MaxNLocator

    surface = interpolant.surface
    x, y = (np.linspace(axis[0], axis[-1], 201) for axis in (surface.d1, surface.d2))
    figure, grid = pyplot.subplots(2, 3, figsize=(10.4, 7.0), sharex=True, sharey=True)
    for axes, (name, title) in zip(grid.flat, FORCES + HEIGHTS):
        factor = UM
        unit = "µm"
        if name in dict(FORCES):
            factor = 1
            unit = "N"
        values = factor * interpolant(name, x[:, None], y[None, :])
        axes.contourf(UM * x, UM * y, values.T, 24, cmap="cividis")
        low = values.min()
        high = values.max()
        # lines no nearer than a twentieth to the extremes, which lie in corners, where a label is
        # cut
        ticks = MaxNLocator(8).tick_values(low, high)
        shares = (ticks - low) / (high - low)
        levels = ticks[(0.05 < shares) & (shares < 0.95)]
        shades = ["w" if v < 0.5 * (low + high) else INK for v in levels]
        lines = axes.contour(UM * x, UM * y, values.T, levels, colors=shades, linewidths=0.9)
        axes.clabel(lines, fontsize=9, fmt="%.0f")
        axes.set_title(f"{title} [{unit}]")
        axes.grid(False)
    spare = grid.flat[5]
    a, b = np.meshgrid(UM * surface.d1, UM * surface.d2)
    spare.plot(a, b, ".", color=INK, ms=3)
    spare.set_title(f"samples, {surface.d1.size} × {surface.d2.size}")
    spare.grid(False)
    figure.supxlabel("d$_1$, warp end displacement [µm]", fontsize=12)
    figure.supylabel("d$_2$, weft end displacement [µm]", fontsize=12)
    return figure


def slices(pyplot: Any, surface: ResponseSurface, cell: Any, label: str) -> Any:
    """Draw cuts along d1 at three d2 and along d2 at three d1, with the shell's cell beside.

    Parameters
    ----------
    cell : {"T1", "T2", "F_c": (n1, n2)} [N] of the cell with a sinusoidal yarn, at the samples
    label : of that cell
    """
    figure, grid = pyplot.subplots(2, 3, figsize=(10.4, 7.0), sharey="col")
    for row, (along, across, names) in enumerate(
        ((surface.d1, surface.d2, ("d$_1$", "d$_2$")), (surface.d2, surface.d1, ("d$_2$", "d$_1$")))
    ):
        cuts = [0, across.size // 2, across.size - 1]
        for axes, (name, title) in zip(grid[row], FORCES):
            for cut, colour in zip(cuts, (COLOURS[0], COLOURS[2], COLOURS[3])):
                ours = getattr(surface, name)
                theirs = cell[name]
                if row == 0:
                    ours = ours.T
                    theirs = theirs.T
                ours = ours[cut]
                theirs = theirs[cut]
                label_of_cut = f"3D, {names[1]} = {UM * across[cut]:.0f} µm"
                axes.plot(
                    UM * along,
                    ours,
                    "o",
                    ms=4,
                    mfc="white",
                    mec=colour,
                    mew=1.3,
                    label=label_of_cut,
                )
                axes.plot(UM * along, theirs, color=colour, lw=1.8)
            axes.set(xlabel=f"{names[0]} [µm]", title=title if row == 0 else "")
            axes.set_xlim(UM * along[0], UM * along[-1])
        grid[row, 0].set_ylabel("force [N]")
        grid[row, 2].legend(
            loc="upper left", fontsize=9.5, title=f"lines: {label}", title_fontsize=9.5
        )
    grid[0, 2].set_ylim(top=1.35 * max(np.max(surface.F_c), np.max(cell["F_c"])))
    return figure


def draw_misses(pyplot: Any, surface: ResponseSurface, errors: Any) -> Any:
    """Draw the largest miss on each grid line of the spline through the other lines, over the
    quantity's largest value."""
    figure, pair = pyplot.subplots(1, 2, figsize=(10.4, 3.6), sharey=True)
    for number, (axes, axis) in enumerate(zip(pair, (surface.d1, surface.d2))):
        for (name, title), colour, dash in zip(FORCES, (WARP, WEFT, INK), DASHES):
            worst = errors[name].lines[number] / np.abs(getattr(surface, name)).max()
            axes.semilogy(
                UM * axis, 100 * worst, dash + "o", color=colour, ms=4, lw=1.5, label=title
            )
        axes.set(xlabel=f"left-out line at d$_{number + 1}$ [µm]")
        axes.plot(
            UM * axis,
            np.full(axis.size, 0.03),
            "|",
            color=FAINT,
            ms=8,
            transform=axes.get_xaxis_transform(),
        )
    pair[0].set_ylabel("largest miss [% of the largest]")
    pair[0].legend(loc="upper right")
    return figure


def energy_map(pyplot: Any, found: Any, paths: Any = None) -> Any:
    """Draw the energy of a crossover over its two strains, white where a yarn is past its strength,
    with paths.

    Parameters
    ----------
    found : weavecell.studies.energy_map.EnergyMap
    paths : {label: (strain_warp, strain_weft)} (n,) [-]; a third entry is the number of the state
        that has the mark, else it is the last
    """
    from matplotlib.patheffects import Normal, Stroke
    from matplotlib.ticker import MaxNLocator

    x = 100 * found.strain_warp
    y = 100 * found.strain_weft
    energy = 1e-3 * found.energy.T
    largest, *strains = found.most
    figure, axes = pyplot.subplots(figsize=(7.4, 6.0))
    levels = np.linspace(0, 1e-3 * largest, 41)
    shades = axes.contourf(x, y, energy, levels, cmap=tension_map(), extend="max")
    rounded = MaxNLocator(8).tick_values(0, 1e-3 * largest)[1:]
    shown = np.where(found.share.max(axis=2).T < 1, energy, np.nan)
    colours = ["w" if level > 0.4e-3 * largest else FAINT for level in rounded]
    lines = axes.contour(x, y, shown, rounded, colors=colours, linewidths=0.9)
    for family, (name, colour) in enumerate((("warp", WARP), ("weft", WEFT))):
        share = found.share[..., family].T
        axes.contourf(x, y, share, [1, np.inf], colors="w")
        axes.contour(x, y, share, [1], colors=[colour], linewidths=2.2)
        axes.plot([], [], color=colour, lw=2.2, label=f"{name} at its strength")
    axes.clabel(lines, fontsize=9, fmt="%g", manual=_along_the_ray(found, rounded))
    look = {"mec": "w", "ls": "none", "ms": 14, "color": ORANGE}
    axes.plot(*(100 * s for s in strains), "*", label="most energy", **look)
    outlined = [Stroke(linewidth=2, foreground="w"), Normal()]
    for number, (label, (warp, weft, *marked)) in enumerate((paths or {}).items()):
        look = {"color": INK, "ms": 2.6, "lw": 0.7, "path_effects": outlined, "zorder": 4}
        axes.plot(100 * warp, 100 * weft, DASHES[number % len(DASHES)], marker="o", **look)
        look = {"color": INK, "mec": "w", "ms": 9, "ls": "none", "zorder": 5}
        at = marked or [-1]
        axes.plot(100 * warp[at], 100 * weft[at], "os^D"[number % 4], label=label, **look)
    axes.set(xlabel="strain along the warp [%]", ylabel="strain along the weft [%]")
    whole = found.share.max(axis=2) < 1
    reach = [axis[whole.any(axis=1 - n)][-1] for n, axis in enumerate((x, y))]
    axes.set(xlim=(0, 1.06 * reach[0]), ylim=(0, 1.06 * reach[1]))
    axes.grid(False)
    bar = figure.colorbar(shades, ticks=MaxNLocator(8))
    bar.set_label("energy over the area at rest [kJ/m²]")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=3, fontsize=9.5)
    return figure


def _along_the_ray(found, levels):
    """Places (strain of warp, of weft) [%] of labels of energies [kJ/m2]: on the straight way from
    rest to the most energy, where no yarn has failed."""
    _, *end = found.most
    share = np.linspace(0, 1, 200)
    steps = zip((found.strain_warp, found.strain_weft), end)
    at = [np.array([int(np.argmin(np.abs(axis - s * to))) for s in share]) for axis, to in steps]
    along = 1e-3 * found.energy[at[0], at[1]]
    shares = [share[int(np.argmax(along >= level))] for level in levels if level < along[-1]]
    return [tuple(100 * s * to for to in end) for s in shares]
