"""The study of the 3D crossover: its judgement on values with a known limit, its files, and one real case."""

import json
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("dolfinx")

from meshing import crossover as mesher
from unitcell3d.assembly.constraints import AXIAL, VERTICAL
from unitcell3d.cases import biaxial_and_platens as loads
from unitcell3d.model.crossover import Numerics
from validation.verification.crossover_convergence import cases, study
from validation.verification.crossover_convergence.axes import BASE, METHOD, axes
from validation.verification.crossover_convergence.cases import solve

FABRIC, PATHS = study.scene()
TRUE = {"T1": 300.0, "T2": 80.0, "F_c": 50.0}


def test_held_ends():
    """Which components of the end face move with the end alone: its middle row, the whole along the yarn, or both."""
    mesh = mesher.build(FABRIC, size=(3, 2, 2))
    n = len(mesh.points)
    for end in (cases.PIN, cases.UPRIGHT, cases.CLAMPED):
        held = cases.held(mesh.grids, n, end)
        unknown = held.unknown.reshape(-1, 3)
        for yarn, grid in enumerate(mesh.grids):
            face, row = grid[-1], grid[-1][:, 1]
            assert np.all(unknown[row][:, [AXIAL[yarn], VERTICAL]] == -1)
            others = np.setdiff1d(face, row)
            assert np.all((unknown[others, AXIAL[yarn]] == -1) == (end != cases.PIN))
            assert np.all((unknown[others, VERTICAL] == -1) == (end == cases.CLAMPED))
        d = np.array([2e-6, 3e-6])
        moved = held.displacement(np.zeros(held.size), d)
        for yarn, grid in enumerate(mesh.grids):
            assert np.allclose(moved[grid[-1], AXIAL[yarn]], d[yarn])
            assert np.allclose(moved[grid[0]], 0)
        free = np.flatnonzero(held.unknown >= 0)
        assert len(set(held.unknown[free])) == len(free) == held.size


def test_a_case_is_the_library_s_own_path():
    case = replace(BASE, size=(2, 2, 2), numerics=(("penalty", 0.5 * Numerics().penalty),))
    path = {"warp only": PATHS["warp only"]}
    result = solve(FABRIC, path, case)
    mesh = mesher.build(FABRIC, size=(2, 2, 2))
    history = loads.biaxial(mesh, FABRIC, (1, 0), max_displacement=path["warp only"][0], numerics=case.full_numerics)
    for quantity in TRUE:
        assert result["values"][f"{quantity}, warp only"] == pytest.approx(getattr(history, quantity)[-1], rel=1e-9)
    assert result["failed"] == {}
    assert result["tangents"] >= history.iterations.sum()
    assert json.loads(json.dumps(result)) == result
    stiff = solve(FABRIC, path, replace(case, end=cases.CLAMPED))
    assert stiff["values"]["T2, warp only"] > 1.02 * result["values"]["T2, warp only"]
    assert all(axis.kind == METHOD or axis.x is None for axis in axes())
