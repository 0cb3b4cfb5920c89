"""Abaqus input file (.inp), model data only, of a numbered mesh; CalculiX reads it too.

Material axes are given for each element (*DISTRIBUTION): a along the fibre, b towards node 4.
Hexahedra are C3D8, bars T3D2, end shells S4. Faces are named as surfaces of elements: side S1 .. S6
as in C3D8. Sets of a whole family list their members, which more readers know than unions. A field
has at most 20 characters.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fabrics.fabric import Fabric
from meshing.inputs import YARNS
from meshing.mesh import YarnMesh
from weavecell.decks.cards import lines, wrap
from weavecell.decks.mesh_deck import deck

TYPES = {"hex": "C3D8", "bar": "T3D2", "shell": "S4"}
# Nodes (from 0) of the sides S1 .. S6.
SIDES = np.array(
    [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)]
)


def texts(mesh: YarnMesh, fabric: Fabric) -> Iterator[str]:
    """Write the parts of the text of the input file."""
    numbered = deck(mesh, fabric)
    yield "".join(f"** {line}\n" for line in numbered.header)
    yield f"*HEADING\n{numbered.header[0]}; SI units\n"
    yield "*NODE\n" + numbered.nodes("%d,%.13E,%.13E,%.13E")
    for part in numbered.parts:
        yield f"*ELEMENT, TYPE={TYPES[part.kind]}, ELSET={part.name}\n"
        yield lines("%d" + ",%d" * part.nodes.shape[1], part.elements, part.nodes)
    yield from _sets(mesh, numbered)
    yield from _axes(mesh)
    yield from _materials(numbered)
    yield from _sections(numbered)


def _sets(mesh, numbered):
    for name, bars in numbered.bar_sets.items():
        yield f"*ELSET, ELSET={name}\n" + _write_members(bars)
    nodes = {name: _write_members(members) for name, members in numbered.node_sets.items()}
    for name, members in numbered.node_unions.items():
        nodes[name] = "".join(nodes[member] for member in members)
    for name, text in nodes.items():
        yield f"*NSET, NSET={name}\n{text}"
    sides = _surfaces(mesh, numbered)
    for name, members in numbered.surface_unions.items():
        sides[name] = "".join(sides[member] for member in members)
    for name, text in sides.items():
        yield f"*SURFACE, TYPE=ELEMENT, NAME={name}\n{text}"


def _write_members(members):
    return wrap(members, 8, "%d", ",")


def _surfaces(mesh, numbered):
    """name -> lines "element, side" of each named surface.

    The nodes of a structured grid are numbered along its axes: the lowest and the highest node of a
    face are its opposite corners and name it.
    """
    corners = mesh.hexes[:, SIDES].reshape(-1, 4) + 1
    keys, order = np.unique(
        _key(corners), return_index=True
    )  # of inner faces either element will do: none is named
    surfaces = {}
    for name, quads in numbered.surfaces.items():
        place = order[np.searchsorted(keys, _key(quads))]
        surfaces[name] = lines("%d,S%d", place // len(SIDES) + 1, place % len(SIDES) + 1)
    return surfaces


def _key(quads):
    return quads.min(axis=1) * (1 << 32) + quads.max(axis=1)


def _axes(mesh):
    points = mesh.points[mesh.hexes]
    b = points[:, 3] - points[:, 0]
    yield "*DISTRIBUTION TABLE, NAME=axes_table\nCOORD3D, COORD3D\n"
    yield "*DISTRIBUTION, NAME=axes, LOCATION=ELEMENT, TABLE=axes_table\n, 1., 0., 0., 0., 1., 0.\n"
    vectors = (mesh.fibre, b / np.linalg.norm(b, axis=1, keepdims=True))
    yield lines("%d" + ",%.9f" * 6, range(1, len(mesh.hexes) + 1), *vectors)
    yield "*ORIENTATION, NAME=fibre\naxes\n1, 0.\n"


def _materials(numbered):
    for yarn, m in zip(YARNS, numbered.materials):
        yield f"*MATERIAL, NAME={yarn}\n*DENSITY\n{m.solid_density:.9E},\n*ELASTIC, TYPE=ENGINEERING CONSTANTS\n"
        moduli = (m.axial, m.transverse, m.transverse)
        yield (
            ", ".join(f"{v:.9E}" for v in moduli)
            + f", 0., 0., 0., {m.shear:.9E}, {m.shear:.9E},\n{m.shear:.9E},\n"
        )
        yield f"*MATERIAL, NAME={yarn}_fibre\n*DENSITY\n{m.bar_density:.9E},\n*ELASTIC\n{m.fibre:.9E}, 0.\n"
        if numbered.select_parts("shell"):
            yield f"*MATERIAL, NAME={yarn}_shell\n*DENSITY\n{m.solid_density:.9E},\n*ELASTIC\n{m.packed:.9E}, 0.\n"


def _sections(numbered):
    for part in numbered.parts:
        yarn = YARNS[part.family]
        if part.kind == "hex":
            yield f"*SOLID SECTION, ELSET={part.name}, MATERIAL={yarn}, ORIENTATION=fibre\n"
        elif part.kind == "bar":
            yield f"*SOLID SECTION, ELSET={part.name}, MATERIAL={yarn}_fibre\n{part.size:.13E},\n"
        else:
            yield f"*SHELL SECTION, ELSET={part.name}, MATERIAL={yarn}_shell\n{part.size:.13E},\n"
