"""Numbers of a shot that are keys of an input file and fields of `ImpactSetup` and `Ply`, each declared once. It
imports no solver: an input file is checked without one."""

from __future__ import annotations

from typing import Any

from fabrics.base.schema import TEXT_OR_TWO, angle, from_text, one_of, quantities, quantity, whole

# [m/s] a faster shot is a slip of the unit
FASTEST = 1000.0
# [m] a wider opening is a slip of the unit
WIDEST = 5.0


def _opening(value: Any, read: Any) -> Any:
    parts = value if isinstance(value, (list, tuple)) and len(value) == 2 else [value]
    sides = [read(part, "m") for part in parts]
    if not 0 < min(sides) <= max(sides) <= WIDEST:
        raise ValueError("out of range")
    if len(sides) == 1:
        return sides[0]
    return tuple(sides)


STRIKE_VELOCITY = quantity(
    "speed along the line of flight", "m/s", "92.5 m/s", most=f"{FASTEST:g} m/s"
)
OPENING = from_text(
    float | tuple[float, float],
    _opening,
    "side of the square opening of the frame, or both sides; diameter of a round one",
    f'a length above 0 and at most {WIDEST:g} m, such as "203 mm", or a list of two, along warp and weft',
    "m",
    "203 mm",
    TEXT_OR_TWO,
)
SYMMETRY = one_of(
    "modelled part of the panel; half: x >= 0, for a shot that flies in the plane x = 0 (azimuth 90 deg); "
    "other half: y >= 0, in the plane y = 0. With resolved yarns a plane is the middle line of a yarn: a "
    "quarter is struck on a crossover, a half on a yarn; if not given, they have the whole panel. "
    "If not given: the smallest part that stands for the whole",
    "quarter",
    "half",
    "other half",
    "whole",
)
WEAVE_ANGLE = angle("angle of the warp to the sides of the opening", -89, 89, "45 deg")
IMPACT_POINT = quantities(
    "point that the projectile hits, from the middle of the opening along its two sides. If not given: "
    "the middle, or with resolved yarns a quarter of a spacing beside the crossover there, in both "
    "directions, in a plane of symmetry 0. A point on the second axis may have the symmetry `half`, one on "
    "the first `other half`, others off the middle `whole`",
    "m",
    "a list of two lengths",
    '["20 mm", "0 mm"]',
)
PLY_GAP = quantity(
    "clearance to the next ply at rest; if not given `panel.ply_gap`, else the mean of the gaps of both fabrics",
    "m",
    "0.12 mm",
    zero=True,
)
END_TIME = quantity(
    "latest end of the run; it ends earlier when the projectile stops (see backing.after_stop) or has "
    "perforated",
    "s",
    "250 us",
    most="10 ms",
)
ELEMENTS = whole(
    "elements along each side of a crossover; if not given, they follow the failure length of the yarns under "
    "the projectile, and are longer further out ([accuracy](../accuracy.md))",
    1,
    8,
)
SNAPSHOT_INTERVAL = quantity(
    "time between the shapes kept for ParaView and the pictures", "s", "10 us"
)
BENDING = quantity("bending stiffness of one yarn", "N m^2", "1e-6 N m^2", zero=True)
