"""Cells of a fabric from its 3D crossover: by a fitted law, by a response surface, or solved at each state."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Literal

import numpy as np

import weavecell as wc
from fabrics.base.errors import UnstableError
from meshing import crossover
from shellfabric.cell.model import CellModel
from shellfabric.cell.surface_cell import SurfaceCell
from unitcell3d.cases import biaxial_and_platens
from unitcell3d.identify import response_surface
from unitcell3d.model.crossover import CrossoverModel, Load
from unitcell3d.solver.path_following import follow
from validation.models.crossover_law import fitted
from validation.values import Values
from weavecell.api import meshes

Tensions = tuple[float, float]


def tensions(
    *,
    fabric: str,
    states: Mapping[str, tuple[float, float]],
    size: Sequence[int],
    cell: Literal["calibrate", "law", "surface", "paths"],
    lines: int = 5,
) -> Values:
    """Compute the tensions of a fabric at states of its crossover.

    Parameters
    ----------
    fabric : path of a fabric file without a law
    states : {name: (d1, d2)} [m] end displacements
    size : hexahedra along, across and through a quarter of a yarn
    cell : the shell's, by the law of `weavecell.calibrate`, by a law of its three paths alone, or by the surface of
        `weavecell.surface` over its default range; or the crossover, solved along a straight path to each state
    lines : of a surface in each direction

    Returns
    -------
    dict with T1, T2 {name: [N]}; cpu_s [s]
    """
    given = meshes.resolve_fabric_for_3d(fabric)
    began = time.process_time()
    if cell == "calibrate":
        at = _by_calibration(given, fabric, size)
    elif cell == "law":
        at = _by_law(given, size)
    elif cell == "surface":
        at = _by_surface(given, size, lines)
    else:
        at = _by_paths(given, size)
    found = {name: at(*state) for name, state in states.items()}
    return {
        "T1": {name: float(pair[0]) for name, pair in found.items()},
        "T2": {name: float(pair[1]) for name, pair in found.items()},
        "cpu_s": time.process_time() - began,
    }


def _by_calibration(given, fabric, size):
    mesh = ",".join(map(str, size))
    done = wc.calibrate(fabric, mesh=mesh, assumed_range=False, jobs=1)
    assert isinstance(done, wc.CalibrationResult)
    return _cell(given, done.law)


def _by_law(given, size):
    mesh = crossover.build(given, size=tuple(size))
    paths = [biaxial_and_platens.biaxial(mesh, given, ratio) for ratio in ((1, 0), (0, 1), (1, 1))]
    return _cell(given, fitted(*paths))


def _cell(given, law):
    model = CellModel(replace(given, laws=(law, law)))
    w1, w2 = given.weave.w

    def at(d1: float, d2: float) -> Tensions:
        found = model.solve(1 + d1 / w1, 1 + d2 / w2)
        return found["N1"], found["N2"]

    return at


def _by_surface(given, size, lines):
    # lines in this process, whose CPU time is told
    with ThreadPoolExecutor(1) as pool:
        sampled = response_surface.sample(
            given, points=(lines, lines), size=tuple(size), executor=pool
        )
    cell = SurfaceCell(given, sampled.surface)
    w1, w2 = given.weave.w

    def at(d1: float, d2: float) -> Tensions:
        found = cell.solve(np.array([1 + d1 / w1]), np.array([1 + d2 / w2]))
        return found["T1"][0, 0], found["T2"][0, 0]

    return at


def _by_paths(given, size):
    mesh = crossover.build(given, size=tuple(size))

    def at(d1: float, d2: float) -> Tensions:
        model = CrossoverModel(mesh, given)
        history = follow(model, [Load(), Load((d1, d2))], biaxial_and_platens.row(model))
        if history.failed:
            raise UnstableError(history.failed)
        return history["T1"][-1], history["T2"][-1]

    return at
