"""What a message proposes to change in a set-up: only what the set-up takes.

A message names its proposals in braces, "compare with {resolved yarns}". `fill` tries each on the
set-up that the message is about, by the checks of every set-up, and gives up the whole message if
one is refused: who follows a message is not refused.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from math import pi
from string import Formatter

from fabrics import metals
from fabrics.base.errors import InputError
from shellfabric.impact.setup import ImpactSetup
from shellfabric.membrane.indicator import Indicator
from shellfabric.membrane.quality import CHECKS
from shellfabric.projectile.projectile import Projectile
from shellfabric.yarns.model import YarnZone


@dataclass(frozen=True)
class Proposal:
    """A change of a set-up.

    Parameters
    ----------
    words : as it stands in an input file
    change : function of an ImpactSetup, which makes the change or raises InputError
    """

    words: str
    change: Callable[[ImpactSetup], ImpactSetup]


def _resolve_yarns(setup):
    mesh = {"symmetry": "whole", "elements_per_crossover": None, "grading": None}
    return replace(setup, crossovers=YarnZone(), instead=None, **mesh)


def _make_metal(setup):
    """With a bullet of lead of the same radius and attitude; its drawing is for the user to give."""
    shot = setup.projectile
    radius, length = shot.radius, 4 * shot.radius
    bullet = Projectile(
        mass=metals.load("lead").density * pi * radius**2 * length,
        radius=radius,
        length=length,
        edge_radius=0.1 * radius,
        body="metal",
        obliquity=shot.obliquity,
        yaw=shot.yaw,
    )
    return replace(setup, projectile=bullet)


PROPOSALS = {
    "resolved yarns": Proposal('crossovers = "yarns"', _resolve_yarns),
    "body of metal": Proposal('body = "metal"', _make_metal),
    "incompressible cell": Proposal(
        'cell_model = "incompressible"', lambda setup: replace(setup, cell_model="incompressible")
    ),
    "variational cell": Proposal(
        'cell_formulation = "variational"',
        lambda setup: replace(setup, cell_formulation="variational"),
    ),
    "whole panel": Proposal('symmetry = "whole"', lambda setup: replace(setup, symmetry="whole")),
    "free edges": Proposal('boundary = "free"', lambda setup: replace(setup, boundary="free")),
}


def is_taken(name: str, setup: ImpactSetup) -> bool:
    """Return whether a set-up takes a proposal and is changed by it."""
    try:
        changed = PROPOSALS[name].change(setup)
        changed.target(changed.plain_table())
    except InputError:
        return False
    return changed != setup


def fill(message: str, setup: ImpactSetup) -> str:
    """Write a message with the words of its proposals; "" if the set-up refuses one of them."""
    names = [name for _, name, _, _ in Formatter().parse(message) if name is not None]
    if not all(is_taken(name, setup) for name in names):
        return ""
    return message.format(**{name: PROPOSALS[name].words for name in names})


def with_remedies(indicators: Iterable[Indicator], setup: ImpactSetup) -> tuple[Indicator, ...]:
    """Give the indicators beyond their limit what to do about it, of what the set-up takes."""
    found = []
    for one in indicators:
        if one.doubtful and one.name in CHECKS:
            one = replace(one, remedy=fill(CHECKS[one.name].advice, setup))
        found.append(one)
    return tuple(found)
