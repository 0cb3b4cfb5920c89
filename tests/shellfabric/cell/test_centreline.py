"""The cell of straight yarns, yarns whose tension curve has a foot, and compression that depends on their strain,
against plain twins."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from scipy.optimize import brentq, minimize

from fabrics import catalogue
from fabrics.base.errors import InputError
from fabrics.compression import CompressionLaw
from shellfabric.cell import crossover_kernels, yarn_kernels
from shellfabric.cell.model import CellModel

FABRIC = catalogue.load("glass-unbalanced")
LAWS = (CompressionLaw(2.1e-4, 1.6e-4), CompressionLaw(0.9e-4, 0.7e-4))
SLACK = (6e-4, 2e-4)
GAP = 1.5e-5
STIFFENING = 130.0
# [-] strains of warp and weft; crimp is 0.42 and 0.65 %
STRAINS = [(0.004, 0.008), (0.009, 0.002), (0.006, -0.001), (0.0, 0.009)]


def model(**changes):
    return CellModel(FABRIC, LAWS, GAP, centreline="straight", slack=SLACK, **changes)


def tension(m, strain):
    """[N] by the integral of the stiffness EA (1 - exp(-e / s))."""
    EA = FABRIC.weave.yarns[m].EA
    return EA * quad(lambda e: 1 - np.exp(-e / SLACK[m]), 0, max(strain, 0))[0]


def polyline(w, h):
    return 2 * np.hypot(w, h)


def plain_twin(strains, stiffening=0.0):
    """(T1, T2, F) of the triangle of forces at a crossing: F = 2 T h / sqrt(w^2 + h^2), (1 + s e) times that of the
    law of compression."""
    weave = FABRIC.weave
    w = [half * (1 + strain) for half, strain in zip(weave.w, strains)]
    rest = [np.sqrt((S0 / 2) ** 2 - half**2) for half, S0 in zip(weave.w, weave.S0)]

    def strain(m, h):
        return polyline(w[m], h) / weave.S0[m] - 1

    def pulled(m, h):
        return tension(m, strain(m, h))

    def height(m, F):
        least = np.sqrt(max((weave.S0[m] / 2) ** 2 - w[m] ** 2, 0))
        off = lambda h: 2 * pulled(m, h) * h / np.hypot(w[m], h) - F  # noqa: E731
        return brentq(off, least, w[m], xtol=1e-16, rtol=1e-13)

    def closing(F):
        heights = [height(m, F) for m in range(2)]
        squeezed = sum(
            float(law.d(F / (1 + stiffening * strain(m, heights[m])))) for m, law in enumerate(LAWS)
        )
        return sum(heights) + squeezed + GAP - sum(rest)

    F = brentq(closing, 1e-9, 1e3, rtol=1e-12)
    return pulled(0, height(0, F)), pulled(1, height(1, F)), F


@pytest.mark.parametrize("height", [0.02, 0.1, 0.35])
@pytest.mark.parametrize(
    ("curve", "curvature"),
    [
        (yarn_kernels.arc, yarn_kernels.arc_curvature),
        (yarn_kernels.straight_arc, yarn_kernels.straight_curvature),
    ],
    ids=["cosine", "straight"],
)
def test_slope_and_curvature_are_those_of_the_length(curve, curvature, height):
    """By differences over the height; without height the curvature is the limit."""
    w = 0.7e-3
    h = height * w
    step = 1e-4 * h
    above, below = curve(w, h + step), curve(w, h - step)
    assert curve(w, h)[1] == pytest.approx((above[0] - below[0]) / (2 * step), rel=1e-5)
    assert curvature(w, h) == pytest.approx((above[1] - below[1]) / (2 * step), rel=1e-5)
    assert curvature(w, 0.0) == pytest.approx(curvature(w, 1e-4 * w), rel=1e-5)


@pytest.mark.parametrize("strains", STRAINS)
def test_straight_yarns_with_feet_against_a_plain_twin(strains):
    found = model().solve(*(1 + np.array(strains)))
    got = [float(found[name]) for name in ("T1", "T2", "F")]
    assert_allclose(got, plain_twin(strains), rtol=1e-7, atol=1e-9)
    # both forms press at the crossing, and share tensions and contact force
    other = model(cell_formulation="equilibrium").solve(*(1 + np.array(strains)))
    assert_allclose([float(other[name]) for name in ("T1", "T2", "F")], got, rtol=1e-10)


@pytest.mark.parametrize("strains", STRAINS[1:3])
def test_compression_that_depends_on_the_strain_against_a_plain_twin(strains):
    cell = model(cell_formulation="equilibrium", stiffening=STIFFENING)
    found = cell.solve(*(1 + np.array(strains)))
    got = [float(found[name]) for name in ("T1", "T2", "F")]
    assert_allclose(got, plain_twin(strains, STIFFENING), rtol=1e-7, atol=1e-9)
    # without it the contact force is another
    assert abs(got[2] / plain_twin(strains)[2] - 1) > 0.02


def test_stiffer_yarns_settle_where_their_energy_is_least():
    """The heights of the variational form, beside those of the least energy of yarns and laws."""
    cell = CellModel(FABRIC, LAWS, GAP, centreline="straight", stiffening=STIFFENING)
    weave = FABRIC.weave
    stretch = 1 + np.array(STRAINS[1])
    w = weave.w * stretch
    room = sum(cell.h0) - GAP

    def energy(x):
        h = np.array(x[:2])
        d = np.array([x[2], room - h.sum() - x[2]])
        if (d < 0).any() or any(d >= [law.a for law in LAWS]):
            return np.inf
        e = polyline(w, h) / weave.S0 - 1
        if (e < 0).any():
            return np.inf
        of_yarns = sum(
            0.5 * yarn.EA * strain**2 * S0 for yarn, strain, S0 in zip(weave.yarns, e, weave.S0)
        )
        of_laws = [law.energy(one) for law, one in zip(LAWS, d)]
        return of_yarns + np.dot(1 + STIFFENING * e, of_laws)

    found = cell.solve(*stretch)
    h = [float(found["h1"]), float(found["h2"])]
    # the solver begins away from what it is held against
    start = [1.1 * h[0], 1.02 * h[1], 0.5 * (room - 1.1 * h[0] - 1.02 * h[1])]
    scale = 1e-4
    least = minimize(
        lambda x: 1e4 * energy(scale * x),
        np.array(start) / scale,
        method="Nelder-Mead",
        options={"xatol": 1e-9, "fatol": 1e-14, "maxiter": 4000, "maxfev": 4000},
    )
    assert_allclose(scale * least.x[:2], h, rtol=2e-5)
    assert float(found["W"]) == pytest.approx(1e-4 * least.fun, rel=1e-8)


def test_a_grid_of_stiffer_yarns_has_the_cells_own_states():
    cell = model(stiffening=STIFFENING)
    x, y = 1 + np.linspace(0, 0.012, 4), 1 + np.linspace(0, 0.008, 3)
    found = cell.solve_grid(x, y)
    exact = cell.solve(*np.meshgrid(x, y, indexing="ij"))
    for name in ("T1", "T2", "F", "W"):
        assert_allclose(found[name], exact[name], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("stiffening", [0.0, STIFFENING])
@pytest.mark.parametrize("centreline", ["straight", "cosine"])
def test_forces_are_the_gradient_of_the_energy(centreline, stiffening):
    cell = CellModel(FABRIC, LAWS, GAP, centreline=centreline, slack=SLACK, stiffening=stiffening)
    stretch = 1 + np.array([*STRAINS[:2], (0.017, 0.003)]).T
    found = cell.solve(*stretch)
    step = 1e-6
    for m, w in enumerate(FABRIC.weave.w):
        moved = step * np.eye(2)[m][:, None]
        rise = cell.solve(*(stretch + moved))["W"] - cell.solve(*(stretch - moved))["W"]
        assert_allclose(rise / (4 * step * w), found[f"N{m + 1}"], rtol=2e-6)


@pytest.mark.parametrize("centreline", ["straight", "cosine"])
def test_slopes_of_what_a_stiffer_yarn_carries_are_differences_of_it(centreline):
    """By its height and by the force that compresses it."""
    cell = CellModel(FABRIC, LAWS, GAP, centreline=centreline, slack=SLACK, stiffening=STIFFENING)
    crossover = cell.crossover
    for yarn, w, higher, F in zip(
        (crossover.warp, crossover.weft), FABRIC.weave.w, (1.4, 1.25), (0.6, 1.7)
    ):
        h = higher * crossover_kernels.slack_height(w, yarn, crossover)
        assert crossover_kernels.length(w, h, yarn, crossover)[0] > 1.001 * yarn.S0
        _, by_height, by_force = crossover_kernels.carried_force(w, h, F, yarn, crossover)

        def carried(h, F, yarn=yarn, w=w):
            return crossover_kernels.carried_force(w, h, F, yarn, crossover)[0]

        step = 1e-5 * h
        rise = carried(h + step, F) - carried(h - step, F)
        assert by_height == pytest.approx(rise / (2 * step), rel=1e-6)
        rise = carried(h, 1.0001 * F) - carried(h, 0.9999 * F)
        assert by_force == pytest.approx(rise / (2e-4 * F), rel=1e-6)


def test_the_table_is_filled_with_the_cells_own_states():
    cell = model()
    table = cell.table(31)
    x, y = np.meshgrid(table.stretch1, table.stretch2, indexing="ij")
    exact = cell.solve(x, y)
    for name in ("T1", "T2", "N1", "W"):
        assert_allclose(table.values[name], exact[name], atol=1e-9 * exact[name].max())
    # at its highest stretches each yarn is past its strength even alone, in spite of its foot
    for m, yarn in enumerate(FABRIC.weave.yarns):
        assert cell.alone(m, (table.stretch1, table.stretch2)[m][-1]) > yarn.strength
    at_rest = cell.solve(1.0, 1.0)
    assert (at_rest["F"], at_rest["W"]) == (0.0, 0.0)


def test_a_foot_shifts_the_line_by_its_width():
    cell = CellModel(FABRIC, LAWS, slack=SLACK)
    for m, (yarn, slack) in enumerate(zip(FABRIC.weave.yarns, SLACK)):
        far = (1 + yarn.crimp) * (1 + 30 * slack)
        assert float(cell.alone(m, far)) == pytest.approx(29 * slack * yarn.EA, rel=1e-9)
        near = (1 + yarn.crimp) * (1 + 1e-3 * slack)
        assert float(cell.alone(m, near)) == pytest.approx(5e-7 * slack * yarn.EA, rel=1e-3)


@pytest.mark.parametrize(
    "bad", [{"centreline": "sine"}, {"slack": (0.0, -1e-3)}, {"stiffening": -1.0}]
)
def test_what_is_not_allowed(bad):
    with pytest.raises(InputError, match=next(iter(bad))):
        CellModel(FABRIC, LAWS, **bad)
