"""What a case of a study computes: functions of keywords, which return dicts of numbers, texts and arrays."""

from __future__ import annotations

from collections.abc import Callable

from fabrics.base.errors import InputError
from validation.values import Values

MODULES = (
    "impact",
    "biaxial",
    "cell",
    "coupons",
    "block",
    "drawn",
    "places",
    "laws",
    "models",
    "patches",
    "peers",
    "sampled",
    "series",
    "solid",
    "weaves",
)


def function(name: str) -> Callable[..., Values]:
    """Find a function by "module.function"; its module is imported when it is needed, since `solid`
    needs dolfinx.

    Raises
    ------
    InputError : there is none of this name
    """
    module, _, inner = name.partition(".")
    found = _module(module)
    if found is None or not callable(getattr(found, inner, None)):
        raise InputError(
            key="run", value=name, allowed=f"a function of {', '.join(MODULES)} of validation/cases"
        )
    return getattr(found, inner)


def _module(name):
    match name:
        case "impact":
            from validation.cases import impact as module
        case "biaxial":
            from validation.cases import biaxial as module
        case "cell":
            from validation.cases import cell as module
        case "coupons":
            from validation.cases import coupons as module
        case "block":
            from validation.cases import block as module
        case "drawn":
            from validation.cases import drawn as module
        case "places":
            from validation.cases import places as module
        case "laws":
            from validation.cases import laws as module
        case "models":
            from validation.cases import models as module
        case "patches":
            from validation.cases import patches as module
        case "peers":
            from validation.cases import peers as module
        case "sampled":
            from validation.cases import sampled as module
        case "series":
            from validation.cases import series as module
        case "solid":
            from validation.cases import solid as module
        case "weaves":
            from validation.cases import weaves as module
        case _:
            return None
    return module
