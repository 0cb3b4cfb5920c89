"""LS-DYNA keyword deck of a panel: *MAT_FABRIC (034) FORM 14 on fully integrated membranes (ELFORM 9).

Cards, fields and widths as in the LS-DYNA Keyword User's Manual, volumes I and II (R11 to R16), with the manual's names
above the values. The curves of the fibres have DATTYP -2, which the manual has for stress-strain curves of *MAT_FABRIC:
here nominal stress against engineering strain; that of shear has the shear angle [rad]. AOPT 2 with the vector
(1, 0, 0) is the ply's first direction. Compression is eliminated (CSE 1).

The projectile is *MAT_RIGID with the mass, place and velocity of *PART_INERTIA; it does not turn. Contact by soft
constraint (SOFT 1): of the nose with the plies, and of the plies among themselves.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from meshing.formats.deck import lines, wrapped
from weavecell.decks.laws import UncoupledCurves
from weavecell.decks.model import STEEL, Card, Deck

MEMBRANE, SHELL = 9, 2  # ELFORM
PLIES = 1  # number of the set of parts
CONSTRAINED = {(False, False): 0, (True, False): 1, (False, True): 2, (True, True): 4}  # CON1: what is held of x and y
HELD = {"clamped": (1,) * 6, "mirror_x": (1, 0, 0, 0, 1, 1), "mirror_y": (0, 1, 0, 1, 0, 1)}  # DOFX ... DOFRZ


def write(deck: Deck, name: str) -> dict[str, str]:
    """{file name: text} of a deck whose laws are UncoupledCurves."""
    parts = _control, _mesh, _parts, _materials, _boundary, _contact
    return {f"{name}.k": "".join(piece for part in parts for piece in part(deck)) + "*END\n"}


def card(**fields: float | str) -> str:
    """A card of fields of 10 characters below their names; names with a leading _ are of fields that have none."""
    names = "".join(f"{'' if name.startswith('_') else name:>10}" for name in fields)
    return f"$#{names[2:]}\n{''.join(map(_field, fields.values()))}\n"


def _field(value):
    if isinstance(value, (int, np.integer)):
        return f"{value:10d}"
    return f"{value:>10}" if isinstance(value, str) else f"{value:10.3E}" if value else f"{value:10.1f}"


def _control(deck: Deck) -> Iterator[str]:
    s = deck.units.s
    pictures, samples = (s * interval for interval in deck.intervals)
    yield "*KEYWORD\n" + "".join(f"$ {line}\n" for line in deck.header) + f"*TITLE\n{deck.title}\n"
    yield "*CONTROL_TERMINATION\n" + card(ENDTIM=s * deck.end_time, ENDCYC=0, DTMIN=0.0, ENDENG=0.0, ENDMAS=0.0)
    yield "*CONTROL_TIMESTEP\n" + card(DTINIT=0.0, TSSFAC=0.9)
    yield "*CONTROL_ENERGY\n" + card(HGEN=2, RWEN=2, SLNTEN=2, RYLEN=1)
    for table in ("GLSTAT", "MATSUM", "RCFORC", "RBDOUT"):
        yield f"*DATABASE_{table}\n" + card(DT=samples)
    yield "*DATABASE_BINARY_D3PLOT\n" + card(DT=pictures)


def _mesh(deck: Deck) -> Iterator[str]:
    points = deck.points * deck.units.m
    yield "*NODE\n$#   NID               X               Y               Z\n"
    yield lines("%8d%16.9E%16.9E%16.9E", range(1, len(points) + 1), points)
    yield "*ELEMENT_SHELL\n$#   EID     PID      N1      N2      N3      N4\n"
    for number, (part, elements) in enumerate(zip(deck.parts, deck.elements), 1):
        yield lines(f"%8d{number:8d}" + "%8d" * 4, elements, part.quads)


def _parts(deck: Deck) -> Iterator[str]:
    m, kg, nose, steel = deck.units.m, deck.units.kg, deck.nose, len(deck.cards) + 1
    sections = [(of.number, f"membrane of {of.name}", MEMBRANE, 1, of.cloth.thickness) for of in deck.cards]
    sections.append((steel, "surface of the projectile", SHELL, 2, deck.skin))
    for number, title, form, points, thickness in sections:
        yield f"*SECTION_SHELL_TITLE\n{title}\n" + card(SECID=number, ELFORM=form, SHRF=1.0, NIP=points)
        yield card(T1=m * thickness, T2=m * thickness, T3=m * thickness, T4=m * thickness)
    for ply in deck.plies:
        yield f"*PART\n{ply.name}\n" + card(PID=ply.number, SECID=ply.card.number, MID=ply.card.number)
    yield "*PART_INERTIA\nprojectile\n" + card(PID=len(deck.parts), SECID=steel, MID=steel)
    x, y, z = m * nose.centre
    yield card(XC=x, YC=y, ZC=z, TM=kg * nose.mass, IRCS=0, NODEID=nose.reference)
    J = kg * m**2 * nose.inertia
    yield card(IXX=J, IXY=0.0, IXZ=0.0, IYY=J, IYZ=0.0, IZZ=J)
    vx, vy, vz = deck.units.velocity(nose.velocity)
    yield card(VTX=vx, VTY=vy, VTZ=vz, VRX=0.0, VRY=0.0, VRZ=0.0)
    yield "*SET_PART_LIST_TITLE\nplies\n" + card(SID=PLIES) + wrapped([ply.number for ply in deck.plies], 8)


def _materials(deck: Deck) -> Iterator[str]:
    for material in deck.cards:
        yield from _fabric(material, deck)
    density, E, nu = deck.units.density(STEEL[0]), deck.units.stress(STEEL[1]), STEEL[2]
    yield "*MAT_RIGID_TITLE\nprojectile\n" + card(MID=len(deck.cards) + 1, RO=density, E=E, PR=nu)
    yield card(CMO=1.0, CON1=CONSTRAINED[deck.mirrors], CON2=7)
    yield card(LCO=0, A2=0.0, A3=0.0, V1=0.0, V2=0.0, V3=0.0)


def _fabric(material: Card, deck: Deck) -> Iterator[str]:
    """The material, and its curves: 3 n - 2 of the warp, 3 n - 1 of the weft, 3 n of shear."""
    law, u, cloth = material.law, deck.units, material.cloth
    assert isinstance(law, UncoupledCurves)
    warp, weft, shear = (3 * material.number - k for k in (2, 1, 0))
    EA, EB = (u.stress(np.max(np.diff(curve[:, 1]) / np.diff(curve[:, 0]))) for curve in law.curves)
    yield f"*MAT_FABRIC_TITLE\n{material.name}\n"
    yield card(MID=material.number, RO=u.density(cloth.density), EA=EA, EB=EB, _EC="", PRBA=0.0, PRAB=0.0)
    yield card(GAB=u.stress(cloth.shear.G1), _GBC="", _GCA="", CSE=1.0, EL=0.0, PRL=0.0, LRATIO=0.0, DAMP=0.0)
    yield card(AOPT=2.0, FLC=0.0, FAC=0.0, ELA=0.0, LNRC=0.0, FORM=14.0, FVOPT=0.0, TSRFAC=0.0)
    yield card(_1="", RGBRTH=0.0, A0REF=0.0, A1=1.0, A2=0.0, A3=0.0, X0=0.0, X1=0.0)
    yield card(V1=0.0, V2=0.0, V3=0.0, _1="", _2="", _3="", BETA=0.0, ISREFG=0)
    yield card(LCA=warp, LCB=weft, LCAB=shear, LCUA=0, LCUB=0, LCUAB=0, RL=0.0)
    yield "$ Nominal stress, engineering strain; shear: angle. Check this on one element\n"
    curves = (warp, "warp", law.curves[0], -2), (weft, "weft", law.curves[1], -2), (shear, "shear", law.trellis, 0)
    for number, name, curve, kind in curves:
        yield f"*DEFINE_CURVE_TITLE\n{material.name}, {name}\n"
        yield card(LCID=number, SIDR=0, SFA=1.0, SFO=1.0, OFFA=0.0, OFFO=0.0, DATTYP=kind)
        yield f"$#{'A1':>18}{'O1':>20}\n" + lines("%20.12E%20.12E", curve[:, 0], u.stress(curve[:, 1]))


def _boundary(deck: Deck) -> Iterator[str]:
    for number, (name, nodes) in enumerate(deck.held().items(), 1):
        x, y, z, rx, ry, rz = HELD[name]
        yield f"*SET_NODE_LIST_TITLE\n{name}\n" + card(SID=number) + wrapped(nodes, 8) + "*BOUNDARY_SPC_SET\n"
        yield card(NSID=number, CID=0, DOFX=x, DOFY=y, DOFZ=z, DOFRX=rx, DOFRY=ry, DOFRZ=rz)


def _contact(deck: Deck) -> Iterator[str]:
    part_set, part = 2, 3  # SSTYP, MSTYP
    contacts = [("SURFACE_TO_SURFACE", len(deck.parts), part, deck.nose.friction)]
    if len(deck.plies) > 1:
        contacts.append(("SINGLE_SURFACE", 0, 0, deck.friction))
    for kind, number, of, friction in contacts:
        yield f"*CONTACT_AUTOMATIC_{kind}\n"
        yield card(SSID=PLIES, MSID=number, SSTYP=part_set, MSTYP=of, SBOXID=0, MBOXID=0, SPR=0, MPR=0)
        yield card(FS=friction, FD=friction, DC=0.0, VC=0.0, VDC=0.0, PENCHK=0)
        yield card(SFS=0.0, SFM=0.0, SST=0.0, MST=0.0, SFST=0.0, SFMT=0.0, FSF=0.0, VSF=0.0) + card(SOFT=1)
