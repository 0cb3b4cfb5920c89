"""Rounding of the nose's edge against the element: an edge that no element resolves drives false failure."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from fabrics import catalogue
from fabrics.variants import homogenised
from shellfabric.cell.model import CellModel, CellTable
from validation.verification.stability import shots
from validation.verification.stability.core import BELOW, STABLE, WRONG, Axis, Map, Outcome, guarded

ALLOWED, VELOCITY = 0.15, 130.0
RADII = (0.01e-3, 0.02e-3, 0.05e-3, 0.1e-3, 0.2e-3, 0.3e-3, 0.6e-3, 1.2e-3)
MESHES = {
    "1/4 a crossover": (4, 1, 8),
    "1/2 a crossover": (2, 1, 8),
    "1, with 2 contact points": (1, 1, 2),
    "1, with 8 contact points": (1, 1, 8),
    "1 a crossover": (1, 1, None),
    "2 a crossover": (1, 2, None),
    "3 a crossover": (1, 3, None),
}  # crossovers an element, elements a crossover, contact points a crossover (None: the default, by the edge)


@cache
def table(crossovers: int) -> CellTable:
    """Table of the cell of an element of so many crossovers, squared."""
    fabric = catalogue.load(shots.FABRIC).with_effective_density()
    return CellModel(homogenised(fabric, crossovers) if crossovers > 1 else fabric).table(shots.TABLE)


def shot(radius: float, crossovers: int, elements: int, points: int | None) -> shots.Answer:
    """Answer of a shot; tensions are those of one yarn."""
    points = None if points is None else points * crossovers
    found = shots.fire(
        table(crossovers), elements=elements, edge_radius=radius, velocity=VELOCITY, contact_points=points
    )
    return replace(found, peak=tuple(tension / crossovers for tension in found.peak))


finest = cache(lambda radius: shot(radius, 1, 4, None))


def point(radius: float, mesh: str) -> Outcome:
    """STABLE where peaks and velocity are those of 4 elements a crossover, and no yarn fails that does not there."""

    def run():
        found, fine = shot(radius, *MESHES[mesh]), finest(radius)
        off = found.off(fine)
        good = off <= ALLOWED and (found.failed == 0) == (fine.failed == 0)
        message = (
            f"{found.failed} failed segments, {fine.failed} on the finest mesh" if found.failed or fine.failed else ""
        )
        return Outcome(STABLE if good else WRONG, 100 * off, message, found.checks)

    return guarded(run)


def chart(quick: bool = False) -> Map:
    """The map."""
    radii = RADII[2:6:3] if quick else RADII
    return Map(
        "edge-radius", "Radius of the nose's edge against the element",
        f"{shots.FABRIC} struck at {VELOCITY:g} m/s, below its limit, by noses of other edges, on meshes about one "
        "element a crossover (1.27 mm); held against 4 a crossover. The contact looks at 8 points along each "
        "crossover, whatever the element, and at more under an edge that these would miss; with 2 it comes near to one "
        "that looks at nodes.",
        Axis("edge radius [mm]", radii, tuple(f"{1e3 * r:g}" for r in radii), 1e-3),
        Axis("mesh", ("1 a crossover",) if quick else tuple(MESHES)), point,
        "difference from 4 elements a crossover [%]",
        f"peaks or velocity off by more than {100 * ALLOWED:g} %, or yarns fail on one mesh alone",
        "a contact that gives energy; a coarse mesh ends with an answer, which only a finer one shows to be wrong",
        (0.3e-3, "1 a crossover"), (BELOW,),
    )  # fmt: skip
