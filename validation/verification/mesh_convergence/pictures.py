"""Picture of the study: each quantity over its limit against the size of the elements, one panel a quantity."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from fabrics.files import replace_whole
from meshing.pictures_style import COLOURS
from validation.verification.mesh_convergence.study import FACTORS, TARGETS

if TYPE_CHECKING:
    from validation.verification.mesh_convergence.study import Quantity

MARKERS = ("o", "s", "^", "D", "v", "P")


def picture(quantities: Sequence[Quantity], path: Path) -> None:
    """Deviation of every fabric from its own limit; hollow where the limit is no Richardson extrapolation."""
    kind = {id(entry): entry.name.partition(" at ")[0] for entry in quantities}
    first = [entry for entry in quantities if entry.fabric == quantities[0].fabric]
    ranks = [_rank(entry, quantities) for entry in first]
    fabrics = list(dict.fromkeys(entry.fabric for entry in quantities))
    figure, row = plt.subplots(2, 4, figsize=(15, 8), squeeze=False)
    places = row.ravel()
    for axes, (name, rank) in zip(places, ranks):
        chosen = [entry for entry in quantities if _rank(entry, quantities) == (name, rank)]
        target = 100 * TARGETS[chosen[0].unit]
        axes.axhspan(-target, target, color="#e8eef4", lw=0)
        for entry in chosen:
            k = fabrics.index(entry.fabric)
            h, deviation = 1 / np.array(entry.elements), 100 * np.array(entry.deviations)
            colour = COLOURS[k % 6]
            regular = entry.extrapolation.basis in ("Richardson", "no change")
            looks = {"ls": "-", "mfc": colour} if regular else {"ls": "--", "mfc": "white"}
            axes.plot(
                [*h, 0], [*deviation, 0], color=colour, marker=MARKERS[k % 6], ms=6.5, lw=1.6, mec=colour,
                label=entry.fabric, clip_on=False, **looks,
            )  # fmt: skip
        axes.axhline(0, color="#9aa3ad", lw=0.8)
        factor = f"\nat {FACTORS[rank]} times the critical velocity" if rank >= 0 else ""
        title = kind[id(chosen[0])] + factor
        axes.set(xlim=(0, 1.09), xlabel="elements per crossover")
        axes.set_title(title, fontsize=10)
        axes.set_xticks([0, *(1 / n for n in chosen[0].elements)], ["∞", *map(str, chosen[0].elements)])
        axes.grid(axis="y", alpha=0.3)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    for axes in places[len(ranks) :]:
        axes.axis("off")
    for axes in row[:, 0]:
        axes.set_ylabel("deviation from the limit [%]")
    handles, labels = places[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower right", bbox_to_anchor=(0.97, 0.2), ncols=2, frameon=False)
    figure.text(
        0.77, 0.13, "shaded: target; dashed and hollow:\nlimit from a least-squares fit,\nthe order being irregular",
        ha="left", va="top", fontsize=9, color="#555555",
    )  # fmt: skip
    figure.tight_layout()
    with replace_whole(path) as beside:
        figure.savefig(beside, dpi=150, metadata={"Date": None} if str(path).endswith(".svg") else None)
    plt.close(figure)


def _rank(entry, quantities):
    """(kind of quantity, how many of the same fabric and kind precede it; -1 where it is alone)."""
    kind = entry.name.partition(" at ")[0]
    alike = [one for one in quantities if one.fabric == entry.fabric and one.name.partition(" at ")[0] == kind]
    return kind, (-1 if len(alike) == 1 else [one.name for one in alike].index(entry.name))


def yarns(found: Any, path: Path) -> None:
    """Tension across the weft yarns beside the nose's edge, one panel a fabric, one line a mesh (see `yarn`)."""
    names = list(dict.fromkeys(entry.fabric for entry in found))
    figure, row = plt.subplots(1, len(names), figsize=(4.6 * len(names), 4.4), sharey=True, squeeze=False)
    for axes, name in zip(row[0], names):
        below = {"va": "bottom", "fontsize": 9, "transform": axes.get_xaxis_transform()}
        entries = [entry for entry in found if entry.fabric == name]
        first = entries[0].number
        axes.axvspan(first - 0.5, first + 0.5, color="#e8eef4", lw=0)
        axes.text(first - 0.55, 0.02, "yarn that\nfails first", ha="right", **below)
        axes.axvspan(*entries[0].edge, color="#f3d9b8", lw=0, alpha=0.7)
        axes.text(max(entries[0].edge[1], first + 0.5) + 0.05, 0.02, "edge of\nthe nose", **below)
        for k, entry in enumerate(entries):
            label = f"{entry.elements} a crossover: yarn {entry.yarn:.0f} N"
            axes.plot(entry.place, entry.tension, color=COLOURS[k], marker=MARKERS[k], ms=5, lw=1.5, label=label)
        axes.set(title=name, xlabel="crossovers from the middle", xlim=(0, entries[0].place[-1]))
        axes.legend(frameon=False, loc="upper left", fontsize=9)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    row[0][0].set(ylabel="tension of the weft's lines [N]", ylim=(0, 330))
    figure.tight_layout()
    with replace_whole(path) as beside:
        figure.savefig(beside, dpi=150)
    plt.close(figure)
