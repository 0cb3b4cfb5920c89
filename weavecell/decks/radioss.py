"""OpenRadioss starter and engine decks of a panel: /MAT/LAW58 with /PROP/TYPE16.

Block format 2023. Fields and widths as in the Radioss Reference Guide and in the input templates of OpenRadioss
(hm_cfg_files): columns of 10 and 20 characters. The shells are membranes, with one point through the thickness; the
vector (1, 0, 0) is the ply's first direction, the second is at 90 degrees to it. LAW58 has linear yarns, and a function
of the shear angle in degrees. /FAIL/FABRIC stands as a comment (_NO_FAILURE): without it nothing breaks.

The projectile is shells in /RBODY, whose mass is that of its main node alone (ICoG 4); it does not turn. Contact is
/INTER/TYPE7, nodes on surface: of all plies on the nose, and of each two neighbouring plies both ways.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from meshing.formats.deck import fields, lines, wrapped
from weavecell.decks.laws import FLEX, CrimpExchange
from weavecell.decks.model import STEEL, Card, Deck

VERSION = 2023
_ICOG_MAIN, _ISHELL, _BOTH, _IDEL = 4, 24, 2, 2
_BROKEN = 1.001  # times the strain of failure: of rupture
_COURANT = 0.5  # 0.9 becomes unstable once elements are lost
_STIFF = 0.03, 1  # scales of the contact stiffness (Stfac): of the steel nose, and of two plies
_NO_FAILURE = (
    "No failure: for a law with strains of its fibres (LAW58) OpenRadioss as of 2026-08-21",
    "(mulawc.F90, failure model 31) gives /FAIL/FABRIC the strain of the neighbouring element, and to the",
    "first of a group a stress: false failures. To use these lines in a version where that is mended,",
    "take the # away from the three that follow:",
)
_GAP = 0.9  # of the distance between plies, so that they do not touch at rest


def write(deck: Deck, name: str) -> dict[str, str]:
    """{file name: text} of a deck whose laws are CrimpExchange."""
    parts = _head, _materials, _properties, _mesh, _groups, _body, _contact
    starter = "".join(piece for part in parts for piece in part(deck)) + "/END\n"
    return {f"{name}_0000.rad": starter, f"{name}_0001.rad": "".join(_engine(deck, name))}


def _head(deck: Deck) -> Iterator[str]:
    u = deck.units
    yield "#RADIOSS STARTER\n" + "".join(f"# {line}\n" for line in deck.header)
    yield f"/BEGIN\n{deck.title}\n{VERSION:10d}\n" + 2 * fields("{:>20}", u.mass, u.length, u.time)
    yield f"/TITLE\n{deck.title}\n"


def _materials(deck: Deck) -> Iterator[str]:
    u = deck.units
    for card in deck.cards:
        yield from _fabric(card, deck)
    yield f"/MAT/LAW1/{_nose(deck)}\nprojectile\n" + _reals(u.density(STEEL[0])) + _reals(u.stress(STEEL[1]), STEEL[2])


def _fabric(card: Card, deck: Deck) -> Iterator[str]:
    law, u = card.law, deck.units
    assert isinstance(law, CrimpExchange)
    E, G = u.stress(law.E), u.stress(card.cloth.shear.G1)
    yield f"/MAT/LAW58/{card.number}\n{card.name}\n" + _reals(u.density(card.cloth.density))
    yield _reals(E[0], 0, E[1], 0, FLEX)  # E1 B1 E2 B2 Flex
    yield _reals(G, G, 0, G)  # G0 GT AlphaT Gsh
    yield _reals(0, 0, 0)  # Df Ds Gfrot
    yield _ids(1, 1)[:-1] + _reals(*law.crimp, FLEX, FLEX)  # N1 N2 S1 S2 Flex1 Flex2
    yield f"{0:10d}{'':10}{0:20.12E}\n" * 2 + f"{card.number:10d}{'':10}{1:20.12E}\n"  # fct_ID1, 2, 3 and scales
    rupture = _BROKEN * law.limit
    strains = law.limit[0], rupture[0], law.limit[1], rupture[1]
    failure = f"/FAIL/FABRIC/{card.number}\n" + _reals(*strains)[:-1] + f"{'':10}{_BOTH:10d}\n" + _reals(0)
    yield "".join(f"#{line}\n" for line in (*_NO_FAILURE, *failure.splitlines()))
    yield f"/FUNCT/{card.number}\n{card.name}, shear\n"
    yield lines("%20.12E%20.12E", law.table[:, 0], u.stress(law.table[:, 1]))


def _properties(deck: Deck) -> Iterator[str]:
    """Flags, hourglass and damping at their defaults, points and thickness; then the axes."""
    m = deck.units.m
    for card in deck.cards:
        thickness = m * card.cloth.thickness
        yield f"/PROP/TYPE16/{card.number}\n{card.name}\n" + _ids(_ISHELL, 0, 0) + _reals(0, 0, 0, 0, 0)
        yield _ids(1, 0)[:-1] + _reals(thickness, 0) + _reals(1, 0, 0)[:-1] + _ids(0, 0)
        yield _reals(0, 90, thickness, 0)[:-1] + _ids(card.number)  # Phi Alpha T Z mat_ID
    yield f"/PROP/TYPE1/{_nose(deck)}\nprojectile\n" + _ids(_ISHELL, 0, 0) + _reals(0, 0, 0, 0, 0)
    yield _ids(1, 0)[:-1] + _reals(m * deck.skin, 0)
    for ply in deck.plies:
        yield f"/PART/{ply.number}\n{ply.name}\n" + _ids(ply.card.number, ply.card.number)
    yield f"/PART/{_last(deck)}\nprojectile\n" + _ids(_nose(deck), _nose(deck))


def _mesh(deck: Deck) -> Iterator[str]:
    points = deck.points * deck.units.m
    yield "/NODE\n" + lines("%10d%20.12E%20.12E%20.12E", range(1, len(points) + 1), points)
    for number, (part, elements) in enumerate(zip(deck.parts, deck.elements), 1):
        yield f"/SHELL/{number}\n" + lines("%10d" * 5, elements, part.quads)


def _groups(deck: Deck) -> Iterator[str]:
    """Groups of nodes: held ones, then those of each part, and of all plies; a surface of each part."""
    fixed = {"clamped": "111 111", "mirror_x": "100 011", "mirror_y": "010 101"}
    for number, (name, nodes) in enumerate(deck.held().items(), 1):
        yield f"/GRNOD/NODE/{number}\n{name}\n" + wrapped(nodes, 10)
        yield f"/BCS/{number}\n{name}\n   {fixed[name]}" + _ids(0, number)
    for part in range(1, _last(deck) + 1):
        for kind in ("GRNOD", "SURF"):
            yield f"/{kind}/PART/{_of(part)}\npart {part}\n" + _ids(part)
    yield f"/GRNOD/PART/{_of(_last(deck) + 1)}\nplies\n" + wrapped([ply.number for ply in deck.plies], 10)


def _body(deck: Deck) -> Iterator[str]:
    nose, u, group = deck.nose, deck.units, _of(_last(deck) + 2)
    J = u.kg * u.m**2 * nose.inertia
    yield f"/GRNOD/NODE/{group}\nmain node of the projectile\n" + _ids(nose.reference)
    yield "/RBODY/1\nprojectile\n" + _ids(nose.reference, 0, 0, 0)[:-1] + _reals(u.kg * nose.mass)[:-1]
    yield _ids(_of(_last(deck)), 0, _ICOG_MAIN, 0) + _reals(J, J, J) + _reals(0, 0, 0) + _ids(0)
    held = "".join(str(int(mirror)) for mirror in deck.mirrors)
    yield f"/BCS/{group}\nprojectile\n   {held}0 111" + _ids(0, group)
    for number, nodes in enumerate((group, _of(_last(deck))), 1):
        yield f"/INIVEL/TRA/{number}\nprojectile\n" + _reals(*u.velocity(nose.velocity))[:-1] + _ids(nodes, 0)
    yield "/TH/RBODY/1\nprojectile\n" + fields("{:<10}", "DEF") + _ids(1)
    yield "/TH/NODE/2\nmotion\n" + fields("{:<10}", "DEF")
    yield "".join(f"{node:10d}{0:10d}{name}\n" for name, node in deck.watched().items())


def _contact(deck: Deck) -> Iterator[str]:
    """(nodes, surface, gap, friction, scale of the stiffness) of each interface."""
    half, places = 0.5 * deck.cards[0].cloth.thickness, [ply.points[0, 2] for ply in deck.plies]
    sides = [(_of(_last(deck) + 1), _of(_last(deck)), half, deck.nose.friction, _STIFF[0])]
    for p, (z, beyond) in enumerate(pairwise(places), 1):
        gap = min(2 * half, _GAP * (beyond - z))
        sides += [(_of(a), _of(b), gap, deck.friction, _STIFF[1]) for a, b in ((p, p + 1), (p + 1, p))]
    for number, (nodes, surface, gap, friction, stiff) in enumerate(sides, 1):
        yield f"/INTER/TYPE7/{number}\ncontact {number}\n" + _ids(nodes, surface, 0, 0, 0, 0, 0, _IDEL, 0, 0)
        yield _reals(0, 0, 0) + _reals(0, 0, 0, 0)[:-1] + _ids(0, 0)  # gap scales;  stiffness bounds
        yield _reals(stiff, friction, deck.units.m * gap, 0, 0)  # Stfac Fric Gapmin Tstart Tstop
        yield f"{'':7}000{'':20}{0:10d}" + _reals(0, 0, 0)  # IBC Inacti VIS_S VIS_F Bumult
        yield _ids(0, 0)[:-1] + _reals(0)[:-1] + _ids(2, 0, 0)[:-1] + _reals(0)[:-1] + _ids(0)  # Iform 2


def _engine(deck: Deck, name: str) -> Iterator[str]:
    s = deck.units.s
    pictures, samples = (s * interval for interval in deck.intervals)
    yield "".join(f"# {line}\n" for line in deck.header)
    yield f"/RUN/{name}/1\n{s * deck.end_time:.9G}\n/VERS/{VERSION}\n/TFILE\n{samples:.9G}\n/PRINT/-100\n"
    yield f"/DT\n{_COURANT} 0\n/ANIM/DT\n0 {pictures:.9G}\n/ANIM/VECT/VEL\n/ANIM/VECT/CONT\n/MON/ON\n"


def _nose(deck):
    """Number of the projectile's material and property."""
    return len(deck.cards) + 1


def _last(deck):
    """Number of the projectile's part."""
    return len(deck.plies) + 1


def _of(part):
    """Number of the group of nodes and of the surface of a part; 1 to 3 are nodes that are held."""
    return 10 + part


def _ids(*numbers):
    return fields("{:10d}", *numbers)


def _reals(*values):
    return fields("{:20.12E}", *values)
