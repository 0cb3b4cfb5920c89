"""Yarns meshed in hexahedra with fibre bars: what a crossover and a woven patch have in common.

A vertical section (`meshing.section`) is carried along the centreline by pure translation,

    warp   (s, p, q) -> (s, p, z(s) + q),    weft   (s, p, q) -> (p, s, z(s) + q),

so every fibre has the length S0 of eq. 4-4 of the thesis, and with the vertical area
A_s (1 + crimp) / Vf0 the yarn's volume is S0 A_s / Vf0 exactly. gmsh makes geometry and mesh
(`meshing.geometry`, `meshing.generate`), in equal steps along the fibres. Mesh lines along a yarn
are fibre lines. Each has a bar of its node's share of the section, scaled so that the bars of a
section together are the fibre area: a straightened yarn has the stiffness E A_s exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from fabrics.base.checks import FloatArray, IntArray
from fabrics.weave import Weave
from meshing.conforming import YarnSection
from meshing.generate import Groups, boxed
from meshing.inputs import YARNS
from meshing.mesh_file import ReadSection, ReadSections
from meshing.overlap import least_gap
from meshing.quality import scaled_jacobian
from meshing.section_fit import SectionFit

SURFACES = (
    "contact",
    "plate",
    "tip",
)  # the other named faces are ends and symmetry planes: groups of nodes


@dataclass(frozen=True, eq=False)
class YarnMesh:
    """A mesh of yarns. Family 0 is warp, 1 is weft.

    Parameters
    ----------
    fabric : str, name of the fabric
    points : (n, 3) [m]
    hexes : (m, 8) int, VTK order, local edge 0-1 along the fibre
    yarn : (m,) int, number of the yarn in `names`
    names : of the yarns
    families : per yarn 0 or 1
    grids : per yarn (nx+1, ny+1, nz+1) int, nodes by place: i along the yarn (towards +x or +y;
        from the symmetry plane in a quarter), j across it, k through it from bottom to top
    bars : per yarn (b, 2) int, node pairs along the fibre
    bar_area : per yarn (b,) [m2]
    faces : name -> (q, 4) int, outward quadrilaterals (see `groups`)
    w, h0, S0 : (warp, weft) [m] half cell lengths, heights and lengths of the centrelines
    fibre_area : (warp, weft) [m2] A_s of a whole yarn
    section_fit : SectionFit, the sections, the overlap they had, and how it was removed;
        ReadSections of a mesh that was read
    end_shells : [m] thickness of shells on the yarn ends, or None
    script : the geometry as a gmsh script, from which the mesh was made; empty of a mesh that was
        read
    """

    fabric: str
    points: np.ndarray
    hexes: np.ndarray
    yarn: np.ndarray
    names: tuple[str, ...]
    families: tuple[int, ...]
    grids: tuple[np.ndarray, ...]
    bars: tuple[np.ndarray, ...]
    bar_area: tuple[np.ndarray, ...]
    faces: dict = field(repr=False)
    w: tuple[float, float]
    h0: tuple[float, float]
    S0: tuple[float, float]
    fibre_area: tuple[float, float]
    section_fit: SectionFit | ReadSections
    end_shells: float | None
    script: str = field(repr=False)

    @property
    def shift(self) -> float:
        """[m] by which warp and weft are moved apart."""
        return self.section_fit.shift

    @property
    def quarter(self) -> bool:
        """Whether half the length and half the width of each yarn is meshed."""
        return any(name.endswith("_symx") for name in self.faces)

    @property
    def sections(self) -> tuple[YarnSection | ReadSection, YarnSection | ReadSection]:
        """(Section, Section) of warp and weft."""
        return self.section_fit.sections

    @property
    def Vf0(self) -> tuple[float, float]:
        """[-] initial fibre volume fractions of the meshed yarns; above the fabric's where the
        overlap requested it."""
        return self.section_fit.Vf0

    @property
    def collected(self) -> dict:
        """For each part of a family, such as "warp_contact": the names in `faces` of all yarns of
        the family."""
        family = dict(zip(self.names, self.families))
        found: dict[str, tuple[str, ...]] = {}
        for name in self.faces:
            yarn, part = name.rsplit("_", 1)
            group = f"{YARNS[family[yarn]]}_{part}"
            found[group] = (*found.get(group, ()), name)
        return found

    @property
    def groups(self) -> dict:
        """Named parts of each yarn, such as "warp_3_end" (a crossover's are "warp" and "weft"), and
        of each family.

        contact, plate, tip : (q, 4) int, outward quadrilaterals: facing the other yarns, away from
            them, the cut tips
        end : (k,) int, nodes of the end towards +x or +y; start : of the other end (not in a
            quarter)
        symx, symy : (k,) int, nodes on the planes x = 0 and y = 0 (quarter)
        """
        quads = {
            name: np.concatenate([self.faces[m] for m in members])
            for name, members in self.collected.items()
        }
        quads.update(self.faces)
        for name in quads:
            if name.rsplit("_", 1)[1] not in SURFACES:
                quads[name] = np.unique(quads[name])
        return quads

    @property
    def shells(self) -> dict:
        """name -> (q, 4) int, quadrilaterals of the shells on the yarn ends; empty without
        `end_shells`."""
        if self.end_shells is None:
            return {}
        return {
            name: quads for name, quads in self.faces.items() if name.endswith(("_end", "_start"))
        }

    @property
    def fibre(self) -> np.ndarray:
        """(m, 3) unit vectors along the fibre in each hexahedron, the mean of its four edges."""
        corners = self.points[self.hexes]
        along = corners[:, [1, 2, 5, 6]].sum(axis=1) - corners[:, [0, 3, 4, 7]].sum(axis=1)
        return along / np.linalg.norm(along, axis=1, keepdims=True)

    @cached_property
    def scaled_jacobian(self) -> np.ndarray:
        """(m,) [-] quality of each hexahedron."""
        return scaled_jacobian(self.points, self.hexes)

    @property
    def min_scaled_jacobian(self) -> float:
        """[-] quality of the worst hexahedron."""
        return float(self.scaled_jacobian.min())

    @cached_property
    def least_gap(self) -> float:
        """[m] between the meshed surfaces of crossing yarns; negative where their facets
        overlap."""
        return least_gap(self)


def assemble(
    groups: Groups, names: Sequence[str], families: Sequence[int], quarter: bool, weave: Weave
) -> dict:
    """Join the yarns of a mesh by gmsh, nodes numbered by place and yarn after yarn: fields of a
    `YarnMesh`.

    Parameters
    ----------
    groups : Groups
    names, families : of the yarns, in their order
    quarter : half the width of each yarn is meshed, and half of its fibres
    weave : Weave, for the fibre areas

    Raises
    ------
    InputError : a group is missing, or not one transfinite box of hexahedra
    """
    share = 0.5 if quarter else 1.0
    points = []
    grids = []
    hexes = []
    pairs = []
    areas = []
    faces = {}
    first = 0
    for name, family in zip(names, families):
        box = boxed(groups, name, family, _faces_of(family, quarter))
        places = groups.points[box.nodes]
        nodes = np.arange(box.nodes.size).reshape(box.nodes.shape) + first
        section = places[-1]
        weight = tributary_areas(section[..., 0, 1 - family], section[..., 2])
        bar_area = weight / weight.sum() * share * weave.yarns[family].A_s
        points.append(places.reshape(-1, 3))
        grids.append(nodes)
        hexes.append(box.hexes + first)
        pairs.append(np.stack([nodes[:-1], nodes[1:]], axis=-1).reshape(-1, 2))
        areas.append(np.tile(bar_area.ravel(), len(nodes) - 1))
        for face, quads in box.quads.items():
            faces[f"{name}_{face}"] = quads + first
        first += nodes.size
    return {
        "points": np.concatenate(points),
        "hexes": np.concatenate(hexes),
        "yarn": np.repeat(np.arange(len(names)), [len(h) for h in hexes]),
        "names": tuple(names),
        "families": tuple(families),
        "grids": tuple(grids),
        "bars": tuple(pairs),
        "bar_area": tuple(areas),
        "faces": faces,
    }


def numbering(
    groups: Groups, names: Sequence[str], families: Sequence[int], quarter: bool
) -> IntArray:
    """Return the numbers (n,) that gmsh gave to the nodes of a mesh, in the order in which
    `assemble` numbers them."""
    yarns = zip(names, families)
    found = [boxed(groups, name, family, _faces_of(family, quarter)) for name, family in yarns]
    return np.concatenate([box.nodes.ravel() for box in found])


def _faces_of(family, quarter):
    """The named faces of a yarn, and of which opposite pair of `generate.OPPOSITE` each is one."""
    faces = {"contact": "contact", "plate": "plate", "end": "end"}
    if not quarter:
        return faces | {"start": "start", "tip": "low/high"}
    planes = ("symx", "symy")
    return faces | {"tip": "high", planes[family]: "start", planes[1 - family]: "low"}


def tributary_areas(y: FloatArray, z: FloatArray) -> FloatArray:
    """Compute the share of each node of a section in its area: each quadrilateral gives the part nearest to a
    corner to that node.

    Parameters
    ----------
    y : (ny+1,) [m] stations across the section
    z : (ny+1, nz+1) [m] heights of the nodes at each station, in equal steps

    Returns
    -------
    area : (ny+1, nz+1) [m2], summing to the area of the polygon
    """
    middle = (y[1:] + y[:-1]) / 2
    bounds = np.concatenate([y[:1], middle, y[-1:]])
    thick = z[:, -1] - z[:, 0]
    at_bounds = np.interp(bounds, y, thick)
    # A strip between two bounds is two trapezoids that meet at the station.
    strip = (bounds[1:] - y) * (at_bounds[1:] + thick) / 2 + (y - bounds[:-1]) * (
        at_bounds[:-1] + thick
    ) / 2
    through = np.ones(z.shape[1])
    through[[0, -1]] = 0.5
    return strip[:, None] * through / through.sum()
