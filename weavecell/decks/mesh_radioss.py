"""OpenRadioss starter file (NAME_0000.rad), block format 2022, of a numbered mesh.

Material axes follow the element: /PROP/TYPE6 with Ip 20, axis 1 from node 1 to node 2, the fibre,
axis 2 to node 4.
Solids are Isolid 17, fully integrated. Bars are /TRUSS. Groups of nodes are /GRNOD, faces
/SURF/SEG, bars /GRTRUS.
"""

from __future__ import annotations

from collections.abc import Iterator

from fabrics.fabric import Fabric
from meshing.inputs import YARNS
from meshing.mesh import YarnMesh
from weavecell.decks.cards import fields, lines
from weavecell.decks.mesh_deck import deck, material_number, set_lines

ELEMENTS = {"hex": "BRICK", "bar": "TRUSS", "shell": "SHELL"}
# Isolid: full integration
FULL = 17
# Icpre
FULL_PRESSURE = 3
# Iframe
COROTATIONAL = 2
# Ip: the first axis runs from node 1 to node 2
EDGE_12 = 20


def texts(mesh: YarnMesh, fabric: Fabric) -> Iterator[str]:
    """Write the parts of the text of the starter file."""
    numbered = deck(mesh, fabric)
    yield "#RADIOSS STARTER\n" + "".join(f"# {line}\n" for line in numbered.header)
    yield f"/BEGIN\n{mesh.fabric}\n" + _ids(2022, 0) + 2 * _texts("kg", "m", "s")
    yield f"/TITLE\n{numbered.header[0]}\n"
    yield from _materials(numbered)
    yield from _parts(numbered)
    yield "/NODE\n" + numbered.nodes("%10d%20.12E%20.12E%20.12E")
    for part in numbered.parts:
        yield f"/{ELEMENTS[part.kind]}/{part.number}\n"
        yield lines("%10d" * (1 + part.nodes.shape[1]), part.elements, part.nodes)
    yield from _groups(numbered)
    yield "/END\n"


def _materials(numbered):
    """Orthotropic solids (law 12, whose strengths left at 0 are infinite), elastic bars and shells
    (law 1)."""
    for family, (yarn, m) in enumerate(zip(YARNS, numbered.materials)):
        yield f"/MAT/LAW12/{material_number(family, 'hex')}\n{yarn}\n" + _reals(m.solid_density)
        yield (
            _reals(m.axial, m.transverse, m.transverse)
            + _reals(0, 0, 0)
            + _reals(m.shear, m.shear, m.shear)
        )
        yield _reals(0, 0, 0, 0) * 6
        yield (
            f"/MAT/LAW1/{material_number(family, 'bar')}\n{yarn} fibres\n"
            + _reals(m.bar_density)
            + _reals(m.fibre, 0)
        )
        if numbered.select_parts("shell"):
            yield f"/MAT/LAW1/{material_number(family, 'shell')}\n{yarn} end shells\n" + _reals(
                m.solid_density
            )
            yield _reals(m.packed, 0)


def _parts(numbered):
    """Parts and properties: one property for all solids, one for each area or thickness."""
    # Isolid, Ismstr, -, Icpre, Itetra10, Inpts, Itetra4, Iframe; viscosities; vector, skew, Ip,
    # Iorth; angle, point; time step.
    yield "/PROP/TYPE6/1\nyarns, fibre from node 1 to node 2\n" + _ids(
        FULL, 0, 0, FULL_PRESSURE, 0, 0, 0, COROTATIONAL
    )
    yield (
        _reals(0, 0, 0)
        + _reals(0, 0, 0)[:-1]
        + _ids(0, EDGE_12, 0)
        + _reals(0, 0, 0, 0)
        + _reals(0)
    )
    for part in numbered.parts:
        if part.kind == "bar":
            yield f"/PROP/TYPE2/{part.section}\n{part.name}\n" + _reals(part.size, 0)
        elif part.kind == "shell":
            # Flags; hourglass and damping; N, Istrain, thickness: defaults but one point through
            # the thickness.
            yield (
                f"/PROP/TYPE1/{part.section}\n{part.name}\n"
                + _ids(0, 0, 0, 0)
                + _reals(0, 0, 0, 0, 0)
            )
            yield _ids(1, 0)[:-1] + _reals(part.size)
        yield f"/PART/{part.number}\n{part.name}\n" + _ids(part.section, part.material)


def _groups(numbered):
    return set_lines(
        numbered,
        ("GRTRUS/TRUS", "GRNOD/NODE", "GRNOD/GRNOD", "SURF/SEG", "SURF/SURF"),
        "/{}/{}\n{}\n".format,
        10,
        lambda quads: lines("%10d" * 5, range(1, len(quads) + 1), quads),
    )


def _ids(*numbers):
    return fields("{:10d}", *numbers)


def _texts(*words):
    return fields("{:>20}", *words)


def _reals(*values):
    return fields("{:20.12E}", *values)
