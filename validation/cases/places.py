"""Panels struck anywhere, with frictions that nobody gave: stops and their doubts, V50, limits, energy taken."""

from __future__ import annotations

import re
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from math import sqrt
from statistics import NormalDist, fmean, median, stdev
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from scipy.stats import qmc

from shellfabric.loop.pack_solver import PackSolver
from shellfabric.yarns.state import Zone
from validation.cases import impact, noses
from validation.values import Values
from weavecell.runs import sweep, table, v50
from weavecell.runs.span import CONFIDENCE
from weavecell.studies import ballistic_limit, inputs, places, strengths, unknown

# of an indicator in words, "name 0.2 (limit 0.1; remedy); name 3 (...)", the name
OF_A_DOUBT = re.compile(r"(?:^doubtful: |\); )([a-z][a-z -]*?) -?[\d.]")
FINELY = 1e-6  # [s] between looks for the first failure
OF_SHOTS = ("v50", "low", "high", "error", "least", "fired", "perforated", "failures", "doubtful")


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
    frictions; outcome; doubts; error [-] of the energy; cpu_s
    """
    sequence = qmc.Sobol(5, seed=seed)
    # it refuses to go on by none
    if number:
        sequence.fast_forward(number)
    share, *place, yarns, nose = map(float, sequence.random()[0])
    velocity = velocities[0] + share * (velocities[1] - velocities[0])
    this = places.resolve(impact.setup(velocity=velocity, nose_friction=noses.ASSUMED, **keywords))
    drawn = {"friction between yarns": yarns, "friction on the nose": nose}
    shares = {name: drawn[name] for name in unknown.find_unknown(this)}
    this = unknown.put_all(this, unknown.ALIKE, shares)
    # a repeat of plain weave has two crossovers each way
    u, v = (2 * share - 1 for share in place)
    this = places.strike_at(this, (u, v))
    began = time.process_time()
    row = sweep.shot(this)
    return {
        "velocity": velocity,
        "left": row["residual_velocity_m_s"],
        "u": u,
        "v": v,
        "yarns": this.crossovers.friction,
        "nose": this.projectile.friction,
        "outcome": row["outcome"],
        "doubts": ", ".join(find_doubts(row)),
        "error": row["energy_error_max"],
        "cpu_s": time.process_time() - began,
    }


def spread(
    *, aims: int, shots: int = 20, share: float = 0.04, seed: int = 1, **keywords: Any
) -> Values:
    """Compute the V50 of drawn shots beside limits that are bisected of some drawn panels.

    Parameters
    ----------
    aims : drawn panels, of places, rolls, frictions and strengths of their own, whose limits are bisected
    shots : of the V50
    share : [-] width of the brackets over V50
    seed : of the shots; the panels of the limits are of the next one
    keywords : of `impact.setup`; the friction on the nose is the assumed one

    Returns
    -------
    dict with v50, low, high, its 90 % interval [m/s]; limits [m/s] of the panels, their mean and its error; off
    [%] of v50 from the mean; doubtful, shots of the V50 with a doubtful check; cpu_s
    """
    this = places.resolve(impact.setup(nose_friction=noses.ASSUMED, **keywords))
    scatter = inputs.read_scatter()
    began = time.process_time()
    with TemporaryDirectory() as folder:
        found = v50.study(this, scatter, shots=shots, seed=seed, folder=folder)
    if found.posterior is None:
        raise ValueError(f"all {shots} shots end alike: {found.shots}")
    V50, low, high = found.posterior.velocities["V50"]
    limits = []
    for number in range(aims):
        pack = strengths.draw_panel(table.as_fired(this), scatter, seed + 1, number).pack
        one = ballistic_limit.critical_velocity(pack, tolerance=share * V50, guess=V50)
        limits.append(one.velocity)
    middle = fmean(limits)
    return {
        "v50": V50,
        "low": low,
        "high": high,
        "limits": sorted(limits),
        "mean": middle,
        "error": stdev(limits) / sqrt(aims) if aims > 1 else float("nan"),
        "off": 100 * (V50 / middle - 1),
        "doubtful": found.doubtful,
        "cpu_s": time.process_time() - began,
    }


def load(
    *, velocity: float, shots: int = 0, seed: int = 1, share: float = 0.5, **keywords: Any
) -> Values:
    """Compute how a nose loads the yarns until the first of them fails, and the V50 of drawn shots.

    Parameters
    ----------
    velocity : [m/s] of the shot at the panel as it is, a crossover under the nose
    shots : of the V50; 0 fires none
    seed : of these; noses of one seed have the same draws
    share : [-] of the strength, from which on a yarn counts as loaded
    keywords : of `impact.setup`; the friction on the nose is the assumed one, where none is given

    Returns
    -------
    dict with loaded, the number of yarns; taken [J] from the projectile until then; time [s]; tensions (warp, weft),
    the highest of each yarn [-] over its strength; v50, low, high, its 90 % interval, error, the standard one [m/s];
    least, the lowest velocity that perforated [m/s]; fired, perforated, failures, doubtful, counts of shots. Without
    the shots, or a V50, these are NaN
    """
    this = table.as_fired(
        places.resolve(impact.setup(velocity=velocity, nose_friction=noses.ASSUMED, **keywords))
    )
    target = this.target(this.table(kept=True))
    solver = PackSolver(target, velocity, ballistic_limit.UNDECIDED, interval=FINELY)
    with suppress(impact.YarnFailed):
        solver.run([impact.end_at_a_failure])
    tensions = find_tensions(solver.part("yarns").zone)
    left = solver.sample("kinetic_projectile")[-1]
    found: Values = {
        "tensions": tensions,
        "loaded": sum(int((family > share).sum()) for family in tensions),
        "taken": float(solver.strike_energy - left),
        "time": float(solver.time),
    }
    found |= dict.fromkeys(OF_SHOTS, float("nan"))
    if not shots:
        return found
    with TemporaryDirectory() as folder:
        of = v50.study(this, inputs.read_scatter(), shots=shots, seed=seed, folder=folder)
    passed = [shot.velocity for shot in of.shots if shot.perforated]
    found |= {"fired": len(of.shots), "perforated": len(passed), "failures": len(of.failures)}
    found |= {"doubtful": of.doubtful, "least": min(passed, default=float("nan"))}
    if of.posterior is not None:
        span = of.posterior.velocities["V50"]
        found |= {"v50": span.value, "low": span.low, "high": span.high}
        found["error"] = span.half / NormalDist().inv_cdf(0.5 + 0.5 * CONFIDENCE)
    return found


def find_tensions(zone: Zone) -> tuple[np.ndarray, np.ndarray]:
    """Find the highest tension of each yarn over its strength [-]: (warp yarns,), (weft yarns,)."""
    found = []
    for first, count, nodes in zip(zone.first, zone.yarns, zone.nodes):
        own = slice(first, first + count * nodes)
        found.append((zone.tension[own] / zone.strength[own]).reshape(count, nodes).max(axis=1))
    return found[0], found[1]


def take(*, shots: int, seed: int = 1, whole_zone: bool = False, **keywords: Any) -> Values:
    """Compute what drawn shots of one velocity take from the projectile; of one seed methods have the same draws.

    Parameters
    ----------
    whole_zone : whether all yarns of the panel are resolved
    keywords : of `impact.setup`, which resolve the yarns unless they pin them; the friction on the nose is the
        assumed one

    Returns
    -------
    dict with taken (shots,) [J]; cpu_s [s], the median of the shots, of which the first may compile; failures,
    shots that did not end
    """
    this = impact.setup(nose_friction=noses.ASSUMED, **keywords)
    if not this.pinned:
        this = places.resolve(this)
    if whole_zone:
        this = replace(this, crossovers=this.crossovers.whole)
    with TemporaryDirectory() as folder:
        fired = table.run(table.draw(this, shots, seed=seed), folder=folder)
    mass = this.projectile.mass
    taken = [0.5 * mass * (shot.velocity**2 - shot.residual * abs(shot.residual)) for shot in fired]
    return {
        "taken": np.array(taken),
        "cpu_s": median(shot.cpu_time for shot in fired),
        "failures": sum(bool(shot.failure) for shot in fired),
    }


def find_doubts(row: Mapping[str, object]) -> list[str]:
    """Find the names of the checks beyond their limits of a row of `sweep`."""
    return OF_A_DOUBT.findall(str(row.get("checks", "")))
