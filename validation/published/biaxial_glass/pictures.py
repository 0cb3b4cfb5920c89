"""Picture of the biaxial curves: tension per yarn against strain, one panel a direction."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from fabrics.files import replace_whole
from meshing.pictures_style import BLUE, GREEN, INK, PURPLE, RED

if TYPE_CHECKING:
    from fabrics.fabric import Fabric

COLOURS = {"k = 0.5": BLUE, "k = 1": GREEN, "k = 2": RED, "free weft": "#555555", "free warp": "#555555"}


def picture(fabric: Fabric, curves: Any, path: Path) -> None:
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


VARIANTS = ((INK, "-"), (BLUE, "--"), (RED, "-"), (PURPLE, "--"))


def options(fabric: Fabric, found: Any, path: Path) -> None:
    """Draw the curves of the cell's variants, {name: [Curve]}: a column a test, a row a yarn."""
    free = ("free weft", "free warp")
    columns = [curve.label for curve in next(iter(found.values())) if curve.label not in free] + ["cross yarns free"]
    figure, axes = plt.subplots(2, len(columns), figsize=(11, 6.2), layout="constrained", sharex=True, sharey="row")
    for m, direction in enumerate(("warp", "weft")):
        for axis, column in zip(axes[m], columns):
            wanted = free[m] if column == columns[-1] else column
            for (name, tests), (colour, dash) in zip(found.items(), VARIANTS):
                curve = next(test for test in tests if test.label == wanted)
                x, y = 100 * curve.strain[:, m], curve.tension[:, m]
                axis.plot(x, y, dash, color=colour, linewidth=1.7, label=name)
                if curve.failed == direction:
                    axis.plot(x[-1], y[-1], "x", color=colour, markersize=7, markeredgewidth=2)
            axis.set_title(f"{direction}, {column}", fontsize=11)
            axis.grid(alpha=0.3)
        axes[m, 0].set_ylabel("tension per yarn, N")
    axes[0, 0].set_xlim(left=0)  # after all is drawn: the axes are shared
    for axis in axes[:, 0]:
        axis.set_ylim(bottom=0)
    for axis in axes[1]:
        axis.set_xlabel("strain of the yarn's direction, %")
    axes[0, 0].legend(frameon=False, fontsize=9)
    figure.suptitle(f"{fabric.name}: what the profile and the toe change, same constants (x: the yarn fails)")
    with replace_whole(path) as beside:
        figure.savefig(beside, dpi=130)
    plt.close(figure)


def sides(fabric: Fabric, tests: Any, path: Path) -> None:
    """Draw tests, {title: (yarn, {model: (strain, tension)})}: the cells as lines, coupon and crossover as marks."""
    styles = {
        "cell, thesis's form": {"color": INK, "lw": 1.7}, "cell, variational": {"color": BLUE, "ls": "--"},
        "shell coupon": {"color": RED, "marker": "o", "ls": "", "mfc": "none", "ms": 7},
        "3D crossover": {"color": GREEN, "marker": "^", "ls": "", "ms": 5},
        "cell, law of the 3D crossover": {"color": GREEN, "ls": ":", "lw": 1.7},
    }  # fmt: skip
    figure, axes = plt.subplots(2, 2, figsize=(10, 7.6), layout="constrained")
    for axis, (title, (yarn, models)) in zip(axes.flat, tests.items()):
        for name, (strain, tension) in models.items():
            axis.plot(100 * strain, tension, label=name, **styles[name])  # type: ignore[arg-type]
        axis.set_title(title, fontsize=11)
        axis.set(xlabel=f"{yarn} strain, %", xlim=(0, None), ylim=(0, None))
        axis.grid(alpha=0.3)
    for axis in axes[:, 0]:
        axis.set_ylabel("tension per yarn, N")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), frameon=False, loc="outside lower center", ncols=3)
    figure.suptitle(f"{fabric.name}: one weave, three models")
    with replace_whole(path) as beside:
        figure.savefig(beside, dpi=130)
    plt.close(figure)
