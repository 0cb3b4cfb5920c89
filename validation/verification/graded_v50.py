"""V50 studies on graded panels against the uniform one: the same drawn panels, struck at the same velocities.

    python -m validation.verification.graded_v50 [--shots 200] [--out FOLDER] [--page docs/reports/scatter.md]

Elements of one crossover reach to f crossovers from the impact point: all that can come under the nose, at least 10.
Shot k has the panel number k of the study and the velocity k of a range about the critical velocity without scatter, on
every mesh. Reported are the shots whose outcome differs from that on the uniform mesh, V50 with its interval, the
residual velocities of the shots that perforate on both, and the CPU time over that on the uniform mesh, the median over
the shots: the runs of one panel follow each other, so that the ratio holds on a busy machine too. Runs are kept in the
folder.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil, inf
from pathlib import Path
from typing import Any

import numpy as np

from fabrics import catalogue, run_cache
from shellfabric.impact.simulation import ImpactSetup
from validation.program import program
from weavecell.analysis.uncertainty import inputs, probit, v50
from weavecell.report.marked_page import markdown, put
from weavecell.results import provenance

FABRICS = ("S-720", "S-726", "S-728")
OPENING, SEED, TOLERANCE = 0.203, 1, 1.0  # [m], of the draws, [m/s] of the critical velocity
RANGE = 0.82, 1.06  # of the critical velocity without scatter; yarns that scatter are weaker
Grading = tuple[tuple[float, float], ...] | None
ZONES: dict[str, Grading] = {  # ends of the zones in units of f, see `v50.first_zone`
    "1": None,
    "1 to f, 2 to 2 f, then 4 (default)": ((1.0, 1), (2.0, 2), (inf, 4)),
}
MARKS = "<!-- table of validation.verification.graded_v50 -->", "<!-- end of graded_v50 -->"


@dataclass(frozen=True)
class Shot:
    """One drawn panel at one velocity, on all meshes.

    Parameters
    ----------
    velocity : [m/s]
    residuals : (meshes,) [m/s] residual velocities; 0 of a projectile that stops
    seconds : (meshes,) [s] CPU time
    """

    velocity: float
    residuals: tuple[float, ...]
    seconds: tuple[float, ...]


def gradings(name: str) -> tuple[int, tuple[Grading, ...]]:
    """(f [crossovers], gradings of a fabric of the catalogue, in the order of ZONES)."""
    first = v50.first_zone(ImpactSetup(catalogue.load(name), 1.0, opening=OPENING))
    return first, tuple(
        None if zones is None else tuple((ceil(until * first) if until < inf else inf, side) for until, side in zones)
        for zones in ZONES.values()
    )


def shot(name: str, number: int, velocity: float, zones: tuple[Grading, ...]) -> Shot:
    """The shot of a number at a fabric of the catalogue, on each mesh."""
    fabric, scatter = catalogue.load(name).with_effective_density(), inputs.published()
    uniform = ImpactSetup(fabric, 1.0, opening=OPENING)
    rows: list[tuple[float, float]] = []
    for grading in zones:
        began = time.process_time()
        found = v50.fire(replace(uniform, grading=grading), scatter, SEED, number, velocity)
        rows.append((found.residual if found.perforated else 0.0, time.process_time() - began))
    residuals, seconds = zip(*rows)
    return Shot(velocity, residuals, seconds)


def rows_of(name: str, shots: Sequence[Shot]) -> list[list[str]]:
    """Rows of the table: one a mesh."""
    residuals, V = np.array([one.residuals for one in shots]), [one.velocity for one in shots]
    seconds, uniform = np.array([one.seconds for one in shots]), residuals[:, 0] > 0
    rows, plain = [], ImpactSetup(catalogue.load(name), 1.0, opening=OPENING, symmetry="whole", table_size=11)
    first, zones = gradings(name)
    for k, (sides, grading) in enumerate(zip(ZONES, zones)):
        hit = residuals[:, k] > 0
        curve, both = probit.fit(V, hit), hit & uniform
        off = residuals[both, k] - residuals[both, 0]
        low, high = curve.intervals["V50"]
        elements, other = replace(plain, grading=grading).panel().elements, np.count_nonzero(hit != uniform)
        rows.append([
            f"{name}, f = {first}" if k == 0 else "", sides, f"{elements}", f"{other} of {len(V)}",
            f"{curve.V50:.2f} ({low:.1f} to {high:.1f})", f"{np.sqrt(np.mean(off**2)):.2f}",
            f"{np.abs(off).max():.2f}", f"{np.median(seconds[:, k] / seconds[:, 0]):.2f}",
        ])  # fmt: skip
    return rows


def main(*, shots: int = 200, jobs: int = 1, out: Path = Path("results/graded-v50"), page: Path | None = None) -> None:
    table = [["fabric", "sides [crossovers]", "elements", "other outcome than uniform", "V50, m/s (95 %)",
              "residual velocity, rms difference, m/s", "largest, m/s", "CPU time over uniform"]]  # fmt: skip
    runs: dict[str, Any] = {"folder": out, "jobs": jobs}
    for name in FABRICS:
        setup = ImpactSetup(catalogue.load(name).with_effective_density(), 1.0, opening=OPENING)
        (bracket,) = run_cache.results(v50.deterministic, [(setup, TOLERANCE)], **runs)
        velocities = 0.5 * sum(bracket) * np.linspace(*RANGE, shots)
        places = [(name, k, round(float(V), 4), gradings(name)[1]) for k, V in enumerate(velocities)]
        table += rows_of(name, run_cache.results(shot, places, **runs))
        print(markdown(table), flush=True)
    if page is not None:
        stamp = provenance.stamp()
        made = f"Made by `python -m validation.verification.graded_v50 --shots {shots}`, commit {stamp['commit']}."
        put(page, *MARKS, f"\n\n{markdown(table)}\n{made}\n\n")


if __name__ == "__main__":
    program(main, shots="of each fabric")
