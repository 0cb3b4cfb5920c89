"""Abaqus/Explicit input file of a panel: *FABRIC from test data on membranes M3D4R.

Keywords, parameters and data lines as in the Abaqus Keywords Guide and the Analysis User's Guide, Fabric material
behavior: nominal stress, then nominal strain along each yarn; shear against the change of the angle between the
yarns [rad]. COMPONENT=1 is the fill, here the ply's second direction (its weft, along y), COMPONENT=2 the warp, along
x: the orientation is turned by a right angle. The curves of the yarns begin at negative strain, without which Abaqus
would take them to be symmetric; that of shear is symmetric. No data are regularised, and their ends are extrapolated
linearly.

The projectile is a rigid body of R3D4 and R3D3 with a point mass; it does not turn. Contact is general contact.
"""

from __future__ import annotations

from collections.abc import Iterator

from meshing.formats.deck import lines, wrapped
from weavecell.analysis.material_card.laws import UncoupledCurves
from weavecell.results.deck import Card, Deck

SUFFIX = ".inp"
_SLACK = -0.9  # strain to which the yarns carry nothing


def write(deck: Deck, name: str) -> dict[str, str]:
    """{file name: text} of a deck whose laws are UncoupledCurves."""
    parts = _mesh, _materials, _model, _step
    head = "".join(f"** {line}\n" for line in deck.header) + f"*HEADING\n{deck.title}\n"
    return {f"{name}{SUFFIX}": head + "".join(piece for part in parts for piece in part(deck))}


def _mesh(deck: Deck) -> Iterator[str]:
    points, nose = deck.points * deck.units.m, deck.nose
    yield "*NODE\n" + lines("%d,%.12E,%.12E,%.12E", range(1, len(points) + 1), points)
    for ply, numbers in zip(deck.plies, deck.elements):
        yield f"*ELEMENT, TYPE=M3D4R, ELSET={_of(ply)}\n" + lines("%d" + ",%d" * 4, numbers, ply.quads)
    yield "*ELEMENT, TYPE=R3D4, ELSET=NOSE\n" + lines("%d" + ",%d" * 4, deck.elements[-2], nose.quads)
    yield "*ELEMENT, TYPE=R3D3, ELSET=NOSE\n" + lines("%d" + ",%d" * 3, deck.elements[-1], nose.triangles)
    yield f"*ELEMENT, TYPE=MASS, ELSET=NOSE_MASS\n{deck.elements[-1][-1] + 1},{nose.reference}\n"
    yield f"*MASS, ELSET=NOSE_MASS\n{deck.units.kg * nose.mass:.12E}\n"
    yield f"*NSET, NSET=REFERENCE\n{nose.reference}\n"
    for name, nodes in deck.held().items():
        yield f"*NSET, NSET={name.upper()}\n" + wrapped(nodes, 8, "%d", ",")


def _materials(deck: Deck) -> Iterator[str]:
    yield "*ORIENTATION, NAME=YARNS, SYSTEM=RECTANGULAR\n0.,1.,0.,-1.,0.,0.\n3,0.\n"
    for ply in deck.plies:
        yield f"*MEMBRANE SECTION, ELSET={_of(ply)}, MATERIAL=FABRIC_{ply.card.number}, ORIENTATION=YARNS\n"
        yield f"{deck.units.m * ply.card.cloth.thickness:.12E}\n"
    for card in deck.cards:
        yield from _fabric(card, deck)


def _fabric(card: Card, deck: Deck) -> Iterator[str]:
    law, u = card.law, deck.units
    assert isinstance(law, UncoupledCurves)
    yield f"** {card.name}\n*MATERIAL, NAME=FABRIC_{card.number}\n*DENSITY\n{u.density(card.cloth.density):.12E}\n"
    yield "*FABRIC\n"
    for component, curve in (("1", law.curves[1]), ("2", law.curves[0]), ("SHEAR", law.trellis)):
        yield f"*UNIAXIAL, COMPONENT={component}\n"
        yield "*LOADING DATA, TYPE=ELASTIC, EXTRAPOLATION=LINEAR, REGULARIZE=OFF\n"
        if component != "SHEAR":
            yield f"0.,{_SLACK}\n"
        yield lines("%.12E,%.12E", u.stress(curve[:, 1]), curve[:, 0])


def _model(deck: Deck) -> Iterator[str]:
    yield "*RIGID BODY, ELSET=NOSE, REF NODE=REFERENCE\n"
    fixed = {"clamped": "1,3", "mirror_x": "1,1", "mirror_y": "2,2"}
    yield "*BOUNDARY\n" + "".join(f"{name.upper()},{fixed[name]}\n" for name in deck.held()) + "REFERENCE,4,6\n"
    yield "".join(f"REFERENCE,{axis},{axis}\n" for axis, mirror in enumerate(deck.mirrors, 1) if mirror)
    speeds = enumerate(deck.units.velocity(deck.nose.velocity), 1)
    yield "*INITIAL CONDITIONS, TYPE=VELOCITY\n"
    yield "".join(f"REFERENCE,{axis},{speed:.12E}\n" for axis, speed in speeds)
    yield "*SURFACE, TYPE=ELEMENT, NAME=PLIES\n" + "".join(f"{_of(ply)},\n" for ply in deck.plies)
    yield "*SURFACE, TYPE=ELEMENT, NAME=PROJECTILE\nNOSE,\n"
    for name, friction in (("PLY_PLY", deck.friction), ("NOSE_PLY", deck.nose.friction)):
        yield f"*SURFACE INTERACTION, NAME={name}\n*FRICTION\n{friction:.6E}\n"
    yield "*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n"
    yield "*CONTACT PROPERTY ASSIGNMENT\n,,PLY_PLY\nPLIES,PROJECTILE,NOSE_PLY\n"


def _step(deck: Deck) -> Iterator[str]:
    s = deck.units.s
    pictures, samples = (s * interval for interval in deck.intervals)
    yield f"*STEP\n*DYNAMIC, EXPLICIT\n,{s * deck.end_time:.12E}\n"
    yield f"*OUTPUT, FIELD, TIME INTERVAL={pictures:.9E}\n*NODE OUTPUT\nU,V\n*ELEMENT OUTPUT\nS,LE\n"
    yield f"*OUTPUT, HISTORY, TIME INTERVAL={samples:.9E}\n*NODE OUTPUT, NSET=REFERENCE\nU3,V3\n"
    yield "*ENERGY OUTPUT\nALLKE,ALLIE,ALLFD,ETOTAL\n*END STEP\n"


def _of(ply):
    """Name of a ply's elements."""
    return f"PLY_{ply.number}"
