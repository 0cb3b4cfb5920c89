"""Onlookers of a march: snapshots, progress, and the clock that decides when they act. See also `checkpoint`."""

from __future__ import annotations

from shellfabric.output.snapshots import snapshot


class Every:
    """True once per interval of the run's time, and at its end.

    Parameters
    ----------
    interval : [s]
    """

    def __init__(self, interval):
        self.interval = interval

    def due(self, march):
        """Whether this audit is the one nearest a multiple of the interval.

        It depends on the march alone, so that a resumed run acts at the same instants.
        """
        dt, last = march.const.dt, march.fine[-1].shape[0]
        numbers = [int((steps + march.chunk / 2) * dt / self.interval) for steps in (march.steps - last, march.steps)]
        before_end = numbers[1] * self.interval < (1 - 1e-9) * march.end_time
        return march.ended or (numbers[1] > numbers[0] and before_end)


class Snapshots(Every):
    """Keep a snapshot every interval, in march.snapshots."""

    def __call__(self, march):
        if self.due(march):
            march.snapshots.append(snapshot(march.panel, march.state, march.time))


class Progress:
    """Report progress.

    Parameters
    ----------
    report : called as report(share of the end time, projectile velocity [m/s])
    """

    def __init__(self, report):
        self.report = report

    def __call__(self, march):
        self.report(1.0 if march.ended else march.time / march.end_time, float(march.state.speed[2]))
