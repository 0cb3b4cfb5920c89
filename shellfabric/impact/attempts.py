"""Runs of a shot that follow one another: with a shorter step if a run loses too much to its length, and with
all yarns of the panel resolved if their default zone was too small.

Outside the zone yarns are pinned. It is too small if much of what is cut lies outside it, where pinned yarns
unzip, or if more yarn would have been drawn in through its rim. Both are checks of the run (`membrane.quality`).
A zone that the user gives stays as it is, with its doubt. What slip costs: limits of S-720 and S-728 at friction
0.1, with a zone of 20 mm against all yarns, were 1.2, 3.2 and 5.7 % lower where yarns slipped by 0.28, 0.26 and 0.32
crossovers at the rim, and 1.2 % higher at friction 0.2 and a slip of 0.12: the limit of 0.15 stands for about 3 %.

A run in which yarn has slipped through the rim while whole yarns took three quarters of the energy of the nose
ends there if another follows (`RimWatch`): 13 shots of spheres and fragments at three fabrics ended so in eight, all of
which had slip beyond its limit at their end too. On the way slip alone does not tell: it springs back where the nose
gets through, to half or a third. What is cut outside the zone is a share of all that is cut, known at the end.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from fabrics.base.errors import InputError
from shellfabric import guards
from shellfabric.impact.setup import ImpactSetup
from shellfabric.loop import pack_memory
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane import quality
from shellfabric.membrane.indicator import Indicator
from shellfabric.plies.model import Pack
from shellfabric.yarns.model import crossings_of

SLOWED = 0.5  # of the strike velocity, at which a run may end by its slip at the rim
RIM = "slip at the rim"
# {check: what it says of a zone that is too small}
TOO_SMALL = {
    RIM: "a yarn slipped by {:.2g} crossovers at its rim",
    "cut outside the zone": "{:.0%} of the cut yarns were outside it",
}


@dataclass(frozen=True)
class Attempt:
    """A run of a shot.

    Parameters
    ----------
    at_full_step : Pack that is struck, with the time step of its set-up
    step_factor : [-] 1, or that on the time step of a run that is made again with a shorter one
    widened : why all yarns are resolved in place of those of a zone; "" of a run with the zone
    """

    at_full_step: Pack
    step_factor: float = 1.0
    widened: str = ""

    @cached_property
    def target(self) -> Pack:
        """The Pack that is struck."""
        if self.step_factor == 1.0:
            return self.at_full_step
        return self.at_full_step.at_shorter_step(self.step_factor)

    def follow(self, solver: Any) -> Attempt | None:
        """Return the run that has to follow one that has ended; None if its result counts."""
        if self.step_factor == 1.0 and solver.step_loss > guards.MOST_STEP_LOSS:
            return self.shorten(shorter_step(solver.step_loss))
        return self.widen_by(solver.part_indicators)

    def widen_by(self, checks: Iterable[Indicator]) -> Attempt | None:
        """Return the run with all yarns resolved if one of the checks doubts the zone."""
        doubts = [check for check in checks if check.name in TOO_SMALL and check.doubtful]
        if not doubts:
            return None
        return self.widen(", ".join(TOO_SMALL[check.name].format(check.value) for check in doubts))

    def shorten(self, factor: float) -> Attempt:
        """Return the run with its step times a factor."""
        return replace(self, step_factor=factor)

    def widen(self, reasons: str = "") -> Attempt | None:
        """Return the run with all yarns resolved; None if the zone is not the default one, if yarns cannot
        be resolved as far as the edges, or if memory is too small for it."""
        zone = self.at_full_step.default_zone
        if zone is None:
            return None
        try:
            wider = self.at_full_step.with_all_yarns()
            pack_memory.check(wider.plies)
        except InputError:
            return None
        before, after = (sum(map(crossings_of, pack.plies)) for pack in (self.at_full_step, wider))
        if after > before:
            why = (
                f"a zone of {1e3 * zone:g} mm was too small ({reasons}): run again with all yarns resolved, "
                f"{after:,} crossings in place of {before:,}"
            )
        else:
            why = (
                f"a zone of {1e3 * zone:g} mm holds all {after:,} crossings of the panel, with a rim beside the "
                f"edges ({reasons}): run again without a rim"
            )
        return replace(self, at_full_step=wider, widened=why)

    def setup_of(self, setup: ImpactSetup) -> ImpactSetup:
        """Return the set-up as it is run, with the zone of this run."""
        if not self.widened:
            return setup
        return with_all_yarns(setup)

    def possible(self) -> list[Attempt]:
        """List this run and all that may follow it."""
        wider = self.widen()
        found = [self, *map(self.shorten, guards.SHORTER_STEPS)]
        if wider is not None:
            found += [wider, *map(wider.shorten, guards.SHORTER_STEPS)]
        return found

    def list_series(self) -> list[list[Attempt]]:
        """List each series of runs that `follow` may make of this one, to its end."""
        count = len(guards.SHORTER_STEPS)
        _, *runs = self.possible()
        series = [[self], *([self, shorter] for shorter in runs[:count])]
        if len(runs) == count:
            return series
        wider, *both = runs[count:]
        series.append([self, wider])
        for shorter, last in zip(runs, both):
            series += [[self, shorter, last], [self, wider, last]]
        return series


def shorter_step(loss: float) -> float:
    """Return the step over that of a run that has lost a share `loss` [-] to its length, of the run that follows."""
    enough = (f for f in guards.SHORTER_STEPS if f * f * loss <= guards.MOST_STEP_LOSS)
    return next(enough, guards.SHORTER_STEPS[-1])


class Superseded(Exception):
    """Ends a run whose result will not count.

    Attributes
    ----------
    following : Attempt in its place
    """

    def __init__(self, following: Attempt) -> None:
        super().__init__(following.widened)
        self.following = following


class RimWatch:
    """A hook that ends a run, by Superseded, once the nose is SLOWED, no yarn is cut and yarn has slipped through
    the rim of the zone; not where no run with all yarns resolved can follow: its result counts, with its doubt.

    Parameters
    ----------
    attempt : Attempt whose run it watches
    """

    def __init__(self, attempt: Attempt) -> None:
        self.attempt = attempt
        self.done = attempt.target.default_zone is None

    def __call__(self, solver: PackSolver) -> None:
        if self.done or solver.ended or solver.sample("cut_yarns")[-1] > 0:
            return
        if solver.sample("v")[-1] > SLOWED * solver.strike_velocity:
            return
        rim = quality.indicator(RIM, solver.slip_at_rim)
        if not rim.doubtful:
            return
        following = self.attempt.widen_by([rim])
        self.done = following is None
        if following is not None:
            raise Superseded(following)


def with_all_yarns(setup: ImpactSetup) -> ImpactSetup:
    """Return a set-up of resolved yarns with all yarns of the panel resolved."""
    assert setup.crossovers is not None
    return replace(setup, crossovers=setup.crossovers.whole)
