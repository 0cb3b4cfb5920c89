"""The law of the crossings of a weave with floats, from that of the plain crossing of the same yarns.

A crossing that is passed by a yarn which floats on is not squeezed as one of plain weave. The cell of the weave
and the plain crossing are taken along the paths of a calibration on one small mesh, a law is fitted to each, and
the ratios of a and of b go to the law of the plain crossing on its finer mesh. Force and compression of the cell
are means over its crossings.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import replace

from fabrics.base import run_cache
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError, UnstableError
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from fabrics.pattern import Pattern
from unitcell3d.identify.law_range import SIZE, solve_samples


def of_own_crossings(
    law: CompressionLaw,
    crossing: Fabric,
    pattern: Pattern,
    *,
    fraction: str,
    folder: FilePath,
    friction: float = 0.0,
    executor: str | Executor = "local",
    jobs: int = 1,
    report: Callable[[int, int], object] | None = None,
) -> CompressionLaw:
    """Compute the law of a weave's own crossings.

    Parameters
    ----------
    law : CompressionLaw of the plain crossing
    crossing : Fabric of the plain crossing
    pattern : of the weave, whose yarns have the heights of that crossing
    fraction : "mesh" or "stated", whose fibre fraction enters the law of the solid
    friction : [-] Coulomb's coefficient
    folder, executor, jobs, report : as in `fabrics.base.run_cache.results`

    Raises
    ------
    UnstableError : the cell or the plain crossing has no law on the mesh `law_range.SIZE`
    """
    crimp = [share * yarn.crimp for share, yarn in zip(pattern.interlacings, crossing.weave.yarns)]
    weave = replace(crossing.weave, pattern=pattern)
    woven = replace(crossing, weave=weave).with_yarns(crimp=crimp)
    cases = [(fabric, SIZE, friction, fraction) for fabric in (crossing, woven)]
    solved = run_cache.results(
        solve_samples,
        cases,
        folder=folder,
        executor=executor,
        jobs=jobs,
        fresh=True,
        report=report,
    )
    fits = []
    for F, d, problem in solved:
        try:
            fits.append(CompressionLaw.fit(F, d))
        except InputError as none:
            raise UnstableError(
                f"{woven.name}, a {pattern.name} weave: paths on a small mesh give no law: {problem or none}"
            ) from none
    plain, own = fits
    a = own.a / plain.a
    b = own.b / plain.b
    size = " x ".join(map(str, SIZE))
    return replace(
        law,
        a=law.a * a,
        b=law.b * b,
        a_interval=_times(law.a_interval, a),
        b_interval=_times(law.b_interval, b),
        residual_rms=own.residual_rms,
        F_range=own.F_range,
        provenance=f"{law.provenance}, a times {a:.3g} and b times {b:.3g} in the cell of a "
        f"{pattern.name} on {size} hexahedra",
    )


def _times(interval, factor):
    if interval is None:
        return None
    return tuple(factor * end for end in interval)
