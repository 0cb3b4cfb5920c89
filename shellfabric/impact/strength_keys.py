"""Numbers of yarns that differ in strength, each declared once: keys of the table [panel.strength] and fields of
`strengths.YarnStrength`. It imports no solver: an input file is checked without one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fabrics.base.schema import key, number, quantity, whole


@dataclass(frozen=True)
class StrengthKeys:
    """The distribution of the strengths; as in `PanelNumbers` a line says all of one."""

    weibull_shape: Annotated[
        float,
        key(
            number(
                "shape of the Weibull distribution; 14.3 was measured on yarns of Kevlar 49 of 200 mm",
                14.3,
                gt=0.0,
                allow_inf_nan=True,
            ),
            "pinned yarns",
        ),
    ]
    seed: Annotated[
        int,
        key(
            whole("seed of the random strengths: another seed gives another panel", 0, 2**31 - 1),
            "pinned yarns",
        ),
    ] = 1
    gauge_length: Annotated[
        float,
        key(
            quantity(
                "length at which yarns have the strength of the fabric on average: longer yarns are weaker",
                "m",
                "200 mm",
            ),
            "pinned yarns",
        ),
    ] = 0.2
