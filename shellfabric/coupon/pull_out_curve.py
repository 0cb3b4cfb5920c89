"""A yarn pull-out followed to a displacement of the crosshead, and what is read off its load.

The crosshead comes to its velocity smoothly, within START of a spacing, and what slides is damped towards it
(`PullOutSolver`). The peak is the highest load after that start. The plateau is the mean load while all crossovers
slide and the yarn's end has not yet left one, over the last SETTLED of that time. The slip length is the length of yarn
that slides at the peak.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import inf

import numpy as np

from fabrics.base.checks import FloatArray, IntArray
from fabrics.base.errors import InputError
from shellfabric.coupon.pull_out import PullOut, PullOutSolver
from shellfabric.driver.solver import Hook, run_to_end
from shellfabric.sliding.model import grid

START = 0.25  # of a spacing, which the crosshead moves until it has its velocity
SETTLED = 1 / 3  # of the time in which all crossovers slide


@dataclass(frozen=True)
class PullOutCurve:
    """Samples of a pull-out.

    Parameters
    ----------
    coupon : PullOut
    start : [s] in which the crosshead comes to its velocity; the peak and what is read at it come after
    time, displacement : (n,) [s], [m] of the crosshead
    load : (n,) [N] on a pulled yarn
    sliding : (n,) [-] crossovers that the yarn slides through
    left : (n,) [-] crossovers that the yarn's end has left
    friction_work : (n,) [J] of all pulled yarns
    work : (n,) [J] of the crosshead on all pulled yarns, by the trapezoidal rule over the samples
    energy_error : [-] largest error of the energy balance over the work of the crosshead; 0 without work
    """

    coupon: PullOut
    start: float
    time: FloatArray
    displacement: FloatArray
    load: FloatArray
    sliding: IntArray
    left: IntArray
    friction_work: FloatArray
    work: FloatArray
    energy_error: float

    @property
    def peak(self) -> float:
        """[N] highest load after the start."""
        return float(self.load[self._at_peak])

    @property
    def _at_peak(self):
        """Number of the sample of the peak; the last one of a run that ended in its start."""
        after = np.flatnonzero(self.time >= self.start)
        if not after.size:
            return len(self.time) - 1
        return int(after[np.argmax(self.load[after])])

    @property
    def plateau(self) -> float | None:
        """[N] mean load while all crossovers slide; None where there is no such sample."""
        whole = np.flatnonzero((self.sliding == self.coupon.crossings) & (self.left == 0))
        if not whole.size:
            return None
        return float(self.load[whole[-max(1, round(SETTLED * whole.size)) :]].mean())

    @property
    def slip_length(self) -> float:
        """[m] length of yarn, at rest, that slides at the peak."""
        spacing = 2 * self.coupon.table.model.fabric.weave.w1
        return float(spacing * self.sliding[self._at_peak])


def follow(
    coupon: PullOut, displacement: float, *, samples: int = 500, hooks: Iterable[Hook] = ()
) -> PullOutCurve:
    """Pull the yarn until the crosshead has moved by `displacement` [m].

    Parameters
    ----------
    coupon : PullOut
    displacement : [m]
    samples : of the load; fewer where a time step is longer than the interval
    hooks : called with the solver after each sample

    Raises
    ------
    InputError : a displacement that is not positive, or no sample
    UnstableError : as ExplicitSolver.run; its `result` is the curve so far
    """
    if not 0 < displacement < inf:
        raise InputError(key="displacement", value=displacement, allowed="above 0")
    if samples < 1:
        raise InputError(key="samples", value=samples, allowed="at least 1")
    end = displacement / coupon.velocity
    side = 2 * coupon.table.model.fabric.weave.w1
    start = 2 * START * min(side, displacement) / coupon.velocity
    end += 0.5 * start
    solver = PullOutSolver(coupon, end, interval=end / samples, start=start)
    rows: list[tuple[float, ...]] = []

    def record(running: PullOutSolver) -> None:
        slip, middle = running.slip, running.const.nj // 2
        gone = int(np.count_nonzero(grid(slip.removed[0], running.panel)[:, middle]))
        moved = float(slip.passed[0][running.node])
        rows.append(
            (
                running.time,
                moved,
                running.load(),
                running.sliding_crossovers(),
                gone,
                float(slip.work[0]),
            )
        )

    record(solver)
    return run_to_end(solver, (record, *hooks), lambda: _curve(coupon, solver, np.array(rows)))


def _curve(coupon, solver, rows):
    time, moved, load, sliding, left, friction = rows.T
    yarns = solver.const.nj + 1 if coupon.together else 1
    parts = 0.5 * (load[1:] + load[:-1]) * np.diff(moved)
    work = yarns * np.concatenate([[0.0], np.cumsum(parts)])
    errors = np.abs(solver.sample("error"))
    error = float(errors.max() / work[-1]) if work[-1] > 0 else 0.0
    return PullOutCurve(
        coupon,
        solver.start,
        time,
        moved,
        load,
        sliding.astype(int),
        left.astype(int),
        friction,
        work,
        error,
    )
