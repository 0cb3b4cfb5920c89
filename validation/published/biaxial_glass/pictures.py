"""Picture of the biaxial curves: tension per yarn against strain, one panel a direction."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.files import replace_whole
from meshing.pictures_style import BLUE, FAINT, GREEN, INK, ORANGE, PURPLE, RED, plots

if TYPE_CHECKING:
    from fabrics.checks import FloatArray
    from fabrics.fabric import Fabric

COLOURS = {"k = 0.5": BLUE, "k = 1": GREEN, "k = 2": RED, "free weft": FAINT, "free warp": FAINT}


def picture(fabric: Fabric, curves: Any, path: Path) -> None:
    """Draw the curves of one weave; a cross marks the failure of the yarn."""
    with plots() as pyplot:
        figure, axes = pyplot.subplots(1, 2, figsize=(10.4, 4.6))
        for index, (axis, direction) in enumerate(zip(axes, ("warp", "weft"))):
            for curve in curves:
                if curve.label == f"free {direction}":
                    continue
                x, y = 100 * curve.strain[:, index], curve.tension[:, index]
                style = {"color": COLOURS[curve.label], "linestyle": "--" if "free" in curve.label else "-"}
                label = "cross yarns free" if "free" in curve.label else curve.label
                axis.plot(x, y, label=label, **style)
                if curve.failed == direction:
                    axis.plot(x[-1], y[-1], "x", color=style["color"], markersize=9, markeredgewidth=2)
            axis.set(xlabel=f"{direction} strain [%]", title=f"{fabric.name}, {direction}", xlim=(0, None))
            axis.set_ylim(bottom=0)
        axes[0].set_ylabel("tension per yarn [N]")
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4,
                      title="warp strain / weft strain (x: the yarn fails)")  # fmt: skip
        _save(figure, path)


VARIANTS = ((INK, "-"), (BLUE, "-"), (RED, "--"), (PURPLE, "-."))
FREE = ("free weft", "free warp")  # test in which the crossing yarns of warp and weft are free


def options(fabric: Fabric, found: Any, path: Path) -> None:
    """Draw what each variant of the cell, {name: [Curve]}, changes of the tension: a column a test, a row a yarn.

    The first variant is the reference. Differences at equal strain are over the largest tension of the reference.
    """
    with plots() as pyplot:
        _save(compose_options(pyplot, fabric, found), path)


def compose_options(pyplot: Any, fabric: Fabric, found: Any) -> Any:
    """The figure of `options`."""
    reference, *others = found
    columns = [curve.label for curve in found[reference] if curve.label not in FREE] + ["cross yarns free"]
    figure, grid = pyplot.subplots(2, len(columns), figsize=(11.4, 5.8), sharex=True, sharey="row")
    for m, direction in enumerate(("warp", "weft")):
        for axes, column in zip(grid[m], columns):
            wanted = FREE[m] if column == columns[-1] else column
            known = {name: next(test for test in tests if test.label == wanted) for name, tests in found.items()}
            strain, tension = known[reference].strain[:, m], known[reference].tension[:, m]
            for name, (colour, dash) in zip(others, VARIANTS[1:]):
                change = difference(strain, tension, known[name].strain[:, m], known[name].tension[:, m])
                axes.plot(100 * strain, 100 * change, dash, color=colour, lw=1.8, label=name)
            axes.axhline(0, color=VARIANTS[0][0], lw=1)
            axes.set_title(f"{direction}, {column}", fontsize=11)
        grid[m, 0].set_ylabel("difference of tension\n[% of the largest]")
    grid[0, 0].set_xlim(left=0)  # after all is drawn: the axes are shared
    for axes in grid[1]:
        axes.set_xlabel("strain of the yarn [%]", fontsize=11)
    figure.suptitle(f'{fabric.name}: tension less that of "{reference}", same constants', fontsize=13)
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def difference(strain: FloatArray, tension: FloatArray, x: FloatArray, y: FloatArray) -> FloatArray:
    """(n,) [-] tension y at strain x less that of the reference at its strains, over the reference's largest; nan
    beyond the end of either curve."""
    order = np.argsort(x)
    other = np.interp(strain, x[order], y[order], right=np.nan)
    return (other - tension) / tension.max()


def sides(fabric: Fabric, tests: Any, path: Path) -> None:
    """Draw tests, {title: (yarn, {model: (strain, tension)})}: the cells as lines, coupon and crossover as marks."""
    styles = {
        "cell, thesis's form": {"color": INK, "lw": 1.7}, "cell, variational": {"color": BLUE, "ls": "--"},
        "shell coupon": {"color": ORANGE, "marker": "o", "ls": "", "mfc": "none", "ms": 7},
        "3D crossover": {"color": GREEN, "marker": "^", "ls": "", "ms": 5},
        "cell, law of the 3D crossover": {"color": GREEN, "ls": ":", "lw": 1.7},
    }  # fmt: skip
    with plots() as pyplot:
        figure, axes = pyplot.subplots(2, 2, figsize=(10.4, 7.6))
        for axis, (title, (yarn, models)) in zip(axes.flat, tests.items()):
            for name, (strain, tension) in models.items():
                axis.plot(100 * strain, tension, label=name, **styles[name])  # type: ignore[arg-type]
            axis.set(xlabel=f"{yarn} strain [%]", xlim=(0, None), ylim=(0, None), title=f"{fabric.name}, {title}")
        for axis in axes[:, 0]:
            axis.set_ylabel("tension per yarn [N]")
        figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
        _save(figure, path)


def _save(figure: Any, path: Path) -> None:
    with replace_whole(path) as beside:
        figure.savefig(beside, format="png", dpi=120)
