"""Hooks of a run: snapshots, and the clock that decides when they act. See also `checkpoint`."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from shellfabric.loop.snapshots import of_plies

if TYPE_CHECKING:
    from shellfabric.loop.driver import ExplicitSolver


class Every:
    """True once per interval of the run's time, and at its end.

    Parameters
    ----------
    interval : [s]
    """

    def __init__(self, interval: float) -> None:
        self.interval = interval

    def due(self, solver: ExplicitSolver) -> bool:
        """Tell whether this sample is the one nearest a multiple of the interval.

        It depends on the run alone, so that a resumed run acts at the same instants.
        """
        before = 0.0
        if len(solver.samples) > 1:
            before = solver.samples[-2][0]
        numbers = [
            int((t + 0.5 * solver.sample_spacing) / self.interval) for t in (before, solver.time)
        ]
        before_end = numbers[1] * self.interval < (1 - 1e-9) * solver.end_time
        return solver.ended or (numbers[1] > numbers[0] and before_end)


class Snapshots(Every):
    """Keep a snapshot every interval, in solver.snapshots.

    Parameters
    ----------
    interval : [s]
    take : called as take(solver), makes the snapshot; None takes those of all plies
    """

    def __init__(self, interval: float, take: Callable[..., object] | None = None) -> None:
        super().__init__(interval)
        self.take = take or of_plies

    def __call__(self, solver: ExplicitSolver) -> None:
        if self.due(solver) and not solver.fabric_ended:
            solver.snapshots.append(self.take(solver))
