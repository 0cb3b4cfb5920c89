"""The ballistic limit of a panel or pack with what is reported of it: scan and residual
velocities."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import Any

import numpy as np

from fabrics.base.checks import FilePath
from shellfabric.impact.setup import ImpactSetup
from shellfabric.membrane.model import Panel
from shellfabric.plies.model import Pack
from weavecell.studies import ballistic_limit, lambert_jonas, limit_scan, pack_limit
from weavecell.studies.ballistic_limit import Limit
from weavecell.studies.lambert_jonas import LambertJonas
from weavecell.studies.limit_scan import ScanRange

# strike velocities of the first and last residual shot, over the velocity above which all shots
# perforate
RESIDUAL_SHOTS = 1 + limit_scan.LOOK, 2.0

# [m/s] width of the bracket of one ply where none is asked for
WIDTH = 1.0

# called with a title; a context whose value is called as report(share of the work done, Shot or
# None)
Stage = Callable[[str], AbstractContextManager[Callable[..., object]]]


@dataclass(frozen=True)
class LimitStudy:
    """A ballistic limit and what follows from its shots.

    Parameters
    ----------
    limit : Limit, with all shots
    fit : Lambert-Jonas fit to the perforations
    scan : the range that was scanned, or None
    """

    limit: Limit
    fit: LambertJonas
    scan: ScanRange | None = None


def search(
    setup: ImpactSetup,
    *,
    tolerance: float | None,
    v50_shots: int = 0,
    residual_shots: int = 0,
    scan: ScanRange | None,
    only_mixed: bool = False,
    stage: Stage = lambda title: nullcontext(lambda *_: None),
    folder: FilePath | None = None,
    **beside: Any,
) -> LimitStudy:
    """Search the limit: bisect, scan about the bracket, fire the shots of V50 and residual shots,
    and fit all that perforate.

    Parameters
    ----------
    setup : ImpactSetup of any strike velocity
    tolerance : see `ballistic_limit.critical_velocity`; None takes `usual_tolerance`
    v50_shots : number of shots a little above the bracket, for `pack_limit`
    residual_shots : number of shots above the limit
    scan : range about the bracket that is scanned for mixed outcomes; None for no scan
    only_mixed : whether it is scanned only if the shots of the search, and one beside either end of
        the bracket, have mixed outcomes
    stage : progress of each stage
    folder : where shots are kept, and taken from
    beside : jobs and executor of `ballistic_limit.critical_velocity`

    Raises
    ------
    InputError, UndecidedError, UnstableError : as `ballistic_limit.critical_velocity`
    """
    panel = setup.target()
    if tolerance is None:
        tolerance = usual_tolerance(panel)
    beside["kept"] = ballistic_limit.KeptShots(folder, setup)
    with stage(f"{setup.title}, critical velocity") as advance:
        limit = ballistic_limit.critical_velocity(
            panel, tolerance=tolerance, report=advance, **beside
        )
    if scan is not None and only_mixed:
        with stage("Outcomes beside the bracket") as advance:
            limit = limit_scan.look_beside(panel, limit, report=advance, **beside)
        if limit.single:
            scan = None
    if scan is not None and scan.ladder(limit):
        with stage("Scan about the bracket") as advance:
            limit = limit_scan.scan(panel, limit, scan, report=advance, **beside)
    if v50_shots:
        with stage("Shots for V50") as advance:
            strikes = [float(v) for v in limit.high * np.geomspace(*pack_limit.ABOVE, v50_shots)]
            shots = ballistic_limit.shoot(panel, strikes, report=advance, **beside)
            limit = limit_scan.with_shots(limit, shots)
    if residual_shots:
        with stage("Residual velocities") as advance:
            fastest = max(limit.high, limit.highest_stop)
            known = [shot.strike_velocity for shot in limit.shots]
            wanted = fastest * np.geomspace(*RESIDUAL_SHOTS, residual_shots)
            # the look above the bracket may be the first of them
            strikes = [float(v) for v in wanted if not np.isclose(v, known, rtol=1e-9).any()]
            shots = ballistic_limit.shoot(panel, strikes, report=advance, **beside)
            limit = limit_scan.with_shots(limit, shots)
    return LimitStudy(limit, residual_fit(limit), scan)


def usual_tolerance(panel: Panel | Pack) -> float:
    """Return the width [m/s] of the bracket of a panel or pack where none is asked for.

    Shots of a pack scatter, so that its bracket only says where the shots of its V50 begin.
    """
    plies = Pack.of(panel).plies
    if len(plies) == 1:
        return WIDTH
    return pack_limit.BRACKET * ballistic_limit.first_guess(panel)


def residual_fit(limit: Limit) -> LambertJonas:
    """Fit Lambert-Jonas to the shots, with the bracket's middle as its limit if there is a single
    limit."""
    strikes = [shot.strike_velocity for shot in limit.shots]
    # one that is taken as stopped may have a little of its velocity left
    residuals = [shot.residual_velocity if shot.perforated else 0.0 for shot in limit.shots]
    return lambert_jonas.fit(strikes, residuals, limit=limit.velocity if limit.single else None)
