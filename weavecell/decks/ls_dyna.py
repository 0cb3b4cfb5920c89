"""LS-DYNA keyword deck of a panel: *MAT_FABRIC (034) FORM 14 on fully integrated membranes (ELFORM
9).

Cards, fields and widths as in the LS-DYNA Keyword User's Manual, volumes I and II (R11 to R16):
columns of 10, nodes of 8 and 16, elements of 8, points of curves of 20 characters; the names of the
fields stand above each card. The curves of the fibres have DATTYP -2, which the manual has for
stress-strain curves of *MAT_FABRIC: here nominal stress against engineering strain; that of shear
has the shear angle [rad]. AOPT 2 with the vector (1, 0, 0) is the ply's first direction.
Compression is eliminated (CSE 1).

The projectile is *MAT_RIGID with the mass, position and velocity of *PART_INERTIA; it does not turn.
Contact by soft constraint (SOFT 1): of the nose with the plies, and of the plies among themselves.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from weavecell.decks.cards import card, numbers, table
from weavecell.decks.laws import UncoupledCurves
from weavecell.decks.model import STEEL, Card, Deck

NAME = "LS-DYNA"
LAW = UncoupledCurves
KEYWORD = "*MAT_FABRIC (034), FORM 14"
# ELFORM of a membrane
MEMBRANE = 9
# ELFORM of a shell
SHELL = 2
_MARK = "$#"
_COURANT = 0.9
# CON1: what is held of x and y
_PLANES = {(False, False): 0, (True, False): 1, (False, True): 2, (True, True): 4}


def names(name: str) -> list[str]:
    """Return the names of the files of a deck."""
    return [f"{name}.k"]


def write(deck: Deck, name: str) -> dict[str, str]:
    """Write a deck whose laws are UncoupledCurves: {file name: text}."""
    parts = _control, _mesh, _parts, _materials, _boundary, _contact
    (file,) = names(name)
    return {file: "".join(piece for part in parts for piece in part(deck)) + "*END\n"}


def _control(deck: Deck) -> Iterator[str]:
    s = deck.units.s
    pictures, samples = deck.intervals
    # a reader may take a comma for free format
    title = deck.title.replace(",", "")
    yield "*KEYWORD\n" + "".join(f"$ {line}\n" for line in deck.header) + f"*TITLE\n{title}\n"
    yield "*CONTROL_TERMINATION\n" + _card(
        ENDTIM=s * deck.end_time, ENDCYC=0, DTMIN=0.0, ENDENG=0.0, ENDMAS=0.0
    )
    yield "*CONTROL_TIMESTEP\n" + _card(DTINIT=0.0, TSSFAC=_COURANT)
    yield "*CONTROL_ENERGY\n" + _card(HGEN=2, RWEN=2, SLNTEN=2, RYLEN=1)
    for database in ("GLSTAT", "MATSUM", "RCFORC", "RBDOUT"):
        yield f"*DATABASE_{database}\n" + _card(DT=s * samples)
    yield "*DATABASE_BINARY_D3PLOT\n" + _card(DT=s * pictures)


def _mesh(deck: Deck) -> Iterator[str]:
    points = deck.points * deck.units.m
    yield "*NODE\n" + table(
        _MARK, "%8d%16.9E%16.9E%16.9E", "NID X Y Z", range(1, len(points) + 1), points
    )
    yield "*ELEMENT_SHELL\n" + table(_MARK, "%8d" * 6, "EID PID N1 N2 N3 N4", deck.shells)


def _parts(deck: Deck) -> Iterator[str]:
    u = deck.units
    nose = deck.nose
    for material in deck.cards:
        yield f"*SECTION_SHELL_TITLE\nmembrane of {material.name}\n"
        yield _card(SECID=material.number, ELFORM=MEMBRANE, SHRF=1.0, NIP=1)
        yield _thickness(u.m * material.fabric.thickness)
    yield "*SECTION_SHELL_TITLE\nsurface of the projectile\n"
    yield _card(SECID=deck.nose_card, ELFORM=SHELL, SHRF=1.0, NIP=2) + _thickness(u.m * deck.skin)
    for ply in deck.plies:
        yield f"*PART\n{ply.name}\n" + _card(
            PID=ply.number, SECID=ply.card.number, MID=ply.card.number
        )
    yield "*PART_INERTIA\nprojectile\n" + _card(
        PID=deck.nose_part, SECID=deck.nose_card, MID=deck.nose_card
    )
    x, y, z = u.m * nose.centre
    vx, vy, vz = u.velocity(nose.velocity)
    J = u.kg * u.m**2 * nose.inertia
    yield _card(XC=x, YC=y, ZC=z, TM=u.kg * nose.mass, IRCS=0, NODEID=nose.reference)
    yield _card(IXX=J, IXY=0.0, IXZ=0.0, IYY=J, IYZ=0.0, IZZ=J)
    yield _card(VTX=vx, VTY=vy, VTZ=vz, VRX=0.0, VRY=0.0, VRZ=0.0)
    yield "*SET_PART_LIST_TITLE\nplies\n" + _card(SID=1)
    yield numbers(_MARK, "PID", [ply.number for ply in deck.plies], 8)


def _materials(deck: Deck) -> Iterator[str]:
    for material in deck.cards:
        yield from _fabric(material, deck)
    u = deck.units
    density, E, nu = STEEL
    yield "*MAT_RIGID_TITLE\nprojectile\n" + _card(
        MID=deck.nose_card, RO=u.density(density), E=u.stress(E), PR=nu
    )
    yield _card(CMO=1.0, CON1=_PLANES[deck.mirrors], CON2=7)
    yield _card(LCO=0, A2=0.0, A3=0.0, V1=0.0, V2=0.0, V3=0.0)


def _fabric(material: Card, deck: Deck) -> Iterator[str]:
    """The material, and its curves: 3 n - 2 of the warp, 3 n - 1 of the weft, 3 n of shear."""
    law = material.law
    u = deck.units
    fabric = material.fabric
    assert isinstance(law, UncoupledCurves)
    shear = 3 * material.number
    warp = shear - 2
    weft = shear - 1
    # the steepest part of a curve stands for the modulus, from which the time step follows
    EA, EB = (u.stress(np.max(np.diff(curve[:, 1]) / np.diff(curve[:, 0]))) for curve in law.curves)
    yield f"*MAT_FABRIC_TITLE\n{material.name}\n"
    yield _card(
        MID=material.number, RO=u.density(fabric.density), EA=EA, EB=EB, _=None, PRBA=0.0, PRAB=0.0
    )
    yield _card(
        GAB=u.stress(fabric.shear.G1),
        _1=None,
        _2=None,
        CSE=1.0,
        EL=0.0,
        PRL=0.0,
        LRATIO=0.0,
        DAMP=0.0,
    )
    yield _card(AOPT=2.0, FLC=0.0, FAC=0.0, ELA=0.0, LNRC=0.0, FORM=14.0, FVOPT=0.0, TSRFAC=0.0)
    yield _card(_=None, RGBRTH=0.0, A0REF=0.0, A1=1.0, A2=0.0, A3=0.0, X0=0.0, X1=0.0)
    yield _card(V1=0.0, V2=0.0, V3=0.0, _1=None, _2=None, _3=None, BETA=0.0, ISREFG=0)
    yield _card(LCA=warp, LCB=weft, LCAB=shear, LCUA=0, LCUB=0, LCUAB=0, RL=0.0)
    yield "$ Nominal stress, engineering strain; shear: angle. Check this on one element\n"
    curves = (
        (warp, "warp", law.curves[0], -2),
        (weft, "weft", law.curves[1], -2),
        (shear, "shear", law.trellis, 0),
    )
    for number, name, curve, kind in curves:
        yield f"*DEFINE_CURVE_TITLE\n{material.name} {name}\n"
        yield _card(LCID=number, SIDR=0, SFA=1.0, SFO=1.0, OFFA=0.0, OFFO=0.0, DATTYP=kind)
        yield table(_MARK, "%20.12E%20.12E", "A1 O1", curve[:, 0], u.stress(curve[:, 1]))


def _boundary(deck: Deck) -> Iterator[str]:
    names = "DOFX", "DOFY", "DOFZ", "DOFRX", "DOFRY", "DOFRZ"
    fixed = {"clamped": (1,) * 6, "mirror_x": (1, 0, 0, 0, 1, 1), "mirror_y": (0, 1, 0, 1, 0, 1)}
    for number, (name, nodes) in enumerate(deck.list_held_nodes().items(), 1):
        yield (
            f"*SET_NODE_LIST_TITLE\n{name}\n" + _card(SID=number) + numbers(_MARK, "NID", nodes, 8)
        )
        yield "*BOUNDARY_SPC_SET\n" + _card(NSID=number, CID=0, **dict(zip(names, fixed[name])))


def _contact(deck: Deck) -> Iterator[str]:
    part_set = 2
    part = 3
    sides = {"SSID": 1, "MSID": deck.nose_part, "SSTYP": part_set, "MSTYP": part}
    # one contact for the nose, whose friction may differ from that of plies on each other
    contacts = [("SURFACE_TO_SURFACE", sides, deck.nose.friction)]
    if len(deck.plies) > 1:
        contacts.append(("SINGLE_SURFACE", sides | {"MSID": 0, "MSTYP": 0}, deck.friction))
    for kind, sides, friction in contacts:
        yield f"*CONTACT_AUTOMATIC_{kind}\n" + _card(**sides, SBOXID=0, MBOXID=0, SPR=0, MPR=0)
        yield _card(FS=friction, FD=friction, DC=0.0, VC=0.0, VDC=0.0, PENCHK=0)
        yield _card(SFS=0.0, SFM=0.0, SST=0.0, MST=0.0, SFST=0.0, SFMT=0.0, FSF=0.0, VSF=0.0)
        # the stiffness follows from masses and the step: steel and fabric differ too much in modulus
        yield _card(SOFT=1)


def _thickness(value):
    return _card(T1=value, T2=value, T3=value, T4=value)


def _card(**fields: Any) -> str:
    """A card of fields of 10 columns: whole numbers, reals, None for an empty one."""
    return card(_MARK, {name: _text(value) for name, value in fields.items()})


def _text(value):
    if value is None:
        return " " * 10
    if isinstance(value, (int, np.integer)):
        return f"{value:10d}"
    # a field has ten columns: three decimals fit beside a sign and an exponent
    if value:
        return f"{value:10.3E}"
    return f"{0.0:10.1f}"
