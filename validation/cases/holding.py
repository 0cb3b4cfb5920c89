"""The friction between yarns with which one ply stops a nose, for `shellfabric/yarns/holding.toml`."""

from __future__ import annotations

from dataclasses import replace
from math import nan, sqrt
from typing import Any

from fabrics.base.errors import UndecidedError
from validation.cases import impact
from validation.cases.places import find_doubts
from validation.values import Values
from weavecell.studies import places, sweep

# {name: [spacings] from the middle crossover along warp and weft}
PLACES = {
    "on a crossover": (0.0, 0.0),
    "in a gap": (0.5, 0.5),
    "on a warp yarn": (0.5, 0.0),
    "on a weft yarn": (0.0, 0.5),
}


def bracket(*, place: str, low: float, high: float, share: float = 0.25, **keywords: Any) -> Values:
    """Bisect the friction between yarns with which a ply whose yarns are all resolved stops a nose
    that pinned yarns stop.

    Parameters
    ----------
    place : name of one of PLACES
    low, high : [-] frictions between which it is looked for
    share : [-] width of the bracket over its lower end, at most
    keywords : of `impact.setup`

    Returns
    -------
    dict with velocity [m/s]; passes and stops, the ends of the bracket [-]; passes is 0 if `low` stops the nose; left
    [m/s] of the nose at `passes`, NaN of none; shots; error [-], the largest of the energy balance over
    the strike energy; doubts, the checks of the shots at the ends beyond their limits; wave [m/s], the
    mean speed of fibre waves

    Raises
    ------
    UndecidedError : pinned yarns that do not stop the nose, or resolved ones of friction `high`
    """
    pinned = impact.setup(**keywords)
    if sweep.shot(pinned)["outcome"] != "stopped":
        raise UndecidedError("pinned yarns do not stop the nose")
    struck = places.strike_at(places.resolve(pinned), PLACES[place])
    zone = struck.crossovers
    assert zone is not None
    fired: dict[float, Values] = {}

    def stops(friction):
        resolved = replace(struck, crossovers=replace(zone, friction=friction).whole)
        fired[friction] = sweep.shot(resolved)
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
    doubts = {name for end in ends for name in find_doubts(end)}
    left = nan
    if low in fired:
        left = fired[low]["residual_velocity_m_s"]
    warp, weft = pinned.fabric.weave.yarns
    return {
        "velocity": pinned.strike_velocity,
        "passes": low,
        "stops": high,
        "left": left,
        "shots": len(fired),
        "error": max(shot["energy_error_max"] for shot in fired.values()),
        "doubts": ", ".join(sorted(doubts)),
        "wave": 0.5 * (warp.wave_speed + weft.wave_speed),
    }
