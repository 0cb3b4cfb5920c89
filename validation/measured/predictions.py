"""Draw what the test of a measured row would report, from the table of drawn shots behind `v50` and `impact --draws`.

A test of V50 takes its shots from one cloth: what is common to a cloth is drawn once for all of them, place and yarns
anew for each. `v50` knows the frictions of each shot alone; here the limits depend on all that is common to a cloth, so
that the V50 of cloths are as far apart as all of it takes them. A test of the growth with the plies is the ratio of two
such V50 of one cloth. An outcome is the share of drawn shots that perforate; a slip, or a count of torn plies, is that
of a whole drawn shot.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.special import betaincinv

from fabrics.base import run_cache
from fabrics.base.checks import FloatArray
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from validation.measured.rows import OF_SHOTS, Case
from weavecell.runs import go_no_go, table, v50
from weavecell.runs.go_no_go import LimitPosterior, Outcomes
from weavecell.runs.table import Shot
from weavecell.studies import ballistic_limit, inputs, strengths, unknown

SEED = 1
SHARES = 200  # equally likely shares that perforate


@dataclass(frozen=True)
class Prediction:
    """Of a measured row.

    Parameters
    ----------
    values : (n,) equally likely, of what the test reports, in the unit of the row; of an outcome the share of
        shots that perforate [-]; none if the shots do not tell
    shots, perforated : how many were fired with an outcome, and how many of them perforated
    drawn : what they were drawn over, in words
    cpu_time : [s] of the shots
    """

    values: FloatArray
    shots: int
    perforated: int
    drawn: str
    cpu_time: float

    @property
    def share(self) -> float:
        """[-] that perforates, the mean by Jeffreys' prior."""
        return (self.perforated + 0.5) / (self.shots + 1)


def predict(case: Case, shots: int, folder: Path, jobs: int = 1) -> Prediction:
    """Draw what the test of a row would report.

    Parameters
    ----------
    case : Case of a measure of shots, "v50", "limit" or "growth"
    shots : how many are fired, of each of two packs for a growth
    folder, jobs : of `run_cache.results`: where each shot is kept as soon as it has ended
    """
    runs: dict[str, Any] = {"folder": folder, "jobs": jobs}
    setup = case.resolved()
    if case.measure == "outcome":
        return _predict_outcome(setup, shots, runs)
    if case.measure in OF_SHOTS:
        return _predict_whole(setup, case.measure, shots, runs)
    if case.measure == "growth":
        few = case.resolved(**{"panel.plies": 2, "projectile.strike_velocity": "240 m/s"})
        return _predict_growth(setup, few, shots, runs)
    fired, posterior = fit_cloths(setup, shots, setup.plies, runs)
    values = np.zeros(0)
    if posterior is not None:
        values = pair_cloths(posterior)
    return _tell(setup, values, fired)


def _predict_outcome(setup, shots, runs):
    rows = table.draw(setup, shots, seed=SEED)
    fired = [shot for shot in table.run(rows, **runs) if not shot.failure]
    hits = sum(shot.perforated for shot in fired)
    levels = (np.arange(SHARES) + 0.5) / SHARES
    shares = betaincinv(hits + 0.5, len(fired) - hits + 0.5, levels)
    return _tell(setup, shares, fired)


def _predict_growth(many, few, shots, runs):
    # yarns, moduli and crimps of both packs are drawn alike
    stride = max(many.plies, few.plies)
    fired, posteriors = [], []
    for setup in (many, few):
        own, posterior = fit_cloths(setup, shots, stride, runs)
        fired += own
        posteriors.append(posterior)
    values = np.zeros(0)
    if None not in posteriors:
        # of the same cloths; what is not known of the two fits has nothing in common
        below = pair_cloths(posteriors[1], np.random.default_rng(SEED))
        values = pair_cloths(posteriors[0]) / below
    return _tell(many, values, fired)


def _predict_whole(setup, measure, shots, runs):
    drawn = table.as_fired(setup)
    found = run_cache.results(fire_whole, [(drawn, measure, n) for n in range(shots)], **runs)
    values, perforated, times = np.array(found, float).T
    return Prediction(values, shots, int(perforated.sum()), unknown.say_drawn(drawn), times.sum())


def fire_whole(setup: ImpactSetup, measure: str, number: int) -> tuple[float, bool, float]:
    """Fire a drawn shot to its end: (what OF_SHOTS reads, whether it perforated, CPU time [s])."""
    began = time.process_time()
    whole = inputs.use_one_thread(setup, symmetry="whole")
    panel = strengths.draw_panel(whole, inputs.read_scatter(), SEED, number)
    shot = run_impact(whole, target=panel.pack)
    seconds = time.process_time() - began
    return OF_SHOTS[measure](shot), shot.outcome == "perforated", seconds


def fit_cloths(
    setup: ImpactSetup, shots: int, stride: int, runs: dict[str, Any]
) -> tuple[list[Shot], LimitPosterior | None]:
    """Fire shots as `v50` does, and fit their limits to all that is common to a cloth.

    Returns
    -------
    shots, posterior : with an outcome; None where these are all alike
    """
    study = v50.study(setup, inputs.read_scatter(), shots=shots, seed=SEED, stride=stride, **runs)
    fired = table.as_fired(setup)
    known = list_known(fired, max(shots, v50.POPULATION), stride)
    outcomes = Outcomes(
        tuple(known),
        np.array([[one[shot.number] for one in known.values()] for shot in study.shots]),
        np.array([shot.velocity for shot in study.shots]),
        np.array([shot.perforated for shot in study.shots], bool),
    )
    if not outcomes.mixed:
        return list(study.shots), None
    guess = ballistic_limit.first_guess(fired.target(fired.table(kept=True)))
    population = np.column_stack([one[: v50.POPULATION] for one in known.values()])
    return list(study.shots), go_no_go.fit(outcomes, guess, population)


def list_known(setup: ImpactSetup, count: int, stride: int) -> dict[str, FloatArray]:
    """Return what is known of drawn shots, {name: (count,) [-] about 0}: as `unknown.draw_known`, and all else that is
    one for a cloth."""
    each = [unknown.draw_known(setup, SEED, number) for number in range(count)]
    found = {name: np.array([one[name] for one in each]) for name in each[0]}
    for name, (row, _) in unknown.find_drawn(setup, inputs.read_scatter()).items():
        if row.of_cloth and name not in found:
            shares = [row.share(SEED, number, number * stride) for number in range(count)]
            found[name] = np.array(shares) - 0.5
    return found


def pair_cloths(posterior: LimitPosterior, draw: np.random.Generator | None = None) -> FloatArray:
    """Return V50 [m/s] (d,) that tests of single cloths would find: cloth after cloth of the population, each with one
    draw of the constants, which `draw` shuffles."""
    limits = posterior.draw_cloths()
    count, cloths = limits.shape
    order = np.arange(count)
    if draw is not None:
        order = draw.permutation(count)
    return limits[order, np.arange(count) % cloths]


def _tell(setup, values, shots):
    """Return the Prediction of shots of the table."""
    hits = sum(shot.perforated for shot in shots)
    seconds = float(np.nansum([shot.cpu_time for shot in shots]))
    return Prediction(values, len(shots), hits, unknown.say_drawn(table.as_fired(setup)), seconds)
