"""Scan of strike velocities about a ballistic limit: is there one limit, or a zone of mixed
outcomes?

Bisection finds one pair of a stop and a perforation and takes for granted that every faster shot
perforates. Where that does not hold, the pair that it finds depends on where it began. The scan
fires shots on an even ladder of strike velocities below and above the bracket. It goes on until no
stop lies within a given range below its upper end and no perforation within a given range above its
lower end; a stop far above the bracket thus extends it upwards. The shots of a range are fired
beside each other, and the result is the same with any executor and number of workers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace

from shellfabric.membrane.indicator import Check, Indicator
from shellfabric.membrane.model import Panel
from shellfabric.plies.model import Pack
from weavecell.studies.ballistic_limit import KeptShots, Limit, Shot, shoot

# [m/s] no shot is fired beyond
HIGHEST = 1000.0
# a search that is not to be scanned has a shot in this band [-] beyond either end of its bracket, of its
# own or one more, at LOOK
BESIDE = 0.02, 0.08
LOOK = 0.03
MIXED = Check(
    "mixed outcomes",
    0.0,
    "highest strike velocity that is stopped less the lowest that perforates, where it is positive",
    "state the zone, or V50 of yarns that scatter",
    unit="m/s",
)


@dataclass(frozen=True)
class ScanRange:
    """Range and step of a scan.

    Parameters
    ----------
    above : [-] range above the highest stop in which every shot has to perforate, as a share of the
        highest stop
    below : [-] range below the lowest perforation in which every shot has to stop, as a share of
        that velocity
    step : [-] between neighbouring shots, as a share of the bracket's upper end
    """

    above: float = 0.25
    below: float = 0.10
    step: float = 0.02

    def ladder(self, limit: Limit) -> list[float]:
        """List velocities [m/s] that the present shots call for, rising; those of the bracket
        itself are not among them."""
        step = self.step * limit.high
        top = min((1 + self.above) * limit.highest_stop, HIGHEST)
        bottom = (1 - self.below) * limit.lowest_perforation
        rungs_up = int((top - limit.high) / step)
        rungs_down = int((limit.low - bottom) / step)
        down = [limit.low - k * step for k in range(rungs_down, 0, -1)]
        up = [limit.high + k * step for k in range(1, rungs_up + 1)]
        return [velocity for velocity in down if velocity > 0] + up


def scan(
    panel: Panel | Pack,
    limit: Limit,
    velocities: ScanRange | None = None,
    *,
    executor: str | Executor = "local",
    jobs: int = 1,
    report: Callable[..., object] | None = None,
    kept: KeptShots | None = None,
) -> Limit:
    """Fire shots below and above a bracket until the zone of mixed outcomes, if there is one, is
    enclosed.

    Parameters
    ----------
    panel : Panel or Pack
    limit : of `ballistic_limit.critical_velocity` on this panel
    velocities : ScanRange; None takes its defaults
    executor, jobs, report, kept : as in `ballistic_limit.shoot`

    Returns
    -------
    Limit : the same bracket, with the shots of the scan after those of the bisection

    Raises
    ------
    InputError, UnstableError : as `ballistic_limit.shoot`
    """
    velocities = velocities or ScanRange()
    known = {shot.strike_velocity for shot in limit.shots}
    while wanted := [v for v in velocities.ladder(limit) if v not in known]:
        fired = shoot(panel, wanted, executor=executor, jobs=jobs, report=report, kept=kept)
        limit = with_shots(limit, fired)
        known.update(wanted)
    return limit


def look_beside(
    panel: Panel | Pack,
    limit: Limit,
    *,
    executor: str | Executor = "local",
    jobs: int = 1,
    report: Callable[..., object] | None = None,
    kept: KeptShots | None = None,
) -> Limit:
    """Fire a shot a few percent below the bracket and one above it, unless the search has fired
    there: two looks at whether outcomes mix.

    Parameters and errors as of `scan`.
    """
    least, most = BESIDE
    wanted = []
    for end, sign in ((limit.low, -1), (limit.high, 1)):
        beyond = [sign * (shot.strike_velocity / end - 1) for shot in limit.shots]
        velocity = (1 + sign * LOOK) * end
        if not any(least <= share <= most for share in beyond) and velocity <= HIGHEST:
            wanted.append(velocity)
    if not wanted:
        return limit
    return with_shots(
        limit, shoot(panel, wanted, executor=executor, jobs=jobs, report=report, kept=kept)
    )


def with_shots(limit: Limit, shots: Sequence[Shot]) -> Limit:
    """Return the limit with further shots at the same panel; its bracket remains that of the
    bisection."""
    return replace(limit, shots=(*limit.shots, *shots))


def indicator(limit: Limit) -> Indicator:
    """Return the quality indicator: width [m/s] of the zone of mixed outcomes, 0 if there is a
    single limit."""
    low, high = limit.mixed_zone or (0.0, 0.0)
    return MIXED.judge(high - low)
