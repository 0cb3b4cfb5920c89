"""Hexahedra of order 2 hold a displacement that is quadratic, on the nodes of the bricks that they replace."""

import numpy as np
import pytest

from fabrics.base.errors import InputError

pytest.importorskip("dolfinx")
ufl = pytest.importorskip("ufl")


def grid_of(counts):
    """(points, grid) of a box of 1 x 2 x 3 m."""
    axes = [np.linspace(0, side, n + 1) for side, n in zip((1.0, 2.0, 3.0), counts)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    return points, np.arange(len(points)).reshape([n + 1 for n in counts])


@pytest.mark.slow(2)
@pytest.mark.parametrize("mirrored", [False, True])
def test_the_energy_of_a_quadratic_displacement_is_exact(mirrored):
    """grad u : grad u of u = (x y, z^2, 3 x z); bricks of order 1 have more."""
    from unitcell3d.assembly.compat import Assembler, HexSpace
    from validation.models.second_order import blocks_of

    points, grid = grid_of((4, 2, 2))
    if mirrored:
        grid = grid[::-1]
    blocks = blocks_of(points, grid)
    assert blocks.shape == (2, 27)
    space = HexSpace.build(points, blocks)
    v = ufl.TestFunction(space.displacements)
    fields = space.displacement, ufl.TrialFunction(space.displacements)
    forms = [ufl.inner(ufl.grad(of), ufl.grad(v)) * ufl.dx for of in fields]
    solid = Assembler(space, *forms)
    x, y, z = points.T
    u = np.stack([x * y, z**2, 3 * x * z], -1)
    space.set_displacement(u)
    # y^2 + x^2 + 4 z^2 + 9 z^2 + 9 x^2 over the box
    exact = 6 * (4 / 3 + 10 / 3 + 13 * 3)
    assert np.sum(u * solid.residual()) == pytest.approx(exact, rel=1e-10)


def test_an_odd_number_of_bricks_is_refused():
    from validation.models.second_order import blocks_of

    with pytest.raises(InputError, match="even"):
        blocks_of(*grid_of((4, 3, 2)))
