"""Plots of coupons, from plain arrays in SI units to matplotlib figures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from meshing.pictures_style import COLOURS, FAINT, INK, WARP, WEFT, tension_map

if TYPE_CHECKING:
    from weavecell.results.coupon import CouponRecord
    from weavecell.results.pull_out import PullOutRecord

_AXES = {"m": (1e3, "mm"), "rad": (180 / np.pi, "°"), "N": (1.0, "N"), "Pa": (1e-6, "MPa")}
_SHEARS = ("#f3f5f7", "#fde0a6", "#f4a259", "#d1495b", "#7b2d6b", "#2d1244")  # even steps of lightness

# figures of each test: file, measures, label of the axis, caption
DRAWN = {
    "bias_extension": (
        ("load", ("load",), "load", "Load on a clamp."),
        (
            "angles",
            ("angle in zone A", "angle in zone B", "angle in zone C", "zone C, yarns that do not stretch"),
            "angle between warp and weft",
            "Mean angle in the three zones: of zone A both yarns lead to a clamp, of B one, of C none.",
        ),
    ),
    "picture_frame": (("stress", ("shear stress", "trellis law"), "shear stress", "Work of the frame, by volume."),),
    "uniaxial": (
        ("load", ("load of a yarn",), "load of a yarn", "Load over the yarns that carry it."),
        (
            "strains",
            ("strain in the middle, along", "strain in the middle, across"),
            "strain",
            "Strain of the middle of the strip along the load and across.",
        ),
    ),
    "biaxial": (
        (
            "load",
            (
                "load of a warp yarn", "load of a weft yarn", "cell at these strains, warp",
                "cell at these strains, weft",
            ),
            "load of a yarn",
            "Load of an arm over its yarns; dashed: the cell alone, at the strains of the middle.",
        ),
    ),
}  # fmt: skip


def axis(name: str, unit: str) -> tuple[float, str]:
    """(factor, unit) of a measure in pictures and texts; strains in %."""
    return (100.0, "%") if unit == "1" and "strain" in name else _AXES.get(unit, (1.0, ""))


def cloth(pyplot: Any, record: CouponRecord) -> Any:
    """The coupon at the end: its elements by their shear, and its yarns by their tension.

    Parameters
    ----------
    record : weavecell.results.coupon.CouponRecord
    """
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.colors import LinearSegmentedColormap

    x, degrees = 1e3 * record.x[-1], np.degrees(np.abs(record.shear[-1]))
    span = np.ptp(x, axis=0)
    tall = float(np.clip(span[1] / span[0], 0.15, 2.0))
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(10.4, 2.0 + 4.4 * tall))
    sheared = PolyCollection(
        x[record.quads], array=degrees, cmap=LinearSegmentedColormap.from_list("shear", _SHEARS), edgecolors="face",
        linewidth=0.2, rasterized=True, clim=(0, max(float(np.quantile(degrees, 0.995)), 1.0)),
    )  # fmt: skip
    left.add_collection(sheared)
    lines, tension = np.concatenate([x[record.warp], x[record.weft]]), np.concatenate(record.tension)
    order = np.argsort(tension)  # the tightest on top
    lines, tension = lines[order], tension[order]
    top = max(float(np.quantile(tension, 0.995)), record.floor)
    pulled = LineCollection(lines, array=tension, cmap=tension_map(), clim=(0, top), linewidth=1.0, rasterized=True)
    right.add_collection(pulled)
    if record.test == "bias_extension":
        _zones(left, record)
    factor, unit = axis(record.prescribed_name, record.prescribed_unit)
    state = f"{record.prescribed_name} {factor * record.prescribed[-1]:.3g} {unit}"
    for axes, title, drawn, label in (
        (left, f"shear, {state}", sheared, "shear angle [°]"), (right, "yarns", pulled, "tension of a yarn [N]"),
    ):  # fmt: skip
        axes.set(aspect="equal", title=title, xlabel="mm")
        axes.autoscale_view()
        axes.grid(False)
        bar = figure.colorbar(drawn, ax=axes, location="bottom", shrink=0.8, aspect=30, extend="max")
        bar.set_label(label)
        bar.outline.set_visible(False)
    left.set_ylabel("mm")
    return figure


def _zones(axes, record):
    """The borders of the zones of a bias coupon, lines of the fabric along the yarns from its clamped corners."""
    held = record.points[record.grips > 0]
    half = np.array([np.ptp(record.points[:, 0]) / 2, np.abs(held[:, 1]).min()])
    middle = 0.5 * (record.points.min(axis=0) + record.points.max(axis=0))
    along = np.linspace(0, 2 * half[0], 60)
    for side in (1, -1):
        for end in (1, -1):
            line = middle + np.column_stack([side * (half[0] - along), end * (half[1] - along)])
            nearest = np.argmin(((record.points[None] - line[:, None]) ** 2).sum(axis=-1), axis=1)
            axes.plot(*(1e3 * record.x[-1][nearest]).T, color=INK, lw=1.2, ls="--")
    places = {"A": (0.0, half[1] - 0.3 * half[0]), "B": (0.8 * half[0], half[1] - half[0]), "C": (0.0, 0.0)}
    for name, place in places.items():
        nearest = np.argmin(((record.points - middle - place) ** 2).sum(axis=1))
        axes.annotate(name, 1e3 * record.x[-1][nearest], ha="center", va="center", color=INK, weight="bold",
                      bbox={"boxstyle": "circle", "fc": "white", "ec": INK, "lw": 0.8})  # fmt: skip


def curves(pyplot: Any, record: CouponRecord, chosen: Sequence[str], label: str) -> Any:
    """Measures against what was prescribed.

    Parameters
    ----------
    chosen : names of measures of one unit; closed forms (cell, trellis law, yarns that do not stretch) are dashed
    label : of the axis, without its unit
    """
    figure, axes = pyplot.subplots(figsize=(10.4, 4.4))
    factor, unit = axis(chosen[0], record.measures[chosen[0]][0])
    across, across_unit = axis(record.prescribed_name, record.prescribed_unit)
    for name, colour in zip(chosen, _colours(chosen)):
        looks = {"ls": "--", "lw": 1.6, "zorder": 3} if _is_known(name) else {"ls": "-", "marker": "o", "ms": 4.5}
        axes.plot(across * record.prescribed, factor * record.measures[name][1], color=colour, label=name, **looks)
    axes.set(xlabel=f"{record.prescribed_name} [{across_unit}]", ylabel=f"{label} [{unit}]")
    axes.set_xlim(left=0)
    if unit != "°" and all(record.measures[name][1].min() >= 0 for name in chosen):
        axes.set_ylim(bottom=0)
    if len(chosen) > 1:
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def _colours(names):
    run = [name for name in names if not _is_known(name)]
    paired = all(family in " ".join(run) for family in ("warp", "weft"))
    of_run = iter((WARP, WEFT) if paired else COLOURS)
    return [INK if _is_known(name) else next(of_run) for name in names]


def _is_known(name):
    return name.startswith(("cell", "trellis")) or "do not stretch" in name


def pull_out(pyplot: Any, record: PullOutRecord) -> Any:
    """Load of a pulled yarn, and the crossovers that it slides through and has left, against the displacement."""
    curve = record.curve
    figure, (upper, lower) = pyplot.subplots(2, 1, figsize=(10.4, 6.4), sharex=True, height_ratios=(2, 1))
    moved = 1e3 * curve.displacement
    upper.plot(moved, curve.load, color=WARP, lw=1.2)
    if curve.plateau is not None:
        upper.axhline(curve.plateau, color=INK, lw=1.2, ls="--", label=f"plateau {curve.plateau:.3g} N")
        upper.legend(loc="upper right")
    upper.set(ylabel="load [N]")
    upper.set_ylim(bottom=0)
    lower.plot(moved, curve.sliding, color=WARP, lw=1.2, label="in slip")
    lower.plot(moved, curve.left, color=WEFT, lw=1.2, ls="--", label="left by the yarn's end")
    lower.set(xlabel="displacement of the crosshead [mm]", ylabel="crossovers")
    lower.set_xlim(left=0)
    lower.set_ylim(bottom=0)
    lower.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def relaxation(pyplot: Any, record: CouponRecord, tolerance: float) -> Any:
    """Out-of-balance force over the reaction through all iterations; a line marks the end of each step."""
    figure, axes = pyplot.subplots(figsize=(10.4, 3.6))
    out, reaction = record.relaxation.T
    ratio = out / np.maximum(reaction, record.floor)
    axes.semilogy(np.arange(1, ratio.size + 1), np.maximum(ratio, 0.1 * tolerance), color=COLOURS[0], lw=0.8)
    axes.axhline(tolerance, color=INK, lw=1.2, ls="--", label="tolerance")
    for end in np.cumsum(record.iterations):
        axes.axvline(end, color=FAINT, lw=0.5)
    axes.set(xlabel="iterations, all steps", ylabel="out of balance / reaction")
    axes.set_xlim(0, ratio.size)
    axes.legend(loc="upper right")
    return figure
