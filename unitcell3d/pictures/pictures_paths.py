"""Plots of loading paths and of the fitted law (matplotlib, SVG or PNG)."""

from __future__ import annotations

import numpy as np

from fabrics.checks import FilePath
from fabrics.fabric import Fabric
from fabrics.files import replace_whole
from meshing.pictures_style import FAINT, GREEN, INK, PURPLE, WARP, WEFT, plots
from unitcell3d.identify.calibration import PLATES, Calibration, samples

COLOURS = (WARP, WEFT, GREEN, PURPLE)


def tensions(calibration: Calibration, fabric: Fabric, path: FilePath) -> None:
    """Warp and weft tension along each biaxial path, with the yarns' strengths; marks where the worst bar fails."""
    named = {name: history for name, history in calibration.histories.items() if name != PLATES}
    with plots() as pyplot:
        figure, axes = pyplot.subplots(1, len(named), figsize=(4.6 * len(named), 4.2), sharey=True, squeeze=False)
        for axis, (name, history) in zip(axes[0], named.items()):
            d = 1e3 * np.maximum(history.d1, history.d2)
            for T, label, colour, yarn in zip((history.T1, history.T2), ("warp", "weft"), COLOURS, fabric.weave.yarns):
                axis.plot(d, T, color=colour, lw=2.2, label=label)
                axis.axhline(yarn.strength, color=colour, lw=1, ls=(0, (2, 3)))
            for item in calibration.failures[name]:
                if item.criterion == "worst bar":
                    at = 1e3 * max(item.d)
                    axis.axvline(at, color=FAINT, lw=1, ls="--")
                    axis.text(
                        at, 110, "worst bar fails ", rotation=90, ha="right", va="bottom", color=FAINT, fontsize=10
                    )
            axis.set_title(name, loc="left", fontweight="bold")
            axis.set_xlabel("end displacement d [mm]")
        axes[0, 0].set_ylabel("yarn tension [N]")
        axes[0, 0].set_ylim(bottom=0)
        axes[0, 0].legend(loc="upper left", bbox_to_anchor=(0, 0.9), title="dotted: strength")
        _save(figure, path)


def fit(calibration: Calibration, path: FilePath) -> None:
    """Contact force against compression: samples of each path, the fitted law, the published one and the plates."""
    with plots() as pyplot:
        figure, axis = pyplot.subplots(figsize=(8.2, 5.4))
        top = 1.08 * max(history.F_c.max() for history in calibration.histories.values())
        F = np.geomspace(1e-3, top, 400)
        law, published = calibration.law, calibration.published
        axis.plot(
            1e3 * law.d(F),
            F,
            color=INK,
            lw=2.4,
            label=f"fit: {_numbers(law)}, rms {1e6 * (law.residual_rms or 0.0):.2f} µm",
        )
        if published is not None:
            axis.plot(1e3 * published.d(F), F, color=FAINT, lw=2.2, ls="--", label=f"published: {_numbers(published)}")
        for (name, history), colour, marker in zip(calibration.histories.items(), COLOURS, "osD^"):
            if name == PLATES:
                axis.plot(
                    1e3 * history.d_c, history.F_c, color=colour, lw=1.6, marker="^", ms=4, label="between plates"
                )
            else:
                force, compression = samples(history)
                axis.plot(1e3 * compression, force, marker, color=colour, ms=5.5, mfc="white", mew=1.4, label=name)
        axis.set_xlabel("compression of one yarn d_c [mm]")
        axis.set_ylabel("contact force F_c [N]")
        axis.set_ylim(0, top)
        axis.set_xlim(left=0)
        axis.legend(loc="upper left")
        axis.set_title(f"{calibration.fabric}, {calibration.sizes[0]} mesh", loc="left", fontweight="bold")
        _save(figure, path)


def _numbers(law):
    return f"a {1e3 * law.a:.4f} mm, b {1e3 * law.b:.4f} mm N$^{{1/3}}$"


def _save(figure, path):
    with replace_whole(path) as beside:
        figure.savefig(beside)
