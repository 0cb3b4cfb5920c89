"""How long the yarns of a panel are, which their strength follows."""

from __future__ import annotations

from math import sqrt

from fabrics.weave import Weave
from shellfabric.projectile import frames


def find_yarn_lengths(
    weave: Weave,
    opening: tuple[float, float],
    weave_angle: float,
    impact_point: tuple[float, float],
    round: bool,
) -> tuple[float, float]:
    """Compute the lengths (warp, weft) [m] of the yarns through the impact point, from edge to edge of
    the opening and straightened: of whole yarns, whatever part of the panel is modelled, and whether
    edges hold them or not.

    Parameters
    ----------
    opening, impact_point, weave_angle, round : as in `PanelGrid` and `PanelSetup`
    """
    found = []
    for direction, yarn in zip(frames.axes(weave_angle).tolist(), weave.yarns):
        if round:
            across = direction[0] * impact_point[1] - direction[1] * impact_point[0]
            chord = 2 * sqrt((0.5 * opening[0]) ** 2 - across**2)
        else:
            # the nearest edge ahead and the nearest behind
            ahead = []
            behind = []
            for side, place, slope in zip(opening, impact_point, direction):
                if slope:
                    ahead.append((0.5 * side * abs(slope) - place * slope) / slope**2)
                    behind.append((0.5 * side * abs(slope) + place * slope) / slope**2)
            chord = min(ahead) + min(behind)
        found.append((1 + yarn.crimp) * chord)
    return found[0], found[1]
