"""A panel or pack with a material card, a rigid projectile, contact and boundary, ready to be
written for another code.

Numbers are SI here; the writers (`ls_dyna`, `radioss`) convert them by the deck's `Units`.
Nodes, elements and parts are numbered from 1: the plies in the order in which the projectile meets
them, then the projectile with a node of reference. Node 1 to node 2 of an element is the ply's
first direction, along x: its warp, or the weft of a ply that is turned, which has a card of its own
with warp and weft exchanged.

Of a panel in symmetry the modelled part is written, with the planes as boundary conditions, and
that share of the projectile's mass; the whole surface of the projectile is there all the same.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from types import ModuleType
from typing import Any

import numpy as np

import fabrics
from fabrics.base.checks import BoolArray, FloatArray, IntArray
from fabrics.base.errors import InputError
from fabrics.base.schema import unread, with_tables, without_place
from shellfabric.impact.setup import ImpactSetup
from shellfabric.loop.snapshots import quads
from shellfabric.membrane import boundary
from shellfabric.projectile.solid import volume
from weavecell.decks.homogenised import HomogenisedFabric
from weavecell.decks.laws import Law
from weavecell.decks.mismatch import LIMIT, Mismatch
from weavecell.decks.nose import mesh
from weavecell.scenes.impact import Scene

STEEL = (
    7800.0,
    2e11,
    0.3,
)  # [kg/m3], [Pa], [-] of the projectile's shells: its mass is given, its contact needs these
# samples along each side of the cell's table, which a deck does not use
_TABLE = 8
# [ply thicknesses] thickness of the projectile's shells
_SKIN = 0.1
# [ply thicknesses] from the shells to the first ply: they must not touch at the start
_CLEARANCE = 0.01
# share of a body's volume that the surface holds at least, whatever its shape
_SEEN = 0.9
# states in the animation of a run
_PICTURES = 50
# samples in the histories of a run
_SAMPLES = 1000
_NEAREST = {
    "plane": "nearest to the cell over the biaxial plane",
    "uniaxial": "nearest to it in uniaxial tension",
}

# what a membrane of another code does not have: keys of the input file that
# say why they are refused (`Unread`), and whether a set-up has it
REFUSED: dict[str, Callable[[Any], bool]] = {
    "backing": lambda ply: ply.backing is not None,
    "fabric.surface": lambda ply: ply.surface is not None,
    "fabric.bending": lambda ply: bool(np.any(ply.bending)),
    "panel.weave_angle": lambda ply: ply.weave_angle != 0,
    "panel.opening_shape": lambda ply: ply.round,
    "panel.crossovers": lambda ply: ply.crossovers is not None or ply.instead is not None,
    "panel.impact_point": lambda ply: any(ply.impact_point),
    "panel.strength": lambda ply: ply.strength is not None,
    "panel.rate_dependence": lambda ply: ply.rate_dependence,
    "panel.boundary.clamp_force": lambda ply: boundary.slips(ply.boundary),
    "projectile.body": lambda ply: ply.projectile.deforms,
}


# keys without a place in a deck (`NoPlace`) that act by their default too, and whether a set-up has
# what they describe: they are told whether or not a scene gives them
ACT_BY_DEFAULT: dict[str, Callable[[Any], bool]] = {
    "panel.yarn_failure": lambda ply: ply.yarn_failure,
    "panel.ply_contact": lambda ply: ply.plies > 1,
}


def list_left_out(setup: ImpactSetup, given: Iterable[str] = ()) -> tuple[str, ...]:
    """List the keys of a scene that a deck has no place for, with what follows from it.

    Parameters
    ----------
    given : keys that the scene sets to something other than their default (`schema.changed`)
    """
    follows = without_place(Scene, "export")
    keys = [key for key, acts in ACT_BY_DEFAULT.items() if acts(setup)]
    for key in given:
        if key not in ACT_BY_DEFAULT and any(name in follows for name in with_tables(key)):
            keys.append(key)
    return tuple(f"{key} ({follows[key]})" if follows.get(key) else key for key in keys)


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
        """Convert from [kg/m3]."""
        return value * self.kg / self.m**3

    def stress(self, value: Any) -> Any:
        """Convert from [Pa]."""
        return value * self.kg / (self.m * self.s**2)

    def velocity(self, value: Any) -> Any:
        """Convert from [m/s]."""
        return value * self.m / self.s


UNITS = {
    "kg-m-s": Units("kg", "m", "s", 1.0, 1.0, 1.0),
    "g-mm-ms": Units("g", "mm", "ms", 1e3, 1e3, 1e3),
}


@dataclass(frozen=True)
class Card:
    """A material: its number from 1, the fabric that it is of, the law, and how far they
    differ."""

    number: int
    name: str
    fabric: HomogenisedFabric
    law: Law
    mismatch: Mismatch


@dataclass(frozen=True)
class Ply:
    """A sheet of membranes.

    Parameters
    ----------
    number, name : of the ply and its part, from 1
    card : Card
    points : (n, 3) [m]
    quads : (m, 4) its nodes, by their numbers in the deck
    held : {"clamped", "mirror_x", "mirror_y": (n,) bool} nodes in the clamp, and on planes of
        symmetry x = 0, y = 0
    """

    number: int
    name: str
    card: Card
    points: FloatArray
    quads: IntArray
    held: dict[str, BoolArray]


@dataclass(frozen=True)
class Nose:
    """The rigid projectile.

    Parameters
    ----------
    points : (n, 3) [m] of its surface
    quads : (m, 4) its nodes, by their numbers in the deck
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
    left_out : keys of the scene that it leaves out
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
    left_out: tuple[str, ...] = ()

    @property
    def points(self) -> FloatArray:
        """(n, 3) [m] of all nodes, in the order of their numbers."""
        return np.vstack([*(ply.points for ply in self.plies), self.nose.points, self.nose.centre])

    @property
    def shells(self) -> IntArray:
        """(m, 6) of all elements: number, number of the part, four nodes."""
        parts = [*(ply.quads for ply in self.plies), self.nose.quads]
        part = np.repeat(np.arange(len(parts)), [len(faces) for faces in parts]) + 1
        return np.column_stack([np.arange(len(part)) + 1, part, np.vstack(parts)])

    @property
    def nose_part(self) -> int:
        """Number of the projectile's part."""
        return len(self.plies) + 1

    @property
    def nose_card(self) -> int:
        """Number of the projectile's material and section."""
        return len(self.cards) + 1

    @property
    def skin(self) -> float:
        """[m] thickness of the projectile's shells."""
        return _SKIN * self.cards[0].fabric.thickness

    @property
    def intervals(self) -> tuple[float, float]:
        """[s] between pictures and between samples of histories."""
        return self.end_time / _PICTURES, self.end_time / _SAMPLES

    def list_held_nodes(self) -> dict[str, IntArray]:
        """Return {name: node numbers}: clamped, and on planes of symmetry without those; empty sets
        are left out."""
        chosen = {}
        for name in self.plies[0].held:
            chosen[name] = np.concatenate([ply.held[name] for ply in self.plies])
            if name != "clamped":
                chosen[name] &= ~chosen["clamped"]
        return {name: np.flatnonzero(held) + 1 for name, held in chosen.items() if held.any()}

    def list_watched_nodes(self) -> dict[str, int]:
        """Return {name: node number} of what histories are written: the projectile, and the point
        of impact of each ply."""
        nodes = {"projectile": self.nose.reference}
        for ply in self.plies:
            nodes[ply.name] = int(ply.quads.min() + np.argmin(np.hypot(*ply.points[:, :2].T)))
        return nodes


def build(
    setup: ImpactSetup,
    code: ModuleType,
    units: str,
    match: str,
    *,
    title: str,
    source: str,
    given: Iterable[str] = (),
) -> Deck:
    """Build the deck of a set-up.

    Parameters
    ----------
    setup : ImpactSetup
    code : the writer, `ls_dyna` or `radioss`: its NAME, LAW and KEYWORD
    units : of UNITS
    match : of `homogenised.MATCHES`
    title, source : in words: of the shot, and of its compression law
    given : keys of the scene, see `list_left_out`

    Raises
    ------
    InputError : what no deck holds
    """
    # a deck that left something out would run, and be wrong in silence
    words = unread(Scene, "export")
    for key, has in REFUSED.items():
        if has(setup):
            raise InputError(key=key.removesuffix(".clamp_force"), allowed=words[key])
    if setup.angled:
        raise InputError(key="panel.ply.angle", allowed="0 or 90 deg in an exported deck")
    pack = replace(setup, table_size=_TABLE).target()
    cards: dict[int, Card] = {}
    plies: list[Ply] = []
    first = 1
    for p, (panel, z) in enumerate(zip(pack.plies, pack.places)):
        # plies that are alike share a panel, and so a card
        if id(panel) not in cards:
            name = _title(setup.fabric_of(p).name) + (" turned" if setup.is_turned(p) else "")
            # a card needs the cell to the strength, not beyond
            fabric = HomogenisedFabric(replace(panel.table.model, reach=1.0))
            law = code.LAW.fit(fabric, match)
            cards[id(panel)] = Card(
                len(cards) + 1, name, fabric, law, Mismatch.measure(fabric, law)
            )
        x, y = (values.ravel() for values in panel.coordinates())
        # what is clamped stands first: a node of the clamp is not on a mirror too
        held = {"clamped": ~panel.loose().ravel()}
        for axis, mirror, places, spacing in zip("xy", panel.mirrors, (x, y), panel.spacing):
            held[f"mirror_{axis}"] = mirror & (np.abs(places) < 1e-9 * spacing)
        points = np.column_stack([x, y, np.full(x.size, z)])
        plies.append(
            Ply(p + 1, f"ply {p + 1}", cards[id(panel)], points, quads(panel) + first, held)
        )
        first += len(points)
    materials = tuple(cards.values())
    share = pack.plies[0].share
    mirrors = pack.plies[0].mirrors
    nose = _nose(setup, share, materials[0].fabric.thickness, plies[0], first)
    law = f"{code.KEYWORD}, {_NEAREST[match]}"
    left_out = list_left_out(setup, given)
    notes = [f"Note: {note}" for note in setup.opening_notes]
    if left_out:
        notes.insert(0, f"Left out of the input file: {', '.join(left_out)}")
    header = _header(materials, units, share, law, source, code.NAME, notes)
    end = setup.end_time
    friction = pack.friction
    return Deck(
        _line(title)[:70],
        header,
        UNITS[units],
        materials,
        tuple(plies),
        nose,
        mirrors,
        friction,
        end,
        left_out,
    )


def _nose(setup, share, thickness, ply, first):
    """The body's surface in elements of the fabric's size, its nose on the line of flight before
    the first ply."""
    shot = setup.projectile
    clear = (0.5 + 0.5 * _SKIN + _CLEARANCE) * thickness
    start = shot.start() - shot.flight * clear / shot.flight[2]
    corners = ply.points[ply.quads[:, [0, 2]] - 1, :2]
    points, faces = mesh(shot, np.diff(corners, axis=1).min())
    if shot.solid is not None:
        seen = volume(points, np.vstack([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]]))
        if seen < _SEEN * volume(shot.solid.points, shot.solid.faces):
            allowed = "a body whose whole surface is visible from its axis"
            raise InputError(key="projectile.stl", allowed=allowed)
    mass = share * shot.mass
    centre = start - shot.radius * shot.frame[2]
    number = first + len(points)
    inertia = 0.4 * mass * shot.radius**2
    velocity = setup.strike_velocity * shot.flight
    return Nose(
        start + points, faces + first, centre, number, mass, inertia, velocity, shot.friction
    )


def _header(cards, units, share, law, source, code, notes):
    """Lines of text: what the deck is, how far its cards are off, and what they do not hold."""
    text = [
        f"weavecell {fabrics.__version__}: a deck for {code}, NOT RUN in it",
        f"Units: {units}",
        f"Material: {law}; computed from a unit cell, not measured; compression law: {source}",
    ]
    for card in cards:
        rms, largest, uniaxial, shear = (
            f"{100 * value:.1f} %" for value in card.mismatch.numbers().values()
        )
        text.append(
            f"Law {card.number} ({card.name}) less the cell, over the strength: rms {rms}, largest {largest} over the "
            f"biaxial plane; {uniaxial} in uniaxial tension, {shear} in shear until locking"
        )
        if card.mismatch.worst > LIMIT:
            text.append(
                f"WARNING: law {card.number} is off by more than {100 * LIMIT:.0f} % of the strength"
            )
    text += [f"Not represented: {cards[0].law.lost}", *notes]
    if share < 1:
        text.append(
            f"Symmetry: {share:g} of panel and projectile are modelled; forces and energies are of that part"
        )
    lines = []
    for entry in text:
        lines += textwrap.wrap(_ascii(entry), 76, subsequent_indent="  ")
    return tuple(lines)


def _title(text):
    """A text for a line of a title, without commas, which a reader may take for free format."""
    return _line(text.replace(",", ""))


def _line(text):
    """Return a text that is a line of its own, which no code takes for a keyword, a comment or a
    parameter."""
    return _ascii(text).lstrip("*/$#&!, ") or "untitled"


def _ascii(text):
    """A text as all codes read it, in one line."""
    return " ".join(text.encode("ascii", "replace").decode().split())
