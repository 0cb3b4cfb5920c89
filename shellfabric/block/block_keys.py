"""Numbers of the block behind the fabric that are keys of the table [backing], declared once, as
`PanelNumbers` are. It imports no solver: an input file is checked without one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fabrics.base.schema import Unread, key, named, number, quantities, quantity

OUTER_BOUNDARIES = ("fixed", "absorbing", "free")


@dataclass(frozen=True, kw_only=True)
class BlockKeys:
    """Size, place, faces and mesh of a block, and for how long it is followed. Read by a "block"."""

    size: Annotated[
        tuple[float, ...],
        key(
            quantities(
                "length, width and thickness of the block",
                "m",
                "a list of three lengths",
                '["300 mm", "300 mm", "180 mm"]',
            ),
            "block",
        ),
    ] = (0.3, 0.3, 0.18)
    standoff: Annotated[
        float,
        key(
            quantity("clearance between last ply and face of the block", "m", "0.5 mm", zero=True),
            "block",
        ),
    ] = 0.0
    outer_boundary: Annotated[
        str,
        key(
            named(
                "condition on the faces other than the struck one: fixed, absorbing (dashpots) or free",
                *OUTER_BOUNDARIES,
            ),
            "block",
        ),
    ] = "fixed"
    min_size: Annotated[
        float,
        key(
            quantity("edge length of the smallest elements, under the impact point", "m", "1 mm"),
            "block",
        ),
    ] = 1.0e-3
    refined_depth: Annotated[
        float,
        key(
            quantity(
                "extent of the smallest elements from the axis and from the face", "m", "8 mm"
            ),
            "block",
        ),
    ] = 8e-3
    growth: Annotated[
        float,
        key(
            number(
                "ratio of the edge lengths of neighbouring elements outside the refined region",
                1.3,
                ge=1.0,
            ),
            "block",
        ),
    ] = 1.2
    after_stop: Annotated[
        float,
        key(
            quantity(
                "time for which the run goes on after the projectile has stopped, so that the block comes to rest; "
                "if not given, the run ends when the projectile stops",
                "s",
                "1 ms",
                zero=True,
                most="10 ms",
            ),
            "block",
        ),
        Unread("limit v50"),
    ] = 0.0
