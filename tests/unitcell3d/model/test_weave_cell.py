"""Cells of weaves with floats: the least cell, who lies beside whom, and the tangent with sides in contact."""

from dataclasses import replace

import numpy as np
import pytest
from equations import assert_model_tangent

from fabrics.pattern import Pattern
from meshing import patch
from unitcell3d.assembly.symmetries import partners
from unitcell3d.cases.biaxial_and_platens import biaxial as of_one
from unitcell3d.cases.periodic_cell import biaxial
from unitcell3d.contact.periodic import Edges, Sides
from unitcell3d.model.periodic_cell import CellLoad, CellModel

SIZE = (3, 2, 1)
FEW = (2, 2, 1)


def woven(fabric, name):
    """The fabric in another weave with heights as in plain weave, the crimp of its changes of sides."""
    weave = replace(fabric.weave, pattern=Pattern.read(name))
    crimp = [f * y.crimp for f, y in zip(weave.pattern.interlacings, weave.yarns)]
    return replace(fabric, weave=weave).with_yarns(crimp=crimp)


@pytest.mark.parametrize(
    ("name", "cell"),
    [
        ("plain", (1, 1, -1)),
        ("basket 2x2", (2, 2, -1)),
        ("twill 2/2", (2, 2, -1)),
        ("twill 3/1", (4, 4, 1)),
        ("satin 5", (5, 5, 1)),
    ],
)
def test_least_cell(name, cell):
    assert Pattern.read(name).cell == cell


@pytest.mark.parametrize(
    "name",
    [
        "plain",
        "basket 2x2",
        "twill 2/2",
        "twill 2/1",
        pytest.param("twill 3/1", marks=pytest.mark.slow),
        pytest.param("satin 5", marks=pytest.mark.slow),
    ],
)
def test_a_symmetry_takes_the_mesh_into_itself(s720, name):
    """Each node to where another is, in a repeat further on or in this one."""
    fabric = woven(s720, name)
    *count, parity = fabric.weave.pattern.cell
    mesh = patch.build(fabric, count, size=FEW)
    w = np.array(fabric.weave.w)
    period = np.array(count[::-1])
    first = np.append((1 - period) * w, 0.0)  # where the first yarns cross
    for symmetry in fabric.weave.pattern.symmetries:
        nodes, images, signs = partners(mesh, 2 * FEW[0], period, parity, symmetry)
        moved = (mesh.points[nodes] - first) * (symmetry.weft_sign, symmetry.warp_sign, 1)
        moved += (*(2 * w * (symmetry.weft, symmetry.warp)), 0)
        apart = moved - (mesh.points[images] - first)
        repeats = np.round(apart[:, :2] / (2 * w * period))
        assert abs(apart[:, :2] - 2 * w * period * repeats).max() < 1e-10
        turned = symmetry.upside_down ^ ((parity < 0) & (repeats.sum(axis=1) % 2 == 1))
        assert (signs[:, 2] == np.where(turned, -1, 1)).all()
        height = np.where(turned, -1, 1) * mesh.points[nodes, 2]
        assert abs(height - mesh.points[images, 2]).max() < 1e-10


@pytest.mark.parametrize(
    "name",
    [
        pytest.param("basket 2x2", marks=pytest.mark.slow(15)),
        pytest.param("twill 2/2", marks=pytest.mark.slow(6)),
    ],
)
def test_half_a_repeat_upside_down_is_the_repeat(s720, name):
    """Two by two yarns and four by four, and tensions, contact and sides."""
    fabric = woven(s720, name)
    d = (5e-6, 8e-6)
    half, whole = (
        biaxial(patch.build(fabric, (n, n), size=SIZE), fabric, d, rows=2) for n in (2, 4)
    )
    for column in ("T1", "T2", "F_c", "d_c"):
        assert half[column][-1] > 0
        assert half[column][-1] == pytest.approx(whole[column][-1], rel=1e-6)
    assert half["F_side"][-1] == pytest.approx(whole["F_side"][-1], rel=1e-5)


@pytest.mark.parametrize(
    ("name", "kinds"), [("basket 2x2", {Edges, Sides}), ("twill 2/2", {Sides})]
)
def test_neighbours_lie_side_by_side_or_pass(s720, name, kinds):
    fabric = woven(s720, name)
    model = CellModel(patch.build(fabric, (2, 2), size=SIZE), fabric, sheared=False)
    assert {type(side) for _, side in model.beside} == kinds


def test_sides_hold_a_group_apart_and_the_tangent_is_the_derivative(s720):
    fabric = woven(s720, "basket 2x2")
    mesh = patch.build(fabric, (2, 2), size=SIZE)
    model = CellModel(mesh, fabric, sheared=False)
    load = CellLoad(model.w, (4e-6, 6e-6))
    rng = np.random.default_rng(3)
    q = 2e-7 * rng.standard_normal(model.size)
    for yarn in (1, 3):  # the second of each group is moved to the first, and that to it
        across = 3 * mesh.grids[yarn].ravel() + 1 - mesh.families[yarn]
        q[model.constraints.unknown[across]] -= 50e-6 * model.constraints.sign[across]
    model.forces(q, load)
    sides = [side for _, side in model.beside if isinstance(side, Sides)]
    assert min(side.gaps.min() for side in sides) < 0
    forces = np.zeros_like(model.points)
    assert (
        sum(side.assemble(model.positions(q, load), model.numerics, forces) for side in sides) > 0
    )
    assert abs(forces.sum(axis=0)).max() < 1e-12 * abs(forces).sum()
    for _ in range(2):
        model.forces(q, load)
        model.system(q, load)
    assert_model_tangent(model, q, load, rng.standard_normal(model.size))


def test_plain_weave_is_its_own_repeat(s720):
    """One crossing upside down, and 2 x 2 as they are: tensions, contact force and compression."""
    d = (6e-6, 9e-6)
    fabric = replace(s720, section="conforming")
    one, four = (biaxial(patch.build(fabric, (n, n), size=SIZE), fabric, d, rows=2) for n in (1, 2))
    for name in ("T1", "T2"):
        assert one[name][-1] == pytest.approx(four[name][-1], rel=1e-8)
    for name in ("F_c", "d_c"):
        assert one[name][-1] > 0
        assert one[name][-1] == pytest.approx(four[name][-1], rel=1e-6)


def test_compression_of_a_cell_is_that_of_the_crossover(s720, meshed):
    """Half of the loss of both heights, by another way to measure it."""
    d = (6e-6, 9e-6)
    fabric = replace(s720, section="conforming")
    of_cell = biaxial(patch.build(fabric, (1, 1), size=SIZE), fabric, d, rows=2)
    alone = of_one(meshed(size=SIZE, section="conforming"), fabric, d, max_displacement=max(d))
    assert of_cell["d_c"][-1] == pytest.approx(alone["d_c"][-1], rel=0.1)
    assert of_cell["F_c"][-1] == pytest.approx(alone["F_c"][-1], rel=0.1)
