"""python -m validation.published.packs.angles [--out results/angles] [--page docs/reports/angles.md]

What turning plies is worth: energy that packs of one fabric absorb whose plies lie at other angles, over the aligned
pack.

Published: up to +14 % of angled over aligned packs, +15 % by the best sequence (Textile Research Journal,
10.1177/0040517514566110). Shots are perforations in a round opening, which is the same for a ply at any angle; the
spread over the strike velocities shows what the order of single failures is worth. Each shot is kept in the folder.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from math import radians
from pathlib import Path
from typing import Any

import numpy as np

from fabrics import catalogue
from shellfabric.impact.simulation import ImpactSetup, Ply, run
from shellfabric.panel.model import Numerics
from validation.commits import computed
from validation.marked_page import markdown, put
from validation.program import program
from validation.published.packs.study import kept
from weavecell.results import provenance

SEQUENCES: tuple[tuple[int, ...], ...] = (
    (0, 0, 0, 0),
    (0, 90, 0, 90),
    (0, 45, 0, 45),
    (0, 15, 30, 45),
    (45, 30, 15, 0),
)
VELOCITIES = (210.0, 230.0, 250.0, 270.0, 290.0)


@dataclass(frozen=True)
class Shot:
    """One shot at four plies of S-728 in a round opening of 100 mm, by the flat cylinder of 3 g.

    Parameters
    ----------
    angles : [deg] of the plies from the front
    velocity : [m/s]
    """

    angles: tuple[int, ...]
    velocity: float


def shoot(shot: Shot) -> dict[str, Any]:
    """What a shot comes to: a dict of numbers and lists, for a file."""
    fabric = catalogue.load("S-728").with_effective_density()
    plies = tuple(Ply(fabric, angle=radians(angle)) for angle in shot.angles)
    result = run(
        ImpactSetup(
            fabric, shot.velocity, opening=0.1, round=True, symmetry="whole", end_time=200e-6, plies=len(plies),
            lay_up=plies, table_size=101, numerics=Numerics(threads=1), ply_friction=0.2,
        )
    )  # fmt: skip
    return {
        "case": asdict(shot),
        "outcome": result.outcome,
        "time": float(result.t[-1]),
        "failed": result.plies["cut_yarns"][-1].tolist(),
        "absorbed": result.strike_energy - 0.5 * result.setup.projectile.mass * result.residual_velocity**2,
        "balance": result.energy_error_max,
        "wall": result.wall_time,
    }


def table(found: Mapping[tuple[int, ...], list[dict[str, Any]]]) -> str:
    """One row a sequence: energy absorbed at each velocity over that of the first, mean and spread."""
    first = np.array([one["absorbed"] for one in found[SEQUENCES[0]]])
    lines = [["angles, deg", *(f"{velocity:g} m/s" for velocity in VELOCITIES), "mean", "rms about the mean"]]
    for angles, shots in found.items():
        words = ["stopped, " if one["outcome"] == "stopped" else "" for one in shots]
        energy = np.array([one["absorbed"] for one in shots])
        more = 100 * (energy / first - 1)
        cells = [f"{word}{value:.1f} J" for word, value in zip(words, energy)]
        if angles != SEQUENCES[0]:
            cells = [f"{word}{value:+.1f} %" for word, value in zip(words, more)]
        ends = [f"{more.mean():+.1f} %", f"{more.std():.1f} %"] if angles != SEQUENCES[0] else ["", ""]
        lines.append([" / ".join(map(str, angles)), *cells, *ends])
    shots = [one for each in found.values() for one in each]
    worst, missed = max(one["balance"] for one in shots), sum(one["missed"] for one in shots)
    error = f"Largest energy error {100 * worst:.2g} % of the strike energy"
    return f"{markdown(lines)}\n{error}; crossings of plies not prevented: {missed:g}."


def main(*, out: Path = Path("results/angles"), page: Path | None = None) -> None:
    stamp, results = provenance.stamp(), kept(out)
    found = {angles: [results(Shot(angles, v), shoot) for v in VELOCITIES] for angles in SEQUENCES}  # type: ignore[arg-type]
    text = table(found)
    print(text)
    if page:
        command = f"python -m validation.published.packs.angles --page {page}"
        put(page, "<!-- angles -->", "<!-- end of angles -->", f"\n{computed(command, stamp)}\n\n{text}\n")


if __name__ == "__main__":
    program(main)
