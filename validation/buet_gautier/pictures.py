"""Picture of the biaxial curves: tension per yarn against strain, one panel a direction."""

from __future__ import annotations

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from fabrics.files import replace_whole

COLOURS = {"k = 0.5": "#0072B2", "k = 1": "#009E73", "k = 2": "#D55E00", "free weft": "#555555", "free warp": "#555555"}


def picture(fabric, curves, path):
    """Draw the curves of one weave; a cross marks the failure of the yarn."""
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained")
    for index, (axis, direction) in enumerate(zip(axes, ("warp", "weft"))):
        for curve in curves:
            if curve.label == f"free {direction}":
                continue
            x, y = 100 * curve.strain[:, index], curve.tension[:, index]
            style = {"color": COLOURS[curve.label], "linestyle": "--" if "free" in curve.label else "-"}
            label = "cross yarns free" if "free" in curve.label else curve.label
            axis.plot(x, y, label=label, linewidth=2, **style)
            if curve.failed == direction:
                axis.plot(x[-1], y[-1], "x", color=style["color"], markersize=9, markeredgewidth=2)
        axis.set(xlabel=f"{direction} strain, %", title=direction)
        axis.grid(alpha=0.3)
        axis.set_xlim(left=0)
        axis.set_ylim(bottom=0)
    for axis in axes:
        axis.set_ylabel("tension per yarn, N")
    axes[0].legend(frameon=False, title="warp strain / weft strain")
    figure.suptitle(f"{fabric.name}: biaxial response of the crossover (x: the yarn fails)")
    with replace_whole(path) as beside:
        figure.savefig(beside, dpi=150)
    plt.close(figure)
