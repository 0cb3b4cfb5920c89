"""Answers over what nobody knows (`weavecell.studies.interval`): what they say, their doubts, their cost."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import sqrt
from statistics import fmean, stdev
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from scipy.stats import qmc
from weavecell.api.intervals import plan_interval

from shellfabric.impact.run import run_impact_or_partial
from validation.cases import impact, noses
from validation.values import Values
from weavecell.api.target import Target
from weavecell.studies import (
    ballistic_limit,
    inputs,
    interval,
    passing_shares,
    places,
    strengths,
    sweep,
    v50,
)

if TYPE_CHECKING:
    from weavecell.studies.interval import Interval, Run

    from shellfabric.impact.setup import ImpactSetup

TOLERANCE = 4.0  # [m/s] of the limit without scatter that begins a V50
SHORT = 5e-6  # [s] of the shots that load the kernels before the clock begins
# of an indicator in words, "name 0.2 (limit 0.1; remedy); name 3 (...)", the name
OF_A_DOUBT = re.compile(r"(?:^doubtful: |\); )([a-z][a-z -]*?) -?[\d.]")


def shot(**keywords: Any) -> Values:
    """Answer a shot over what nobody knows.

    Parameters
    ----------
    keywords : of `impact.setup`; the friction on the nose is the assumed one

    Returns
    -------
    dict of `describe`, with pinned, the outcome of the pinned shot, and pinned_doubts
    """
    pinned, found = _answer_beside_pinned(interval.SHOT, sweep.shot, keywords)
    return found | {"pinned": pinned["outcome"]}


def limit(**keywords: Any) -> Values:
    """Search a limit over what nobody knows.

    Parameters
    ----------
    keywords : of `impact.setup`; the friction on the nose is the assumed one

    Returns
    -------
    dict of `describe`, with pinned [m/s], the limit of pinned yarns, and pinned_doubts
    """
    pinned, found = _answer_beside_pinned(interval.LIMIT, sweep.critical_velocity, keywords)
    return found | {"pinned": pinned.get("critical_velocity_m_s")}


def stop(*, number: int, velocities: tuple[float, float], seed: int = 1, **keywords: Any) -> Values:
    """Fire a shot at resolved yarns, of which velocity, place and frictions are a point of a Sobol sequence.

    Parameters
    ----------
    number : of the point
    velocities : (low, high) [m/s]
    seed : of the sequence
    keywords : of `impact.setup`

    Returns
    -------
    dict with velocity, left [m/s]; u, v [spacings] of the place along warp and weft; yarns, nose, the
    frictions; outcome; doubts; error [-] of the energy; widened, whether it was run again with all yarns
    resolved; cpu_s
    """
    sequence = qmc.Sobol(5, seed=seed)
    # it refuses to go on by none
    if number:
        sequence.fast_forward(number)
    share, *place, yarns, nose = map(float, sequence.random()[0])
    velocity = velocities[0] + share * (velocities[1] - velocities[0])
    this = places.resolve(impact.setup(velocity=velocity, nose_friction=noses.ASSUMED, **keywords))
    unknown = interval.find_unknown(this)
    frictions = {}
    for (name, (low, high)), drawn in zip(sorted(unknown.items()), (yarns, nose)):
        frictions[name] = low + drawn * (high - low)
    # a repeat of plain weave has two crossovers each way
    along = (2 * place[0] - 1, 2 * place[1] - 1)
    this = interval.vary(this, places.Place("anywhere", along), frictions).setup
    began = time.process_time()
    row = sweep.shot(this)
    return {
        "velocity": velocity,
        "left": row["residual_velocity_m_s"],
        "u": along[0],
        "v": along[1],
        "yarns": this.crossovers.friction,
        "nose": this.projectile.friction,
        "outcome": row["outcome"],
        "doubts": ", ".join(find_doubts(row)),
        "error": row["energy_error_max"],
        "widened": "widened" in row,
        "cpu_s": time.process_time() - began,
    }


def spread(
    *, aims: int, shots: int = 20, share: float = 0.04, seed: int = 1, **keywords: Any
) -> Values:
    """Compute the V50 of shots that strike anywhere beside limits that are bisected at some of the places.

    Parameters
    ----------
    aims : drawn panels, of places, rolls and strengths of their own, whose limits are bisected
    shots : of the V50
    share : [-] width of the brackets over the limit without scatter
    seed : of the shots; the panels of the limits are of the next one
    keywords : of `impact.setup`; the friction on the nose is the assumed one

    Returns
    -------
    dict with v50, low, high, its 95 % interval, half, at which half of the shots pass, without a curve [m/s];
    limits [m/s] of the places, their mean and its error; off [%] of v50 from the mean; doubtful, shots of
    the V50 with a doubtful check; cpu_s
    """
    this = places.resolve(impact.setup(nose_friction=noses.ASSUMED, **keywords))
    scatter = inputs.read_scatter()
    began = time.process_time()
    with TemporaryDirectory() as folder:
        found = v50.study(this, scatter, shots=shots, seed=seed, tolerance=TOLERANCE, folder=folder)
    guess = 0.5 * sum(found.deterministic)
    limits = []
    for number in range(aims):
        pack = strengths.draw_panel(v50.as_fired(this), scatter, seed + 1, number).pack
        one = ballistic_limit.critical_velocity(pack, tolerance=share * guess, guess=guess)
        limits.append(one.velocity)
    middle = fmean(limits)
    curve = found.curves["probit"]
    low, high = curve.intervals["V50"]
    outcomes = [(one.velocity, one.perforated) for one in found.shots]
    passing = passing_shares.PassingShares.of_shots(*zip(*outcomes))
    return {
        "v50": curve.V50,
        "low": low,
        "high": high,
        "half": passing.velocities[0.5],
        "limits": sorted(limits),
        "mean": middle,
        "error": stdev(limits) / sqrt(aims),
        "off": 100 * (curve.V50 / middle - 1),
        "doubtful": found.doubtful,
        "cpu_s": time.process_time() - began,
    }


def _answer_beside_pinned(
    quantity: str, run_pinned: Callable[[ImpactSetup], Values], keywords: Values
) -> tuple[Values, Values]:
    """Compute a row of pinned yarns, and then an interval: the row, and the interval with the doubts of
    the row and the cost of both."""
    this = impact.setup(nose_friction=noses.ASSUMED, **keywords)
    _load_kernels(this)
    began = time.process_time()
    pinned = run_pinned(replace(this, crossovers=None, instead=None))
    cost = time.process_time() - began
    doubts = {"pinned_doubts": ", ".join(find_doubts(pinned))}
    return pinned, _answer(this, quantity, cost) | doubts


def _answer(this: ImpactSetup, quantity: str, pinned_cost: float) -> Values:
    """Compute an interval as the application does, and say what it cost beside a pinned run [s]."""
    target = Target(None, this, "", this.title, from_file=False)
    began = time.process_time()
    plan = plan_interval(target, quantity)
    # the study keeps the answer, and not its runs
    with TemporaryDirectory() as folder:
        first = interval.begin([plan], folder=folder)
        (found,) = interval.follow_up([plan], first, folder=folder)
    spent = time.process_time() - began
    return describe(found) | {"cpu_s": spent, "cost": spent / pinned_cost}


def describe(found: Interval) -> Values:
    """Say what an interval answers.

    Returns
    -------
    dict with low, high [m/s]; outcome; decides; words; runs, doubtful, stopped, stopped_doubtful, numbers of
    runs; doubts, the checks beyond their limits with the number of runs; widened, runs that were made
    again with all yarns resolved
    """
    stopped = [run for run in found.runs if run.outcome == "stopped"]
    return {
        "low": found.low,
        "high": found.high,
        "outcome": found.outcome,
        "decides": ", ".join(found.decides),
        "words": found.words(),
        "runs": len(found.runs),
        "doubtful": found.doubtful,
        "stopped": len(stopped),
        "stopped_doubtful": sum(run.doubtful for run in stopped),
        "doubts": _count_doubts(found.runs),
        "widened": sum("widened" in run.row for run in found.runs),
    }


def _load_kernels(this: ImpactSetup) -> None:
    """Fire short shots with pinned and with resolved yarns, whole and in part."""
    short = replace(this, end_time=SHORT, crossovers=None, instead=None)
    run_impact_or_partial(short)
    resolved = places.resolve(replace(this, end_time=SHORT))
    for place in places.choose_places(resolved, this.strike_velocity).listed:
        run_impact_or_partial(places.strike_at(resolved, place))


def find_doubts(row: Mapping[str, object]) -> list[str]:
    """Find the names of the checks beyond their limits of a row of `sweep`."""
    return OF_A_DOUBT.findall(str(row.get("checks", "")))


def _count_doubts(runs: Sequence[Run]) -> str:
    """Each check beyond its limit, with the number of runs."""
    names = [name for run in runs if run.doubtful for name in find_doubts(run.row)]
    return ", ".join(f"{name} ({names.count(name)})" for name in dict.fromkeys(names))
