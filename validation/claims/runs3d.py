"""The computations of the 3D crossover and of its packs that checks share: see `runs`. They need dolfinx and gmsh."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fabrics import catalogue

if TYPE_CHECKING:
    from validation.claims.registry import RunResult

COLUMNS = (
    "path",
    "d1",
    "d2",
    "plates",
    "T1",
    "T2",
    "F_c",
    "F_plate",
    "h1",
    "h2",
    "d_c",
    "d_yarns",
    "fibre_strain_mean",
    "fibre_strain_max",
)


def stretched(*, fabric: str, ratio: Sequence[float], size: str = "coarse", reach: float | None = None) -> RunResult:
    """A biaxial path of the crossover, to fibre failure or to `reach` [m]; with the deformed centrelines at its end."""
    from meshing import crossover as mesher
    from unitcell3d.cases import biaxial_and_platens

    given = catalogue.load(fabric)
    mesh = mesher.build(given, size=size)
    found = biaxial_and_platens.biaxial(mesh, given, ratio, max_displacement=reach)
    x = mesh.points + found.last["u"]
    lines = []
    for grid, axis, sign in zip(mesh.grids, (0, 1), (1, -1)):
        # the axis of the yarn over the plane of symmetry across it: middle of each column through the thickness
        low, high = x[grid[:, 0, 0]], x[grid[:, 0, -1]]
        lines.append(np.stack([0.5 * (low + high)[:, axis], sign * 0.5 * (low + high)[:, 2]]))
    thick = [np.ptp(mesh.points[grid[0, 0], 2]) for grid in mesh.grids]
    now = [np.ptp(x[grid[0, 0], 2]) for grid in mesh.grids]
    return {name: getattr(found, name) for name in COLUMNS} | {
        "failed": found.failed,
        "lines": lines,
        "thickness": np.array(thick),
        "thickness_end": np.array(now),
    }


def lone(
    *, fabric: str, family: int, size: str = "coarse", bars: int | None = None, one_point: bool = False
) -> RunResult:
    """One yarn alone, pulled straight and on; `bars` 0 takes its fibres away, `one_point` integrates the least."""
    from meshing import crossover as mesher
    from unitcell3d.cases import single_yarn as cases_single_yarn
    from unitcell3d.material import solid_law

    given = catalogue.load(fabric)
    found = cases_single_yarn.pull(
        mesher.build(given, size=size),
        given,
        family,
        bars=bars,
        integration=solid_law.ONE_POINT if one_point else solid_law.FULL,
        strain=0.06 if bars == 0 else None,
    )
    return {name: found.columns[name] for name in ("strain", "T", "T_taut", "astray")} | {"failed": found.failed}


def plates(*, fabric: str, size: str = "coarse") -> RunResult:
    """The crossover pressed between plates."""
    from meshing import crossover as mesher
    from unitcell3d.cases import biaxial_and_platens

    given = catalogue.load(fabric)
    found = biaxial_and_platens.plate_compression(mesher.build(given, size=size), given)
    return {name: getattr(found, name) for name in COLUMNS} | {"failed": found.failed}


def meshes(*, fabric: str, sections: Sequence[str], size: str = "coarse") -> RunResult:
    """What the mesher makes of a fabric: yarn volumes, deviation of the axis from a cosine, least gap, domains."""
    from meshing import crossover as mesher
    from meshing import patch

    given, found = catalogue.load(fabric), {}
    for section in sections:
        mesh = mesher.build(given, size=size, section=section)
        errors, spread = [], []
        for grid, w, h, axis in zip(mesh.grids, mesh.w, mesh.h0, (0, 1)):
            middle = 0.5 * (mesh.points[grid[:, 0, 0]] + mesh.points[grid[:, 0, -1]])
            rise = np.abs(middle[:, 2])
            wave = h * np.cos(np.pi * middle[:, axis] / (2 * w))
            errors.append(np.ptp(rise - wave) / h)
            heights = mesh.points[grid[:, :, -1], 2] - mesh.points[grid[:, :, 0], 2]
            spread.append(np.ptp(heights, axis=0).max() / heights.max())
        found[section] = {"cosine": max(errors), "spread": max(spread), "overlap": _overlap(mesh)}
    parts = {domain: len(mesher.build(given, size=size, domain=domain).names) for domain in ("quarter", "whole")}
    return {"sections": found, "yarns": parts | {"four": len(patch.build(given, (2, 2), size=size).names)}}


def brick(*, fabric: str, stretch: Sequence[float]) -> RunResult:
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
    return {"stress": nominal / (b * c), "V_f": law.Vf0 / (b * c), "strain": float(np.log(a)), "E_a": law.E_a}


def _overlap(mesh):
    """[m] deepest point of the weft's upper face within the warp, on the nodes of the quarter; 0 if none."""
    from scipy.interpolate import LinearNDInterpolator

    warp, weft = (mesh.points[grid] for grid in mesh.grids)
    lower, upper = warp[:, :, 0].reshape(-1, 3), weft[:, :, -1].reshape(-1, 3)
    below = LinearNDInterpolator(lower[:, :2], lower[:, 2])(upper[:, :2])
    depth = upper[:, 2] - below
    return float(max(np.nanmax(depth), 0.0))


ROWS = 30  # of the loading of a pack, and of its unloading


def released(
    *, fabric: str, plies: int, friction: float, closed: float, size: tuple[int, int, int] = (4, 3, 2)
) -> RunResult:
    """Aligned plies between plates that close and open again: closure [m] and pressure [Pa] of both branches.

    Parameters
    ----------
    fabric, plies : name, number
    friction : [-] Coulomb's coefficient between yarns, and between yarns and plates
    closed : [-] share of the first distance of the plates by which they close
    size : of the mesh of a quarter yarn
    """
    from meshing import crossover as mesher
    from unitcell3d.cases.stack import StackModel
    from unitcell3d.model.crossover import Load, Numerics
    from unitcell3d.solver import path_following

    given = catalogue.load(fabric)
    model = StackModel(mesher.build(given, size=tuple(size)), given, plies, Numerics(friction=friction))
    rest, area = model.plates.at_rest, given.weave.cell_area

    def row(state, load):
        force = model.copies[1] * float(np.mean(state.plates))
        return {"closure": 2 * (rest - load.plates), "pressure": force / area}

    loads = [Load(plates=share * rest) for share in (1.0, 1.0 - closed, 1.0)]
    found = path_following.follow(model, loads, row, rows=(ROWS, ROWS))
    closure, pressure = (np.array([row[key] for row in found.rows]) for key in ("closure", "pressure"))
    turn = int(np.argmax(closure))
    return {
        "loading": np.array([closure[: turn + 1], pressure[: turn + 1]]),
        "unloading": np.array([closure[turn:], pressure[turn:]]),
        "failed": found.failed,
    }


RUNS = {
    "stretched": (stretched, 20),
    "plates": (plates, 60),
    "lone": (lone, 10),
    "meshes": (meshes, 5),
    "brick": (brick, 3),
    "released": (released, 25),
}
