"""OpenRadioss starter and engine decks of a panel: /MAT/LAW58 with /PROP/TYPE16.

Block format 2023. Fields and widths as in the Radioss Reference Guide and in the input templates of
OpenRadioss (hm_cfg_files): whole numbers in columns of 10, reals of 20 characters; the names of the
fields stand above each card.
The shells are membranes, with one point through the thickness; the vector (1, 0, 0) is the ply's
first direction, the second is at 90 degrees to it. LAW58 has linear yarns, and a function of the
shear angle in degrees. /FAIL/FABRIC stands as a comment (_NO_FAILURE): without it nothing breaks.

The projectile is shells in /RBODY, whose mass is that of its main node alone (ICoG 4); it does not
turn. Contact is /INTER/TYPE7, nodes on surface: of all plies on the nose, and of each two
neighbouring plies both ways.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

from weavecell.decks.cards import card, numbers, table
from weavecell.decks.laws import FLEX, CrimpExchange
from weavecell.decks.model import STEEL, Card, Deck

NAME = "OpenRadioss"
LAW = CrimpExchange
KEYWORD = "/MAT/LAW58 (FABR_A)"
VERSION = 2023
_MARK = "#"
# Ishell of the element
_QEPH = 24
# rupture comes just after the strain of failure, so that one criterion decides
_BROKEN = 1.001
# with 0.9 runs become unstable once elements are deleted
_COURANT = 0.5
# Stfac: scale of the contact stiffness of the steel nose
_STIFF_NOSE = 0.03
# Stfac of the contact between plies
_STIFF_PLIES = 1.0
_NO_FAILURE = (
    "No failure: for a law with strains of its fibres (LAW58) OpenRadioss of 2026-08-21",
    "(mulawc.F90, failure model 31) gives /FAIL/FABRIC the strain of the neighbouring element, and to the",
    "first of a group a stress: false failures. To use these lines in a version that corrects this,",
    "take the # away from the three that follow:",
)
# share of the distance between plies, so that they do not touch at rest
_GAP = 0.9


def names(name: str) -> list[str]:
    """Return the names of the files of a deck: of the starter, and of the engine."""
    return [f"{name}_0000.rad", f"{name}_0001.rad"]


def write(deck: Deck, name: str) -> dict[str, str]:
    """Write a deck whose laws are CrimpExchange: {file name: text}."""
    parts = _head, _materials, _properties, _mesh, _groups, _body, _contact
    starter = "".join(piece for part in parts for piece in part(deck)) + "/END\n"
    return dict(zip(names(name), (starter, "".join(_engine(deck, name)))))


def _head(deck: Deck) -> Iterator[str]:
    u = deck.units
    units = {"MUNIT": f"{u.mass:>20}", "LUNIT": f"{u.length:>20}", "TUNIT": f"{u.time:>20}"}
    yield "#RADIOSS STARTER\n" + "".join(f"# {line}\n" for line in deck.header)
    yield f"/BEGIN\n{deck.title}\n" + _card(Invers=VERSION) + 2 * card(_MARK, units)
    yield f"/TITLE\n{deck.title}\n"


def _materials(deck: Deck) -> Iterator[str]:
    for material in deck.cards:
        yield from _fabric(material, deck)
    density, E, nu = STEEL
    yield f"/MAT/LAW1/{deck.nose_card}\nprojectile\n"
    yield _card(RHO_I=deck.units.density(density)) + _card(E=deck.units.stress(E), nu=nu)


def _fabric(material: Card, deck: Deck) -> Iterator[str]:
    law = material.law
    u = deck.units
    number = material.number
    assert isinstance(law, CrimpExchange)
    E1, E2 = u.stress(law.E)
    S1, S2 = law.crimp
    G = u.stress(material.fabric.shear.G1)
    yield f"/MAT/LAW58/{number}\n{material.name}\n" + _card(
        RHO_I=u.density(material.fabric.density)
    )
    yield _card(E1=E1, B1=0.0, E2=E2, B2=0.0, FLEX=FLEX)
    yield _card(G0=G, GT=G, AlphaT=0.0, Gsh=G)
    yield _card(Df=0.0, Ds=0.0, GFROT=0.0)
    yield _card(N1=1, N2=1, S1=S1, S2=S2, FLEX1=FLEX, FLEX2=FLEX)
    yield _card(fct_ID1=0, _=None, Fscale1=0.0)
    yield _card(fct_ID2=0, _=None, Fscale2=0.0)
    yield _card(fct_ID3=number, _=None, Fscale3=1.0)
    # written as comments: OpenRadioss takes one of these strains for a stress (`_NO_FAILURE`)
    start1, start2 = law.limit
    end1, end2 = _BROKEN * law.limit
    strains = _card(
        Eps_f1=start1, Eps_r1=end1, Eps_f2=start2, Eps_r2=end2, _=None, Ndir=2
    ).splitlines()[1]
    for line in (*_NO_FAILURE, f"/FAIL/FABRIC/{number}", strains, f"{0:20.12E}"):
        yield f"#{line}\n"
    # the trellis law is a curve of its own, in the unit of stress of the deck
    yield f"/FUNCT/{number}\n{material.name}, shear\n"
    yield table(_MARK, "%20.12E%20.12E", "X Y", law.table[:, 0], u.stress(law.table[:, 1]))


def _properties(deck: Deck) -> Iterator[str]:
    m = deck.units.m
    # OpenRadioss reads dn = 0 as its default of 1.5 % of critical damping, whose work is in no
    # energy
    hourglass = _card(hm=0.0, hf=0.0, hr=0.0, dm=0.0, dn=1e-9)
    flags = _card(Ishell=_QEPH, Ismstr=0, Ish3n=0) + hourglass
    for material in deck.cards:
        thickness = m * material.fabric.thickness
        yield f"/PROP/TYPE16/{material.number}\n{material.name}\n" + flags
        yield _card(N=1, Istrain=0, Thick=thickness, Ashear=0.0)
        yield _card(Vx=1.0, Vy=0.0, Vz=0.0, skew_ID=0, Iorth=0)
        yield _card(Phi=0.0, Alpha=90.0, T=thickness, Z=0.0, mat_ID=material.number)
    yield f"/PROP/TYPE1/{deck.nose_card}\nprojectile\n" + flags
    yield _card(N=1, Istrain=0, Thick=m * deck.skin, Ashear=0.0)
    for ply in deck.plies:
        yield f"/PART/{ply.number}\n{ply.name}\n" + _card(
            prop_ID=ply.card.number, mat_ID=ply.card.number
        )
    yield f"/PART/{deck.nose_part}\nprojectile\n" + _card(
        prop_ID=deck.nose_card, mat_ID=deck.nose_card
    )


def _mesh(deck: Deck) -> Iterator[str]:
    points = deck.points * deck.units.m
    yield "/NODE\n" + table(
        _MARK, "%10d%20.12E%20.12E%20.12E", "node_ID X Y Z", range(1, len(points) + 1), points
    )
    names = "shell_ID node_ID1 node_ID2 node_ID3 node_ID4"
    for part in range(1, deck.nose_part + 1):
        own = deck.shells[deck.shells[:, 1] == part]
        yield f"/SHELL/{part}\n" + table(_MARK, "%10d" * 5, names, own[:, 0], own[:, 2:])


def _groups(deck: Deck) -> Iterator[str]:
    """Groups of nodes: held ones, then those of each part, and of all plies; a surface of each
    part."""
    fixed = {"clamped": "111 111", "mirror_x": "100 011", "mirror_y": "010 101"}
    for number, (name, nodes) in enumerate(deck.list_held_nodes().items(), 1):
        yield f"/GRNOD/NODE/{number}\n{name}\n" + numbers(_MARK, "node_ID", nodes, 10)
        yield f"/BCS/{number}\n{name}\n" + _write_fixed(fixed[name], number)
    for part in range(1, deck.nose_part + 1):
        for kind in ("GRNOD", "SURF"):
            yield f"/{kind}/PART/{_group(part)}\npart {part}\n"
            yield numbers(_MARK, "part_ID", [part], 10)
    # all plies together: what the nose may touch
    yield f"/GRNOD/PART/{_plies(deck)}\nplies\n"
    yield numbers(_MARK, "part_ID", [ply.number for ply in deck.plies], 10)


def _body(deck: Deck) -> Iterator[str]:
    u = deck.units
    nose = deck.nose
    main = _group(deck.nose_part + 2)
    surface = _group(deck.nose_part)
    # the nose does not turn, but a rigid body needs an inertia
    J = u.kg * u.m**2 * nose.inertia
    vx, vy, vz = u.velocity(nose.velocity)
    yield f"/GRNOD/NODE/{main}\nmain node of the projectile\n"
    yield numbers(_MARK, "node_ID", [nose.reference], 10)
    yield "/RBODY/1\nprojectile\n"
    yield _card(
        node_ID=nose.reference,
        sens_ID=0,
        skew_ID=0,
        Ispher=0,
        Mass=u.kg * nose.mass,
        grnd_ID=surface,
        Ikrem=0,
        ICoG=4,
        surf_ID=0,
    )
    yield _card(J11=J, J22=J, J33=J) + _card(J12=0.0, J23=0.0, J13=0.0) + _card(Ioptoff=0)
    mirror_x, mirror_y = deck.mirrors
    yield f"/BCS/{main}\nprojectile\n" + _write_fixed(f"{mirror_x:d}{mirror_y:d}0 111", main)
    # the main node and the surface start with the same velocity, or the body would jump
    for number, nodes in enumerate((main, surface), 1):
        yield f"/INIVEL/TRA/{number}\nprojectile\n"
        yield _card(Vx=vx, Vy=vy, Vz=vz, grnd_ID=nodes, skew_ID=0)
    yield f"/TH/RBODY/1\nprojectile\n{'DEF':<10}\n" + _card(body_ID=1)
    yield f"/TH/NODE/2\nmotion\n{'DEF':<10}\n"
    yield "".join(f"{node:10d}{0:10d}{name}\n" for name, node in deck.list_watched_nodes().items())


def _contact(deck: Deck) -> Iterator[str]:
    half = 0.5 * deck.cards[0].fabric.thickness
    heights = [ply.points[0, 2] for ply in deck.plies]
    pairs = [(_plies(deck), _group(deck.nose_part), half, deck.nose.friction, _STIFF_NOSE)]
    for p, (z, beyond) in enumerate(pairwise(heights), 1):
        # plies that start within the gap of their contact would be pushed apart
        gap = min(2 * half, _GAP * (beyond - z))
        ply = _group(p)
        next_ply = _group(p + 1)
        # nodes against segments see one side: each ply is once the one and once the other
        pairs.append((ply, next_ply, gap, deck.friction, _STIFF_PLIES))
        pairs.append((next_ply, ply, gap, deck.friction, _STIFF_PLIES))
    for number, (nodes, surface, gap, friction, stiffness) in enumerate(pairs, 1):
        yield f"/INTER/TYPE7/{number}\ncontact {number}\n"
        yield _card(
            grnd_IDs=nodes,
            surf_IDm=surface,
            Istf=0,
            Ithe=0,
            Igap=0,
            _=0,
            Ibag=0,
            Idel=2,
            Icurv=0,
            Iadm=0,
        )
        yield _card(Fscale_gap=0.0, Gapmax=0.0, Fpenmax=0.0)
        yield _card(Stmin=0.0, Stmax=0.0, mesh_size=0.0, dtmin=0.0, Irem_gap=0, Irem_i2=0)
        yield _card(
            Stfac=stiffness, Fric=friction, Gapmin=deck.units.m * gap, Tstart=0.0, Tstop=0.0
        )
        yield _card(IBC=f"{'000':>10}", _=" " * 20, Inacti=0, VIS_S=0.0, VIS_F=0.0, Bumult=0.0)
        yield _card(
            Ifric=0, Ifiltr=0, Xfreq=0.0, Iform=2, sens_ID=0, fct_IDF=0, AscaleF=0.0, fric_ID=0
        )


def _engine(deck: Deck, name: str) -> Iterator[str]:
    s = deck.units.s
    pictures, samples = deck.intervals
    yield "".join(f"# {line}\n" for line in deck.header)
    yield f"/RUN/{name}/1\n{s * deck.end_time:.9G}\n/VERS/{VERSION}\n"
    yield f"/TFILE\n{s * samples:.9G}\n/PRINT/-100\n/DT\n{_COURANT} 0\n"
    yield f"/ANIM/DT\n0 {s * pictures:.9G}\n/ANIM/VECT/VEL\n/ANIM/VECT/CONT\n/MON/ON\n"


def _group(part):
    """Number of the group of nodes and of the surface of a part; 1 to 3 are nodes that are held."""
    return 10 + part


def _plies(deck):
    """Number of the group of nodes of all plies."""
    return _group(deck.nose_part + 1)


def _write_fixed(codes, group):
    """The card of /BCS: 1 for each displacement along, and rotation about x, y, z that is held."""
    return _card(Tra_rot=f"{codes:>10}", skew_ID=0, grnod_ID=group)


def _card(**fields: Any) -> str:
    """A card: whole numbers and None (empty) in fields of 10 columns, reals of 20; texts as they
    are."""
    return card(_MARK, {name: _text(value) for name, value in fields.items()})


def _text(value):
    if isinstance(value, float):
        return f"{value:20.12E}"
    if isinstance(value, str):
        return value
    if value is None:
        return " " * 10
    return f"{value:>10}"
