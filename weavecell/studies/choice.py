"""Decide between pinned and resolved yarns by their friction (`crossovers = "auto"`).

Pinned yarns are enough where their friction is known to hold them: where it is at least the upper end of
`yarns.holding.friction_to_hold`. Elsewhere, and where no such range is known, the yarns about the nose are
resolved. No run has to be made to know it of a shot; of a limit, a search with pinned yarns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from shellfabric.yarns.holding import friction_of_plies
from shellfabric.yarns.model import aim

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup
    from weavecell.studies.ballistic_limit import Limit


@dataclass(frozen=True)
class Choice:
    """A choice between pinned and resolved yarns.

    Parameters
    ----------
    resolved : whether the yarns are resolved
    why : in words
    """

    resolved: bool
    why: str

    def __str__(self) -> str:
        return f"yarns {'resolved' if self.resolved else 'pinned'}: {self.why}"


def with_pinned(setup: ImpactSetup) -> ImpactSetup:
    """Return the set-up with pinned yarns, which are judged by the friction of the resolved ones; one
    that leaves no choice as it is."""
    zone = setup.instead
    if zone is None:
        return setup
    return replace(setup, instead=None, yarn_friction=zone.friction)


def with_resolved(setup: ImpactSetup) -> ImpactSetup:
    """Return the set-up with resolved yarns: the whole panel, struck beside a crossover unless an impact
    point is given."""
    zone = setup.instead
    assert zone is not None
    point = setup.impact_point
    if point == (0.0, 0.0):
        point = aim(setup.fabric.weave, zone.seed)
    return replace(setup, crossovers=zone, instead=None, impact_point=point, symmetry="whole")


def choose(setup: ImpactSetup, velocity: float, at: str = "") -> Choice:
    """Choose between pinned and resolved yarns.

    Parameters
    ----------
    setup : set-up with `instead`
    velocity : [m/s] of the strike
    at : words that follow the velocity, such as that it is a limit
    """
    zone = setup.instead
    assert zone is not None
    if not all(fabric.weave.pattern.is_plain for fabric in setup.fabrics):
        return Choice(True, "the friction that holds pinned ones is known of plain weaves alone")
    panels = with_pinned(setup).plain_panels()
    needed = friction_of_plies(panels, velocity)
    if needed is None:
        # a nose wider than those of the bisections, or a block behind the fabric
        return Choice(
            True, "with this nose and backing the friction that holds pinned ones is not known"
        )
    low, high = needed
    theirs = f"{zone.friction:g}{_assumed_span(zone)}"
    needs = f"a friction of {low:.2g} to {high:.2g}, by the fabric, holds them"
    why = f"at {velocity:.4g} m/s{at} {needs}, and theirs is {theirs}"
    return Choice(high > zone.friction, why)


def choose_by_limit(setup: ImpactSetup, found: Limit) -> Choice:
    """Choose between pinned and resolved yarns at the velocity of a limit with pinned ones.

    Parameters
    ----------
    setup : set-up with `instead`
    found : limit with pinned yarns
    """
    chosen = choose(setup, found.velocity, ", the limit of pinned ones,")
    if not chosen.resolved:
        return chosen
    return replace(chosen, why=f"{chosen.why} (limit of pinned yarns {found.velocity:.1f} m/s)")


def doubt_order(setups: Sequence[ImpactSetup]) -> list[str]:
    """Write a line if targets of several weaves are compared with pinned yarns, which do not decide
    which weave stops more."""
    weaves = {fabric.weave.pattern.rows for setup in setups for fabric in setup.fabrics}
    if len(weaves) == 1 or all(setup.crossovers is not None for setup in setups):
        return []
    return ["which weave stops more is not decided by pinned yarns: crossovers = yarns"]


def _assumed_span(zone):
    """What is assumed of the friction between yarns, in words; "" where it is given."""
    if not zone.assumed_lines:
        return ""
    return ", assumed {:g} to {:g}".format(*zone.friction_range)
