"""The range of a compression law: how a and b move together over what is not known of the crossover: the
constants of an assumed solid, or what measurements leave open of a fitted one; thickness and warp's share
behind an unknown crimp, or the range of a stated one; whose fibre fraction the solid has; the mesh. For
each end of each the paths are solved on the mesh `SIZE`, and a law is fitted. What counts is its ratio
to the law of the best values there,

    e = (ln a' / a, ln b' / b),    covariance = sum of e e^T / z^2,   z = 1.96: ends are those of 95 %

Of the two ends the farther one counts, and of the other the part of e that is not along that: ranges are
not symmetric, and what is drawn shall reach both. The covariance goes with the law (`CompressionLaw.spread`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fabrics import assumed
from fabrics.base import run_cache
from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.errors import InputError, UnstableError
from fabrics.compression import NORMAL_95, CompressionLaw
from fabrics.data_sheet import FAMILIES
from fabrics.fabric import Fabric
from fabrics.variants import with_solids
from meshing.inputs import Size
from unitcell3d.identify.calibrate import build_mesh, path_jobs, run_job
from unitcell3d.identify.calibration import samples
from unitcell3d.identify.solid_record import NAMES, SolidFit
from unitcell3d.material.numerics import FRACTIONS, fraction_of

# mesh of the paths at the ends: what counts is their ratio to those of the best values
SIZE = (4, 3, 2)
# [-] of fibre volume fraction, from the mesh at rest to packed yarns
_LEAST_ROOM = 0.01
MESH = "mesh"
FRACTION = "fibre fraction"


@dataclass(frozen=True)
class LawRange:
    """What is not known of a crossover, and what that makes of its law.

    Parameters
    ----------
    law : CompressionLaw of the best values on the mesh `SIZE`
    ends : {unknown: CompressionLaw at each end of it that has a law}
    failed : {unknown: why an end has no law}
    """

    law: CompressionLaw
    ends: dict[str, tuple[CompressionLaw, ...]]
    failed: dict[str, str]

    def parts(self) -> dict[str, FloatArray]:
        """Return {unknown: (2, 2) covariance of ln a and ln b that it makes}"""
        return {name: _covariance(self._ratios(laws)) for name, laws in self.ends.items()}

    def _ratios(self, laws):
        return [np.log([law.a / self.law.a, law.b / self.law.b]) for law in laws]

    @property
    def covariance(self) -> FloatArray:
        """(2, 2) of ln a and ln b."""
        return np.sum([np.zeros((2, 2)), *self.parts().values()], axis=0)

    def shares(self) -> dict[str, float]:
        """Compute what share of the variance of the compression each unknown makes, at the middle of
        the law's forces, {unknown: [-]}, the largest first."""
        toward = self.law.slopes_of_compression()
        of_each = {name: float(toward @ part @ toward) for name, part in self.parts().items()}
        total = sum(of_each.values())
        pairs = sorted(of_each.items(), key=lambda pair: -pair[1])
        return {name: value / total for name, value in pairs} if total > 0 else {}

    def around(self, law: CompressionLaw) -> CompressionLaw:
        """Give another law, such as that of a finer mesh, this range: joint, as intervals of a and b,
        and as ends that bracket it."""
        return law.with_spread(self.covariance)


def _covariance(ratios):
    """Return the covariance of the farther end, plus what the other adds across it.

    ratios : [(2,) ln of a and of b at an end over those of the law]
    """
    far, *others = sorted(ratios, key=lambda e: -float(e @ e)) or [np.zeros(2)]
    total = np.outer(far, far)
    for e in others:
        rest = e - far * (e @ far) / max(far @ far, 1e-30)
        total += np.outer(rest, rest)
    return total / NORMAL_95**2


def list_unknowns(
    fabric: Fabric, fit: SolidFit | None, fraction: str
) -> dict[str, tuple[tuple[Fabric, str], ...]]:
    """List what is not known of a crossover: {name: (the fabric, whose fibre fraction it has) at each end}.

    Parameters
    ----------
    fabric : Fabric that was calibrated
    fit : of its solid, if that was fitted
    fraction : "mesh" or "stated", whose fibre fraction enters the law of the solid
    """
    found: dict[str, tuple[tuple[Fabric, str], ...]] = {}
    if fit is not None:
        for number, pair in enumerate(fit.limits, 1):
            found[f"solid, direction {number}"] = tuple((end, fraction) for end in pair)
    else:
        found |= {
            name: tuple((end, fraction) for end in ends)
            for name, ends in _ends_of_solid(fabric).items()
        }
        other = next(name for name in FRACTIONS if name != fraction)
        if found and fraction == fraction_of(fabric):
            found[FRACTION] = ((fabric, other),)
    crimps = assumed.crimp_ends(fabric)
    for words, end in crimps.items():
        # "thickness times 1.1" and "thickness times 0.9" are of one unknown
        name = words.partition(" times ")[0]
        if name.startswith("warp share"):
            name = "warp share"
        found[name] = (*found.get(name, ()), (end, fraction))
    for name, ends in _ends_of_stated_crimp(fabric).items():
        found[name] = tuple((end, fraction) for end in ends)
    return found


def _ends_of_stated_crimp(fabric):
    """Return {crimp that the file states with a range: (the fabric with its low end, with its high end)}"""
    ends = {}
    for number, family in enumerate(FAMILIES):
        ratios = fabric.ranges.get(f"{family}.crimp")
        if ratios is not None:
            pair = np.ones((2, 2))
            pair[:, number] = ratios
            ends[f"{family} crimp"] = tuple(
                assumed.scale_ranged(fabric, "crimp", tuple(each)) for each in pair
            )
    return ends


def _ends_of_solid(fabric):
    """Return {constant of an assumed solid: (the fabric with its low end, with its high end)}"""
    ends = {}
    laws = fabric.solid_laws
    for name in NAMES:
        ratios = [
            fabric.ranges.get(f"solid.{family}.{name}") or fabric.ranges.get(f"solid.{name}")
            for family in ("warp", "weft")
        ]
        if not any(ratios):
            continue
        pair = []
        for end in (0, 1):
            values = [
                getattr(law, name) * (ratio[end] if ratio else 1.0)
                for law, ratio in zip(laws, ratios)
            ]
            if name == "K_r":
                values = [min(value, 0.99) for value in values]
            if name == "V_c":
                values = [max(value, 1.01 * law.Vf0) for value, law in zip(values, laws)]
            pair.append(with_solids(fabric, **{name: values}))
        ends[name] = tuple(pair)
    return ends


def find_range(
    fabric: Fabric,
    law: CompressionLaw,
    unknowns: Mapping[str, tuple[tuple[Fabric, str], ...]],
    *,
    fraction: str,
    folder: FilePath,
    friction: float = 0.0,
    executor: str | Executor = "local",
    jobs: int = 1,
    report: Callable[[int, int], object] | None = None,
) -> LawRange:
    """Compute the range of a law.

    Parameters
    ----------
    fabric : Fabric that was calibrated
    law : CompressionLaw of its calibration, on the mesh of that
    unknowns : of `list_unknowns`
    fraction : as there
    friction : [-] Coulomb's coefficient
    folder, executor, jobs, report : as in `fabrics.base.run_cache.results`

    Raises
    ------
    UnstableError : the best values have no law on the mesh `SIZE`
    """
    names = ["", *(name for name, ends in unknowns.items() for _ in ends)]
    given = [(fabric, fraction), *(end for ends in unknowns.values() for end in ends)]
    cases = [(each, SIZE, friction, which) for each, which in given]
    solved = run_cache.results(
        solve_samples,
        cases,
        folder=folder,
        executor=executor,
        jobs=jobs,
        fresh=True,
        report=report,
    )
    ends: dict[str, list[CompressionLaw]] = {name: [] for name in unknowns}
    failed = {}
    best = None
    for name, (F, d, problem) in zip(names, solved):
        try:
            found = CompressionLaw.fit(F, d)
        except InputError as none:
            failed[name] = problem or str(none)
            continue
        if name:
            ends[name].append(found)
        else:
            best = found
    if best is None:
        raise UnstableError(f"the paths of {fabric.name} on a small mesh give no law: {failed['']}")
    ends[MESH] = [law]
    return LawRange(best, {name: tuple(laws) for name, laws in ends.items()}, failed)


def solve_samples(
    fabric: Fabric, size: Size, friction: float, fraction: str
) -> tuple[FloatArray, FloatArray, str]:
    """Solve the paths of a calibration: their samples (F, d) [N, m], and why one of them has none or
    ended."""
    problem = ""
    pairs: list[tuple[Any, ...]] = [(np.empty(0), np.empty(0))]
    try:
        fabric = _packed_later(fabric, size)
        for job in path_jobs(fabric, size, friction, fibre_fraction=fraction):
            with suppress(UnstableError):
                history, _ = run_job(job)
                pairs.append(samples(history))
                problem = history.failed or problem
    except InputError as refused:  # a thinner fabric may leave no room for its yarns
        problem = str(refused)
    F, d = (np.concatenate(parts) for parts in zip(*pairs))
    return F, d, problem


def _packed_later(fabric, size):
    """Return the fabric with V_c above the density that the mesh gives its yarns."""
    dense = build_mesh(fabric, size).Vf0
    laws = [
        replace(law, V_c=max(law.V_c, Vf0 + _LEAST_ROOM))
        for law, Vf0 in zip(fabric.solid_laws or (), dense)
    ]
    return replace(fabric, solid_laws=tuple(laws))
