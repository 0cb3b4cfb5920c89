"""What one set-up of a sweep comes to: a shot, the ballistic limit, or V50, as a row of plain
values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fabrics.base.errors import UndecidedError, UnstableError, WeavecellError
from shellfabric.impact.run import run_impact_or_partial
from shellfabric.impact.setup import ImpactSetup
from shellfabric.membrane import quality
from shellfabric.membrane.indicator import OK
from weavecell.runs import v50
from weavecell.studies import inputs, pack_limit, shot_row
from weavecell.studies import limit as limits
from weavecell.studies.ballistic_limit import Limit
from weavecell.studies.limit_scan import ScanRange
from weavecell.studies.pack_limit import PackV50

MIXED = "mixed outcomes"
INTERVAL = f"{100 * pack_limit.CONFIDENCE:g} % interval"


@dataclass(frozen=True)
class Quantity:
    """What is drawn of a sweep: a column, those of the ends of its interval or bracket, what the
    label of the axis ends with, and whether there is no value between the ends."""

    column: str
    ends: tuple[str, str] | None = None
    note: str = ""
    is_span: bool = False


QUANTITIES = {
    "shot": Quantity("residual_velocity_m_s"),
    "critical-velocity": Quantity("critical_velocity_m_s", ("lower_m_s", "upper_m_s")),
    "v50": Quantity("v50_m_s", ("v50_low_m_s", "v50_high_m_s"), ", 90 % interval"),
}


def row(
    setup: ImpactSetup, quantity: str, tolerance: float | None = None, **options: Any
) -> dict[str, Any]:
    """Compute the row of a set-up; one that cannot be computed says why in "outcome".

    Parameters
    ----------
    setup : ImpactSetup
    quantity : of `QUANTITIES`
    tolerance : [m/s] of the bracket of a critical velocity; None takes `limit.usual_tolerance`
    options : of a V50, see `v50.study`
    """
    try:
        if quantity == "v50":
            study = v50.study(setup, inputs.read_scatter(), **options)
            names = ", ".join(dict.fromkeys(name for shot in study.shots for name in shot.doubtful))
            return {
                "outcome": "not determined: all outcomes are alike"
                if study.posterior is None
                else "fitted",
                **study.summary(),
                "checks": f"doubtful: {names}" if names else OK,
            }
        if quantity == "shot":
            return shot(setup)
        return critical_velocity(setup, tolerance)
    except WeavecellError as problem:
        kinds = {UnstableError: "unstable", UndecidedError: "undecided"}
        return {"outcome": f"{kinds.get(type(problem), 'not determined')}: {problem}"}


def shot(setup: ImpactSetup) -> dict[str, Any]:
    """Compute the row of one shot."""
    return shot_row.row_of(*run_impact_or_partial(setup))


def critical_velocity(setup: ImpactSetup, tolerance: float | None = None) -> dict[str, Any]:
    """Search the critical velocity.

    Of one ply it is in its bracket, or in the zone of mixed outcomes if the shots of the search
    show one, which is then scanned. Of a pack it is V50 with its interval (`pack_limit`), or the
    bracket if too few shots perforate.
    """
    if setup.plies > 1:
        return _v50_of_pack(setup, tolerance)
    limit = limits.search(setup, tolerance=tolerance, scan=ScanRange(), only_mixed=True).limit
    return _bracketed(limit)


def _v50_of_pack(setup, tolerance):
    """Row of the V50 of a pack, of the shots that `api.limits` fires."""
    limit = limits.search(setup, tolerance=tolerance, v50_shots=pack_limit.SHOTS, scan=None).limit
    return row_of_limit(limit, pack_limit.of_shots(limit.shots))


def row_of_limit(limit: Limit, found: PackV50 | None) -> dict[str, Any]:
    """Return the row of a limit that has been searched.

    Parameters
    ----------
    found : V50 of a pack; None of one ply, and of a pack too few of whose shots perforate
    """
    if found is None:
        return _bracketed(limit)
    return {
        "outcome": INTERVAL,
        "critical_velocity_m_s": found.velocity,
        "lower_m_s": found.low,
        "upper_m_s": found.high,
        "spread_m_s": found.spread,
        "shots": len(limit.shots),
        "checks": shot_row.with_reasons(quality.worst(shot.checks for shot in limit.shots)),
    }


def _bracketed(limit):
    """Row of a limit in its bracket, or in its zone of mixed outcomes."""
    low, high = limit.mixed_zone or (limit.low, limit.high)
    return {
        "outcome": "single limit" if limit.single else MIXED,
        "critical_velocity_m_s": 0.5 * (low + high) if limit.single else None,
        "lower_m_s": float(low),
        "upper_m_s": float(high),
        "shots": len(limit.shots),
        "checks": shot_row.with_reasons(quality.worst(shot.checks for shot in limit.ends)),
    }
