"""How often the 95 % intervals of `weavecell fit` hold the value that made the curve.

    python -m validation.verification.fit_coverage [--trials 40] [--out FOLDER] [--page docs/reports/fit.md]

A run with known values gives a curve. Each trial adds normal noise of 2 % of its largest value, fits from the values of
the catalogue, and counts the intervals that hold the known ones. Runs are kept in the folder.
"""

from __future__ import annotations

from dataclasses import replace
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import binom

from fabrics import run_cache
from fabrics.files import write_whole
from validation.program import program, publish
from weavecell.commands import fit_model
from weavecell.commands.fit_model import Data, Model
from weavecell.report.marked_page import markdown
from weavecell.results import provenance

NOISE, SEED = 0.02, 1
SHOT = """[fabric]
name = "S-720"
[projectile]
mass = "3 g"
diameter = "5.5 mm"
edge_radius = "0.3 mm"
strike_velocity = "90 m/s"
[panel]
opening = "50 mm"
[run]
end_time = "120 us"
"""
FRAME = """[fabric]
name = "S-720"
[picture_frame]
shear_angle = "35 deg"
crossovers = 4
[run]
steps = 10
"""
CASES = {  # what is fitted: input file, abscissa, unit of the ordinates, ordinate, known values
    "velocity over time, 60 points, shot that perforates": (
        SHOT, "velocity", ("time", "s", np.linspace(2e-6, 118e-6, 60)), ("velocity", "m/s"),
        {"modulus": 0.9, "failure_strain": 1.1},
    ),
    "picture frame, 30 points": (
        FRAME, "picture_frame", ("shear angle", "rad", np.radians(np.linspace(1, 34, 30))), ("shear stress", "Pa"),
        {"trellis_stiffness": 0.8, "trellis_angles": 1.1},
    ),
}  # fmt: skip
MARKS = "<!-- table of validation.verification.fit_coverage -->", "<!-- end of fit_coverage -->"


def trials_of(name: str, count: int, out: Path, **runs: Any) -> list[list[str]]:
    """Rows of the table, one a parameter, of a case of CASES."""
    text, kind, x, (column, unit), known = CASES[name]
    file = out / f"{kind}.toml"
    with write_whole(file) as opened:
        opened.write(text)
    blank = Data(kind, x, {column: np.ones(len(x[2]))}, unit, "made")
    model, names = Model(str(file), blank, out), tuple(known)
    asked = [(kind, model.at(known), x[2], column)]
    [exact] = run_cache.results(fit_model.computed, asked, folder=out / "runs", **runs)
    found, rng = [], np.random.default_rng(SEED)
    for _ in range(count):
        noisy = exact + NOISE * np.abs(exact).max() * rng.standard_normal(len(exact))
        model.points = replace(blank, columns={column: noisy})
        found.append(fit_model.solve(model, names, folder=out / "runs", **runs))
    low, high = binom.interval(0.95, count, 0.95)
    rows = []
    for k, (one, value) in enumerate(known.items()):
        held = sum(abs(each.values[k] - value) <= each.half[k] for each in found)
        off = [each.values[k] / value - 1 for each in found]
        half = np.median([each.half[k] for each in found]) / value
        rows.append([
            name if k == 0 else "", one, f"{value:g}", f"{100 * np.mean(off):+.1f}",
            f"{100 * np.std(off) / sqrt(1 - 1 / count):.1f}", f"{100 * half:.1f}",
            f"{held} of {count} ({low:.0f} to {high:.0f} expected)", f"{sum(each.determined[k] for each in found)}",
        ])  # fmt: skip
    return rows


def main(
    *, trials: int = 40, jobs: int = 1, out: Path = Path("results/fit-coverage"), page: Path | None = None
) -> None:
    table = [["curve", "factor on", "known", "mean of the fits, % off", "their scatter, %",
              "half width of the interval, median, %", "intervals that hold it", "called determined"]]  # fmt: skip
    for name in CASES:
        table += trials_of(name, trials, out, jobs=jobs)
    made = f"Made by `python -m validation.verification.fit_coverage --trials {trials}`, "
    publish(markdown(table), page, MARKS, f"{made}commit {provenance.stamp()['commit']}.\n\n")


if __name__ == "__main__":
    program(main, trials="of each curve")
