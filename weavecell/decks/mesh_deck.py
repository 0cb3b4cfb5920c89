"""What the input files of LS-DYNA, Abaqus and OpenRadioss have in common: numbered parts, sets and
sections of a mesh.

Nodes, elements, parts and sets are numbered from 1. Elements: all hexahedra, then all bars, then
the end shells. A yarn is one part of hexahedra. The bars of a family with the same area are one
part, so that the area is a property of the part; the bars of each yarn are a set. Node 1 to node 2
of a hexahedron is the fibre direction, exactly: its four edges along the fibre are parallel.

Units are SI: m, kg, s, N, Pa.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from fabrics.base.counted import counted
from fabrics.fabric import Fabric
from meshing.inputs import YARNS
from meshing.mesh import SURFACES, YarnMesh
from weavecell.decks.cards import lines, wrap
from weavecell.decks.linear_material import linearise

MATERIALS = ("hex", "bar", "shell")  # of each family, numbered in this order
# digits that decide whether two bars have the same area: rounding must not make two parts of them
SAME_AREA = 9


@dataclass(frozen=True)
class Part:
    """Elements with one section and one material.

    Parameters
    ----------
    number, name : of the part
    kind : "hex", "bar" or "shell"
    family : 0 of warp, 1 of weft
    elements : (m,) int
    nodes : (m, k) int
    size : area [m2] of bars, thickness [m] of shells, else None
    """

    number: int
    name: str
    kind: str
    family: int
    elements: np.ndarray
    nodes: np.ndarray
    size: float | None = None

    @property
    def section(self) -> int:
        """Number of its section or property: one for all hexahedra, else one for each area or
        thickness."""
        if self.kind == "hex":
            return 1
        return self.number

    @property
    def material(self) -> int:
        """Number of its material."""
        return material_number(self.family, self.kind)


@dataclass(frozen=True)
class Deck:
    """A mesh, ready to be written.

    Parameters
    ----------
    header : lines of text, what is in the file
    points : (n, 3) [m]
    parts : of Part
    bar_sets : yarn name -> (b,) int, its bars
    node_sets, surfaces : name -> (k,) int, or (q, 4) int outward quadrilaterals
    node_unions, surface_unions : name -> names of the sets in it: the same part of all yarns of a
        family
    materials : (RestMaterial, RestMaterial)
    """

    header: list
    points: np.ndarray
    parts: list
    bar_sets: dict
    node_sets: dict
    surfaces: dict
    node_unions: dict
    surface_unions: dict
    materials: tuple

    def nodes(self, template: str) -> str:
        """Write a line of a %-template for each node: its number and its place."""
        return lines(template, range(1, len(self.points) + 1), self.points)

    def select_parts(self, kind: str) -> list[Part]:
        """Return the parts of one kind."""
        return [part for part in self.parts if part.kind == kind]


def material_number(family: int, kind: str) -> int:
    """Return the number, from 1, of the material of a kind of parts of a family."""
    return 1 + len(MATERIALS) * family + MATERIALS.index(kind)


def set_lines(
    numbered: Deck,
    keywords: Sequence[str],
    head: Callable[[str, int, str], str],
    per_line: int,
    quads: Callable[[np.ndarray], str],
) -> Iterator[str]:
    """Write all sets, and the unions of a family as sets of sets; numbered through, each kind from
    1.

    Parameters
    ----------
    keywords : of sets of bars, sets of nodes, their unions, surfaces, and their unions
    head : head(keyword, number, name) -> the lines above the members
    per_line : members a line
    quads : quads(members) -> the lines of a surface, members (q, 4)
    """

    def each(keyword, sets, content, first=1):
        for number, (name, members) in enumerate(sets.items(), first):
            yield head(keyword, number, name) + content(members)

    def union(keyword, unions, sets):
        number = {name: n for n, name in enumerate(sets, 1)}
        return each(
            keyword,
            unions,
            lambda names: wrap_members([number[name] for name in names]),
            1 + len(sets),
        )

    def wrap_members(members):
        return wrap(members, per_line)

    bars, nodes, node_unions, surfaces, surface_unions = keywords
    yield from each(bars, numbered.bar_sets, wrap_members)
    yield from each(nodes, numbered.node_sets, wrap_members)
    yield from union(node_unions, numbered.node_unions, numbered.node_sets)
    yield from each(surfaces, numbered.surfaces, quads)
    yield from union(surface_unions, numbered.surface_unions, numbered.surfaces)


def deck(mesh: YarnMesh, fabric: Fabric) -> Deck:
    """Number the parts, elements and sets of a mesh of a fabric."""
    groups = {name: nodes + 1 for name, nodes in mesh.groups.items() if name in mesh.faces}
    unions = {name: members for name, members in mesh.collected.items() if name not in mesh.faces}
    surfaces = {name: quads for name, quads in groups.items() if _is_surface(name)}
    hexes = _hexes(mesh)
    bars = _bars(mesh)
    parts = [*hexes, *bars, *_shells(mesh)]
    first = 1 + len(mesh.hexes)
    bounds = np.cumsum([first, *(len(b) for b in mesh.bars)])
    return Deck(
        header=_header(mesh),
        points=mesh.points,
        parts=[Part(number, *part) for number, part in enumerate(parts, 1)],
        bar_sets={
            f"{yarn}_fibre": np.arange(a, b) for yarn, a, b in zip(mesh.names, bounds, bounds[1:])
        },
        node_sets={name: nodes for name, nodes in groups.items() if name not in surfaces},
        surfaces=surfaces,
        node_unions={name: members for name, members in unions.items() if not _is_surface(name)},
        surface_unions={name: members for name, members in unions.items() if _is_surface(name)},
        materials=linearise(fabric, mesh.Vf0),
    )


def _is_surface(name):
    return name.rsplit("_", 1)[1] in SURFACES


def _header(mesh):
    return [
        f"weavecell: {mesh.fabric}, {counted(len(mesh.names), 'yarn')}, {counted(len(mesh.hexes), 'hexahedron')}",
        "Units: m, kg, s, N, Pa",
        "Fibre direction: from node 1 to node 2 of each hexahedron",
        "Materials: linear, the yarn at rest (V_f = Vf0); put the yarn law in their place",
        "Mass: half of the fibres' in the bars, half in the hexahedra",
    ]


def _hexes(mesh):
    for number, (name, family) in enumerate(zip(mesh.names, mesh.families)):
        elements = np.flatnonzero(mesh.yarn == number)
        yield name, "hex", family, elements + 1, mesh.hexes[elements] + 1


def _bars(mesh):
    """One part for each area in each family, the largest areas first."""
    pairs = np.concatenate(mesh.bars) + 1
    areas = np.concatenate(mesh.bar_area)
    of = np.repeat(mesh.families, [len(b) for b in mesh.bars])
    elements = np.arange(len(pairs)) + 1 + len(mesh.hexes)
    for family, yarn in enumerate(YARNS):
        mine = np.flatnonzero(of == family)
        largest = areas[mine].max()
        _, group = np.unique(-np.round(areas[mine] / largest, SAME_AREA), return_inverse=True)
        for number in range(group.max() + 1):
            chosen = mine[group == number]
            yield (
                f"{yarn}_bars_{number + 1}",
                "bar",
                family,
                elements[chosen],
                pairs[chosen],
                areas[chosen].mean(),
            )


def _shells(mesh):
    first = 1 + len(mesh.hexes) + sum(len(b) for b in mesh.bars)
    for name, quads in mesh.shells.items():
        family = mesh.families[mesh.names.index(name.rsplit("_", 1)[0])]
        yield (
            f"{name}_shell",
            "shell",
            family,
            np.arange(len(quads)) + first,
            quads + 1,
            mesh.end_shells,
        )
        first += len(quads)
