"""Yarns meshed in hexahedra with fibre bars: what a crossover and a woven patch have in common.

A vertical section (`meshing.section`) is carried along the centreline by pure translation:

    warp   (s, p, q) -> (s, p, z(s) + q)
    weft   (s, p, q) -> (p, s, z(s) + q)

so every fibre is the centreline moved sideways, all have the length S0 of eq. 4-4 of the thesis,
and with the vertical area A_s (1 + crimp) / Vf0 the yarn's volume is S0 A_s / Vf0 exactly. The
nodes of a box (`meshing.grid`) are placed by this map. Mesh lines along the box are fibre lines.
Each carries a bar whose area is the share of its node in the section, scaled so that all bars of a
section together are the fibre area: the bars lie along the fibre, so a straightened yarn has the
stiffness E A_s exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from fabrics.base.checks import FloatArray, IntArray
from meshing import grid
from meshing.conforming import YarnSection
from meshing.inputs import YARNS
from meshing.overlap import least_gap
from meshing.quality import scaled_jacobian
from meshing.section_fit import SectionFit

SURFACES = (
    "contact",
    "plate",
    "tip",
)  # the other named faces are ends and symmetry planes: groups of nodes


@dataclass(frozen=True)
class Strand:
    """One yarn before it is meshed.

    Parameters
    ----------
    name : str
    family : 0 of a warp, 1 of a weft yarn
    points : (nx+1, ny+1, nz+1, 3) [m] along, across and through
    bar_area : (ny+1, nz+1) [m2] of the fibre bars of a section
    over : (nx,) bool, where the yarn lies over the one that it crosses
    """

    name: str
    family: int
    points: np.ndarray
    bar_area: np.ndarray
    over: np.ndarray


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
    section_fit : SectionFit, the sections, the overlap they had, and how it was removed
    end_shells : [m] thickness of shells on the yarn ends, or None
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
    section_fit: SectionFit
    end_shells: float | None

    @property
    def shift(self) -> float:
        """[m] by which warp and weft are moved apart."""
        return self.section_fit.shift

    @property
    def sections(self) -> tuple[YarnSection, YarnSection]:
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


def place(
    family: int,
    s: FloatArray,
    centre: FloatArray,
    y: FloatArray,
    heights: FloatArray,
    across: float = 0.0,
) -> FloatArray:
    """Compute the node positions of a yarn.

    Parameters
    ----------
    family : 0 along x, 1 along y
    s, centre : (nx+1,) [m] positions along the yarn and heights of its centreline
    y, heights : (ny+1,), (ny+1, nz+1) [m] positions across and heights of the section
    across : [m] of the centreline

    Returns
    -------
    points : (nx+1, ny+1, nz+1, 3) [m]
    """
    z = centre[:, None, None] + heights[None]
    points = np.empty((*z.shape, 3))
    points[..., family] = s[:, None, None]
    points[..., 1 - family] = across + y[None, :, None]
    points[..., 2] = z
    return points


def assemble(strands: Sequence[Strand]) -> tuple[dict, dict[str, dict[str, IntArray]]]:
    """Number the nodes of all yarns one after another and join their bricks, bars and faces: fields
    of a `YarnMesh`.

    Faces are named with the yarn and i0, i1, j0, j1 or contact and plate.
    """
    grids = []
    hexes = []
    pairs = []
    areas = []
    faces = {}
    first = 0
    for strand in strands:
        shape = strand.points.shape[:3]
        right = strand.family == 0
        nodes = np.arange(np.prod(shape)).reshape(shape) + first
        first += nodes.size
        bars = grid.bars(nodes)
        grids.append(nodes)
        hexes.append(grid.bricks(nodes, right))
        pairs.append(bars.reshape(-1, 2))
        areas.append(np.broadcast_to(strand.bar_area, bars.shape[:-1]).reshape(-1).copy())
        faces[strand.name] = _sides(grid.faces(nodes, right), strand.over, shape[1] - 1)
    return {
        "points": np.concatenate([strand.points.reshape(-1, 3) for strand in strands]),
        "hexes": np.concatenate(hexes),
        "yarn": np.repeat(np.arange(len(strands)), [len(h) for h in hexes]),
        "names": tuple(strand.name for strand in strands),
        "families": tuple(strand.family for strand in strands),
        "grids": tuple(grids),
        "bars": tuple(pairs),
        "bar_area": tuple(areas),
    }, faces


def outer_faces(sides: dict[str, dict[str, IntArray]]) -> dict[str, IntArray]:
    """Name the outer faces of whole yarns, as `YarnMesh.groups` lists them."""
    named = {}
    for yarn, of in sides.items():
        named[f"{yarn}_contact"] = of["contact"]
        named[f"{yarn}_plate"] = of["plate"]
        named[f"{yarn}_end"] = of["i1"]
        named[f"{yarn}_start"] = of["i0"]
        named[f"{yarn}_tip"] = np.concatenate([of["j0"], of["j1"]])
    return named


def _sides(sides, over, ny):
    """The six sides of a yarn with k0 and k1 exchanged for contact (below where the yarn lies over)
    and plate."""
    below = np.repeat(over, ny)[:, None]
    lower = sides.pop("k0")
    upper = sides.pop("k1")
    return sides | {
        "contact": np.where(below, lower, upper),
        "plate": np.where(below, upper, lower),
    }
