"""Runs of a shot that follow one another: with a shorter step if a run loses too much to its length."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from shellfabric import guards
from shellfabric.plies.model import Pack


@dataclass(frozen=True)
class Attempt:
    """A run of a shot.

    Parameters
    ----------
    at_full_step : Pack that is struck, with the time step of its set-up
    step_factor : [-] 1, or that on the time step of a run that is made again with a shorter one
    """

    at_full_step: Pack
    step_factor: float = 1.0

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
        return None

    def shorten(self, factor: float) -> Attempt:
        """Return the run with its step times a factor."""
        return replace(self, step_factor=factor)

    def possible(self) -> list[Attempt]:
        """List this run and all that may follow it."""
        return [self, *map(self.shorten, guards.SHORTER_STEPS)]


def shorter_step(loss: float) -> float:
    """Return the step over that of a run that has lost a share `loss` [-] to its length, of the run that follows."""
    enough = (f for f in guards.SHORTER_STEPS if f * f * loss <= guards.MOST_STEP_LOSS)
    return next(enough, guards.SHORTER_STEPS[-1])
