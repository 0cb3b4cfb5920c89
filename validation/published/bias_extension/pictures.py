"""Picture of the bias extension test: the deformed coupons, coloured by the angle between the yarns."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from fabrics.files import replace_whole
from shellfabric.coupon.quasistatic import ZONES, bias_size
from validation.published.bias_extension.cases import CLOTHS, Case

_LABEL = {
    "ha": "center", "va": "center", "fontsize": 9, "bbox": {"facecolor": "white", "alpha": 0.7, "lw": 0, "pad": 1.5}
}  # fmt: skip


def picture(cases: list[Case], path: Path) -> None:
    """Draw the coupons side by side at the end of their runs, with the borders of the zones as material lines."""
    figure = Figure(figsize=(3.3 * len(cases), 7.8), layout="constrained")
    for axes, case in zip(figure.subplots(1, len(cases), sharey=True, squeeze=False)[0], cases):
        result = case.result
        x, angle = 1e3 * result.states[-1].x, 90 - np.degrees(result.shear())
        width = 1e3 * bias_size(result)[1]
        lowest = 72 if case.problem is None else 40
        cloth = PolyCollection(
            x[result.coupon.quads], array=angle, cmap="viridis_r", clim=(lowest, 90), edgecolors="face"
        )
        cloth.set_linewidth(0.2)
        cloth.set_rasterized(True)
        axes.add_collection(cloth)
        if case.problem is None:
            for k, name in enumerate(ZONES):
                for middle in _middles(case, k):
                    axes.text(*(1e3 * middle), f"{name}\n{case.means()[k]:.1f}°", **_LABEL)
        force, moved = abs(result.force(1, 1)[-1]), 1e3 * result.prescribed[-1]
        state = f"{moved:.3g} mm, {force:.0f} N" if case.problem is None else f"{moved:.3g} mm: bands, stopped"
        axes.set_title(f"{CLOTHS[case.name]}\n{state}", fontsize=10)
        axes.set(aspect="equal", xlabel="mm", xlim=(-0.61 * width, 0.61 * width))
        axes.autoscale_view(scalex=False)
        axes.spines[["top", "right"]].set_visible(False)
        label = f"angle between the yarns, °\n({lowest} and less in yellow)"
        figure.colorbar(cloth, ax=axes, location="bottom", shrink=0.9, label=label)
    figure.axes[0].set_ylabel("along the load, mm")
    title = f"Bias extension of balanced S-728; not stretching, zone C would be at {cases[0].inextensible():.1f}°"
    # above the titles of the coupons, for which the equal scales leave no room inside the figure
    figure.text(0.5, 1.03, title, ha="center", fontsize=12)
    with replace_whole(path) as beside:
        figure.savefig(beside, dpi=130, bbox_inches="tight")


def _middles(case, k):
    """Places [m] for the label of zone k: its middle in each of its parts."""
    result = case.result
    x, rest = result.states[-1].x, result.coupon.points
    length, width = bias_size(result)
    spots = {0: ((0, 0.5 * length - 0.17 * width),), 1: ((-0.33 * width, 0.5 * length - 0.5 * width),), 2: ((0, 0),)}[k]
    return [x[np.argmin(np.linalg.norm(rest - spot, axis=1))] for spot in spots]
