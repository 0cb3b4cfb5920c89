"""Sliding crossovers: error of the cell's scaling, stability, cost, pull-out, and critical velocities by friction.

    python -m validation.verification.sliding [--out FOLDER] [--page docs/reports/sliding.md] [--jobs N] [--only NAMES]

Runs are kept in the folder and not made twice. Without --page the tables are printed alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

from fabrics import catalogue, run_cache
from fabrics.errors import UndecidedError, UnstableError
from meshing.pictures_style import BLUE, INK, ORANGE, PURPLE, RED
from shellfabric.cell.model import CellModel
from shellfabric.impact.ballistic_limit import critical_velocity
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.panel.model import Panel
from shellfabric.panel.numerics import Numerics
from shellfabric.sliding.model import CrossoverFriction, SlidingPanel
from shellfabric.solver.pack_solver import PackSolver
from validation.marked_page import markdown, put
from validation.models import cell_scaling
from validation.program import program, save
from validation.verification import sliding_pull_out as pulls
from validation.verification.study import known
from weavecell.results import provenance

MARKS = "<!-- tables of validation.verification.sliding -->", "<!-- end of sliding -->"
FABRICS = ("S-720", "S-726", "S-727", "S-728", "S-731", "S-745")
BRACKET = 96.0, 110.0  # [m/s] tests of S-726 in the thesis: stopped, perforated
TESTS = {"S-726": f"stopped at {BRACKET[0]:.0f}, perforated at {BRACKET[1]:.0f}"}
MU = (0.1, 0.2, 0.3)
SHARES = (0.8, 0.9, 0.95, 0.98, 1.02, 1.05, 1.1, 1.2)
STRAINS = (-0.02, 0.03)
THRESHOLDS = (0.0, 0.05, 0.2, 0.5, 2.0, 20.0, 200.0, 1000.0)
CFL = (0.9, 0.7, 0.5, 0.3)


def setup(name: str, velocity: float, friction: CrossoverFriction | None, cfl: float = 0.9) -> ImpactSetup:
    """The shot of the thesis at a fabric, one element a crossover."""
    fabric = catalogue.load(name).with_effective_density()
    numerics = Numerics(cfl=cfl, threads=1)
    return ImpactSetup(fabric, velocity, elements_per_crossover=1, numerics=numerics, crossovers=friction)


def scaling(name: str) -> list[list[float]]:
    """(shares, quantities) error over the strength, see `cell_scaling.errors`."""
    strains = np.linspace(*STRAINS, 26)
    model = CellModel(catalogue.load(name))
    return [[float(value) for value in row] for row in cell_scaling.errors(model, SHARES, strains)]


def stability(cohesion: float, cfl: float) -> tuple[float, str, float, float]:
    """(energy error over the strike energy, outcome, work of friction over it, least share of yarn of a segment)."""
    this = replace(setup("S-726", 100.0, CrossoverFriction(0.0, cohesion), cfl), opening=0.08)
    solver = PackSolver(this.panel(this.table(kept=True)), 100.0, 100e-6)
    try:
        solver.run()
    except UnstableError as problem:
        return inf, str(problem), inf, 0.0
    size = (solver.const.ni + 1) * solver.const.row_stride
    least = min(float(share[:size].min()) for share in solver.slips[0].share)
    error = float(np.max(np.abs(solver.sample("error")))) / solver.strike_energy
    return error, solver.outcome, float(solver.sample("crossover_friction")[-1]) / solver.strike_energy, least


def cost(mu: float | None) -> tuple[float, int]:
    """([ns] for an element and a step, steps) of S-726 at 100 m/s over 100 us; mu None for pinned crossovers."""
    this = setup("S-726", 100.0, None if mu is None else CrossoverFriction(mu))
    panel, best = this.panel(this.table(kept=True)), inf
    for _ in range(3):
        solver = PackSolver(panel, 100.0, 100e-6)
        solver.run()
        best = min(best, 1e9 * solver.wall_time / (solver.steps * panel.elements))
    return best, solver.steps


def limit(name: str, mu: float | None) -> tuple[float, float, float, float, float]:
    """(stop, perforation [m/s], cut yarns of the slowest perforation, largest energy error, widest window [m]);
    of pinned crossovers where mu is None."""
    this = setup(name, 100.0, None if mu is None else CrossoverFriction(mu))
    panel = this.panel(this.table(kept=True))
    try:
        found = critical_velocity(panel, tolerance=1.0)
    except (UndecidedError, UnstableError):
        return float("nan"), float("nan"), 0, float("nan"), float("nan")
    slowest = min((shot for shot in found.shots if shot.perforated), key=lambda shot: shot.strike_velocity)
    balance = max(shot.balance for shot in found.shots)
    return found.low, found.high, slowest.cut_yarns, balance, window(panel, found.low)


def window(panel: Panel, velocity: float) -> float:
    """[m] widest distance of neighbouring yarns where the projectile has stopped."""
    if not isinstance(panel, SlidingPanel):
        return float("nan")
    solver = PackSolver(panel, velocity, 1e-3)
    return float(solver.run().slip_summaries()[0].largest_window)


def text(results: dict[str, list]) -> str:
    """The tables of the studies that have been run."""
    makers = {
        "scaling": _scaling_table, "stability": _stability, "cost": _cost, "pulled": pulls.cohesion_table,
        "under_load": pulls.load_table, "limit": _limits,
    }  # fmt: skip
    return "\n".join(make(results[name]) for name, make in makers.items() if name in results)


def _stability(found):
    rows = [["threshold, N", *(f"Courant factor {cfl:g}" for cfl in CFL)]]
    for n, threshold in enumerate(THRESHOLDS):
        cells = found[n * len(CFL) : (n + 1) * len(CFL)]
        rows.append([f"{threshold:g}", *(f"{100 * e:.3f} % ({share:.2f})" for e, _, _, share in cells)])
    head = (
        "### Stability\n\nLargest energy error over the strike energy, in brackets the least yarn of a segment over "
        "that at rest: S-726, 80 mm square, 100 m/s, 100 µs, mu = 0 and the threshold c0.\n"
    )
    return f"{head}\n{markdown(rows)}"


def _cost(found):
    (pinned, steps), *_, (_, more) = found
    rows = [["crossovers", "ns for an element and a step", "over pinned"]]
    for name, (ns, _) in zip(("pinned", "infinite threshold", *(f"mu = {mu:g}" for mu in MU)), found):
        rows.append([name, f"{ns:.1f}", f"{ns / pinned:.2f}"])
    head = f"### Cost\n\nOne thread. The step of the sliding panel is {steps / more:.3f} of the pinned one.\n"
    return f"{head}\n{markdown(rows)}"


def _scaling_table(found):
    rows = [["fabric", "yarn over that at rest", *cell_scaling.QUANTITIES]]
    for name, table in zip(FABRICS, found):
        for share, row in zip(SHARES, table):
            rows.append([name, f"{share:g}", *(f"{100 * value:.2f} %" for value in row)])
    return f"### Error of the effective stretch\n\n{markdown(rows)}"


def _counts(weave):
    """Yarns per inch of warp and weft."""
    return f"{weave.warp_count * 0.0254:.0f} x {weave.weft_count * 0.0254:.0f}"


def _limits(found):
    rows = [["fabric", "yarns / inch", "pinned, m/s", *(f"mu = {mu:g}" for mu in MU), "tests"]]
    for n, name in enumerate(FABRICS):
        fabric, cells = catalogue.load(name), found[n * (1 + len(MU)) : (n + 1) * (1 + len(MU))]
        words = [f"{low:.1f} - {high:.1f}" if low == low else "none found" for low, high, *_ in cells]
        rows.append([name, _counts(fabric.weave), *words, TESTS.get(name, "")])
    worst = max((balance for *_, balance, _ in found if balance == balance), default=0.0)
    more = [["fabric", *(f"mu = {mu:g}" for mu in MU)]]
    for n, name in enumerate(FABRICS):
        cells = found[n * (1 + len(MU)) + 1 : (n + 1) * (1 + len(MU))]
        more.append([name, *(f"{failed}, {1e3 * wide:.2f} mm" for _, _, failed, _, wide in cells)])
    return (
        "### Critical velocity\n\nFastest stop and slowest perforation, m/s. The largest energy error of "
        f"any shot is {100 * worst:.2f} % of the strike energy.\n\n{markdown(rows)}\nFailed segments of yarns at the "
        f"slowest perforation, and the widest distance of neighbouring yarns at the fastest stop.\n\n{markdown(more)}\n"
        "![Critical velocities](figures/sliding-limits.png)\n"
    )


def chart(pyplot: Any, found: list) -> Any:
    """Critical velocities of the fabrics from the loosest weave to the densest, with the bracket of the tests."""
    weaves = [catalogue.load(name).weave for name in FABRICS]
    order = sorted(range(len(FABRICS)), key=lambda n: (weaves[n].warp_count + weaves[n].weft_count, FABRICS[n]))
    looks = ((INK, "s"), (ORANGE, "o"), (BLUE, "^"), (PURPLE, "D"))
    figure, axes = pyplot.subplots(figsize=(8.6, 4.8))
    for case, label in enumerate(("pinned", *(f"sliding, µ = {mu:g}" for mu in MU))):
        places = np.arange(len(order)) + 0.13 * (case - 0.5 * len(MU))
        values = [0.5 * sum(found[n * (1 + len(MU)) + case][:2]) for n in order]
        colour, marker = looks[case]
        axes.plot(places, values, marker, color=colour, ms=8, label=label)
    at = order.index(FABRICS.index("S-726")) + 0.34
    axes.plot([at, at], BRACKET, "_-", color=RED, ms=12, label="tests: stopped, perforated")
    counts = [f"{FABRICS[n]}\n{_counts(weaves[n])}" for n in order]
    axes.set_xticks(range(len(order)), counts)
    axes.grid(False, axis="x")
    axes.set(xlabel="fabric, yarns per inch of warp and weft", ylabel="critical velocity [m/s]", ylim=(0, None))
    axes.set_title("One ply, 203 mm, clamped; 3 g flat cylinder; one element per crossover")
    axes.legend(loc="lower left", ncols=2)
    return figure


def main(
    *, out: Path = Path("results/sliding"), jobs: int = 1, page: Path | None = None, only: Sequence[str] | None = None
) -> None:
    commit = provenance.stamp()["commit"]  # before the pictures are written
    cases: dict[str, tuple[Any, list[tuple]]] = {
        "scaling": (scaling, [(name,) for name in FABRICS]),
        "stability": (stability, [(threshold, cfl) for threshold in THRESHOLDS for cfl in CFL]),
        "cost": (cost, [(mu,) for mu in (None, inf, *MU)]),
        "pulled": (pulls.pulled, [(n, mu) for n in pulls.CROSSINGS for mu in pulls.PULL_MU]),
        "under_load": (
            pulls.under_load,
            [(which, n, load) for which in pulls.STIFFNESS for n in pulls.COUNTS for load in pulls.LOADS],
        ),
        "limit": (limit, [(name, mu) for name in FABRICS for mu in (None, *MU)]),
    }
    results = {}
    for name in only or cases:
        known("--only", name, tuple(cases))
        function, places = cases[name]
        report = lambda done, total, name=name: print(f"{name}: {done} of {total}", flush=True)  # noqa: E731
        results[name] = run_cache.results(function, places, folder=out, jobs=jobs, report=report)
    made = text(results)
    print(made)
    if page is not None:
        if "limit" in results:
            save(chart, results["limit"], to=page.parent / "figures" / "sliding-limits.png")
        if "under_load" in results:
            save(pulls.chart, results["under_load"], to=page.parent / "figures" / "sliding-pull-out.png")
        name = f"python -m validation.verification.sliding --page {page}"
        put(page, *MARKS, f"\n\nMade by `{name}`, commit {commit}.\n\n{made}\n")


if __name__ == "__main__":
    program(main, only="of scaling, stability, cost, pulled, under_load, limit; all of them by default")
