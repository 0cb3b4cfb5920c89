"""S-745 on coarse and finer meshes: outcomes at evenly spaced strike velocities, and where the first yarn fails.

    python -m validation.verification.mesh_convergence.mixed_outcomes [--out DIR] [--page docs/reports/convergence.md]

On one element per crossover outcomes are mixed: faster shots stop than some that perforate. For each mesh the study
fires the projectile at even steps of strike velocity, and records at some of these velocities where and when the first
yarn segment fails, and the peak tension of the first stress wave in the weft yarn through the impact point, if nothing
failed. Writes outcomes.csv; with --page the tables go into that page, between the marks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fabrics import catalogue
from shellfabric.cell.model import CellTable
from shellfabric.impact.ballistic_limit import UNDECIDED
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.panel.model import Panel
from shellfabric.solver.pack_solver import PackSolver
from validation.program import program, publish, write_records
from weavecell.report.marked_page import markdown

FABRIC = "S-745"
MESHES = (1, 2, 3)  # elements per crossover, along each side
STRIKES = tuple(range(200, 273, 4))  # [m/s]
LOOKED_AT = (208, 216, 224, 240, 260)  # [m/s]
WAVE = 9e-6  # [s] the first stress wave has not reached the clamp
SAMPLE = 0.25e-6  # [s] between samples
MARKS = "<!-- tables of mixed_outcomes -->", "<!-- end of mixed_outcomes -->"
_FAMILIES = ("warp", "weft")


@dataclass(frozen=True)
class FirstFailure:
    """The first yarn segment that fails.

    Parameters
    ----------
    time : [s] after the strike
    family : "warp" or "weft"
    distance : [crossovers] of the segment from the impact point, along its yarn
    yarn : [crossovers] of the yarn from the impact point
    """

    time: float
    family: str
    distance: float
    yarn: float


class _FirstFailure:
    """Hook: records the segment that fails first; of several at one sample that which is nearest."""

    def __init__(self):
        self.found: FirstFailure | None = None

    def __call__(self, solver):
        if self.found is not None:
            return
        n, stride, near = solver.panel.elements_per_crossover, solver.const.row_stride, []
        for family, failed in enumerate(solver.state.failed):
            for i, j in zip(*divmod(np.flatnonzero(failed), stride)):
                along, across = (i, j) if family == 0 else (j, i)
                near.append(((along + 0.5) / n, across / n, family))
        if near:
            distance, yarn, family = min(near)
            self.found = FirstFailure(solver.time, _FAMILIES[family], float(distance), float(yarn))


def setup(elements: int, failure: bool = True) -> ImpactSetup:
    """The standard shot at the fabric with a mesh."""
    fabric = catalogue.load(FABRIC).with_effective_density()
    return ImpactSetup(fabric, 100.0, elements_per_crossover=elements, failure=failure)


def fire(panel: Panel, velocity: float) -> tuple[PackSolver, FirstFailure | None]:
    """One shot at a velocity [m/s], to its outcome, and the first failure."""
    solver, first = PackSolver(panel, velocity, UNDECIDED, interval=SAMPLE), _FirstFailure()
    solver.run((first,))
    return solver, first.found


def first_wave(elements: int, table: CellTable, velocity: float) -> tuple[float, float]:
    """(peak tension [N], its distance [crossovers] from the impact point) of the first stress wave in the weft yarn
    through the impact point, of yarns that do not fail."""
    solver = PackSolver(setup(elements, failure=False).panel(table), velocity, WAVE, interval=SAMPLE)
    peak = np.zeros(solver.const.row_stride)

    def look(solver):
        np.maximum(peak, solver.state.T[1][: solver.const.row_stride], out=peak)  # the line of x = 0

    solver.run((look,))
    return float(peak.max()), (int(peak.argmax()) + 0.5) / elements


def study(report: Callable[..., object] | None = print) -> tuple[list[dict], list[dict]]:
    """(rows of the shots, rows of the first waves)."""
    shots, waves, table = [], [], setup(1).table()
    strength = table.model.fabric.weave.weft.strength
    for elements in MESHES:
        panel = setup(elements).panel(table)
        for velocity in STRIKES:
            solver, first = fire(panel, float(velocity))
            shots.append(
                {
                    "elements per crossover": elements, "strike velocity [m/s]": velocity, "outcome": solver.outcome,
                    "failed segments": int(solver.sample("failed_yarns")[-1]),
                    "first failure [us]": "" if first is None else f"{1e6 * first.time:.1f}",
                    "family": "" if first is None else first.family,
                    "distance along the yarn [crossovers]": "" if first is None else f"{first.distance:.1f}",
                    "yarn [crossovers]": "" if first is None else f"{first.yarn:.1f}",
                }
            )  # fmt: skip
            report(" ".join(str(value) for value in shots[-1].values()))
        for velocity in LOOKED_AT:
            peak, place = first_wave(elements, table, float(velocity))
            waves.append(
                {
                    "elements per crossover": elements, "strike velocity [m/s]": velocity,
                    "peak over strength": peak / strength, "distance [crossovers]": place,
                }
            )  # fmt: skip
    return shots, waves


def runs_of_outcomes(shots: Sequence[dict[str, Any]]) -> str:
    """ "stops to 208, perforates 212 to 220, ..." of the shots on one mesh, rising in strike velocity."""
    parts: list[list] = []
    for shot in shots:
        word = {"stopped": "stops", "perforated": "perforates"}.get(shot["outcome"], shot["outcome"])
        if parts and parts[-1][0] == word:
            parts[-1][2] = shot["strike velocity [m/s]"]
        else:
            parts.append([word, shot["strike velocity [m/s]"], shot["strike velocity [m/s]"]])
    return ", ".join(f"{word} {low}" if low == high else f"{word} {low} to {high}" for word, low, high in parts)


def mixed_zone(shots: Sequence[dict[str, Any]]) -> tuple[float, float] | None:
    """(lowest perforation, highest stop) [m/s] of the shots on one mesh; None where these do not overlap."""
    stops = [shot["strike velocity [m/s]"] for shot in shots if shot["outcome"] == "stopped"]
    through = [shot["strike velocity [m/s]"] for shot in shots if shot["outcome"] == "perforated"]
    return (min(through), max(stops)) if min(through) < max(stops) else None


def outcome_table(shots: Sequence[dict[str, Any]]) -> str:
    """One row a mesh."""
    rows = [("elements per crossover", f"outcomes from {STRIKES[0]} to {STRIKES[-1]} m/s, in steps of "
             f"{STRIKES[1] - STRIKES[0]} m/s", "mixed zone, m/s")]  # fmt: skip
    for elements in MESHES:
        own = [shot for shot in shots if shot["elements per crossover"] == elements]
        zone = mixed_zone(own)
        rows.append((str(elements), runs_of_outcomes(own), f"{zone[0]} to {zone[1]}" if zone else "none"))
    return markdown(rows)


def mechanism_table(shots: Sequence[dict[str, Any]], waves: Sequence[dict[str, Any]]) -> str:
    """One row a mesh and velocity that was looked at."""
    rows = [("elements per crossover", "strike, m/s", "peak of the first wave over the strength",
             "its distance, crossovers", "first failure after, µs", "family", "its distance, crossovers", "outcome",
             "failed segments")]  # fmt: skip
    by = {(shot["elements per crossover"], shot["strike velocity [m/s]"]): shot for shot in shots}
    for wave in waves:
        shot = by[wave["elements per crossover"], wave["strike velocity [m/s]"]]
        rows.append(
            (
                str(wave["elements per crossover"]), str(wave["strike velocity [m/s]"]),
                f"{wave['peak over strength']:.2f}", f"{wave['distance [crossovers]']:.1f}",
                shot["first failure [us]"] or "-", shot["family"] or "-",
                shot["distance along the yarn [crossovers]"] or "-", shot["outcome"], str(shot["failed segments"]),
            )
        )  # fmt: skip
    return markdown(rows)


def main(*, out: Path = Path("results/mixed-outcomes"), page: Path | None = None) -> None:
    shots, waves = study()
    write_records(out / "outcomes.csv", shots)
    publish(f"{outcome_table(shots)}\n{mechanism_table(shots, waves)}", page, MARKS)


if __name__ == "__main__":
    program(main)
