"""Scaled Jacobian and volume of hexahedra against closed forms and against VTK."""

import numpy as np
import pytest
from hexahedra import CUBE, volumes

from meshing.quality import scaled_jacobian

ONE = np.arange(8)[None]


@pytest.mark.parametrize("a, b", [(0.0, 0.0), (0.0, 0.5), (0.3, 0.0), (0.6, 1.5)])
def test_a_sheared_brick_in_any_place(a, b):
    """Edges (1,0,a), (0,1,b), (0,0,1), each of any length: the shape of every element of a yarn, of slopes a and b."""
    turn, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    edges = np.array([(1e-3, 0, 1e-3 * a), (0, 3e-5, 3e-5 * b), (0, 0, 2.0)])
    sheared = CUBE @ edges @ turn + 7
    assert scaled_jacobian(sheared, ONE)[0] == pytest.approx(
        1 / np.sqrt((1 + a * a) * (1 + b * b)), rel=1e-9
    )


def test_degenerate_and_inverted():
    flat = CUBE.copy()
    inside_out = CUBE * (1, 1, -1)
    flat[6] = flat[2]
    assert scaled_jacobian(flat, ONE)[0] == 0
    assert scaled_jacobian(inside_out, ONE)[0] == -1
    assert volumes(inside_out, ONE)[0] == pytest.approx(-1)


def test_volume_of_trilinear_elements_is_exact():
    """A frustum of a pyramid: base 1, top c, height 1: (1 + c + c^2) / 3."""
    for c in (0.1, 0.5, 2.0):
        frustum = CUBE - (0.5, 0.5, 0)
        frustum[4:, :2] *= c
        assert volumes(frustum, ONE)[0] == pytest.approx((1 + c + c * c) / 3, rel=1e-14)


def test_random_elements_agree_with_vtk():
    pyvista = pytest.importorskip("pyvista")
    rng = np.random.default_rng(0)
    points = (CUBE + 0.35 * rng.normal(size=(200, 8, 3))).reshape(-1, 3)
    hexes = np.arange(1600).reshape(200, 8)
    grid = pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: hexes}, points)
    # VTK also looks at the centre of the element, which can only be worse where the corners are already poor.
    theirs = np.asarray(grid.cell_quality("scaled_jacobian")["scaled_jacobian"])
    ours = scaled_jacobian(points, hexes)
    assert np.all(theirs <= ours + 1e-9)
    assert np.mean(abs(theirs - ours) < 1e-9) > 0.9
