"""Plots of packs of plies: what each of them bears."""

from __future__ import annotations

from typing import Any

import numpy as np

from meshing.pictures_style import BLUE, FAINT, ORANGE, RED

US, MM = 1e6, 1e3
_STEPS = ("#0b1a4a", "#1a4f92", "#2b83ba", "#6bb0d0", "#9fcbe0")  # front to rear


def shades(count: int) -> list:
    """Colours of plies from the front to the rear, in even steps."""
    from matplotlib.colors import LinearSegmentedColormap

    ramp = LinearSegmentedColormap.from_list("plies", _STEPS)
    return [ramp(n / max(1, count - 1)) for n in range(count)]


def shares(pyplot: Any, peaks: np.ndarray, failed: np.ndarray, energy: np.ndarray) -> Any:
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
    row[0].set(title="highest tension / strength", ylim=(0, max(1.3, 1.25 * float(peaks.max()))))
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


def pushes(pyplot: Any, t: np.ndarray, push: np.ndarray, deflection: np.ndarray, tension: np.ndarray) -> Any:
    """Force of the nose on each ply it touches, deflections of the plies, and their highest tensions.

    Parameters
    ----------
    t : (n,) [s]
    push, deflection, tension : (n, plies) [N, m, -], of the tension the share of the strength
    """
    figure, (left, right, third) = pyplot.subplots(1, 3, figsize=(10.4, 3.7))
    colours = shades(push.shape[1])
    for ply, colour in enumerate(colours):
        label = f"ply {ply + 1}" if ply in (0, push.shape[1] - 1) else None
        if np.any(push[:, ply]):
            left.plot(US * t, 1e-3 * push[:, ply], color=colour, lw=1.6, label=f"ply {ply + 1}")
        right.plot(US * t, MM * deflection[:, ply], color=colour, lw=1.6, label=label)
        third.plot(US * t, 100 * tension[:, ply], color=colour, lw=1.6)
    left.set(title="projectile on a ply [kN]", xlabel="time after strike [µs]")
    right.set(title="deflection [mm]", xlabel="time after strike [µs]")
    third.set(title="peak tension / strength [%]", xlabel="time after strike [µs]")
    left.legend(loc="upper right", ncols=2)
    right.legend(loc="upper left")
    for axes in (left, right, third):
        axes.set_xlim(0, US * float(t[-1]))
    return figure
