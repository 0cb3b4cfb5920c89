"""The friction between yarns with which one ply stops a nose, for `shellfabric/yarns/holding.toml`."""

from __future__ import annotations

from math import sqrt
from typing import Any

from fabrics.base.errors import UndecidedError
from validation.cases import impact
from validation.values import Values


def bracket(*, low: float, high: float, share: float = 0.2, **keywords: Any) -> Values:
    """Bisect the friction between yarns with which a ply whose yarns are all resolved stops a nose
    that pinned yarns stop.

    Parameters
    ----------
    low, high : [-] frictions between which it is looked for
    share : [-] width of the bracket over its lower end, at most
    keywords : of `impact.shot`

    Returns
    -------
    dict with passes and stops, the ends of the bracket [-]; passes is 0 if `low` stops the nose; left
    [m/s] of the nose at `passes`, NaN of none; shots; error [-], the largest of the energy balance over
    the strike energy; flags, the checks of the shots at the ends beyond their limits

    Raises
    ------
    UndecidedError : pinned yarns that do not stop the nose, or resolved ones of friction `high`
    """
    if impact.shot(**keywords)["outcome"] != "stopped":
        raise UndecidedError("pinned yarns do not stop the nose")
    fired: dict[float, Values] = {}

    def stops(friction):
        resolved = {"crossovers": "yarns", "crossover_friction": friction, "whole_zone": True}
        fired[friction] = impact.shot(**keywords, **resolved)
        return fired[friction]["outcome"] == "stopped"

    if not stops(high):
        raise UndecidedError(f"yarns of friction {high:g} do not stop the nose")
    if stops(low):
        low, high = 0.0, low
    while low > 0 and high / low > 1 + share:
        middle = round(sqrt(low * high), 3)
        if stops(middle):
            high = middle
        else:
            low = middle
    ends = [fired[friction] for friction in (low, high) if friction in fired]
    beyond = {flag for end in ends for flag in end["flags"].split(", ") if flag}
    return {
        "passes": low,
        "stops": high,
        "left": fired[low]["residual_velocity_m_s"] if low in fired else float("nan"),
        "shots": len(fired),
        "error": max(shot["energy_error_max"] for shot in fired.values()),
        "flags": ", ".join(sorted(beyond)),
    }
