"""What is recorded along yarns and at the edges, declared once: keys of the table [history] and fields of
`histories.HistoryRequest`. It imports no solver: an input file is checked without one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fabrics.base.schema import key, quantities, quantity

_YARNS = "a list of distances of {} yarns from the impact point"


@dataclass(frozen=True)
class HistoryKeys:
    """What is recorded, keys of the table [history]; as in `PanelNumbers` a line says all of one."""

    interval: Annotated[
        float,
        key(
            quantity("time between samples along yarns and at the edges", "s", "1 us"),
            "pinned yarns pack",
        ),
    ] = 1e-6
    warp: Annotated[
        tuple[float, ...],
        key(
            quantities(
                "warp yarns that are recorded", "m", _YARNS.format("warp"), '["0 mm", "10 mm"]'
            ),
            "pinned yarns pack",
        ),
    ] = (0.0,)
    weft: Annotated[
        tuple[float, ...],
        key(
            quantities(
                "weft yarns that are recorded", "m", _YARNS.format("weft"), '["0 mm", "10 mm"]'
            ),
            "pinned yarns pack",
        ),
    ] = (0.0,)
