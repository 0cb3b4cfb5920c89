"""Plots of tests on coupons, from their records and what the solver returned to matplotlib
figures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base.record import Record
from weavecell.report.pictures_style import (
    COLOURS,
    FAINT,
    INK,
    WARP,
    WEFT,
    legend_beside,
    tension_map,
)
from weavecell.results.coupon import UNLOADED
from weavecell.results.display import choose_unit
from weavecell.results.keys import COUPON_MEASURES, find_axis

if TYPE_CHECKING:
    from shellfabric.coupon.pull_out import PullOutCurve
    from shellfabric.coupon.solver import Result

TESTS = {
    "bias_extension": "bias extension",
    "picture_frame": "picture frame",
    "uniaxial": "uniaxial tension",
    "biaxial": "biaxial tension",
    "pull_out": "yarn pull-out",
}
# curves of each test: file, measures that begin with one of these, label of the axis, caption
CURVES: dict[str, tuple[tuple[str, tuple[str, ...], str, str], ...]] = {
    "bias_extension": (
        ("load", ("load",), "load", "Load on a clamp."),
        (
            "angles",
            ("angle in zone", "zone C"),
            "angle between warp and weft",
            "Mean angle in the three zones: of zone A both yarns lead to a clamp, of B one, of C none.",
        ),
    ),
    "picture_frame": (
        ("stress", ("shear stress", "trellis"), "shear stress", "Work of the frame, by volume."),
    ),
    "uniaxial": (
        ("load", ("load of a yarn",), "load of a yarn", "Load over the yarns that carry it."),
        (
            "strains",
            ("strain in the",),
            "strain",
            "Strain of the middle of the strip along the load and across.",
        ),
    ),
    "biaxial": (
        (
            "load",
            ("load of a", "cell at these strains"),
            "load of a yarn",
            "Load of an arm over its yarns; dashed: the cell alone, at the strains of the middle.",
        ),
    ),
}
# closed forms, which are dashed
_KNOWN = ("cell", "trellis", "zone C")
_SHEARS = (
    "#f3f5f7",
    "#fde0a6",
    "#f4a259",
    "#d1495b",
    "#7b2d6b",
    "#2d1244",
)  # even steps of lightness


def sheared_coupon(pyplot: Any, record: Record, solved: Result) -> Any:
    """Draw the coupon at the end: its elements by their shear, and its yarns by their tension."""
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.colors import LinearSegmentedColormap

    coupon = solved.coupon
    x = 1e3 * solved.states[-1].x
    degrees = np.degrees(np.abs(solved.shear()))
    tension = np.concatenate(coupon.tensions(solved.states[-1].x))
    width, height = np.ptp(x, axis=0)
    tall = float(np.clip(height / width, 0.15, 2.0))
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(10.4, 2.0 + 4.4 * tall))
    shears = LinearSegmentedColormap.from_list("shear", _SHEARS)
    most = max(float(np.quantile(degrees, 0.995)), 1.0)
    looks: dict[str, Any] = {"edgecolors": "face", "linewidth": 0.2, "rasterized": True}
    elements = PolyCollection(x[coupon.quads], array=degrees, cmap=shears, clim=(0, most), **looks)
    left.add_collection(elements)
    tightest_last = np.argsort(tension)
    edges = np.concatenate([x[family] for family in coupon.edges])[tightest_last]
    tension = tension[tightest_last]
    top = max(float(np.quantile(tension, 0.995)), solved.force_floor)
    yarns = LineCollection(
        edges, array=tension, cmap=tension_map(), clim=(0, top), linewidth=1.0, rasterized=True
    )
    right.add_collection(yarns)
    if record.facts["test"] == "bias_extension":
        _zones(left, solved)
    prescribed = record.facts["prescribed_name"]
    unit, factor = choose_unit(COUPON_MEASURES[prescribed].unit)
    state = f"{prescribed} {factor * record[prescribed][-1]:.3g} {unit}"
    for axes, title, drawn, label in (
        (left, f"shear, {state}", elements, "shear angle [°]"),
        (right, "yarns", yarns, "tension of a yarn [N]"),
    ):
        axes.set(aspect="equal", title=title, xlabel="mm")
        axes.autoscale_view()
        axes.grid(False)
        bar = figure.colorbar(
            drawn, ax=axes, location="bottom", shrink=0.8, aspect=30, extend="max", label=label
        )
        bar.outline.set_visible(False)
    left.set_ylabel("mm")
    return figure


def _zones(axes, solved):
    """The borders of the zones of a bias coupon, lines of the fabric along the yarns from its
    clamped corners."""
    points = solved.coupon.points
    x = 1e3 * solved.states[-1].x
    half = np.array([np.ptp(points[:, 0]) / 2, np.abs(points[solved.grips > 0][:, 1]).min()])
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    along = np.linspace(0, 2 * half[0], 60)
    for side in (1, -1):
        for end in (1, -1):
            line = middle + np.column_stack([side * (half[0] - along), end * (half[1] - along)])
            nearest = np.argmin(((points[None] - line[:, None]) ** 2).sum(axis=-1), axis=1)
            axes.plot(*x[nearest].T, color=INK, lw=1.2, ls="--")
    places = {
        "A": (0.0, half[1] - 0.3 * half[0]),
        "B": (0.8 * half[0], half[1] - half[0]),
        "C": (0.0, 0.0),
    }
    circle = {"boxstyle": "circle", "fc": "white", "ec": INK, "lw": 0.8}
    for name, place in places.items():
        nearest = np.argmin(((points - middle - place) ** 2).sum(axis=1))
        axes.annotate(
            name, x[nearest], ha="center", va="center", color=INK, weight="bold", bbox=circle
        )


def curves(pyplot: Any, record: Record, names: Sequence[str], label: str) -> Any:
    """Draw columns of one unit against what was prescribed; closed forms (cell, trellis law, zone C
    of yarns that do not stretch) are dashed, points of unloaded steps hollow. The label of the axis
    is without its unit."""
    figure, axes = pyplot.subplots(figsize=(10.4, 4.4))
    prescribed = record.facts["prescribed_name"]
    unit, factor = choose_unit(COUPON_MEASURES[names[0]].unit)
    across_label, across = find_axis(prescribed, "coupon_measures")
    computed = " ".join(name for name in names if not name.startswith(_KNOWN))
    colours = iter((WARP, WEFT) if "warp" in computed and "weft" in computed else COLOURS)
    slack = record[UNLOADED] == 1
    for name in names:
        known = name.startswith(_KNOWN)
        if known:
            looks = {"ls": "--", "lw": 1.6, "zorder": 3}
            colour = INK
        else:
            looks = {"ls": "-", "marker": "o", "ms": 4.5}
            colour = next(colours)
        axes.plot(
            across * record[prescribed], factor * record[name], color=colour, label=name, **looks
        )
        if slack.any() and not known:
            axes.plot(
                across * record[prescribed][slack],
                factor * record[name][slack],
                ls="",
                marker="o",
                ms=5.5,
                mfc="white",
                mec=colour,
                zorder=4,
                label=f"{name}, unloaded",
            )
    axes.set(xlabel=across_label, ylabel=f"{label} [{unit}]")
    axes.set_xlim(left=0)
    if unit != "°" and all(record[name].min() >= 0 for name in names):
        axes.set_ylim(bottom=0)
    if len(names) > 1 or slack.any():
        legend_beside(axes)
    return figure


def relaxation(pyplot: Any, solved: Result, tolerance: float) -> Any:
    """Draw the out-of-balance force over the reaction through all iterations; a line marks the end
    of each step."""
    figure, axes = pyplot.subplots(figsize=(10.4, 3.6))
    out, reaction = np.concatenate([state.history for state in solved.states]).T
    ratio = out / np.maximum(reaction, solved.force_floor)
    axes.semilogy(
        np.arange(1, ratio.size + 1), np.maximum(ratio, 0.1 * tolerance), color=COLOURS[0], lw=0.8
    )
    axes.axhline(tolerance, color=INK, lw=1.2, ls="--", label="tolerance")
    for end in np.cumsum([state.iterations for state in solved.states]):
        axes.axvline(end, color=FAINT, lw=0.5)
    axes.set(xlabel="iterations, all steps", ylabel="out of balance / reaction")
    axes.set_xlim(0, ratio.size)
    axes.legend(loc="upper right")
    return figure


def pull_out(pyplot: Any, curve: PullOutCurve) -> Any:
    """Draw the load of a pulled yarn, and the crossovers that it slides through and has left,
    against the displacement."""
    figure, (upper, lower) = pyplot.subplots(
        2, 1, figsize=(10.4, 6.4), sharex=True, height_ratios=(2, 1)
    )
    crosshead, load = (
        find_axis(name, "coupon_measures") for name in ("displacement of the crosshead", "load")
    )
    displacement = crosshead.factor * curve.displacement
    upper.plot(displacement, load.factor * curve.load, color=WARP, lw=1.2)
    if curve.plateau is not None:
        upper.axhline(
            curve.plateau, color=INK, lw=1.2, ls="--", label=f"plateau {curve.plateau:.3g} N"
        )
        upper.legend(loc="lower center")
    upper.set(ylabel=load.label)
    upper.set_ylim(bottom=0)
    lower.plot(displacement, curve.sliding, color=WARP, lw=1.2, label="in slip")
    lower.plot(
        displacement, curve.left, color=WEFT, lw=1.2, ls="--", label="left by the yarn's end"
    )
    lower.set(xlabel=crosshead.label, ylabel="crossovers")
    lower.set_xlim(left=0)
    lower.set_ylim(bottom=0)
    legend_beside(lower)
    return figure
