"""The chain of a fabric: platen curve -> constants of its solid -> biaxial paths -> compression law
with intervals.

The intervals of a and b follow from what the platen curve leaves open of the constants. On each
principal direction of their covariance the biaxial paths are solved at both 95 % ends
(`SolidFit.limits`), on a coarse mesh; the changes of ln a, and of ln b, of the three directions,
which are independent, add as squares, upwards and downwards on their own.

Every fit, and every path, is kept in the folder as soon as it is done (`fabrics.base.run_cache`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from fabrics.base import run_cache
from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.errors import InputError, UnstableError
from fabrics.compression import CompressionLaw
from unitcell3d.identify.calibrate import Job, path_jobs, run_job
from unitcell3d.identify.calibration import samples
from unitcell3d.identify.solid_record import SolidFit

# mesh of the paths at the ends: what counts is their ratio to those of the fitted solid
SIZE = "coarse"


@dataclass(frozen=True)
class LawInterval:
    """95 % of a compression law, from those of the solid's constants.

    Parameters
    ----------
    a, b : (low, high) [m], [m N^(1/3)]
    law : CompressionLaw of the fitted solid, on the mesh of the ends
    ends : ((CompressionLaw, CompressionLaw), ...) low and high of each principal direction; None
        where no law fits
    """

    a: tuple[float, float]
    b: tuple[float, float]
    law: CompressionLaw
    ends: tuple[tuple[CompressionLaw | None, CompressionLaw | None], ...]

    def around(self, law: CompressionLaw) -> dict[str, tuple[float, float]]:
        """Place the interval about another law, such as that of a finer mesh, at the same ratios:
        {"a", "b": (low, high)}."""
        return {
            "a": (self.a[0] / self.law.a * law.a, self.a[1] / self.law.a * law.a),
            "b": (self.b[0] / self.law.b * law.b, self.b[1] / self.law.b * law.b),
        }


def law_intervals(
    fits: Sequence[SolidFit],
    *,
    folder: FilePath,
    friction: float = 0.0,
    executor: str | Executor = "local",
    jobs: int = 1,
    report: Callable[[int, int], object] | None = None,
) -> list[LawInterval | Exception]:
    """Compute intervals of the compression laws of fitted solids.

    Parameters
    ----------
    fits : of SolidFit
    folder, executor, jobs, report : as in `fabrics.base.run_cache.results`
    friction : [-] Coulomb's coefficient

    Returns
    -------
    A LawInterval, or the UnstableError of the fitted solid's own paths, of each fit
    """
    solids = [[fit.fabric, *(end for pair in fit.limits for end in pair)] for fit in fits]
    paths = [
        [path_jobs(fabric, SIZE, friction, fibre_fraction="mesh") for fabric in each]
        for each in solids
    ]
    cases = [(job,) for each in paths for own in each for job in own]
    found = iter(
        run_cache.results(
            _path, cases, folder=folder, executor=executor, jobs=jobs, fresh=True, report=report
        )
    )
    return [
        _interval(fit, [[next(found) for _ in own] for own in each])
        for fit, each in zip(fits, paths)
    ]


def _path(job: Job) -> tuple[FloatArray, ...]:
    """Samples (F, d) [N, m] of one path; (0,) where it has none."""
    try:
        history, _ = run_job(job)
    except UnstableError:
        return np.empty(0), np.empty(0)
    return samples(history)


def _interval(fit, paths):
    own, *ends = (_law(each) for each in paths)
    if own is None:
        return UnstableError(f"no path of {fit.fabric.name} with the fitted solid gives a law")
    pairs = tuple(zip(ends[0::2], ends[1::2]))
    return LawInterval(_range(own, pairs, "a"), _range(own, pairs, "b"), own, pairs)


def _law(paths: Sequence[tuple[FloatArray, FloatArray]]) -> CompressionLaw | None:
    F, d = (np.concatenate([pair[i] for pair in paths]) for i in (0, 1))
    try:
        return CompressionLaw.fit(F, d)
    except InputError:
        return None


def combine(value: float, ends: Sequence[Sequence[float | None]]) -> tuple[float, float]:
    """Combine changes to (low, high) about `value`: those that the unknowns make add as squares,
    downwards and upwards on their own.

    Parameters
    ----------
    value : with all unknowns at their best
    ends : for each unknown, the value at both ends of its interval, the others at their best; None
        where there is none
    """
    changes = [[end - value for end in pair if end is not None] for pair in ends]
    down = np.sqrt(sum(min([0.0, *each]) ** 2 for each in changes))
    up = np.sqrt(sum(max([0.0, *each]) ** 2 for each in changes))
    return float(value - down), float(value + up)


def _range(own, pairs, key):
    """(low, high) of a or b, whose logarithms change."""
    ends = [[None if law is None else np.log(getattr(law, key)) for law in pair] for pair in pairs]
    low, high = combine(float(np.log(getattr(own, key))), ends)
    return float(np.exp(low)), float(np.exp(high))
