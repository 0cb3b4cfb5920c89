"""Where a nose may strike a weave."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

from fabrics.assumed import friction_between_yarns
from fabrics.base.errors import InputError
from shellfabric.membrane.grid import SYMMETRIES
from shellfabric.yarns.model import YarnZone

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup

# [spacings] from the middle crossover along warp and weft: on a yarn, half-way between gap and crossover
ON_WARP = (0.5, 0.0)


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


def strike_at(setup: ImpactSetup, along: tuple[float, float]) -> ImpactSetup:
    """Return a set-up of resolved yarns that is struck at a place, as the smallest part of the panel
    that stands for the whole.

    Raises
    ------
    InputError : what resolved yarns do not have
    """
    x, y = (2 * float(share * w) for share, w in zip(along, setup.fabric.weave.w))
    planes = tuple(setup.projectile.mirrored(axis) and not off for axis, off in enumerate((x, y)))
    if any(planes) and setup.strength is None and not setup.angled:
        symmetry = next(name for name, has in SYMMETRIES.items() if has == planes)
        part = replace(setup, impact_point=(x, y), symmetry=symmetry)
        # edges or plies may not be alike on both sides; any other problem is of the whole too
        with suppress(InputError):
            part.plain_panels()
            return part
    return replace(setup, impact_point=(x, y), symmetry="whole")
