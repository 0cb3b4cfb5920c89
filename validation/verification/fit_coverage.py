"""How often the 95 % intervals of `weavecell.fit` hold the value that made the curve.

    python -m validation.verification.fit_coverage [--trials 40] [--page docs/reports/fit.md]

A run with known values gives a curve. Each trial adds normal noise of 2 % of its largest value, fits from the values of
the catalogue, and counts the intervals that hold the known ones.
"""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from pathlib import Path

import numpy as np
from scipy.stats import binom

import weavecell as wc
from fabrics.checks import FloatArray
from fabrics.variants import scale_shear, scale_yarns
from validation.marked_page import markdown
from validation.program import program, publish
from weavecell.results import provenance

NOISE, SEED, RANGE = 0.02, 1, (0.5, 1.0, 2.0)
TIMES, ANGLES = np.linspace(2e-6, 118e-6, 60), np.radians(np.linspace(1, 34, 30))
MARKS = "<!-- table of validation.verification.fit_coverage -->", "<!-- end of fit_coverage -->"


def velocity(modulus: float, failure_strain: float) -> FloatArray:
    """[m/s] of the projectile at TIMES."""
    fabric = scale_yarns(wc.fabric("S-720"), E=modulus, failure_strain=failure_strain)
    shot = wc.impact(fabric, "90 m/s", opening="50 mm", end_time="120 us").to_dataframe()
    return np.interp(TIMES, shot["time_s"], shot["velocity_m_s"])


def stress(trellis_stiffness: float, trellis_angles: float) -> FloatArray:
    """[Pa] of a picture frame at ANGLES."""
    fabric = scale_shear(wc.fabric("S-720"), trellis_stiffness, trellis_angles)
    frame = wc.coupon(fabric, "picture_frame", shear_angle="35 deg", crossovers=4, steps=10).to_dataframe()
    return np.interp(ANGLES, frame["shear_angle_rad"], frame["shear_stress_Pa"])


CASES: dict[str, tuple[Callable[..., FloatArray], dict[str, float]]] = {
    "velocity over time, 60 points, shot that perforates": (velocity, {"modulus": 0.9, "failure_strain": 1.1}),
    "picture frame, 30 points": (stress, {"trellis_stiffness": 0.8, "trellis_angles": 1.1}),
}


def trials_of(name: str, count: int) -> list[list[str]]:
    """Rows of the table, one an unknown, of a case of CASES."""
    model, known = CASES[name]
    exact, rng, fits = model(**known), np.random.default_rng(SEED), []
    for _ in range(count):
        noisy = exact + NOISE * np.abs(exact).max() * rng.standard_normal(len(exact))
        fits.append(wc.fit(model, noisy, dict.fromkeys(known, RANGE)))
    low, high = binom.interval(0.95, count, 0.95)
    rows: list[list[str]] = []
    for unknown, value in known.items():
        off = np.array([fit.values[unknown] / value - 1 for fit in fits])
        half = np.array([fit.half[unknown] / value for fit in fits])
        rows.append([
            name if not rows else "", unknown, f"{value:g}", f"{100 * off.mean():+.1f}",
            f"{100 * off.std() / sqrt(1 - 1 / count):.1f}", f"{100 * np.median(half):.1f}",
            f"{np.sum(np.abs(off) <= half)} of {count} ({low:.0f} to {high:.0f} expected)",
            f"{sum(fit.determined[unknown] for fit in fits)}",
        ])  # fmt: skip
    return rows


def main(*, trials: int = 40, page: Path | None = None) -> None:
    table = [["curve", "factor on", "known", "mean of the fits, % off", "their scatter, %",
              "half width of the interval, median, %", "intervals that hold it", "called determined"]]  # fmt: skip
    for name in CASES:
        table += trials_of(name, trials)
    made = f"Made by `python -m validation.verification.fit_coverage --trials {trials}`, "
    publish(markdown(table), page, MARKS, f"{made}commit {provenance.stamp()['commit']}.\n\n")


if __name__ == "__main__":
    program(main, trials="of each curve")
