"""One crossover of a plain weave in hexahedra: the warp along x over the weft along y, the crossing at the origin.

A vertical section (`meshing.section`) is carried along the centreline by pure translation:

    warp   (s, p, q) -> (s, p,  h_1 cos(pi s / 2 w_1) + shift/2 + q)
    weft   (s, p, q) -> (p, s, -h_2 cos(pi s / 2 w_2) - shift/2 + q)

so every fibre is the centreline moved sideways, all have the length S0 of eq. 4-4 of the source thesis, and with the
vertical area A_s (1 + crimp) / Vf0 the yarn's volume is S0 A_s / Vf0 exactly. gmsh meshes a box (`meshing.box`); the
nodes are placed by this map. Mesh lines along the box are fibre lines. Each carries a bar whose area is the share of
its node in the section, scaled so that all bars of a section together are the fibre area: the bars lie along the fibre,
so a straightened yarn has the stiffness E A_s exactly.

"quarter" is x >= 0, y >= 0: half the length and half the width of each yarn, so half of its bars' area.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from meshing import grid, inputs
from meshing.box import transfinite_box
from meshing.closing import Closing, close
from meshing.inputs import YARNS
from meshing.quality import scaled_jacobian


@dataclass(frozen=True, eq=False)
class Crossover:
    """The mesh of a crossover. Index 0 is warp, 1 is weft.

    Parameters
    ----------
    fabric : str, name of the fabric
    domain : "quarter" or "whole"
    points : (n, 3) [m]
    hexes : (m, 8) int, VTK order, local edge 0-1 along the fibre
    yarn : (m,) int, 0 or 1
    grids : per yarn (nx+1, ny+1, nz+1) int, nodes by place: i along the yarn (towards +x or +y; from the symmetry
        plane in a quarter), j across it, k through it from bottom to top
    bars : per yarn (b, 2) int, node pairs along the fibre
    bar_area : per yarn (b,) [m2]; the bars that cut one section sum to `share` A_s
    faces : name -> (q, 4) int, outward quadrilaterals (see `groups`)
    w, h0, S0 : (warp, weft) [m] half cell lengths, heights and lengths of the centrelines
    fibre_area : (warp, weft) [m2] A_s of the whole yarn
    closing : Closing, the sections, the overlap they had, and how it was removed
    """

    fabric: str
    domain: str
    points: np.ndarray
    hexes: np.ndarray
    yarn: np.ndarray
    grids: tuple[np.ndarray, np.ndarray]
    bars: tuple[np.ndarray, np.ndarray]
    bar_area: tuple[np.ndarray, np.ndarray]
    faces: dict = field(repr=False)
    w: tuple[float, float]
    h0: tuple[float, float]
    S0: tuple[float, float]
    fibre_area: tuple[float, float]
    closing: Closing

    @property
    def share(self) -> float:
        """[-] of a yarn's section that is meshed: a half in a quarter crossover."""
        return 0.5 if self.domain == "quarter" else 1.0

    @property
    def shift(self) -> float:
        """[m] by which warp and weft are moved apart."""
        return self.closing.shift

    @property
    def sections(self):
        """(Section, Section) of warp and weft."""
        return self.closing.sections

    @property
    def Vf0(self) -> tuple[float, float]:
        """[-] initial fibre volume fractions of the meshed yarns; above the fabric's where the overlap asked for it."""
        return self.closing.Vf0

    @property
    def groups(self) -> dict:
        """Named parts, "warp_..." and "weft_...".

        contact, plate, tip : (q, 4) int, outward quadrilaterals: facing the other yarn, away from it, the cut tips
        end : (k,) int, nodes of the end at +w; start : of the end at -w (whole)
        symx, symy : (k,) int, nodes on the planes x = 0 and y = 0 (quarter)
        """
        surfaces = ("contact", "plate", "tip")
        return {
            name: quads if name.split("_")[1] in surfaces else np.unique(quads) for name, quads in self.faces.items()
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
        return float(self.scaled_jacobian.min())


def build(
    fabric,
    *,
    domain="quarter",
    size="medium",
    section=None,
    gap=0.0,
    width=None,
    bluntness=0.075,
    overlap="solve",
) -> Crossover:
    """Mesh one crossover of a fabric.

    Parameters
    ----------
    fabric : Fabric, with solid laws (for the fibre volume fractions)
    domain : "quarter" or "whole"
    size : "coarse", "medium", "fine" or (nx, ny, nz), hexahedra along, across and through a quarter of each yarn
    section : "sine", "ellipse" or None for the fabric's
    gap : [m] between parallel yarns; the widths are the spacings less the gap
    width : (warp, weft) [m] instead of a gap; these widths are kept whatever the overlap
    bluntness : [-] thickness of the cut tips over that of the middle
    overlap : "solve" or "refuse" an overlap too large for a shift (`meshing.closing`)

    Raises
    ------
    InputError : a value is not allowed, or the sections overlap and this is refused or cannot be solved
    """
    inputs.one_of("domain", domain, ("quarter", "whole"))
    inputs.one_of("overlap", overlap, ("solve", "refuse"))
    nx, ny, nz = inputs.size(size)
    weave = fabric.weave
    closing = close(
        fabric.section if section is None else section,
        inputs.widths(weave, gap, width),
        inputs.fractions(fabric),
        weave,
        bluntness,
        prescribed=width is not None,
        overlap=overlap,
    )
    whole = domain == "whole"
    corners = transfinite_box(*((2 * nx, 2 * ny, nz) if whole else (nx, ny, nz)))
    shape = tuple(corners.reshape(-1, 3).max(axis=0) + 1)
    parts = [_yarn(index, closing, weave, nx, ny, nz, whole) for index in (0, 1)]
    count = int(np.prod(shape))
    grids = tuple(np.arange(count).reshape(shape) + index * count for index in (0, 1))
    hexes = [grid.bricks(nodes, corners, right=index == 0) for index, nodes in enumerate(grids)]
    share = 1.0 if whole else 0.5
    bars = [grid.bars(nodes) for nodes in grids]
    areas = [
        np.broadcast_to(weight / weight.sum() * share * yarn.A_s, pairs.shape[:-1])
        for (_, weight), yarn, pairs in zip(parts, weave.yarns, bars)
    ]
    return Crossover(
        fabric=fabric.name,
        domain=domain,
        points=np.concatenate([points.reshape(-1, 3) for points, _ in parts]),
        hexes=np.concatenate(hexes),
        yarn=np.repeat([0, 1], [len(h) for h in hexes]),
        grids=grids,
        bars=tuple(pairs.reshape(-1, 2) for pairs in bars),
        bar_area=tuple(area.reshape(-1).copy() for area in areas),
        faces=_faces(grids, whole),
        w=weave.w,
        h0=weave.h0,
        S0=weave.S0,
        fibre_area=tuple(yarn.A_s for yarn in weave.yarns),
        closing=closing,
    )


def _yarn(index, closing, weave, nx, ny, nz, whole):
    """Node positions (nx+1, ny+1, nz+1, 3) of one yarn and the tributary areas (ny+1, nz+1) of its section."""
    section, w, h = closing.sections[index], weave.w[index], weave.h0[index]
    s, y = np.linspace(0, w, nx + 1), section.stations(ny)
    if whole:
        s, y = (np.concatenate([-part[:0:-1], part]) for part in (s, y))
    heights = section.half_thickness(y)[:, None] * np.linspace(-1, 1, nz + 1)
    sign = 1 if index == 0 else -1
    centre = sign * (h * np.cos(np.pi * s / (2 * w)) + closing.shift / 2)
    along, across, z = np.broadcast_arrays(s[:, None, None], y[None, :, None], centre[:, None, None] + heights[None])
    points = np.stack([along, across, z] if index == 0 else [across, along, z], axis=-1)
    return points, grid.tributary_areas(y, heights)


def _faces(grids, whole):
    """Names of the outer faces of both yarns, as `Crossover.groups` lists them."""
    named = {}
    for index, (yarn, nodes) in enumerate(zip(YARNS, grids)):
        sides = grid.faces(nodes, right=index == 0)
        lower, upper = sides["k0"], sides["k1"]
        named[f"{yarn}_contact"], named[f"{yarn}_plate"] = (lower, upper) if index == 0 else (upper, lower)
        named[f"{yarn}_end"] = sides["i1"]
        if whole:
            named[f"{yarn}_start"] = sides["i0"]
            named[f"{yarn}_tip"] = np.concatenate([sides["j0"], sides["j1"]])
        else:
            named[f"{yarn}_tip"] = sides["j1"]
            named[f"{yarn}_symx"], named[f"{yarn}_symy"] = (
                (sides["i0"], sides["j0"]) if index == 0 else (sides["j0"], sides["i0"])
            )
    return named
