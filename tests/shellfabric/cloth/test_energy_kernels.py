"""Energies of whole cloth, eight at a time, against plain numpy on a random state."""

from math import factorial

import numpy as np
import pytest
from conftest_tools import bring, grid
from scipy.integrate import quad

from shellfabric.cell import packed_table
from shellfabric.solver import ply_kernels


@pytest.fixture
def shaken(small):
    """A panel at random, sheared by up to 40 degrees, of which edges at the rim store nothing."""
    panel, rng = small(symmetry="quarter"), np.random.default_rng(5)
    const, state = panel.constants(), panel.state(50.0)
    X, Y = panel.coordinates()
    angle = 0.7 * X / X.max()
    x = np.stack([1.01 * X + Y * np.sin(angle), 1.01 * Y * np.cos(angle), np.zeros_like(X)], axis=-1)
    bring(panel, state, x + 0.01 * const.dx * rng.standard_normal(x.shape))
    warp, weft = (grid(const, length) for length in state.yarn_length)
    warp[:, [0, -1]] = 0.0  # not crossed four times
    weft[[0, -1]] = 0.0
    for v, f in zip(state.v, state.f_contact):
        v[: X.size], f[: X.size] = rng.standard_normal((2, X.size)) * [[30.0], [0.1]]
    return panel, const, state


def energies(state, const):
    out = np.zeros(5)
    ply_kernels.energies(state, const, None, out)
    return out


def test_kinetic_energy(shaken):
    """m v(n-1/2) v(n+1/2) / 2 of all nodes that no clamp holds."""
    _, const, state = shaken
    expected, free = 0.0, np.ones((const.ni + 1, const.nj + 1), bool)
    free[-1], free[:, -1] = False, False
    for c in range(3):
        force = grid(const, state.f_int[c] + state.f_int_above[c] + state.f_contact[c])
        v, m = grid(const, state.v[c]), grid(const, state.mass)
        expected += 0.5 * np.sum((m * v * (v + const.dt * force / m))[free])
    assert energies(state, const)[0] == pytest.approx(expected, rel=1e-12)


def derivative(c, p, q, m, n):
    """d^(m + n) / dp^m dq^n of the sum of c[3 a + b] p^a q^b."""
    return sum(
        c[3 * a + b] * factorial(a) / factorial(a - m) * p ** (a - m) * factorial(b) / factorial(b - n) * q ** (b - n)
        for a in range(m, 3)
        for b in range(n, 3)
    )


def spline(table, L1, L2):
    """[J] of a crossover, the plain table's; beyond it as `table_kernels` has it, below it as at its edge."""
    p, q = ((L - x[0]) / (x[1] - x[0]) for L, x in ((L1, table.stretch1), (L2, table.stretch2)))
    p, q = np.maximum(p, 0), np.maximum(q, 0)
    i, j = (np.minimum(place.astype(int), n - 1) for place, n in zip((p, q), table.spline.shape))
    p, q = p - i, q - j
    inside, over = np.minimum([p, q], 1), np.maximum([p - 1, q - 1], 0)
    cells, corner = np.moveaxis(table.spline[i, j], -1, 0), table.spline[-1, -1]
    far = over / (1 + over * np.reshape(table.steps, (2, 1, 1)) / packed_table.REACH)
    one = np.ones(2)
    found = derivative(cells, *inside, 0, 0) + far.prod(axis=0) * derivative(cells, *inside, 1, 1)
    for k, (first, second) in enumerate((((1, 0), (2, 0)), ((0, 1), (0, 2)))):
        slope, curvature = (derivative(corner, *one, *orders) for orders in (first, second))
        found += (
            far[k] * (derivative(cells, *inside, *first) - slope) + slope * over[k] + 0.5 * curvature * over[k] ** 2
        )
    return found


def test_energy_of_yarns(shaken):
    """Half a crossover's for each edge, per cell length, of its own stretch and the mean of those that cross it."""
    panel, const, state = shaken
    L1, L2 = (grid(const, L) for L in state.stretch)
    y1, y2 = (grid(const, y) for y in state.yarn_length)
    mean2 = 0.25 * (L2[:-1, :-2] + L2[:-1, 1:-1] + L2[1:, :-2] + L2[1:, 1:-1])
    mean1 = 0.25 * (L1[:-2, :-1] + L1[:-2, 1:] + L1[1:-1, :-1] + L1[1:-1, 1:])
    W1, W2 = spline(panel.table, L1[:-1, 1:-1], mean2), spline(panel.table, mean1, L2[1:-1, :-1])
    w1, w2 = panel.weave.w
    expected = 0.5 * np.sum(y1[:-1, 1:-1] * W1) / (2 * w1) + 0.5 * np.sum(y2[1:-1, :-1] * W2) / (2 * w2)
    assert energies(state, const)[1] == pytest.approx(expected, rel=1e-11)


def test_energy_of_trellis(shaken):
    """Twice integrated, a modulus that rises from G1 at gamma1 to G2 at gamma2, over the angles between mean edges."""
    panel, const, state = shaken
    X, Y = panel.coordinates()
    rest = np.stack([X, Y, np.zeros_like(X)])
    x, shear = rest + np.stack([grid(const, u) for u in state.u]), panel.fabric.shear
    warp, weft = np.diff(x, axis=1) / const.dx, np.diff(x, axis=2) / const.dy
    a, b = warp[:, :, :-1] + warp[:, :, 1:], weft[:, :-1] + weft[:, 1:]
    lengths = (np.linalg.norm(part, axis=0) for part in (warp, weft))
    own, other = next(lengths), next(lengths)
    sine = (a * b).sum(0) / ((own[:, :-1] + own[:, 1:]) * (other[:-1] + other[1:]))
    angles = np.arcsin(np.abs(sine)).ravel()
    assert angles.min() < shear.gamma1 < shear.gamma2 < angles.max()

    def modulus(g):
        return np.interp(g, [shear.gamma1, shear.gamma2], [shear.G1, shear.G2])

    kinks = [shear.gamma1, shear.gamma2]
    U = [quad(lambda g, a=a: (a - g) * modulus(g), 0, a, points=[k for k in kinks if k < a])[0] for a in angles]
    expected = const.dx * const.dy * panel.weave.thickness * np.sum(U)
    assert energies(state, const)[2] == pytest.approx(expected, rel=1e-9)
