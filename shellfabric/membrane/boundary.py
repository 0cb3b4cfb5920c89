"""Edges of the panel, each of the four sides "clamped", "free", a PullIn or a Grip.

Warp yarns end at the two warp sides (lowest and highest x), weft yarns at the two weft sides. An edge is
one side for all four, or (warp, weft), each one side for both ends or a pair (lowest, highest). Nodes of
a slipping side move along the yarns that end there and not otherwise; where two sides meet that are not
free, the corner is held. Fabric that slips out of the clamp is not added: as in the thesis, the edge's
nodes move in. It imports no solver: an input file is checked without one.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Annotated, Any, TypeAlias

from fabrics.base.checks import refuse
from fabrics.base.errors import InputError
from fabrics.base.fields import check_fields
from fabrics.base.schema import Unread, declared, key, quantity

SLIPS = "clamped or free: no side that slips is exported"


@dataclass(frozen=True, kw_only=True)
class SlipKeys:
    """Numbers of a side that slips, keys of the tables [panel.boundary]; as in `PanelNumbers` a line says
    all of one. Models: a "pull_in" and a "grip", whose fields have the same names."""

    clamp_force: Annotated[
        float | None,
        key(
            quantity(
                "friction-limited clamp: tension of a yarn at which it slips",
                "N",
                "20 N",
                ranged=True,
            ),
            "grip",
        ),
        Unread("export", SLIPS),
    ] = None
    pull_in: Annotated[
        float | None,
        key(
            quantity(
                "prescribed slip of the yarn in the middle of the zone, into the panel", "m", "5 mm"
            ),
            "pull_in",
        ),
        Unread("export", SLIPS),
    ] = None
    start: Annotated[
        float | None,
        key(
            quantity("time at which the prescribed slip begins", "s", "200 us", zero=True),
            "pull_in",
        ),
        Unread("export", SLIPS),
    ] = None
    end: Annotated[
        float | None,
        key(quantity("time at which the prescribed slip ends", "s", "650 us"), "pull_in"),
        Unread("export", SLIPS),
    ] = None
    zone: Annotated[
        float,
        key(
            quantity(
                "width of the triangular zone of the side that slips, about its middle",
                "m",
                "60 mm",
            ),
            "pull_in",
        ),
        Unread("export", SLIPS),
    ] = 60e-3


_KEYS = declared(SlipKeys)


@dataclass(frozen=True)
class PullIn:
    """A side that slips in the clamp by a given amount, from a triangular zone (thesis section
    6.4.3).

    Parameters
    ----------
    pull_in : [m] of the yarn through the impact point, at each end
    start, end : [s] over which it is made, evenly
    zone : [m] whole width of the triangle, at whose ends nothing slips

    Raises
    ------
    InputError : a value out of its range
    """

    pull_in: Annotated[float, _KEYS["pull_in"]]
    start: Annotated[float, _KEYS["start"]]
    end: Annotated[float, _KEYS["end"]]
    zone: Annotated[float, _KEYS["zone"]] = SlipKeys.zone

    @property
    def words(self) -> str:
        """What it does, for the reader."""
        return (
            f"slip by {1e3 * self.pull_in:g} mm from {1e6 * self.start:g} to {1e6 * self.end:g} us, about their middle "
            f"{1e3 * self.zone:g} mm wide"
        )

    def __post_init__(self):
        check_fields(self)
        if not self.start < self.end < inf:
            refuse(self, "end", "after the start")


@dataclass(frozen=True)
class Grip:
    """A side whose clamp holds each yarn by friction, up to a force.

    Parameters
    ----------
    clamp_force : [N] per yarn

    Raises
    ------
    InputError : a force that is not positive
    """

    clamp_force: Annotated[float, _KEYS["clamp_force"]]

    @property
    def words(self) -> str:
        """What it does, for the reader."""
        return f"held by friction up to {self.clamp_force:g} N a yarn"

    def __post_init__(self):
        check_fields(self)


Boundary: TypeAlias = str | PullIn | Grip | tuple  # in any form that `sides` takes


def sides(edge: Any) -> tuple[tuple[Any, Any], ...]:
    """Resolve a boundary in any of its forms to ((lowest, highest) of the warp, (lowest, highest)
    of the weft).

    Raises
    ------
    InputError : a side that is none of those above
    """
    families = _both(edge)
    pairs = tuple(map(_both, families))
    if [len(pair) for pair in pairs] != [2, 2]:
        raise InputError(
            key="boundary", value=edge, allowed="one side, or (warp, weft) of one or two sides each"
        )
    for pair in pairs:
        for side in pair:
            if side not in ("clamped", "free") and not isinstance(side, (PullIn, Grip)):
                raise InputError(
                    key="boundary", value=side, allowed="clamped, free, a PullIn or a Grip"
                )
    return pairs


def list_in_words(edge: Any) -> list[str]:
    """List how the yarns end, for the reader: a line for all, or for each family and side of it."""
    families = sides(edge)
    if len({side for pair in families for side in pair}) == 1:
        return [f"All yarn ends are {_say(families[0][0])}"]
    found = []
    for family, (low, high) in zip(("Warp", "Weft"), families):
        if low == high:
            found.append(f"{family} ends are {_say(low)}")
        else:
            found.append(
                f"{family} ends are {_say(low)} at the low side and {_say(high)} at the high one"
            )
    return found


def _say(side):
    if isinstance(side, str):
        return side
    if isinstance(side, PullIn):
        return f"in a clamp where they {side.words}"
    return side.words


def _both(given):
    """A pair as it is, anything else twice."""
    if isinstance(given, tuple):
        return given
    return given, given


def is_clamped(edge: Any) -> bool:
    """Tell whether all four sides are clamped."""
    return sides(edge) == (("clamped", "clamped"),) * 2


def slips(edge: Any) -> bool:
    """Tell whether a side of it is not simply clamped or free."""
    return any(not isinstance(side, str) for pair in sides(edge) for side in pair)


def pull_in(edge: Any) -> tuple[float, ...]:
    """Return (warp, weft) [m] by which fabric slips into the panel at most, of edges without
    grips."""
    found = []
    for pair in sides(edge):
        lengths = [side.pull_in for side in pair if isinstance(side, PullIn)]
        found.append(max(lengths, default=0.0))
    return tuple(found)
