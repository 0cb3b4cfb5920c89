"""Pinned or resolved yarns, as the checks of pinned ones say (`crossovers = "auto"`).

Pinned yarns are enough unless the nose would part them, which takes less friction than
`yarns.model.friction_to_hold`, or unless they unzip (the check "unzipping"). Then the yarns are resolved about the
nose, at the cost of a second run.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

from shellfabric.yarns.model import aim, friction_of_plies

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup
    from shellfabric.membrane.quality import Indicator

PINNED_ENOUGH = "yarns pinned: the checks ask for no more"


def with_pinned(setup: ImpactSetup) -> ImpactSetup:
    """Return the set-up with pinned yarns, which are tried first."""
    return replace(setup, instead=None)


def with_resolved(setup: ImpactSetup) -> ImpactSetup:
    """Return the set-up with the yarns that are resolved if pinned ones are not enough."""
    zone = setup.instead
    assert zone is not None
    point = setup.impact_point
    if point == (0.0, 0.0):
        point = aim(setup.fabric.weave, zone.seed)
    return replace(setup, crossovers=zone, instead=None, impact_point=point, symmetry="whole")


def find_reason(
    setup: ImpactSetup, velocity: float, indicators: Iterable[Indicator], at: str = ""
) -> str:
    """Say why yarns have to be resolved; "" where pinned ones are enough.

    Parameters
    ----------
    setup : with `instead`
    velocity : [m/s] of the strike
    indicators : of the shots with pinned yarns
    at : words behind the velocity, such as that it is a limit
    """
    zone = setup.instead
    assert zone is not None
    for one in indicators:
        if one.name == "unzipping" and one.doubtful:
            return f"yarns resolved: pinned ones unzip, {one.number} times those under the nose are cut"
    panels = [one.panel(one.plain_table()) for one in with_pinned(setup).kinds]
    needed = friction_of_plies(panels, velocity)
    if needed is None or needed <= zone.friction:
        return ""
    return (
        f"yarns resolved: at {velocity:.4g} m/s{at} a friction of {needed:.2g} holds them, "
        f"and theirs is {zone.friction:g}"
    )
