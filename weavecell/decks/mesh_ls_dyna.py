"""LS-DYNA keyword file (.k), fixed columns of 8 or 10 characters, of a numbered mesh.

Material axes follow the element (AOPT 0): a from node 1 to node 2, the fibre. Solids are ELFORM 2,
fully integrated: one-point elements have modes without energy. Bars are trusses (ELFORM 3). Columns
of 10 leave five digits to areas.
"""

from __future__ import annotations

from collections.abc import Iterator

from fabrics.fabric import Fabric
from meshing.inputs import YARNS
from meshing.mesh import YarnMesh
from weavecell.decks.cards import fields, lines
from weavecell.decks.mesh_deck import MATERIALS, deck, material_number, set_lines

ELEMENTS = {"hex": "SOLID", "bar": "BEAM", "shell": "SHELL"}


def texts(mesh: YarnMesh, fabric: Fabric) -> Iterator[str]:
    """Write the parts of the text of the keyword file."""
    numbered = deck(mesh, fabric)
    yield "*KEYWORD\n" + "".join(f"$ {line}\n" for line in numbered.header)
    yield f"*TITLE\n{numbered.header[0]}\n"
    yield "*NODE\n" + numbered.nodes("%8d%16.9E%16.9E%16.9E")
    yield from _elements(numbered)
    yield from _parts(numbered)
    yield from _materials(numbered)
    yield from _sets(numbered)
    yield "*END\n"


def _elements(numbered):
    for kind, word in ELEMENTS.items():
        parts = numbered.select_parts(kind)
        if parts:
            yield f"*ELEMENT_{word}\n"
        for part in parts:
            yield lines(
                f"%8d{part.number:8d}" + "%8d" * part.nodes.shape[1], part.elements, part.nodes
            )


def _parts(numbered):
    """Parts and sections: one section for all solids, one for each area or thickness."""
    yield "*SECTION_SOLID\n" + _ids(1, 2)
    for part in numbered.parts:
        yield f"*PART\n{part.name}\n" + _ids(part.number, part.section, part.material)
        if part.kind == "bar":
            yield "*SECTION_BEAM\n" + _ids(part.section, 3) + _reals(part.size)
        elif part.kind == "shell":
            yield "*SECTION_SHELL\n" + _ids(part.section, 16) + _reals(*[part.size] * 4)


def _materials(numbered):
    for family, (yarn, m) in enumerate(zip(YARNS, numbered.materials)):
        hexes, bars, shells = (f"{material_number(family, kind):10d}" for kind in MATERIALS)
        yield f"*MAT_ORTHOTROPIC_ELASTIC_TITLE\n{yarn}\n{hexes}"
        yield _reals(m.solid_density, m.axial, m.transverse, m.transverse, 0, 0, 0)
        yield _reals(m.shear, m.shear, m.shear, 0) + _reals(0) * 2
        yield f"*MAT_ELASTIC_TITLE\n{yarn} fibres\n{bars}" + _reals(m.bar_density, m.fibre, 0)
        if numbered.select_parts("shell"):
            yield f"*MAT_ELASTIC_TITLE\n{yarn} end shells\n{shells}" + _reals(
                m.solid_density, m.packed, 0
            )


def _sets(numbered):
    keywords = "BEAM", "NODE_LIST", "NODE_ADD", "SEGMENT", "SEGMENT_ADD"
    head = "*SET_{}_TITLE\n{}\n{:10d}\n"
    return set_lines(
        numbered,
        keywords,
        lambda keyword, number, name: head.format(keyword, name, number),
        8,
        lambda quads: lines("%10d" * 4, quads),
    )


def _ids(*numbers):
    return fields("{:10d}", *numbers)


def _reals(*values):
    return fields("{:10.4E}", *values)
