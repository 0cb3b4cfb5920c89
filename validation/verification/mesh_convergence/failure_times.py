"""S-731 above its critical velocity: residual velocity and time of the first failure on several meshes.

    python -m validation.verification.mesh_convergence.failure_times [--out FOLDER] [--page docs/reports/convergence.md]

The tension under the nose rises in steps, as stress waves come back from the clamped edges, and the ply fails at one of
them: at a lower strike velocity at a later one. The residual velocity therefore jumps at certain strike velocities. For
each mesh of `study.mesh` the shots are fired at even steps, and the strike velocity above which the ply fails within
EARLY is bisected. Runs are kept in the folder. With --page the tables go into that page, between the marks.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import catalogue, run_cache
from shellfabric.impact.ballistic_limit import UNDECIDED
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.panel.numerics import Numerics
from shellfabric.solver.pack_solver import PackSolver
from validation.program import program, publish
from validation.verification.mesh_convergence.study import mesh
from weavecell.report.marked_page import markdown
from weavecell.results import provenance

if TYPE_CHECKING:
    from shellfabric.panel.model import Panel

FABRIC = "S-731"
MESHES = (1, 2, 3)  # levels of `study.mesh` that are fired at STRIKES
STRIKES = (150.0, 160.0, 166.0, 172.0, 176.0, 180.0, 184.0, 190.0, 200.0)  # [m/s]
BISECTED = (1, 2, 3, 4)  # levels
EARLY, BETWEEN, WIDTH = (
    100e-6,
    (160.0, 184.0),
    0.5,
)  # [s]; [m/s] where all fail later, and earlier; [m/s] of the bracket
SAMPLE = 1e-6  # [s] between samples
MARKS = "<!-- tables of failure_times -->", "<!-- end of failure_times -->"


@cache
def _panel(level: int) -> Panel:
    fabric = catalogue.load(FABRIC).with_effective_density()
    return mesh(ImpactSetup(fabric, 100.0, numerics=Numerics(threads=1)).panel(), level)


def shot(level: int, velocity: float, end: float) -> tuple[float, float, float]:
    """(residual velocity [m/s], absorbed energy [J], time of the first failure [s], infinite if none), until `end`."""
    solver = PackSolver(_panel(level), velocity, end, interval=SAMPLE)
    solver.run()
    left, failed = float(solver.sample("v")[-1]), solver.sample("failed_yarns") > 0
    first = float(solver.sample("t")[failed.argmax()]) if failed.any() else float("inf")
    return left, 0.5 * solver.panel.projectile.mass * (velocity**2 - left**2), first


def early(level: int) -> tuple[float, float]:
    """(low, high) [m/s] of the strike velocity above which the ply fails within EARLY, on a mesh."""
    low, high = BETWEEN
    while high - low > WIDTH:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if shot(level, middle, EARLY)[2] < EARLY else (middle, high)
    return low, high


def tables(shots: Sequence[tuple[float, float, float]], brackets: Sequence[tuple[float, float]]) -> str:
    """The shots, a row a strike velocity, and the bisected velocities."""
    of = {(level, V): found for (level, V), found in zip(((n, V) for n in MESHES for V in STRIKES), shots)}
    rows = [["strike, m/s", *(f"{n} per crossover: residual velocity, m/s (first failure, µs)" for n in MESHES)]]
    for V in STRIKES:
        rows.append([f"{V:g}", *(f"{of[n, V][0]:.1f} ({1e6 * of[n, V][2]:.0f})" for n in MESHES)])
    steps = [["elements per crossover", *map(str, BISECTED)],
             [f"strike velocity above which the ply fails within {1e6 * EARLY:g} µs, m/s",
              *(f"{low:.1f} to {high:.1f}" for low, high in brackets)]]  # fmt: skip
    return f"{markdown(rows)}\n{markdown(steps)}"


def main(*, out: Path = Path("results/failure-times"), jobs: int = 1, page: Path | None = None) -> None:
    name = "python -m validation.verification.mesh_convergence.failure_times"
    commit = provenance.stamp()["commit"]
    runs: dict[str, Any] = {"folder": out, "jobs": jobs}
    shots = run_cache.results(shot, [(n, V, UNDECIDED) for n in MESHES for V in STRIKES], **runs)
    text = tables(shots, run_cache.results(early, [(n,) for n in BISECTED], **runs))
    publish(text, page, MARKS, f"Made by `{name}`, commit {commit}.\n\n")


if __name__ == "__main__":
    program(main)
