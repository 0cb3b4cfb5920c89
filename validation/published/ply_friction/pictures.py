"""Picture of the study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from fabrics.files import replace_whole
from meshing.pictures_style import BLUE, GREEN, ORANGE, RED
from validation.published.ply_friction.study import Found


def chart(found: Mapping[str, Sequence[Found]], path: Path) -> None:
    """Velocity at first failure (open) and ballistic limit (full, with its zone of mixed outcomes) against friction.

    Parameters
    ----------
    found : {fabric: rows}
    """
    figure, axes = plt.subplots(figsize=(8.6, 4.6), layout="constrained")
    for (fabric, rows), colour in zip(found.items(), (BLUE, ORANGE, GREEN, RED)):
        mu = [one.friction for one in rows]
        limits = [one.limit for one in rows]
        zone = [[max(one.limit - one.perforation, 0) for one in rows], [max(one.stop - one.limit, 0) for one in rows]]
        axes.errorbar(mu, limits, zone, fmt="o-", color=colour, capsize=3, label=f"{fabric}, ballistic limit")
        axes.plot(mu, [one.onset for one in rows], "o--", color=colour, mfc="white", label=f"{fabric}, first failure")
    axes.set(xlabel="friction coefficient between plies", ylabel="strike velocity [m/s]")
    axes.set_ylim(0, 1.12 * max(max(one.limit, one.stop) for rows in found.values() for one in rows))
    axes.legend(frameon=False, ncols=2)
    axes.grid(alpha=0.3)
    with replace_whole(path) as beside:
        figure.savefig(beside, format="png", dpi=130)
    plt.close(figure)
