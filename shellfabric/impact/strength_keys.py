"""Numbers of yarns that differ in strength, each declared once: keys of the table [panel.strength] and fields of
`strengths.YarnStrength`. It imports no solver: an input file is checked without one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fabrics.base.schema import key, number, whole


@dataclass(frozen=True)
class StrengthKeys:
    """The distribution of the strengths; as in `PanelNumbers` a line says all of one."""

    weibull_shape: Annotated[
        float | None,
        key(
            number(
                "shape of the Weibull distribution; that of the fabric's yarns if not given, 14.3 assumed",
                14.3,
                gt=0.0,
                allow_inf_nan=True,
            ),
            "pinned yarns",
        ),
    ] = None
    seed: Annotated[
        int,
        key(
            whole("seed of the random strengths: another seed gives another panel", 0, 2**31 - 1),
            "pinned yarns",
        ),
    ] = 1
