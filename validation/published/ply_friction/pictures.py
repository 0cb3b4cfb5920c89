"""Picture of the study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fabrics.files import replace_whole
from meshing.pictures_style import BLUE, GREEN, ORANGE, RED, plots
from validation.published.ply_friction.study import Found


def chart(found: Mapping[str, Sequence[Found]], path: Path) -> None:
    """Velocity at first failure (open) and ballistic limit (full, with its zone of mixed outcomes) against friction.

    Parameters
    ----------
    found : {fabric: rows}
    """
    with plots() as pyplot:
        figure = compose(pyplot, found)
        with replace_whole(path) as beside:
            figure.savefig(beside, format="png", dpi=130)


def compose(pyplot: Any, found: Mapping[str, Sequence[Found]]) -> Any:
    """The figure of `chart`; bars: from the lowest perforation to the highest stop where they overlap."""
    figure, axes = pyplot.subplots(figsize=(9.4, 4.6))
    for (fabric, rows), colour, mark in zip(found.items(), (BLUE, ORANGE, GREEN, RED), "os^D"):
        mu = [one.friction for one in rows]
        limits = [one.limit for one in rows]
        zone = [[max(one.limit - one.perforation, 0) for one in rows], [max(one.stop - one.limit, 0) for one in rows]]
        axes.errorbar(
            mu, limits, zone, fmt=f"{mark}-", color=colour, capsize=4, lw=1.8, label=f"{fabric}, ballistic limit"
        )
        axes.plot(
            mu,
            [one.onset for one in rows],
            f"{mark}--",
            color=colour,
            lw=1.8,
            mfc="white",
            label=f"{fabric}, first failure",
        )
    axes.set(xlabel="friction coefficient between plies", ylabel="strike velocity [m/s]", title="four plies, 203 mm")
    axes.set_xticks(sorted({one.friction for rows in found.values() for one in rows}))
    figure.legend(loc="outside right upper")
    return figure
