"""The computations of the 3D crossover and of its packs that claims share, as those of `runs`; they need gmsh, and all
but `meshes` and `sections` dolfinx."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from fabrics import catalogue

SIZE = "coarse"  # mesh of a quarter crossover
ROWS = 30  # of the loading of a pack, and of its unloading


def _meshed(fabric, size=SIZE, **options):
    """(mesh of the quarter crossover, fabric)"""
    from meshing import crossover as mesher

    given = catalogue.load(fabric)
    return mesher.build(given, size=size, **options), given


def _columns(found):
    names = "path", "d1", "d2", "plates", "T1", "T2", "F_c", "F_plate", "d_c", "failed"
    return {name: getattr(found, name) for name in names}


def stretched(fabric: str, *, ratio: Sequence[float], reach: float | None = None) -> SimpleNamespace:
    """A biaxial path to fibre failure or to `reach` [m]; at its end the centrelines and the thickness of the yarns."""
    from unitcell3d.cases import biaxial_and_platens

    mesh, given = _meshed(fabric)
    found = biaxial_and_platens.biaxial(mesh, given, ratio, max_displacement=reach)
    x, lines = mesh.points + found.last["u"], []
    for grid, axis, sign in zip(mesh.grids, (0, 1), (1, -1)):
        # the axis of the yarn over the plane of symmetry across it: middle of each column through the thickness
        low, high = x[grid[:, 0, 0]], x[grid[:, 0, -1]]
        lines.append(np.stack([0.5 * (low + high)[:, axis], sign * 0.5 * (low + high)[:, 2]]))
    thickness = [np.array([np.ptp(points[grid[0, 0], 2]) for grid in mesh.grids]) for points in (mesh.points, x)]
    return SimpleNamespace(**_columns(found), lines=lines, thickness=thickness[0], thickness_end=thickness[1])


def plates(fabric: str) -> SimpleNamespace:
    """The crossover pressed between plates."""
    from unitcell3d.cases import biaxial_and_platens

    return SimpleNamespace(**_columns(biaxial_and_platens.plate_compression(*_meshed(fabric))))


def lone(fabric: str, *, family: int, bars: int | None = None, one_point: bool = False) -> SimpleNamespace:
    """One yarn alone, pulled straight and on; `bars` 0 takes its fibres away, `one_point` integrates the least."""
    from unitcell3d.cases import single_yarn
    from unitcell3d.material import solid_law

    integration = solid_law.ONE_POINT if one_point else solid_law.FULL
    strain = 0.06 if bars == 0 else None
    mesh, given = _meshed(fabric)
    found = single_yarn.pull(mesh, given, family, bars=bars, integration=integration, strain=strain)
    return SimpleNamespace(strain=found.columns["strain"], T=found.columns["T"])


def sections(fabric: str) -> SimpleNamespace:
    """Sections of whole yarns, warp and weft: `area` (2,) [m2] their volume over the length of their centreline,
    `fibre` (2,) [m2] of the bars that cut the section at the crossing."""
    mesh, _ = _meshed(fabric)
    area, fibre = [], []
    for number, (grid, pairs, bars, S0) in enumerate(zip(mesh.grids, mesh.bars, mesh.bar_area, mesh.S0)):
        # half of the length and half of the section are meshed
        area.append(4 * _volume(mesh.points[mesh.hexes[mesh.yarn == number]]) / S0)
        fibre.append(float(bars[np.isin(pairs, grid[0]).any(axis=1)].sum()) / mesh.share)
    return SimpleNamespace(area=np.array(area), fibre=np.array(fibre))


def _volume(corners):
    """[m3] of bricks (m, 8, 3) in VTK order: six tetrahedra each, about the diagonal from corner 0 to corner 6."""
    first, last = corners[:, 0], corners[:, 6]
    sixths = [
        np.einsum("ij,ij->i", np.cross(corners[:, a] - first, corners[:, b] - first), last - first)
        for a, b in itertools.pairwise((1, 2, 3, 7, 4, 5, 1))
    ]
    return float(abs(np.sum(sixths)) / 6)


def meshes(fabric: str, *, sections: Sequence[str]) -> SimpleNamespace:
    """What the mesher makes of a fabric, by section: deviation of the axis from a cosine and spread of the thickness
    over that at the crest [-], deepest point of the weft in the warp [m]; and the yarns of each domain."""
    from meshing import patch

    found: dict[str, Any] = {}
    for section in sections:
        mesh, given = _meshed(fabric, section=section)
        errors, spread = [], []
        for grid, w, h, axis in zip(mesh.grids, mesh.w, mesh.h0, (0, 1)):
            middle = 0.5 * (mesh.points[grid[:, 0, 0]] + mesh.points[grid[:, 0, -1]])
            errors.append(np.ptp(np.abs(middle[:, 2]) - h * np.cos(np.pi * middle[:, axis] / (2 * w))) / h)
            heights = mesh.points[grid[:, :, -1], 2] - mesh.points[grid[:, :, 0], 2]
            spread.append(np.ptp(heights, axis=0).max() / heights.max())
        found[section] = {"cosine": max(errors), "spread": max(spread), "overlap": _overlap(mesh)}
    return SimpleNamespace(sections=found, four=len(patch.build(given, (2, 2), size=SIZE).names))


def _overlap(mesh):
    """[m] deepest point of the weft's upper face within the warp, on the nodes of the quarter; 0 if none."""
    from scipy.interpolate import LinearNDInterpolator

    warp, weft = (mesh.points[grid] for grid in mesh.grids)
    lower, upper = warp[:, :, 0].reshape(-1, 3), weft[:, :, -1].reshape(-1, 3)
    below = LinearNDInterpolator(lower[:, :2], lower[:, 2])(upper[:, :2])
    return float(max(np.nanmax(upper[:, 2] - below), 0.0))


def brick(fabric: str, *, stretch: Sequence[float]) -> SimpleNamespace:
    """Cauchy stress [Pa] along the fibre of one brick of warp at three stretches, and its fibre fraction."""
    from unitcell3d.assembly.compat import Assembler, HexSpace
    from unitcell3d.material.solid_law import forms

    law = catalogue.load(fabric).solid_laws[0]
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
    space = HexSpace.build(corners, np.arange(8)[None])
    constants = space.cell_constants(np.array([[law.E_a, law.a_E, law.b_E, law.Vf0, law.V_c, law.G]]))
    solid = Assembler(space, *forms(space, constants))
    a, b, c = stretch
    space.set_displacement(corners * (np.array(stretch) - 1))
    nominal = (solid.residual().T @ corners)[0, 0]
    return SimpleNamespace(stress=nominal / (b * c), V_f=law.Vf0 / (b * c), strain=float(np.log(a)), E_a=law.E_a)


def released(
    fabric: str, *, plies: int, friction: float, closed: float, size: tuple[int, int, int] = (4, 3, 2)
) -> SimpleNamespace:
    """Aligned plies between plates that close and open again: (closure [m], pressure [Pa]) of both branches.

    Parameters
    ----------
    fabric, plies : name, number
    friction : [-] Coulomb's coefficient between yarns, and between yarns and plates
    closed : [-] share of the first distance of the plates by which they close
    size : of the mesh of a quarter yarn
    """
    from unitcell3d.cases.stack import StackModel
    from unitcell3d.model.crossover import Load, Numerics
    from unitcell3d.solver import path_following

    mesh, given = _meshed(fabric, size=tuple(size))
    model = StackModel(mesh, given, plies, Numerics(friction=friction))
    rest, area = model.plates.at_rest, given.weave.cell_area

    def row(state, load):
        force = model.copies[1] * float(np.mean(state.plates))
        return {"closure": 2 * (rest - load.plates), "pressure": force / area}

    loads = [Load(plates=share * rest) for share in (1.0, 1.0 - closed, 1.0)]
    found = path_following.follow(model, loads, row, rows=(ROWS, ROWS))
    branches = np.array([[row[key] for row in found.rows] for key in ("closure", "pressure")])
    turn = int(np.argmax(branches[0]))
    return SimpleNamespace(loading=branches[:, : turn + 1], unloading=branches[:, turn:])
