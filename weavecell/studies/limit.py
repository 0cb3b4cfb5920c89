"""The ballistic limit of a panel or pack with what is reported of it: scan, residual velocities, range over laws."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import Any

import numpy as np

from fabrics.errors import UndecidedError, UnstableError
from shellfabric.impact import ballistic_limit, lambert_jonas, limit_scan
from shellfabric.impact.ballistic_limit import Limit, Shot
from shellfabric.impact.lambert_jonas import LambertJonas
from shellfabric.impact.limit_scan import ScanRange
from shellfabric.impact.simulation import ImpactSetup
from weavecell.studies import assumed_range
from weavecell.studies.assumed_range import AssumedRange

# strike velocities of the first and last residual shot, over the velocity above which all shots perforate
RESIDUAL_SHOTS = 1.03, 2.0

# called with a title; a context whose value is called as report(share of the work done, Shot or None)
Stage = Callable[[str], AbstractContextManager[Callable[..., object]]]


@dataclass(frozen=True)
class LimitStudy:
    """A ballistic limit and what follows from its shots.

    Parameters
    ----------
    limit : Limit, with all shots
    fit : Lambert-Jonas fit to the perforations, or None where they are too few
    range : AssumedRange of the critical velocity; None where nothing is assumed, or it was not asked for
    """

    limit: Limit
    fit: LambertJonas | None
    range: AssumedRange | None


def search(
    setup: ImpactSetup,
    *,
    tolerance: float,
    residual_shots: int = 0,
    scan: ScanRange | None,
    with_range: bool | str = False,
    stage: Stage = lambda title: nullcontext(lambda *_: None),
    **beside: Any,
) -> LimitStudy:
    """Bisect, scan about the bracket, fire residual shots, fit them, and repeat the search over assumed laws.

    Parameters
    ----------
    setup : ImpactSetup of any strike velocity
    tolerance : as of `ballistic_limit.critical_velocity`
    residual_shots : number of shots above the limit
    scan : range about the bracket that is scanned for mixed outcomes; None for no scan
    with_range : which range is computed, as of `assumed_range.with_ends`; never of a lay-up
    stage : progress of each stage
    beside : jobs and executor of `ballistic_limit.critical_velocity`

    Raises
    ------
    InputError, UndecidedError, UnstableError : as `ballistic_limit.critical_velocity`; `shots` of the latter two are
        all that had ended
    """
    panel, ended = setup.target(), list[Shot]()

    def reported(advance):
        def report(share, shot):
            ended.append(shot)
            advance(share, shot)

        return beside | {"report": report}

    try:
        with stage(f"{setup.title}, critical velocity") as advance:
            limit = ballistic_limit.critical_velocity(
                panel, tolerance=tolerance, **reported(advance)
            )
        if scan is not None and scan.ladder(limit):
            with stage("Scan about the bracket") as advance:
                limit = limit_scan.scan(panel, limit, scan, **reported(advance))
        if residual_shots:
            with stage("Residual velocities") as advance:
                strikes = max(limit.high, limit.highest_stop) * np.geomspace(
                    *RESIDUAL_SHOTS, residual_shots
                )
                limit = limit_scan.with_shots(
                    limit, ballistic_limit.shoot(panel, strikes, **reported(advance))
                )
    except (UndecidedError, UnstableError) as problem:
        problem.shots = tuple(ended)
        raise
    over_laws = None
    if not setup.lay_up and (with_ends := assumed_range.with_ends(setup, with_range)):
        with stage("Range over the assumed laws") as advance:
            over_laws = assumed_range.critical_velocity(
                with_ends,
                limit.velocity,
                tolerance=tolerance,
                on_progress=lambda share: advance(share, None),
                **beside,
            )
    return LimitStudy(limit, residual_fit(limit), over_laws)


def residual_fit(limit: Limit) -> LambertJonas | None:
    """Lambert-Jonas fit to the perforations, with the bracket's middle as its limit if there is a single limit; None
    where the perforations are too few."""
    perforations = [shot for shot in limit.shots if shot.perforated]
    if len(perforations) <= (2 if limit.single else 3):
        return None
    velocities = zip(*((shot.strike_velocity, shot.residual_velocity) for shot in perforations))
    return lambert_jonas.fit(*velocities, limit=limit.velocity if limit.single else None)
