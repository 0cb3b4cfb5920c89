"""The contact of the crossover on linear materials: Hertz's line and point contact, the patch test.

Hertz (Johnson, Contact Mechanics, chapter 4), two half spaces of E, nu, so E* = E / (2 (1 - nu^2)):

    cylinder on plane            a^2 = 4 P' R / (pi E*),   p0 = 2 P' / (pi a)         mean of x^2 under the load: a^2/4
    crossed equal cylinders      a^3 = 3 P R / (4 E*),     p0 = 3 P / (2 pi a^2)      mean of r^2: 2 a^2/5
"""

import numpy as np
import pytest
from blocks import Blocks, block, graded, level

from unitcell3d.model.crossover import Numerics

E = 1e9
NU = 0.3
R = 1e-3
STIFF = E / 2 / (1 - NU**2)
HARD = Numerics(penalty=1e15, toe=1e-9)


def under_load(blocks, yarn, quantity):
    """Mean of a function of (x, y) [m], weighted with the nodal contact forces of one face, and the pressure at 0."""
    grid = blocks.grids[0][:, :, 0] if yarn == 0 else blocks.grids[1][:, :, -1]
    force = abs(blocks.contact[grid.ravel(), 2])
    return np.average(quantity(blocks.points[grid.ravel(), :2]), weights=force), blocks.pressures(
        yarn
    )[1][0]


def test_cylinder_on_plane():
    strip = 5e-5
    along = graded(0.8e-3, 30, 20)
    through = graded(0.8e-3, 26, 20)
    width = np.array([0, strip])
    bodies = (
        block(0, along, width, through, lambda x, y: x**2 / (2 * R)),
        block(1, width, along, through, level),
    )
    pair = Blocks(*bodies, E, NU, numerics=HARD)
    # plane strain
    pair.press(4e-6, hold=[(np.flatnonzero(np.isclose(pair.points[:, 1], strip)), 1)])
    P = 2 * pair.lift / strip
    a = np.sqrt(4 * P * R / np.pi / STIFF)
    assert 8 < a / along[1] < 20
    for yarn in (0, 1):
        square, p0 = under_load(pair, yarn, lambda x: x[:, 0] ** 2)
        assert np.sqrt(4 * square) == pytest.approx(a, rel=0.02)
        assert p0 == pytest.approx(2 * P / np.pi / a, rel=0.02)


@pytest.mark.slow
def test_crossed_cylinders():
    along = graded(0.4e-3, 10, 8)
    through = graded(0.4e-3, 6, 12)
    bodies = (
        block(0, along, along, through, lambda x, y: y**2 / (2 * R)),
        block(1, along, along, through, lambda x, y: -(x**2) / (2 * R)),
    )
    pair = Blocks(*bodies, E, NU, numerics=HARD)
    pair.press(8e-6)
    P = 4 * pair.lift
    a = (0.75 * P * R / STIFF) ** (1 / 3)
    for yarn in (0, 1):
        square, p0 = under_load(pair, yarn, lambda x: (x**2).sum(axis=1))
        assert np.sqrt(2.5 * square) == pytest.approx(a, rel=0.02)
        assert p0 == pytest.approx(1.5 * P / np.pi / a**2, rel=0.02)


def flat(n_upper, n_lower, side=1e-3):
    upper = np.linspace(0, side, n_upper + 1)
    lower = np.linspace(0, side, n_lower + 1)
    depth = np.linspace(0, side / 2, 3)
    bodies = (
        block(0, upper, upper, depth, level),
        block(1, lower, lower, depth, level),
    )
    return Blocks(*bodies, E, NU, numerics=Numerics(penalty=1e16, toe=1e-11))


def misfit(pair, descent=1e-6):
    """Largest deviation of the vertical displacement from that of a uniform column, over the descent."""
    u = pair.press(descent)
    z = pair.points[:, 2]
    top = z.max()
    low = z.min()
    upper = np.concatenate([np.zeros(pair.grids[0].size, bool), np.ones(pair.grids[1].size, bool)])
    # each half of the column takes half of the descent, but for the penetration
    ideal = np.where(
        upper, -descent / 2 * (z - low) / -low, -descent + descent / 2 * (top - z) / top
    )
    return abs(u[:, 2] - ideal).max() / descent


@pytest.mark.parametrize("cells", [(4, 4), (3, 4), (5, 8), (6, 8)])
def test_contact_patch(cells):
    """A uniform pressure goes through faces whose meshes need not match: within 0.1 %.

    Found: 0.005 % where the meshes match, that is the penetration of the penalty, E / (penalty L) = 1e-4; up to 0.07 %
    where they do not, the error of two Gauss points along a face of the slave on the master's cubics (with three points
    0.009 %). Slave nodes with lumped areas on a surface through the nodes left 2 to 4 %.
    """
    pair = flat(*cells)
    assert misfit(pair) < 1e-3
    assert pair.lift == pytest.approx(E * 1e-6 / 1e-3 * 1e-6, rel=5e-4)
