"""Coverage of the discretisation uncertainty: random scenes, each held against a finer mesh than both of its pair.

    python -m validation.verification.discretisation [--out results/discretisation] [--page docs/reports/convergence.md]

Each scene is run on its own mesh, on the finer mesh of `weavecell impact --uncertainty`, and on a reference with a
quarter of the element side near the impact point. A scene is covered where the reference lies in the interval of every
result. Runs are kept in the folder and not made twice.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

from fabrics import run_cache
from shellfabric.impact import simulation
from shellfabric.impact.simulation import ImpactSetup
from validation.marked_page import markdown
from validation.program import program, publish
from validation.verification import drawn_shots
from weavecell.studies import mesh_uncertainty, window

COUNT, SEED = 40, 808
MARKS = "<!-- table of validation.verification.discretisation -->", "<!-- end of discretisation -->"


@dataclass(frozen=True)
class Row:
    """One scene.

    Parameters
    ----------
    fabric, velocity : [-, m/s] of the scene
    outcomes : on the scene's mesh, the finer one and the reference
    results : ((name, unit, value, reference, uncertainty), ...) of the results that all three meshes have
    seconds : [s] process time of the three
    """

    fabric: str
    velocity: float
    outcomes: tuple[str, str, str]
    results: tuple[tuple[str, str, float, float, float], ...]
    seconds: tuple[float, float, float]

    @property
    def decided(self) -> bool:
        """Whether the pair has one outcome, so that there are intervals."""
        return self.outcomes[0] == self.outcomes[1]

    @property
    def covered(self) -> bool:
        """Whether the reference has that outcome and lies in all intervals."""
        inside = all(abs(reference - value) <= u for _, _, value, reference, u in self.results)
        return self.decided and self.outcomes[2] == self.outcomes[0] and inside


def reference(setup: ImpactSetup, finer: ImpactSetup) -> ImpactSetup:
    """The set-up with a quarter of the scene's element side near the impact point, and half of it around that."""
    count = setup.resolved_elements_per_crossover
    if finer.grading is None:
        return replace(setup, elements_per_crossover=4 * count)
    reach = finer.grading[0][0]
    grading = ((reach, 1 / (4 * count)), (2 * reach, 1 / (2 * count)), (inf, 1 / count))
    return replace(setup, elements_per_crossover=None, grading=grading)


def row(number: int) -> Row:
    """The random scene of a number, on its three meshes."""
    drawn = drawn_shots.drawn(number, SEED)
    setup: Any = mesh_uncertainty.smallest_part(replace(drawn, numerics=replace(drawn.numerics, threads=1)))
    table = setup.table()
    refined: Any = mesh_uncertainty.finer(setup, table)
    results: list[Any] = []
    seconds: list[float] = []
    for this in (setup, refined, reference(setup, refined)):
        began = time.process_time()
        result = simulation.run(this, table=table)
        results.append(mesh_uncertainty.Shot(result, window=window.about(result)))
        seconds.append(time.process_time() - began)
    pair = mesh_uncertainty.compare(*results[:2])
    finest = {one.name: one.other for one in mesh_uncertainty.compare(results[0], results[2]).intervals}
    found = tuple(
        (one.name, one.unit, one.value, finest[one.name], one.uncertainty)
        for one in pair.intervals if one.name in finest
    )  # fmt: skip
    (outcome, *others), (one, two, three) = (shot.result.outcome for shot in results), seconds
    return Row(setup.fabric.name, setup.strike_velocity, (outcome, *others), found, (one, two, three))


def tables(rows: list[Row]) -> str:
    """A summary and the scenes."""
    decided = [one for one in rows if one.decided]
    covered = sum(one.covered for one in decided)
    summary = [["cases", "outcome depends on the mesh of the pair", "all results within their intervals",
                "cost of the pair over that of the case, median"],
               [f"{len(rows)}", f"{len(rows) - len(decided)}", f"{covered} of {len(decided)}",
                f"{np.median([1 + one.seconds[1] / one.seconds[0] for one in rows]):.1f}"]]  # fmt: skip
    names = list(dict.fromkeys(name for one in decided for name, *_ in one.results))
    results = [["result", "cases", "covered", "median uncertainty, % of the value", "median error, % of the value"]]
    for name in names:
        found = [(value, ref, u) for one in decided for n, _, value, ref, u in one.results if n == name and value]
        inside = sum(abs(ref - value) <= u for value, ref, u in found)
        sizes = [100 * u / abs(value) for value, _, u in found]
        errors = [100 * abs(ref / value - 1) for value, ref, _ in found]
        results.append([name, f"{len(found)}", f"{inside}", f"{np.median(sizes):.2g}", f"{np.median(errors):.2g}"])
    missed = [["case", "strike, m/s", "outcomes", "results outside their intervals: value, uncertainty, reference"]]
    for one in decided:
        if not one.covered:
            outside = [f"{name}: {value:.4g} ± {u:.2g}, {ref:.4g} {unit}"
                       for name, unit, value, ref, u in one.results if abs(ref - value) > u]  # fmt: skip
            missed.append([one.fabric, f"{one.velocity:g}", ", ".join(one.outcomes), "; ".join(outside) or "-"])
    return "\n".join(markdown(part) for part in (summary, results, missed) if len(part) > 1)


def main(
    *, out: Path = Path("results/discretisation"), jobs: int = 1, count: int = COUNT, page: Path | None = None
) -> None:
    places = [(number,) for number in range(count)]
    rows = run_cache.results(row, places, folder=out, jobs=jobs)
    made = tables(rows)
    publish(made, page, MARKS)


if __name__ == "__main__":
    program(main, count="number of scenes")
