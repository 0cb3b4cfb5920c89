"""Options of earlier versions, and what took their place; nothing else is loaded to say so."""

from __future__ import annotations

from collections.abc import Iterable

from fabrics.base import door
from fabrics.base.errors import InputError

_V50 = "v50 answers over all that nobody gave"
_SCATTER = "strengths scatter as weibull_shape of a fabric file says"
_DRAWN = "all that nobody gave is drawn"
# {function: {option of earlier versions: what took its place}}, with options as the command line names them
GONE = {
    "impact": dict.fromkeys(
        ("interval", "assumed_range"),
        "one run is made, and --draws 16 fires 16 drawn shots beside it",
    ),
    "critical_velocity": dict.fromkeys(
        ("interval", "assumed_range"), f"one limit is searched, and {_V50}"
    )
    | dict.fromkeys(
        ("scan_above", "scan_below", "scan_step"),
        "--scan looks 25 % above and 10 % below, every 2 %",
    ),
    "v50": {"assumed_range": _DRAWN}
    | dict.fromkeys(("weibull_shape", "modulus_cov", "crimp_cov"), _SCATTER),
    "compare": {
        "quantity": "V50 is compared, over all that nobody gave",
        "tolerance": "no limit is searched; --shots 32 narrows the difference",
        "interval": _DRAWN,
        "assumed_range": _DRAWN,
    },
    "sweep": {
        "interval": f"each row is one run; {_V50}",
        "one_at_a_time": "next says what to measure first; --over takes one key",
    },
}


def refuse_gone(function: str, names: Iterable[str]) -> None:
    """Refuse options of earlier versions, and say what took their place.

    Raises
    ------
    InputError
    """
    for name in names:
        words = GONE.get(function, {}).get(name)
        if words is not None:
            raise InputError(f"was removed: {door.name_options(words)}", key=door.option(name, ""))
