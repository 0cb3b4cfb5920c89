"""The runs: first failure and ballistic limit of packs of four plies against the friction between their plies.

Literature: friction raises V50 by about 10 % (Rao et al., as quoted in 10.1177/0040517514527376); that is of yarns and
plies together. Here the crossovers are pinned and the nose is frictionless, so that the friction between plies is the
only one.

Ballistic limit. The strike velocity between the last stop and the first perforation, by bisection. Packs that tear may
have more than one such velocity; the bracket that is found is given, and every shot is kept.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from fabrics.errors import UndecidedError
from validation.published.packs import study as packs
from validation.published.packs.study import Case

FABRICS, PLIES = ("S-726", "S-728"), 4
FRICTIONS = (0.0, 0.1, 0.2, 0.3)
END = 1.5e-3  # [s] by which a shot has stopped or perforated
RANGE, STEP = (80.0, 400.0), 1.15  # [m/s]; first factor from the guess
TOLERANCE = 2.0  # [m/s] of the bracket of the ballistic limit
Shots = Callable[[Case], dict[str, Any]]


@dataclass(frozen=True)
class Found:
    """What friction does to one pack.

    Parameters
    ----------
    friction : [-]
    onset : [m/s] strike velocity at which the first yarn fails
    stop, perforation : [m/s] bracket of the ballistic limit
    rubbed : [-] work of friction between plies over the strike energy, of the fastest shot that stopped
    balance : [-] largest error of the energy balance over the strike energy, of all shots of the bisection
    unstable : number of its shots that a guard stopped, which count as perforations
    """

    friction: float
    onset: float
    stop: float
    perforation: float
    rubbed: float
    balance: float
    unstable: int

    @property
    def limit(self) -> float:
        """[m/s] middle of the bracket."""
        return 0.5 * (self.stop + self.perforation)


def perforates(found: dict[str, Any]) -> bool:
    """Whether a shot perforated; one that a guard stopped counts as one.

    Raises
    ------
    UndecidedError : it is still in flight at its end
    """
    if found["outcome"] == "in flight":
        raise UndecidedError(f"{found['case']} has neither stopped nor perforated after {found['time'] * 1e6:.0f} us")
    return found["outcome"] != "stopped"


def bracket(shots: Shots, case: Case, guess: float) -> list[dict[str, Any]]:
    """Shots about the ballistic limit, the last stop and the first perforation of which are `TOLERANCE` apart."""
    fired: dict[float, dict[str, Any]] = {}

    def through(velocity):
        fired[velocity] = shots(replace(case, velocity=velocity, end_time=END))
        return perforates(fired[velocity])

    low = high = round(guess, 1)
    if through(low):
        while through(low := round(low / STEP, 1)):
            high = low
    else:
        while not through(high := round(high * STEP, 1)):
            low = high
    while high - low > TOLERANCE:
        middle = round(0.5 * (low + high), 1)
        low, high = (low, middle) if through(middle) else (middle, high)
    return list(fired.values())


def study(shots: Shots, fabric: str) -> list[Found]:
    """One Found for each friction; each search begins at the limit of the friction before."""
    rows: list[Found] = []
    for friction in FRICTIONS:
        case = Case(fabric, PLIES, 0.0, friction=friction)
        onset = packs.onset(shots, case, guess=rows[-1].onset if rows else None)
        fired = bracket(shots, case, rows[-1].limit if rows else 1.3 * onset)
        stops = [one for one in fired if not perforates(one)]
        last = max(stops, key=lambda one: one["case"]["velocity"])
        first = min(one["case"]["velocity"] for one in fired if perforates(one))
        rows.append(Found(
            friction, onset, last["case"]["velocity"], first, last["rubbed"], max(one["balance"] for one in fired),
            sum(one["outcome"] == "unstable" for one in fired),
        ))  # fmt: skip
    return rows
