"""The runs: first failure and ballistic limit of packs of four plies against the friction between their plies.

Literature: friction raises V50 by about 10 % (Rao et al., as quoted in 10.1177/0040517514527376); that is of yarns and
plies together. Here the crossovers are pinned and the nose is frictionless, so that the friction between plies is the
only one.

Ballistic limit. Of torn packs it is no single velocity: stops and perforations alternate over a zone of several per
cent, and a bisection ends at any of its edges. So the same strike velocities are fired at every coefficient, `SHARES`
of the limit that a bisection finds without friction. The limit is the velocity that has as many perforations below it
as stops above; lowest perforation and highest stop bound the zone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from fabrics.errors import UndecidedError
from validation.published.packs import study as packs
from validation.published.packs.study import Case

FABRICS, PLIES = ("S-726", "S-728"), 4
FRICTIONS = (0.0, 0.1, 0.2, 0.3)
END = 1.5e-3  # [s] by which a shot has stopped or perforated
STEP = 1.15  # first factor from the guess
TOLERANCE = 2.0  # [m/s] of the bracket of the ballistic limit
STRIDE = 0.02  # between the velocities of the scan, of the limit without friction
SHARES = tuple(1 + STRIDE * n for n in range(-6, 7))
Shots = Callable[[Case], dict[str, Any]]


@dataclass(frozen=True)
class Found:
    """What friction does to one pack.

    Parameters
    ----------
    friction : [-]
    onset : [m/s] strike velocity at which the first yarn fails
    limit : [m/s] ballistic limit: as many perforations below it as stops above, in the scan
    perforation, stop : [m/s] lowest perforation and highest stop of the scan
    rubbed : [-] work of friction between plies over the strike energy, of the highest stop
    balance : [-] largest error of the energy balance over the strike energy, of the scan
    unstable : number of its shots that a guard stopped, which count as perforations
    """

    friction: float
    onset: float
    limit: float
    perforation: float
    stop: float
    rubbed: float
    balance: float
    unstable: int


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


def scan(shots: Shots, case: Case, centre: float) -> list[dict[str, Any]]:
    """The shots at `SHARES` of a velocity [m/s], slowest first."""
    return [shots(replace(case, velocity=round(share * centre, 1), end_time=END)) for share in SHARES]


def summed(friction: float, onset: float, fired: Sequence[dict[str, Any]]) -> Found:
    """The Found of a scan, slowest shot first."""
    velocity = [one["case"]["velocity"] for one in fired]
    through = [perforates(one) for one in fired]
    stops = [v for v, one in zip(velocity, through) if not one]
    step = (velocity[-1] - velocity[0]) / (len(velocity) - 1)
    last = fired[velocity.index(max(stops))] if stops else fired[0]
    return Found(
        friction, onset, velocity[0] + (len(stops) - 0.5) * step,
        min((v for v, one in zip(velocity, through) if one), default=velocity[-1] + step),
        max(stops, default=velocity[0] - step), last["rubbed"], max(one["balance"] for one in fired),
        sum(one["outcome"] == "unstable" for one in fired),
    )  # fmt: skip


def study(shots: Shots, fabric: str) -> list[Found]:
    """One Found for each friction."""
    rows: list[Found] = []
    centre = 0.0
    for friction in FRICTIONS:
        case = Case(fabric, PLIES, 0.0, friction=friction)
        onset = packs.onset(shots, case, guess=rows[-1].onset if rows else None)
        if not rows:
            fired = bracket(shots, case, 1.1 * onset)
            ends = [[one["case"]["velocity"] for one in fired if perforates(one) == through] for through in (0, 1)]
            centre = 0.5 * (max(ends[0]) + min(ends[1]))
        rows.append(summed(friction, onset, scan(shots, case, centre)))
    return rows
