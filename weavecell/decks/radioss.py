"""OpenRadioss starter and engine decks of a panel: /MAT/LAW58 with /PROP/TYPE16.

Block format 2023. Fields, widths and their names as in the Radioss Reference Guide and in the input templates of
OpenRadioss (hm_cfg_files): whole numbers have 10 columns, reals 20. The shells are membranes, with one point through
the thickness; the vector (1, 0, 0) is the ply's first direction, the second is at 90 degrees to it. LAW58 has linear
yarns, and a function of the shear angle in degrees. /FAIL/FABRIC stands as a comment (_NO_FAILURE): without it nothing
breaks.

The projectile is shells in /RBODY, whose mass is that of its main node alone (ICoG 4); it does not turn. Contact is
/INTER/TYPE7, nodes on surface: of all plies on the nose, and of each two neighbouring plies both ways.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from meshing.formats.deck import lines, wrapped
from weavecell.decks.laws import FLEX, CrimpExchange
from weavecell.decks.model import STEEL, Card, Deck

VERSION = 2023
ISHELL = 24
BROKEN = 1.001  # times the strain of failure: of rupture
COURANT = 0.5  # 0.9 becomes unstable once elements are lost
STIFFNESS_OF_NOSE, STIFFNESS_OF_PLIES = 0.03, 1.0  # Stfac: the nose is of steel
GAP = 0.9  # of the distance between plies, so that they do not touch at rest
HELD = {"clamped": "111 111", "mirror_x": "100 011", "mirror_y": "010 101"}
_BLANK = " " * 10
_NO_FAILURE = """\
No failure: for a law with strains of its fibres (LAW58) OpenRadioss as of 2026-08-21
(mulawc.F90, failure model 31) gives /FAIL/FABRIC the strain of the neighbouring element, and to the
first of a group a stress: false failures. To use these lines in a version where that is mended,
take one # away from each of the lines that follow, down to /FUNCT:
"""


def write(deck: Deck, name: str) -> dict[str, str]:
    """{file name: text} of a deck whose laws are CrimpExchange."""
    parts = _head, _materials, _properties, _mesh, _groups, _body, _contact
    starter = "".join(piece for part in parts for piece in part(deck)) + "/END\n"
    return {f"{name}_0000.rad": starter, f"{name}_0001.rad": "".join(_engine(deck, name))}


def card(**fields: float | str) -> str:
    """A line of fields below their names: int of 10 columns, float of 20, texts as they are; names with a leading _ are
    of fields that have none."""
    texts = {name: _field(value) for name, value in fields.items()}
    names = "".join(f"{'' if name.startswith('_') else name:>{len(text)}}" for name, text in texts.items())
    return f"#{names[1:]}".rstrip() + f"\n{''.join(texts.values())}\n"


def _field(value):
    return value if isinstance(value, str) else f"{value:10d}" if isinstance(value, int) else f"{value:20.12E}"


def _head(deck: Deck) -> Iterator[str]:
    units = "".join(f"{name:>20}" for name in (deck.units.mass, deck.units.length, deck.units.time))
    yield "#RADIOSS STARTER\n" + "".join(f"# {line}\n" for line in deck.header)
    yield f"/BEGIN\n{deck.title}\n{VERSION:10d}\n{units}\n{units}\n/TITLE\n{deck.title}\n"


def _materials(deck: Deck) -> Iterator[str]:
    for material in deck.cards:
        yield from _fabric(material, deck)
    density, E, nu = deck.units.density(STEEL[0]), deck.units.stress(STEEL[1]), STEEL[2]
    yield f"/MAT/LAW1/{_nose(deck)}\nprojectile\n" + card(RHO_I=density) + card(E=E, nu=nu)


def _fabric(material: Card, deck: Deck) -> Iterator[str]:
    law, u = material.law, deck.units
    assert isinstance(law, CrimpExchange)
    (E1, E2), G = u.stress(law.E), u.stress(material.cloth.shear.G1)
    yield f"/MAT/LAW58/{material.number}\n{material.name}\n" + card(RHO_I=u.density(material.cloth.density))
    yield card(E1=E1, B1=0.0, E2=E2, B2=0.0, Flex=FLEX) + card(G0=G, GT=G, AlphaT=0.0, Gsh=G)
    yield card(Df=0.0, Ds=0.0, GFROT=0.0)
    yield card(N1=1, N2=1, S1=law.crimp[0], S2=law.crimp[1], FLEX1=FLEX, FLEX2=FLEX)
    yield card(FCT_ID1=0, _1=_BLANK, Fscale1=0.0) + card(FCT_ID2=0, _1=_BLANK, Fscale2=0.0)
    yield card(FCT_ID3=material.number, _1=_BLANK, Fscale3=1.0)
    (f1, f2), (r1, r2) = law.limit, BROKEN * law.limit
    failure = card(EPSILON_F1=f1, EPSILON_R1=r1, EPSILON_F2=f2, EPSILON_R2=r2, _1=_BLANK, NDIR=2) + card(FCT_ID=0.0)
    yield "".join(f"#{line}\n" for line in f"{_NO_FAILURE}/FAIL/FABRIC/{material.number}\n{failure}".splitlines())
    yield f"/FUNCT/{material.number}\n{material.name}, shear\n#{'X':>19}{'Y':>20}\n"
    yield lines("%20.12E%20.12E", law.table[:, 0], u.stress(law.table[:, 1]))


def _properties(deck: Deck) -> Iterator[str]:
    m = deck.units.m
    for material in deck.cards:
        thickness = m * material.cloth.thickness
        yield f"/PROP/TYPE16/{material.number}\n{material.name}\n" + _shell(thickness)
        yield card(Vx=1.0, Vy=0.0, Vz=0.0, Skew_ID=0, Ipos=0)
        yield card(Phi_i=0.0, Alpha_i=90.0, T_i=thickness, Z_i=0.0, mat_IDi=material.number)
    yield f"/PROP/TYPE1/{_nose(deck)}\nprojectile\n" + _shell(m * deck.skin)
    for ply in deck.plies:
        yield f"/PART/{ply.number}\n{ply.name}\n" + card(prop_ID=ply.card.number, mat_ID=ply.card.number)
    yield f"/PART/{len(deck.parts)}\nprojectile\n" + card(prop_ID=_nose(deck), mat_ID=_nose(deck))


def _shell(thickness):
    """Flags, hourglass and damping at their defaults; points and thickness."""
    flags = card(Ishell=ISHELL, Ismstr=0, Ish3n=0) + card(Hm=0.0, Hf=0.0, Hr=0.0, Dm=0.0, Dn=0.0)
    return flags + card(N=1, Istrain=0, Thick=thickness, Ashear=0.0)


def _mesh(deck: Deck) -> Iterator[str]:
    points = deck.points * deck.units.m
    yield "/NODE\n" + lines("%10d%20.12E%20.12E%20.12E", range(1, len(points) + 1), points)
    for number, (part, elements) in enumerate(zip(deck.parts, deck.elements), 1):
        yield f"/SHELL/{number}\n" + lines("%10d" * 5, elements, part.quads)


def _groups(deck: Deck) -> Iterator[str]:
    """Groups of nodes: held ones, then those of each part, and of all plies; a surface of each part."""
    for number, (name, nodes) in enumerate(deck.held().items(), 1):
        yield f"/GRNOD/NODE/{number}\n{name}\n" + wrapped(nodes, 10) + _held(number, name, HELD[name])
    last = len(deck.parts)
    for part in range(1, last + 1):
        for kind in ("GRNOD", "SURF"):
            yield f"/{kind}/PART/{_group(part)}\npart {part}\n" + card(part_ID=part)
    yield f"/GRNOD/PART/{_group(last + 1)}\nplies\n" + wrapped([ply.number for ply in deck.plies], 10)


def _held(group, name, directions):
    """Boundary condition of a group of nodes: directions such as "100 011" of translation and rotation."""
    return f"/BCS/{group}\n{name}\n" + card(Tra_rot=f"   {directions}", skew_ID=0, grnod_ID=group)


def _body(deck: Deck) -> Iterator[str]:
    nose, u, last = deck.nose, deck.units, len(deck.parts)
    surface, main = _group(last), _group(last + 2)
    J, mass = u.kg * u.m**2 * nose.inertia, u.kg * nose.mass
    yield f"/GRNOD/NODE/{main}\nmain node of the projectile\n" + card(node_ID=nose.reference) + "/RBODY/1\nprojectile\n"
    yield card(
        node_ID=nose.reference, sens_ID=0, skew_ID=0, Ispher=0, Mass=mass, grnd_ID=surface, Ikrem=0, ICoG=4, surf_ID=0
    )
    yield card(Jxx=J, Jyy=J, Jzz=J) + card(Jxy=0.0, Jyz=0.0, Jxz=0.0) + card(Ioptoff=0)
    yield _held(main, "projectile", "{:d}{:d}0 111".format(*deck.mirrors))
    vx, vy, vz = u.velocity(nose.velocity)
    for number, nodes in enumerate((main, surface), 1):
        yield f"/INIVEL/TRA/{number}\nprojectile\n" + card(Vx=vx, Vy=vy, Vz=vz, Gnod_id=nodes, Skew_id=0)
    yield f"/TH/RBODY/1\nprojectile\n{'DEF':<10}\n{1:10d}\n/TH/NODE/2\nmotion\n{'DEF':<10}\n"
    yield "".join(f"{node:10d}{0:10d}{name}\n" for name, node in deck.watched().items())


def _contact(deck: Deck) -> Iterator[str]:
    thickness, places = deck.cards[0].cloth.thickness, [ply.points[0, 2] for ply in deck.plies]
    last = len(deck.parts)
    sides = [(_group(last + 1), _group(last), 0.5 * thickness, deck.nose.friction, STIFFNESS_OF_NOSE)]
    for p, (z, beyond) in enumerate(pairwise(places), 1):
        pair, gap = (_group(p), _group(p + 1)), min(thickness, GAP * (beyond - z))
        sides += [(*groups, gap, deck.friction, STIFFNESS_OF_PLIES) for groups in (pair, pair[::-1])]
    for number, (nodes, surface, gap, friction, stiff) in enumerate(sides, 1):
        yield f"/INTER/TYPE7/{number}\ncontact {number}\n"
        yield card(grnd_IDs=nodes, surf_IDm=surface, Istf=0, Ithe=0, Igap=0, Multimp=0, Ibag=0, Idel=2, Icurv=0, Iadm=0)
        yield card(Fscalegap=0.0, Gap_max=0.0, Fpenmax=0.0)
        yield card(Stmin=0.0, Stmax=0.0, mesh_size=0.0, dtmin=0.0, Irem_gap=0, Irem_i2=0)
        yield card(Stfac=stiff, Fric=friction, Gapmin=deck.units.m * gap, Tstart=0.0, Tstop=0.0)
        yield card(IBC="       000", _1=2 * _BLANK, Inacti=0, VIS_S=0.0, VIS_F=0.0, Bumult=0.0)
        yield card(Ifric=0, Ifiltr=0, Xfreq=0.0, Iform=2, sens_ID=0, fct_IDF=0, AscaleF=0.0, fric_ID=0)


def _engine(deck: Deck, name: str) -> Iterator[str]:
    s = deck.units.s
    pictures, samples = (s * interval for interval in deck.intervals)
    yield "".join(f"# {line}\n" for line in deck.header)
    yield f"/RUN/{name}/1\n{s * deck.end_time:.9G}\n/VERS/{VERSION}\n/TFILE\n{samples:.9G}\n/PRINT/-100\n"
    yield f"/DT\n{COURANT} 0\n/ANIM/DT\n0 {pictures:.9G}\n/ANIM/VECT/VEL\n/ANIM/VECT/CONT\n/MON/ON\n"


def _nose(deck):
    """Number of the projectile's material and property."""
    return len(deck.cards) + 1


def _group(part):
    """Number of the group of nodes and of the surface of a part; 1 to 3 are nodes that are held."""
    return 10 + part
