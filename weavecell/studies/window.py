"""Mean of a shot that perforates over a window of strike velocities, with its standard error.

Yarns fail one after the other, so that residual velocity, absorbed energy and failures are staircases
in the strike velocity. The shot is repeated at `FACTORS` times V0. The mean is the value at V0 of the
straight line through the n shots (`fit_line_at`), since a trend is no scatter. Residuals of a
staircase are not normal: the standard error measures scatter, and is no confidence interval.

A jump of the absorbed energy between two regimes, such as fabric that holds the nose or is cut out at
once, is no scatter: it is found from the shots (`Window.jump`), and no mean is quoted.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from math import nan, sqrt
from typing import Any

import numpy as np

from fabrics.base import run_cache, sums
from shellfabric.impact.result import ImpactResult
from shellfabric.impact.run import run_impact_or_partial
from shellfabric.impact.setup import ImpactSetup
from shellfabric.shot_keys import FASTEST
from weavecell.studies import shot_row

FACTORS = 0.92, 0.96, 1.0, 1.04, 1.08
# a jump: a step of the absorbed energy, over the largest energy and over the median of the other steps
LEAST_JUMP = 0.2
STANDS_OUT = 4.0
LEAST_SHOTS = 4
QUANTITIES = {  # key of a shot's row, words, unit
    "residual_velocity": ("residual_velocity_m_s", "residual velocity", "m/s"),
    "absorbed_energy": ("absorbed_energy_J", "absorbed energy", "J"),
    "cut_yarns": ("cut_yarns", "cut yarns", ""),
}


@dataclass(frozen=True)
class Jump:
    """A jump of the absorbed energy within a window.

    Parameters
    ----------
    velocities : [m/s] of the two shots between which it lies
    energies : [J] means of the absorbed energy below and above it
    """

    velocities: tuple[float, float]
    energies: tuple[float, float]

    @property
    def words(self) -> str:
        """Where it lies, and what is below and above it."""
        (low, high), (below, above) = self.velocities, self.energies
        return (
            f"absorbed energy jumps between {low:.4g} and {high:.4g} m/s ({below:.3g} J below, {above:.3g} J above): "
            "no mean over it"
        )


@dataclass(frozen=True)
class Window:
    """Shots about a strike velocity; one that became unstable counts in no mean.

    Parameters
    ----------
    strike_velocity : [m/s] of the middle
    shots : rows of `shot_row.row_of`, each with its "strike_velocity_m_s", by strike velocity
    """

    strike_velocity: float
    shots: tuple[dict[str, Any], ...]

    @property
    def outcomes(self) -> Counter[str]:
        """{outcome: number of shots}; more than one where outcomes are mixed."""
        return Counter(shot["outcome"] for shot in self.shots)

    @property
    def jump(self) -> Jump | None:
        """The jump of the absorbed energy between two of the shots; None if there is none, or fewer
        than LEAST_SHOTS."""
        shots = [shot for shot in self.shots if shot["outcome"] != "unstable"]
        if len(shots) < LEAST_SHOTS:
            return None
        velocity = np.array([shot["strike_velocity_m_s"] for shot in shots])
        energy = np.array([shot["absorbed_energy_J"] for shot in shots])
        order = np.argsort(velocity)
        velocity, energy = velocity[order], energy[order]
        steps = np.abs(np.diff(energy))
        k = int(steps.argmax())
        others = float(np.median(np.delete(steps, k)))
        if steps[k] < LEAST_JUMP * np.abs(energy).max() or steps[k] < STANDS_OUT * others:
            return None
        low, high = float(energy[: k + 1].mean()), float(energy[k + 1 :].mean())
        return Jump((float(velocity[k]), float(velocity[k + 1])), (low, high))

    def mean(self, quantity: str) -> tuple[float, float]:
        """Compute (mean, standard error) of one of `QUANTITIES`, in its unit; NaN of fewer than
        three shots."""
        counted = [shot for shot in self.shots if shot["outcome"] != "unstable"]
        points = np.array(
            [(shot["strike_velocity_m_s"], shot[QUANTITIES[quantity][0]]) for shot in counted]
        )
        return fit_line_at(points[:, 0], points[:, 1], self.strike_velocity)

    def summary(self) -> dict[str, Any]:
        """Return all of it as plain values."""
        mean: dict[str, float | None] = {}
        error: dict[str, float | None] = {}
        jump = self.jump
        for name, (key, *_) in QUANTITIES.items():
            mean[key] = error[key] = None
            if jump is None:
                mean[key], error[key] = self.mean(name)
        return {
            "mean": mean,
            "standard_error": error,
            "jump": jump and {"between_m_s": jump.velocities, "absorbed_energy_J": jump.energies},
            "stopped": self.outcomes["stopped"],
            "shots": list(self.shots),
        }


def fit_line_at(x: np.ndarray, y: np.ndarray, at: float) -> tuple[float, float]:
    """Fit a line through points (n,) by least squares: (its value at a place, the standard error);
    NaN below n = 3.

    With the mean velocity V_m, the slope b and the residuals r_i of the line these are

        y_m + b (V0 - V_m),   s sqrt(1/n + (V0 - V_m)^2 / sum (V_i - V_m)^2)   with
        s^2 = sum r_i^2 / (n - 2)

    (Montgomery, Peck, Vining, Introduction to Linear Regression Analysis, estimation of the mean).
    """
    if x.size < 3:
        return nan, nan
    off = x - x.mean()
    place = at - x.mean()
    slope = sums.dot(off, y) / sums.dot(off, off)
    residuals = y - y.mean() - slope * off
    variance = sums.dot(residuals, residuals) / (x.size - 2)
    return float(y.mean() + slope * place), sqrt(
        variance * (1 / x.size + place**2 / sums.dot(off, off))
    )


def fire(setup: ImpactSetup) -> dict[str, Any]:
    """Fire one shot of a window and return its row."""
    return _row(*run_impact_or_partial(setup, table=setup.table(kept=True)))


def _row(result, problem=""):
    return {"strike_velocity_m_s": result.setup.strike_velocity} | shot_row.row_of(result, problem)


def fire_window(result: ImpactResult, **runs: Any) -> Window | None:
    """Fire the window about a shot that has been made; None of one that did not perforate.

    Parameters
    ----------
    runs : folder, executor, jobs, report of `run_cache.results`; nothing is kept without
    """
    if result.outcome != "perforated":
        return None
    plain = replace(result.setup, snapshot_interval=None, history=None)
    velocity = result.setup.strike_velocity
    others = []
    for factor in FACTORS:
        if factor != 1:
            strike = min(factor * velocity, FASTEST)
            others.append((replace(plain, strike_velocity=strike),))
    if runs:
        # only the means are wanted: no shapes, no histories along yarns
        rows = run_cache.results(fire, others, **runs)
    else:
        rows = [fire(*other) for other in others]
    return Window(
        velocity, tuple(sorted([*rows, _row(result)], key=lambda row: row["strike_velocity_m_s"]))
    )
