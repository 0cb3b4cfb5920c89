"""A panel or pack with a material card, a rigid projectile, contact and boundary, ready to be written for another code.

Numbers are SI here; the writers (`ls_dyna`, `radioss`) convert them by the deck's `Units`.
Nodes, elements and parts are numbered from 1: the plies in the order in which the projectile meets them, then the
projectile with a node of reference. Node 1 to node 2 of an element is the ply's first direction, along x: its warp, or
the weft of a ply that is turned, which has a card of its own with warp and weft exchanged.

Of a panel in symmetry the modelled part is written, with the planes as boundary conditions, and that share of the
projectile's mass; the whole surface of the projectile is there all the same.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

import fabrics
from fabrics.checks import BoolArray, FloatArray, IntArray
from fabrics.errors import InputError
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.output.snapshots import quads
from shellfabric.panel import boundary
from shellfabric.projectile.solid import volume
from weavecell.decks.cloth import Cloth
from weavecell.decks.laws import Law
from weavecell.decks.mismatch import LIMIT, Mismatch
from weavecell.decks.nose import mesh

STEEL = 7800.0, 2e11, 0.3  # [kg/m3], [Pa], [-] of the projectile's shells: its mass is given, its contact needs these
_TABLE = 8  # samples a side of a cell's table that nothing uses
_SKIN, _CLEARANCE = 0.1, 0.01  # [ply thicknesses] of the projectile's shells, and from them to the first ply
_SEEN = 0.9  # of the volume of a body of any shape that this surface holds at least
_PICTURES, _SAMPLES = 50, 1000  # of a run

# what a membrane of another code does not have: key of the input file, what is allowed, and whether a set-up has it
REFUSED: dict[str, tuple[str, Callable[[Any], bool]]] = {
    "backing": ("left out: a block behind the fabric is not exported", lambda ply: ply.backing is not None),
    "fabric.surface": ("left out: a card is made from compression laws", lambda ply: ply.surface is not None),
    "fabric.bending": ("0: a membrane has no bending stiffness", lambda ply: bool(np.any(ply.bending))),
    "panel.weave_angle": ("0: an oblique weave is not exported", lambda ply: ply.weave_angle != 0),
    "panel.ply.angle": ("0 or 90 deg in an exported deck", lambda ply: ply.angled),
    "panel.opening_shape": ('"rectangular"', lambda ply: ply.round),
    "panel.impact_point": ("0", lambda ply: any(ply.impact_point or ())),
    "panel.rate_dependence": ("false: cards have one strength", lambda ply: ply.rate_dependence),
    "panel.crossovers": ('"pinned": no law here lets yarns slide', lambda ply: ply.crossovers is not None),
    "panel.boundary": ("clamped or free: no side that slips is exported", lambda ply: boundary.slips(ply.edge)),
    "projectile.body": ('"rigid"', lambda ply: ply.projectile.bar is not None),
}


@dataclass(frozen=True)
class Units:
    """Consistent units of a deck.

    Parameters
    ----------
    mass, length, time : names
    kg, m, s : one SI unit in them
    """

    mass: str
    length: str
    time: str
    kg: float
    m: float
    s: float

    def density(self, value: Any) -> Any:
        """From [kg/m3]."""
        return value * self.kg / self.m**3

    def stress(self, value: Any) -> Any:
        """From [Pa]."""
        return value * self.kg / (self.m * self.s**2)

    def velocity(self, value: Any) -> Any:
        """From [m/s]."""
        return value * self.m / self.s


UNITS = {"kg-m-s": Units("kg", "m", "s", 1.0, 1.0, 1.0), "g-mm-ms": Units("g", "mm", "ms", 1e3, 1e3, 1e3)}


@dataclass(frozen=True)
class Card:
    """A material: a law with the membrane that it is of.

    Parameters
    ----------
    number, name : from 1
    fabric, law, mismatch : what it was made of, the law, and how far they differ
    """

    number: int
    name: str
    cloth: Cloth
    law: Law
    mismatch: Mismatch


@dataclass(frozen=True)
class Ply:
    """A sheet of membranes; its number is that of its part.

    Parameters
    ----------
    number, name : from 1
    card : Card
    points : (n, 3) [m]
    quads : (m, 4) its nodes from 1, in the deck's numbers
    held, mirror_x, mirror_y : (n,) bool nodes in the clamp, and on planes of symmetry x = 0 and y = 0
    """

    number: int
    name: str
    card: Card
    points: FloatArray
    quads: IntArray
    held: BoolArray
    mirror_x: BoolArray
    mirror_y: BoolArray


@dataclass(frozen=True)
class Nose:
    """The rigid projectile.

    Parameters
    ----------
    points : (n, 3) [m] of its surface
    quads : (m, 4) nodes in the deck's numbers
    centre : (3,) [m] node of reference, whose number is `reference`
    mass : [kg] of the modelled part
    inertia : [kg m2] about each axis; it does not turn, but no code takes zero
    velocity : (3,) [m/s]
    friction : [-] with the fabric
    """

    points: FloatArray
    quads: IntArray
    centre: FloatArray
    reference: int
    mass: float
    inertia: float
    velocity: FloatArray
    friction: float


@dataclass(frozen=True)
class Deck:
    """What the writers write.

    Parameters
    ----------
    title, header : one line, and lines of at most 76 characters
    units : Units
    cards, plies, nose : see there
    mirrors : whether x = 0 and y = 0 are planes of symmetry
    friction : [-] between plies
    end_time : [s]
    """

    title: str
    header: tuple[str, ...]
    units: Units
    cards: tuple[Card, ...]
    plies: tuple[Ply, ...]
    nose: Nose
    mirrors: tuple[bool, bool]
    friction: float
    end_time: float

    @property
    def points(self) -> FloatArray:
        """(n, 3) [m] of all nodes, in the order of their numbers."""
        return np.vstack([*(ply.points for ply in self.plies), self.nose.points, self.nose.centre])

    @property
    def parts(self) -> tuple[Ply | Nose, ...]:
        """The plies, then the projectile."""
        return *self.plies, self.nose

    @property
    def skin(self) -> float:
        """[m] thickness of the projectile's shells."""
        return _SKIN * self.cards[0].cloth.thickness

    @property
    def intervals(self) -> tuple[float, float]:
        """[s] between pictures and between samples of histories."""
        return self.end_time / _PICTURES, self.end_time / _SAMPLES

    def held(self) -> dict[str, IntArray]:
        """{name: node numbers}: clamped, and on planes of symmetry without those; empty sets are left out."""
        numbers = np.arange(1, 1 + sum(len(ply.points) for ply in self.plies))
        clamped = np.concatenate([ply.held for ply in self.plies])
        sets = {"clamped": numbers[clamped]}
        for name in ("mirror_x", "mirror_y"):
            sets[name] = numbers[np.concatenate([getattr(ply, name) for ply in self.plies]) & ~clamped]
        return {name: nodes for name, nodes in sets.items() if nodes.size}

    def watched(self) -> dict[str, int]:
        """{name: node number} of what histories are written: the projectile, and the point of impact of each ply."""
        nodes = {"projectile": self.nose.reference}
        for ply in self.plies:
            nodes[ply.name] = int(ply.quads.min() + np.argmin(np.hypot(*ply.points[:, :2].T)))
        return nodes

    @cached_property
    def elements(self) -> tuple[IntArray, ...]:
        """Numbers of the elements of each part."""
        ends = np.cumsum([0, *(len(part.quads) for part in self.parts)])
        return tuple(np.arange(a, b) + 1 for a, b in pairwise(ends))


def build(
    setup: ImpactSetup, make: Callable[[Cloth], Law], units: str, *, title: str, source: str, law: str, code: str
) -> Deck:
    """The deck of a set-up.

    Parameters
    ----------
    setup : ImpactSetup
    make : the law of a fabric
    units : of UNITS
    title, source, law, code : in words: of the shot, of its compression law, of the law and the code for the header

    Raises
    ------
    InputError : unknown units, or what no deck holds
    """
    if units not in UNITS:
        raise InputError(key="units", value=units, allowed=" or ".join(UNITS))
    for key, (allowed, has) in REFUSED.items():
        if has(setup):
            raise InputError(key=key, allowed=allowed)
    panels, places, friction = _panels(setup)
    cards: dict[int, Card] = {}
    plies: list[Ply] = []
    for p, (panel, place) in enumerate(zip(panels, places)):
        if id(panel) not in cards:
            name = _ascii(setup.fabric_of(p).name) + (" turned" if setup.is_turned(p) else "")
            cards[id(panel)] = _card(panel.table.model, make, len(cards) + 1, name)
        plies.append(_ply(panel, cards[id(panel)], place, plies))
    used = tuple(cards.values())
    share, mirrors = panels[0].share, panels[0].mirrors
    nose = _nose(setup.projectile, setup.strike_velocity, share, used[0].cloth.thickness, plies)
    header = _header(used, units, share, source, law, code)
    return Deck(_ascii(title)[:70], header, UNITS[units], used, tuple(plies), nose, mirrors, friction, setup.end_time)


def _panels(setup):
    """(panels in the order of the plies, their places [m], friction between them): all that is asked of a set-up's
    pack."""
    found = replace(setup, table_size=_TABLE).target()
    return found.plies, found.places, found.friction


def _card(model, make, number, name):
    cloth = Cloth(replace(model, reach=1.0))
    law = make(cloth)
    return Card(number, name, cloth, law, Mismatch.of(cloth, law))


def _ply(panel, card, place, before):
    X, Y = (each.ravel() for each in panel.coordinates())
    first = 1 + sum(len(ply.points) for ply in before)
    on = [m & (np.abs(x) < 1e-9 * s) for m, x, s in zip(panel.mirrors, (X, Y), panel.spacing)]
    number = len(before) + 1
    return Ply(
        number, f"ply {number}", card, np.column_stack([X, Y, np.full(X.size, place)]), quads(panel) + first,
        ~boundary.loose(panel).ravel(), *on,
    )  # fmt: skip


def _nose(shot, speed, share, thickness, plies):
    """The body's surface in elements of the fabric's size, its nose on the line of flight before the first ply."""
    clear = (0.5 + 0.5 * _SKIN + _CLEARANCE) * thickness
    start = shot.start() - shot.flight * clear / shot.flight[2]
    first = sum(len(ply.points) for ply in plies)
    corners = plies[0].points[plies[0].quads[:, [0, 2]] - 1, :2]
    points, quads = mesh(shot, np.diff(corners, axis=1).min())
    if shot.solid is not None:
        held = volume(points, np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]))
        if held < _SEEN * volume(shot.solid.points, shot.solid.faces):
            allowed = "a body whose surface is seen from its axis: from there it is drawn"
            raise InputError(key="projectile.stl", allowed=allowed)
    return Nose(
        start + points, quads + first + 1, start - shot.radius * shot.frame[2], first + len(points) + 1,
        share * shot.mass, 0.4 * share * shot.mass * shot.radius**2, speed * shot.flight, shot.friction,
    )  # fmt: skip


def _header(cards, units, share, source, law, code):
    """Lines of text: what the deck is, how far its cards are off, and what they do not hold."""
    text = [
        f"weavecell {fabrics.__version__}: a deck for {code}, NOT RUN in it",
        f"Units: {units}",
        f"Material: {law}; computed from a unit cell, not measured; compression law: {source}",
    ]
    for card in cards:
        percent = {key: f"{100 * value:.1f} %" for key, value in card.mismatch.numbers().items()}
        text.append(
            "Law {n} ({name}) less the cell, over the strength: rms {rms}, largest {largest} over the biaxial plane; "
            "{uniaxial} in uniaxial tension, {shear} in shear until locking".format(
                n=card.number, name=card.name, **percent
            )
        )
        if card.mismatch.worst > LIMIT:
            text.append(f"WARNING: law {card.number} is off by more than {100 * LIMIT:.0f} % of the strength")
    text.append(f"Not held: {cards[0].law.lost}")
    if share < 1:
        text.append(f"Symmetry: {share:g} of panel and projectile are modelled; forces and energies are of that part")
    return tuple(line for each in text for line in textwrap.wrap(_ascii(each), 76, subsequent_indent="  "))


def _ascii(text):
    """A text as all codes read it, in one line."""
    return " ".join(text.encode("ascii", "replace").decode().split())
