"""Whether [accuracy] keeps its targets: random shots, each held against a mesh twice as fine as the one of its results.

    python -m validation.verification.accuracy [--count 20] [--out results/accuracy] [--page docs/reports/fidelity.md]

Shots at one ply and, every third, at packs of two to four; one or two quantities of each have a target of 2, 5 or 10 %.
All elements of the reference have half the side of those of the results. Runs are kept in the folder.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from fabrics import run_cache
from fabrics.errors import InputError, UnstableError
from shellfabric.impact import simulation
from shellfabric.impact.simulation import ImpactSetup
from validation.marked_page import markdown
from validation.program import program, publish
from validation.verification import drawn_shots
from weavecell.studies import mesh_uncertainty, window

COUNT, SEED = 20, 2025
TARGETS = (0.02, 0.05, 0.1)
QUANTITIES = {"residual velocity": "residual_velocity", "absorbed energy": "absorbed_energy",
              "peak deflection": "deflection", "peak tension, warp": "peak_tension",
              "peak tension, weft": "peak_tension"}  # fmt: skip
FINEST = 16  # elements per crossover
SMALLER, END = (0.5, 0.35), 250e-6  # opening over that of a drawn ply and pack, [s]: shots of seconds
MARKS = "<!-- table of validation.verification.accuracy -->", "<!-- end of accuracy -->"


@dataclass(frozen=True)
class Row:
    """One shot: in words, its targets, the meshes that were run, whether confirmed, errors against the reference, which
    may have another outcome, and the process time of all meshes over that of the first."""

    shot: str
    targets: dict[str, float]
    meshes: tuple[str, ...]
    confirmed: bool
    outcomes: tuple[str, str]
    errors: dict[str, float]
    cost: float

    @property
    def met(self) -> bool:
        """Whether the results are within their targets of the reference, whatever the command says."""
        return len(set(self.outcomes)) == 1 and all(self.errors[name] <= share for name, share in self.targets.items())


def row(number: int) -> Row:
    """The random shot of a number, its results and the reference."""
    draw = np.random.default_rng((SEED, number, 1))
    names = draw.choice(sorted(set(QUANTITIES.values())), int(draw.integers(1, 3)), replace=False)
    targets = {str(name): float(draw.choice(TARGETS)) for name in names}
    drawn: Any = (drawn_shots.drawn_pack if number % 3 == 2 else drawn_shots.drawn)(number, SEED)
    opening: Any = tuple(SMALLER[drawn.plies > 1] * side for side in drawn.opening)
    drawn = replace(drawn, opening=opening, end_time=END, numerics=replace(drawn.numerics, threads=1))
    results: list[Any] = []
    seconds: list[float] = []

    def shoot(setup: ImpactSetup, table: Any, _: str = "") -> Any:
        began = time.process_time()
        result, problem = simulation.fired(setup, table=table)
        results.append(mesh_uncertainty.Shot(result, UnstableError(problem) if problem else None, window.about(result)))
        seconds.append(time.process_time() - began)
        return results[-1]

    _, found = mesh_uncertainty.climb(drawn, targets, shoot, fixed={"projectile"})
    answer, cost = results[-1], sum(seconds) / seconds[0]
    table, finest = found.setup.table(), replace(found.setup, grading=None, elements_per_crossover=FINEST)
    try:
        shoot(mesh_uncertainty.halved(found.setup), table)
    except InputError:  # of a graded mesh no element is shorter than an eighth of a crossover
        shoot(finest, table)
    strike = {"residual velocity": drawn.strike_velocity, "absorbed energy": answer.result.strike_energy}
    errors = dict.fromkeys(targets, 0.0)  # of what is not there
    for one in mesh_uncertainty.compare(answer, results[-1]).intervals:
        share = abs(one.other - one.value) / strike.get(one.name, one.other)
        errors[QUANTITIES[one.name]] = max(errors.get(QUANTITIES[one.name], 0.0), share)
    outcomes = answer.result.outcome, results[-1].result.outcome
    return Row(_words(drawn), targets, found.meshes, found.confirmed, outcomes, errors, cost)


def _words(setup):
    plies = f"{setup.plies} plies, " if setup.plies > 1 else ""
    return f"{plies}{setup.fabric.name.split(',')[0]}, {setup.projectile.shape}, {setup.strike_velocity:g} m/s"


def tables(rows: list[Row]) -> str:
    """A summary and the shots."""
    confirmed = [one for one in rows if one.confirmed]
    summary = [["shots", "confirmed", "of these within their targets of a mesh twice as fine", "of all",
                "cost over that of the first mesh, median"],
               [f"{len(rows)}", f"{len(confirmed)}", f"{sum(one.met for one in confirmed)}",
                f"{sum(one.met for one in rows)}",
                f"{np.median([one.cost for one in rows]):.1f}"]]  # fmt: skip
    shots = [["shot (fabrics changed)", "outcome", "target and error against the reference, %", "mesh of the results",
              "confirmed", "within"]]  # fmt: skip
    for one in rows:
        found = [f"{name.replace('_', ' ')} {100 * share:g}: {100 * one.errors[name]:.2g}"
                 for name, share in one.targets.items()]  # fmt: skip
        outcome = " / ".join(dict.fromkeys(one.outcomes))
        shots.append([one.shot, outcome, "; ".join(found), one.meshes[-1], *("yes" if yes else "**no**"
                     for yes in (one.confirmed, one.met))])  # fmt: skip
    return "\n".join(map(markdown, (summary, shots)))


def main(
    *, out: Path = Path("results/accuracy"), jobs: int = 1, count: int = COUNT, page: Path | None = None
) -> None:  # fmt: skip
    rows = run_cache.results(row, [(number,) for number in range(count)], folder=out, jobs=jobs)
    publish(tables(rows), page, MARKS)


if __name__ == "__main__":
    program(main, count="number of shots")
