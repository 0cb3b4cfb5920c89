"""Global sensitivity of an impact: Sobol indices of velocity and peak tension over the uncertainties of the input.

First order, the share of the variance that an input explains on its own, S_i = Var(E(y | x_i)) / Var(y); total order,
the share that is gone when it alone is known last, S_Ti = 1 - Var(E(y | x_not i)) / Var(y). Samples after Saltelli
(Computer Physics Communications 181 (2010) 259), N (D + 2) of them, estimates and bootstrap intervals by SALib.

What is looked at, at each strike velocity:
- the projectile's velocity `INSTANT` after the strike, or at the end of a shot that ends sooner. Of a shot that has
  perforated by then it is the residual velocity; of one that is stopped, whose residual velocity is always 0, it is a
  smooth measure of the energy absorbed, and the one by which the thesis's runs at +-20 % are compared;
- the peak tension of any yarn of any ply, over the run.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fabrics import run_cache
from fabrics.errors import InputError, UnstableError
from shellfabric.impact.simulation import ImpactSetup, run
from weavecell.studies import inputs

INSTANT = 200e-6
QUANTITIES = {"velocity": "m/s", "peak tension": "N"}
TABLE = 101  # stretches a side of the cell's table: S-720's peaks and velocities are within 0.05 % of those with 201
CONFIDENCE = 0.95
_DIGITS = 12  # of a factor: what names a run


@dataclass(frozen=True)
class Indices:
    """Sobol indices of one quantity.

    Parameters
    ----------
    velocity : [m/s] strike velocity
    quantity : a name of QUANTITIES
    names : (D,) of the inputs
    first, first_half, total, total_half : (D,) indices and half widths of their intervals; NaN if nothing varies
    mean, deviation : of the quantity over the sample, in its unit
    perforated : [-] share of the sample that perforated
    unstable : number of shots that became unstable, with which no index is determined
    """

    velocity: float
    quantity: str
    names: tuple
    first: np.ndarray
    first_half: np.ndarray
    total: np.ndarray
    total_half: np.ndarray
    mean: float
    deviation: float
    perforated: float
    unstable: int = 0


def problem(entries: Mapping[str, inputs.Entry]) -> dict[str, Any]:
    """What SALib calls the problem: names and bounds of the factors."""
    bounds = [[1 - entry.value, 1 + entry.up] for entry in entries.values()]
    return {"num_vars": len(bounds), "names": list(entries), "bounds": bounds}


def sample(problem: Mapping[str, Any], samples: int, seed: int) -> np.ndarray:
    """(N (D + 2), D) factors of a problem; `samples` N is a power of 2."""
    from SALib.sample import sobol

    if samples < 2 or samples & (samples - 1):
        raise InputError(key="samples", value=samples, allowed="a power of 2: 2, 4, 8, ...")
    return sobol.sample(problem, samples, calc_second_order=False, seed=seed)


def estimate(problem: Mapping[str, Any], y: np.ndarray, seed: int) -> tuple[np.ndarray, ...]:
    """(first, its half width, total, its half width), (D,) each, of a quantity y (N (D + 2),) on a sample."""
    from SALib.analyze import sobol

    if np.isnan(y).any() or not np.ptp(y) > 1e-12 * np.abs(y).max():
        return (np.full(problem["num_vars"], np.nan),) * 4
    indices = sobol.analyze(
        problem, y, calc_second_order=False, num_resamples=1000, conf_level=CONFIDENCE, seed=seed
    )
    return tuple(np.asarray(indices[key]) for key in ("S1", "S1_conf", "ST", "ST_conf"))


def shots(
    setup: ImpactSetup, factors: Sequence[tuple[str, float]], velocities: Sequence[float]
) -> dict[tuple[float, str], float]:
    """One row of the sample: {(velocity, quantity): value} and, by (velocity, "perforated"), whether it did.

    Parameters
    ----------
    setup : ImpactSetup of any strike velocity
    factors : tuple of (name, factor)
    velocities : tuple of [m/s]
    """
    changed = inputs.changed_setup(setup, **dict(factors))
    values: dict[tuple[float, str], float] = {}
    table = changed.table()  # of the cell, whatever the velocity
    for velocity in velocities:
        try:
            result: Any = run(replace(changed, strike_velocity=velocity), table=table)
        except UnstableError:
            values |= {(velocity, name): np.nan for name in (*QUANTITIES, "perforated")}
            continue
        values[velocity, "velocity"] = float(
            np.interp(INSTANT, result.t, np.maximum(result.v, 0.0))
        )
        values[velocity, "peak tension"] = float(np.max(result.peak_tension))
        values[velocity, "perforated"] = result.outcome == "perforated"
    return values


def study(
    setup: ImpactSetup, velocities: Sequence[float], *, samples: int, seed: int = 1, **runs: Any
) -> tuple[Indices, ...]:
    """Sobol indices of all quantities at the strike velocities.

    Parameters
    ----------
    setup : ImpactSetup of any strike velocity; what it records is not used
    velocities : [m/s]
    samples : N, a power of 2
    seed : of the sample and of the bootstrap
    runs : folder, executor, jobs, report of `run_cache.results`

    Raises
    ------
    InputError : as `simulation.run`
    """
    factors = problem(inputs.table("range"))
    rows = sample(factors, samples, seed)
    if setup.surface is not None:
        raise InputError(
            "a response surface holds for one fabric", key="surface", allowed="left out"
        )
    plain = inputs.alone(setup, strike_velocity=1.0, table_size=TABLE)
    arguments = [
        (
            plain,
            tuple((name, round(float(x), _DIGITS)) for name, x in zip(factors["names"], row)),
            tuple(velocities),
        )
        for row in rows
    ]
    values = run_cache.results(shots, arguments, **runs)

    def indices(velocity, quantity):
        y = np.array([row[velocity, quantity] for row in values])
        perforated = float(np.nanmean([row[velocity, "perforated"] for row in values]))
        estimates = estimate(factors, y, seed)
        names = tuple(factors["names"])
        return Indices(
            velocity,
            quantity,
            names,
            *estimates,
            float(np.nanmean(y)),
            float(np.nanstd(y)),
            perforated,
            int(np.isnan(y).sum()),
        )

    return tuple(indices(velocity, quantity) for velocity in velocities for quantity in QUANTITIES)
