"""Plots of packs of plies: cuts through the plies, and what each of them bears."""

from __future__ import annotations

import numpy as np

from weavecell.style import BLUE, FAINT, ORANGE, RED, STEEL

US, MM = 1e6, 1e3
_STEPS = ("#0b1a4a", "#1a4f92", "#2b83ba", "#6bb0d0", "#9fcbe0")  # front to rear


def shades(count):
    """Colours of plies from the front to the rear, in even steps."""
    from matplotlib.colors import LinearSegmentedColormap

    ramp = LinearSegmentedColormap.from_list("plies", _STEPS)
    return [ramp(n / max(1, count - 1)) for n in range(count)]


def cuts(pyplot, chosen, thickness, mirrored, projectile, close_up):
    """Cuts through the impact point, each whole and as a close-up, in which the lines are as thick as the plies.

    Parameters
    ----------
    chosen : sequence of pack_record.Cut
    thickness : (plies,) [m]
    mirrored : whether the modelled part continues mirrored in x = 0
    projectile : (n, 2) [m] its outline, the foremost point at height 0
    close_up : [m] half the width of a close-up
    """
    figure, grid = pyplot.subplots(
        len(chosen), 2, figsize=(10.4, 0.5 + 2.7 * len(chosen)), squeeze=False, width_ratios=(1.15, 1)
    )
    colours = shades(len(thickness))
    top = max(max(float(line[:, 1].max()) for line in cut.lines) for cut in chosen)
    for row, cut in zip(grid, chosen):
        for axes, near in zip(row, (False, True)):
            axes.fill(
                MM * projectile[:, 0], MM * (projectile[:, 1] + cut.nose), fc="#d5dae0", ec=STEEL, lw=1.0, zorder=1
            )
            for line, colour in zip(cut.lines, colours):
                x, z = (np.concatenate([sign * line[::-1, c], line[:, c]]) if mirrored else line[:, c]
                        for c, sign in ((0, -1), (1, 1)))  # fmt: skip
                axes.plot(MM * x, MM * z, color=colour, lw=1.4, zorder=2, solid_joinstyle="round")
            axes.grid(visible=near)
            axes.set_aspect("equal")
        whole = MM * max(float(line[:, 0].max()) for line in cut.lines)
        row[0].set(xlim=(-whole, whole), ylim=(-8, MM * top + 3), ylabel="z [mm]")
        row[0].set_aspect("auto")
        row[0].set_title(f"{US * cut.t:.0f} µs")
        foremost = max(float(line[:, 1].max()) for line in cut.lines)
        row[1].set(xlim=(-MM * close_up, MM * close_up), ylim=(MM * (foremost - 1.25 * close_up), MM * foremost + 0.8))
        _bands(row[1], cut, thickness, mirrored, colours)
    for axes in grid[-1]:
        axes.set_xlabel("x [mm]")
    return figure


def _bands(axes, cut, thickness, mirrored, colours):
    """Plies as bands of their thickness."""
    for line, t, colour in zip(cut.lines, thickness, colours):
        line = np.concatenate([[-1, 1] * line[:0:-1], line]) if mirrored else line
        along = np.gradient(line, axis=0)
        normal = np.column_stack([-along[:, 1], along[:, 0]]) / np.hypot(*along.T)[:, None]
        outline = np.concatenate([line + 0.5 * t * normal, (line - 0.5 * t * normal)[::-1]])
        axes.fill(MM * outline[:, 0], MM * outline[:, 1], color=colour, alpha=0.45, lw=0, zorder=1.5)


def shares(pyplot, peaks, failed, energy):
    """What each ply bears: highest tension, failed yarn segments, energy at the end.

    Parameters
    ----------
    peaks : (plies, 2) [-] highest tension of warp and weft over the strength
    failed : (plies,)
    energy : (plies,) [J]
    """
    figure, row = pyplot.subplots(1, 3, figsize=(10.4, 3.6))
    ply = np.arange(1, len(failed) + 1)
    for column, (name, colour) in enumerate((("warp", BLUE), ("weft", RED))):
        row[0].bar(ply + 0.2 * (2 * column - 1), peaks[:, column], 0.38, color=colour, label=name)
    row[0].axhline(1.0, color=FAINT, ls=":", lw=1.2)
    row[0].set(title="highest tension / strength", ylim=(0, max(1.1, 1.25 * float(peaks.max()))))
    row[0].legend(loc="upper right", ncols=2)
    row[1].bar(ply, failed, 0.7, color=ORANGE)
    row[1].set(title="failed yarn segments", ylim=(0, max(1.0, 1.1 * float(np.max(failed)))))
    row[2].bar(ply, energy, 0.7, color=BLUE)
    row[2].set(title="energy at the end [J]", ylim=(0, 1.1 * float(np.max(energy))))
    for axes in row:
        axes.set_xlabel("ply, from the front")
        axes.set_xticks(ply if len(ply) <= 8 else ply[:: -(-len(ply) // 8)])
        axes.grid(axis="x", visible=False)
    return figure


def pushes(pyplot, t, push, deflection):
    """Force of the nose on each ply it touches, and deflections at the impact point.

    Parameters
    ----------
    t : (n,) [s]
    push, deflection : (n, plies) [N, m]
    """
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(10.4, 3.9))
    colours = shades(push.shape[1])
    for ply, colour in enumerate(colours):
        label = f"ply {ply + 1}" if ply in (0, push.shape[1] - 1) else None
        if np.any(push[:, ply]):
            left.plot(US * t, 1e-3 * push[:, ply], color=colour, lw=1.6, label=f"ply {ply + 1}")
        right.plot(US * t, MM * deflection[:, ply], color=colour, lw=1.6, label=label)
    left.set(title="force of the nose [kN]", xlabel="time after strike [µs]")
    right.set(title="deflection at the impact point [mm]", xlabel="time after strike [µs]")
    left.legend(loc="upper right", ncols=2)
    right.legend(loc="lower right")
    for axes in (left, right):
        axes.set_xlim(0, US * float(t[-1]))
    return figure
