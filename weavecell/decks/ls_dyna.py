"""LS-DYNA keyword deck of a panel: *MAT_FABRIC (034) FORM 14 on fully integrated membranes (ELFORM 9).

Cards, fields and widths as in the LS-DYNA Keyword User's Manual, volumes I and II (R11 to R16): columns of 10, nodes
of 8 and 16, elements of 8, points of curves of 20 characters. The curves of the fibres have DATTYP -2, which the manual
has for stress-strain curves of *MAT_FABRIC: here nominal stress against engineering strain; that of shear has the shear
angle [rad]. AOPT 2 with the vector (1, 0, 0) is the ply's first direction. Compression is eliminated (CSE 1).

The projectile is *MAT_RIGID with the mass, place and velocity of *PART_INERTIA; it does not turn. Contact by soft
constraint (SOFT 1): of the nose with the plies, and of the plies among themselves.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from meshing.formats.deck import fields, lines, wrapped
from weavecell.decks.laws import UncoupledCurves
from weavecell.decks.model import STEEL, Card, Deck

MEMBRANE, SHELL = 9, 2  # ELFORM
SUFFIX = ".k"
_FORM, _FABRIC_CURVE, _CSE, _AOPT = 14, -2, 1, 2
_COURANT = 0.9
_PAIRS = {(False, False): 0, (True, False): 1, (False, True): 2, (True, True): 4}  # CON1: what is held of x and y


def write(deck: Deck, name: str) -> dict[str, str]:
    """{file name: text} of a deck whose laws are UncoupledCurves."""
    parts = _head, _mesh, _parts, _materials, _boundary, _contact
    text = "".join(piece for part in parts for piece in part(deck)) + "*END\n"
    return {f"{name}{SUFFIX}": text}


def _head(deck: Deck) -> Iterator[str]:
    s = deck.units.s
    pictures, samples = (s * interval for interval in deck.intervals)
    yield "*KEYWORD\n" + "".join(f"$ {line}\n" for line in deck.header)
    yield f"*TITLE\n{deck.title}\n*CONTROL_TERMINATION\n" + _row(s * deck.end_time, 0, 0.0, 0.0, 0.0)
    yield "*CONTROL_TIMESTEP\n" + _row(0.0, _COURANT) + "*CONTROL_ENERGY\n" + _row(2, 2, 2, 1)
    for table in ("GLSTAT", "MATSUM", "RCFORC", "RBDOUT"):
        yield f"*DATABASE_{table}\n" + _row(samples)
    yield "*DATABASE_BINARY_D3PLOT\n" + _row(pictures)


def _mesh(deck: Deck) -> Iterator[str]:
    points = deck.points * deck.units.m
    yield "*NODE\n" + lines("%8d%16.9E%16.9E%16.9E", range(1, len(points) + 1), points)
    yield "*ELEMENT_SHELL\n"
    for number, (part, elements) in enumerate(zip(deck.parts, deck.elements), 1):
        yield lines(f"%8d{number:8d}" + "%8d" * 4, elements, part.quads)


def _parts(deck: Deck) -> Iterator[str]:
    m, kg = deck.units.m, deck.units.kg
    for card in deck.cards:
        yield f"*SECTION_SHELL_TITLE\nmembrane of {card.name}\n" + _row(card.number, MEMBRANE, 1.0, 1)
        yield _row(*[m * card.cloth.thickness] * 4)
    skin = len(deck.cards) + 1
    yield "*SECTION_SHELL_TITLE\nsurface of the projectile\n" + _row(skin, SHELL, 1.0, 2) + _row(*[m * deck.skin] * 4)
    for ply in deck.plies:
        yield f"*PART\n{ply.name}\n" + _row(ply.number, ply.card.number, ply.card.number)
    nose = deck.nose
    yield "*PART_INERTIA\nprojectile\n" + _row(_nose(deck), skin, skin)
    yield _row(*m * nose.centre, kg * nose.mass, 0, nose.reference)
    J = kg * m**2 * nose.inertia
    yield _row(J, 0.0, 0.0, J, 0.0, J) + _row(*deck.units.velocity(nose.velocity), 0.0, 0.0, 0.0)
    yield "*SET_PART_LIST_TITLE\nplies\n" + _row(1)
    yield wrapped([ply.number for ply in deck.plies], 8)


def _materials(deck: Deck) -> Iterator[str]:
    for card in deck.cards:
        yield from _fabric(card, deck)
    (density, E, nu), held = STEEL, _PAIRS[deck.mirrors]
    yield "*MAT_RIGID_TITLE\nprojectile\n" + _row(
        len(deck.cards) + 1, deck.units.density(density), deck.units.stress(E), nu
    )
    yield _row(1.0, held, 7) + _row(0, 0.0, 0.0, 0.0, 0.0, 0.0)


def _fabric(card: Card, deck: Deck) -> Iterator[str]:
    """The material, and its curves: 3 n - 2 of the warp, 3 n - 1 of the weft, 3 n of shear."""
    law, u, cloth = card.law, deck.units, card.cloth
    assert isinstance(law, UncoupledCurves)
    warp, weft, shear = (3 * card.number - k for k in (2, 1, 0))
    slopes = [np.max(np.diff(curve[:, 1]) / np.diff(curve[:, 0])) for curve in law.curves]
    yield f"*MAT_FABRIC_TITLE\n{card.name}\n"
    yield _row(card.number, u.density(cloth.density), *map(u.stress, slopes), "", 0.0, 0.0)  # MID RO EA EB - PRBA PRAB
    yield _row(u.stress(cloth.shear.G1), "", "", float(_CSE), 0.0, 0.0, 0.0, 0.0)  # GAB - - CSE EL PRL LRATIO DAMP
    # AOPT FLC FAC ELA LNRC FORM FVOPT TSRFAC;  - RGBRTH A0REF A1 A2 A3 X0 X1;  V1 V2 V3 - - - BETA ISREFG
    yield _row(float(_AOPT), 0.0, 0.0, 0.0, 0.0, float(_FORM), 0.0, 0.0)
    yield _row("", 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0) + _row(0.0, 0.0, 0.0, "", "", "", 0.0, 0)
    yield _row(warp, weft, shear, 0, 0, 0, 0.0)  # LCA LCB LCAB LCUA LCUB LCUAB RL
    named = ((warp, "warp", *law.curves[:1]), (weft, "weft", *law.curves[1:]), (shear, "shear", law.trellis))
    yield "$ Nominal stress, engineering strain; shear: angle. Check this on one element\n"
    for number, name, curve in named:
        kind = 0 if name == "shear" else _FABRIC_CURVE
        yield f"*DEFINE_CURVE_TITLE\n{card.name}, {name}\n" + _row(number, 0, 1.0, 1.0, 0.0, 0.0, kind)
        yield lines("%20.12E%20.12E", curve[:, 0], u.stress(curve[:, 1]))


def _boundary(deck: Deck) -> Iterator[str]:
    fixed = {"clamped": (1,) * 6, "mirror_x": (1, 0, 0, 0, 1, 1), "mirror_y": (0, 1, 0, 1, 0, 1)}
    for number, (name, nodes) in enumerate(deck.held().items(), 1):
        yield f"*SET_NODE_LIST_TITLE\n{name}\n" + _row(number) + wrapped(nodes, 8)
        yield "*BOUNDARY_SPC_SET\n" + _row(number, 0, *fixed[name])


def _contact(deck: Deck) -> Iterator[str]:
    """SSID MSID SSTYP MSTYP ...;  FS FD ...;  scale factors at their defaults;  SOFT."""
    part_set, part = 2, 3
    pairs = [("SURFACE_TO_SURFACE", (1, _nose(deck), part_set, part), deck.nose.friction)]
    if len(deck.plies) > 1:
        pairs.append(("SINGLE_SURFACE", (1, 0, part_set, 0), deck.friction))
    for kind, sides, friction in pairs:
        yield f"*CONTACT_AUTOMATIC_{kind}\n" + _row(*sides, 0, 0, 0, 0) + _row(friction, friction, *[0.0] * 3, 0)
        yield _row(*[0.0] * 8) + _row(1)


def _nose(deck):
    """Number of the projectile's part."""
    return len(deck.plies) + 1


def _row(*values):
    """Fields of 10 characters: whole numbers, reals, empty ones."""
    return fields("{}", *(f"{v:>10}" if isinstance(v, str) else _number(v) for v in values))


def _number(value):
    if isinstance(value, (int, np.integer)):
        return f"{value:10d}"
    return f"{value:10.3E}" if value else f"{0.0:10.1f}"
