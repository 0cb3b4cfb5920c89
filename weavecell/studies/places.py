"""Where a nose may strike a weave: the fewest places whose answers bracket those of all places.

A round nose meets most yarn on a crossover, and least in the gap between four. The strip of a chisel
lies on a yarn of the warp or of the weft. A flat nose over several yarns, and a nose that is wide
beside the spacing of the yarns, meets alike wherever it strikes; so do several plies, which are
shifted against each other. These pairs held the limits of eight spread places of S-728 and of a
Kevlar 29 of 467 g/m2 for a sphere and a fragment simulator; the numbers of yarns and plies below
are judged by the same runs.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from fabrics.assumed import friction_between_yarns
from fabrics.base.assumed_number import least
from fabrics.base.counted import counted
from fabrics.base.errors import InputError
from shellfabric.membrane.grid import SYMMETRIES
from shellfabric.yarns.holding import WIDEST, friction_of_plies
from shellfabric.yarns.model import YarnZone

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup

COVERED = 4.0  # [spacings] of the diameter of a flat nose, from which it feels no place
ALIKE_BY_PLIES = {"flat": 2, "chisel": 2}  # plies from which a nose feels no place
ALIKE_BY_PLIES_OF_OTHERS = 5


@dataclass(frozen=True)
class Place:
    """A place that a nose strikes.

    Parameters
    ----------
    name : in words, such as "in a gap"
    along : [spacings] from the middle crossover along warp and weft; None is the point of the set-up
    """

    name: str
    along: tuple[float, float] | None


CROSSOVER = Place("on a crossover", (0.0, 0.0))
GAP = Place("in a gap", (0.5, 0.5))
ON_WARP = Place("on a warp yarn", (0.5, 0.0))
ON_WEFT = Place("on a weft yarn", (0.0, 0.5))
GIVEN = Place("at the given point", None)
# {name: Place}
NAMED = {place.name: place for place in (CROSSOVER, GAP, ON_WARP, ON_WEFT, GIVEN)}


@dataclass(frozen=True)
class Places:
    """Places that are struck.

    Parameters
    ----------
    listed : of them
    why : why there is one alone, in words; "" of several
    """

    listed: tuple[Place, ...]
    why: str = ""

    @property
    def words(self) -> str:
        """Where the answer holds."""
        if self.listed == (GIVEN,):
            return GIVEN.name
        return "wherever it strikes"


def choose_places(setup: ImpactSetup, velocity: float) -> Places:
    """Choose the places that are struck.

    Parameters
    ----------
    setup : ImpactSetup of resolved yarns (`resolve`)
    velocity : [m/s] of the nose, by which it is judged whether friction holds the yarns
    """
    shot = setup.projectile
    across = shot.radius / min(setup.fabric.weave.w)
    zone = setup.crossovers
    assert zone is not None
    lowest = least(zone.friction)
    # the smoothest nose pushes yarns aside most
    needed = friction_of_plies(setup.plain_panels(), velocity, least(shot.friction))
    if needed is not None and lowest >= needed[1]:
        why = f"a friction of {lowest:g} holds the yarns at {velocity:.4g} m/s, which ask for {needed[1]:.2g}"
    elif across > 2 * WIDEST:
        why = f"the nose is {across:.0f} yarns wide"
    elif shot.shape == "flat" and across >= COVERED:
        why = f"the flat nose is {across:.0f} yarns wide"
    elif setup.plies >= ALIKE_BY_PLIES.get(shot.shape, ALIKE_BY_PLIES_OF_OTHERS):
        why = f"{counted(setup.plies, 'ply')} are shifted against each other"
    elif shot.shape == "chisel":
        return Places((ON_WARP, ON_WEFT))
    else:
        return Places((CROSSOVER, GAP))
    return Places((CROSSOVER,), why)


def resolve(setup: ImpactSetup) -> ImpactSetup:
    """Return the set-up with resolved yarns: as it is, or as the whole panel with the zone that checks
    choose by or the default one. The part of a panel that pinned yarns need is not that of resolved ones,
    whose pattern may mirror itself in no plane.
    """
    if setup.crossovers is not None:
        return setup
    zone = setup.instead
    if zone is None:
        zone = YarnZone(friction=friction_between_yarns(*setup.fabrics).number)
    return replace(setup, crossovers=zone, instead=None, symmetry="whole")


def strike_at(setup: ImpactSetup, place: Place) -> ImpactSetup:
    """Return a set-up of resolved yarns that is struck at a place, as the smallest part of the panel
    that stands for the whole.

    Raises
    ------
    InputError : what resolved yarns do not have
    """
    if place.along is None:
        return setup
    x, y = (2 * float(share * w) for share, w in zip(place.along, setup.fabric.weave.w))
    whole = replace(setup, impact_point=(x, y), symmetry="whole")
    if setup.strength is not None or setup.angled:
        return whole
    planes = tuple(setup.projectile.mirrored(axis) and not off for axis, off in enumerate((x, y)))
    part = replace(whole, symmetry=next(name for name, has in SYMMETRIES.items() if has == planes))
    try:
        part.plain_panels()
    except InputError:
        # of edges or plies that are not alike on both sides; any other problem is of the whole too
        return whole
    return part
