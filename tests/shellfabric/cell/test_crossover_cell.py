"""The crossover: closed forms, its limits, its potential, and the table against the cell."""

from functools import partial

import numpy as np
import pytest
from numpy.polynomial.polynomial import polyval2d
from numpy.testing import assert_allclose, assert_array_equal
from panels import potential_grid, table

from fabrics import catalogue
from shellfabric.cell import packed_table
from shellfabric.cell.model import CellModel
from shellfabric.coupon import relaxation_kernels
from shellfabric.membrane import element_kernels, table_kernels
from shellfabric.membrane.model import Panel
from validation.models.variants import with_law_form


@pytest.mark.parametrize(
    "name, F, T1, T2",
    [
        ("S-720", 1.982, 3.45, 4.24),
        ("S-726", 0.927, 1.31, 3.15),
        ("S-728", 4.357, 8.28, 10.87),
        ("S-745", 1.306, 1.54, 2.83),
    ],
)
def test_printed_law_at_rest(name, F, T1, T2):
    """Forces that the printed law leaves in fabric at rest (erratum E-05, nominal denier)."""
    fabric = with_law_form(catalogue.load(name), "printed")
    rest = CellModel(fabric, cell_formulation="equilibrium").solve(1.0, 1.0)
    assert float(rest["F"]) == pytest.approx(F, rel=2e-3)
    assert (float(rest["T1"]), float(rest["T2"])) == pytest.approx((T1, T2), rel=4e-3)


def test_rest_and_limits(fabric):
    """At rest nothing acts by the regularised law."""
    rest = CellModel(fabric).solve(1.0, 1.0)
    assert all(rest[name] == 0.0 for name in ("T1", "T2", "F", "W"))
    stiff = CellModel(fabric, cell_model="incompressible").solve(1.02, 1.01)
    assert stiff["h1"] + stiff["h2"] == pytest.approx(sum(fabric.weave.h0), rel=1e-12)
    loose = CellModel(fabric, cell_model="decoupled").solve(1.04, 1.01)
    weave = fabric.weave
    # erratum E-14
    assert loose["T1"] == pytest.approx(weave.warp.EA * (2.08 * weave.w1 - weave.S01) / weave.S01)
    assert loose["T2"] == 0.0
    middle = CellModel(fabric).solve(1.02, 1.01)
    assert (
        CellModel(fabric, cell_model="decoupled").solve(1.02, 1.01)["T1"]
        < middle["T1"]
        < stiff["T1"]
    )


def table_potential(table, x, y):
    """[J] the potential as the march reads it, at one pair of stretches."""
    rx, ry = 1 / np.array(table.steps)
    top1, top2 = (axis.size - 2.0 for axis in (table.stretch1, table.stretch2))
    grid = table.stretch1[0], rx, top1, table.stretch2[0], ry, top2, top2 + 1
    rows, level = table.packed.potential
    return table_kernels.potential(x, y, grid, rows, table.packed.beyond, level)


def table_forces(table, x, y):
    """Forces as the element reads them."""
    w1, w2 = table.model.fabric.weave.w
    rx, ry = (1 / step for step in table.steps)
    x0 = table.stretch1[0]
    y0 = table.stretch2[0]
    top1 = table.stretch1.size - 2.0
    top2 = table.stretch2.size - 2.0
    grid = (x0, rx, top1, y0, ry, top2, top2 + 1)
    room = np.zeros((2, x.size + 8))
    at = (0, x.size, *(np.append(part, np.ones(8)) for part in (x, y)), grid)
    N1, N2 = room
    if table.model.cell_formulation == "variational":
        per = rx / (2 * w1), ry / (2 * w2)
        *_, high1, high2 = table_kernels.potential_forces(
            *at,
            table.packed.potential[0],
            table.packed.beyond,
            per,
            np.zeros(16, np.int32),
            N1,
            N2,
        )
        assert high1 == max(N1[: x.size].max(), 0.0)
        assert high2 == max(N2[: x.size].max(), 0.0)
    else:
        far = np.inf, np.inf
        largest = table_kernels.bilinear_tensions(*at, table.tension1.reshape(-1, 4), far, N1)
        assert largest == N1[: x.size].max()
        table_kernels.bilinear_tensions(*at, table.tension2.reshape(-1, 4), far, N2)
    N1, N2 = room[:, : x.size]
    return N1, N2


@pytest.mark.parametrize("form", ["equilibrium", "variational"])
def test_table_against_cell(fabric, form):
    """Errors of the table fall with the square of its spacing; at 201 they are below 0.2 % of the strength."""
    model = CellModel(fabric, cell_formulation=form)
    rng = np.random.default_rng(1)
    x = rng.uniform(0.97, 1.04, 4000)
    y = rng.uniform(0.97, 1.04, 4000)
    exact = model.solve(x, y)
    errors = []
    for n in (101, 201):
        N = table_forces(model.table(n), x, y)
        off = [abs(got - exact[name]) for got, name in zip(N, ("N1", "N2"))]
        errors.append((np.max(off), np.sqrt(np.mean(np.square(off)))))
    strength = fabric.weave.warp.strength
    assert errors[1][0] < 2e-3 * strength
    assert errors[1][1] < 0.36 * errors[0][1]


@pytest.mark.parametrize("name", ["S-720", "S-731", "S-745"])
def test_forces_tell_what_tensions_cannot_exceed(name):
    """No tension is above the ceiling that the force beside it sets, anywhere; and the ceiling is close."""
    table = CellModel(catalogue.load(name).with_effective_density()).table(81)
    rng = np.random.default_rng(2)
    n = 20000
    panel = Panel(table)
    const = panel.constants()
    x, y = (rng.uniform(axis[0], axis[-1], n) for axis in (table.stretch1, table.stretch2))
    forces = table_forces(table, x, y)
    at = (0, n, np.append(x, np.ones(8)), np.append(y, np.ones(8)), const.table_grid)
    T = np.zeros(n + 8)
    for N, tension, unit, ceiling, yarn in (
        (
            forces[0],
            const.tension1,
            const.tension_bound_step1,
            const.tension_bound_table1,
            panel.weave.warp,
        ),
        (
            forces[1],
            const.tension2,
            const.tension_bound_step2,
            const.tension_bound_table2,
            panel.weave.weft,
        ),
    ):
        table_kernels.bilinear_tensions(*at, tension, (np.inf, np.inf), T)
        bounds = np.array(
            [
                element_kernels.tension_bound(const, 0.0, 0.0, max(force, 0.0), unit, ceiling)
                for force in N
            ]
        )
        assert np.all(T[:n] <= bounds)
        taut = (N > 0.2 * yarn.strength) & (N < yarn.strength)
        assert np.all(bounds[taut] < 1.06 * N[taut] + 0.01 * yarn.strength)
        top = const.table_grid[2] + 1.0
        assert element_kernels.tension_bound(const, top + 0.1, 0.0, 0.0, unit, ceiling) == np.inf
        assert element_kernels.tension_bound(const, 0.0, top + 0.1, 0.0, unit, ceiling) == np.inf
        assert element_kernels.tension_bound(const, 0.0, 0.0, np.inf, unit, ceiling) == np.inf


@pytest.mark.parametrize("name", ["S-720", "S-726", "S-731", "S-745"])
def test_forces_beyond_the_table(name):
    """Beside a yarn that has failed, lines are drawn out to 1.4: forces are those of one potential, the tangent is
    positive and no stiffer than the time step is made for, and what a yarn does to a crossing one saturates.

    The polynomials of the last cell gave forces below zero and up to 120 times the stiffness of the yarn there.
    """
    table = CellModel(catalogue.load(name).with_effective_density()).table()
    weave = table.model.fabric.weave
    rng = np.random.default_rng(3)
    n = 3000
    h = 1e-5
    ends = [axis[-1] for axis in (table.stretch1, table.stretch2)]
    inside = [rng.uniform(axis[0], axis[-1], n) for axis in (table.stretch1, table.stretch2)]
    far = [end + rng.uniform(0, 0.4, n) for end in ends]
    x, y = (
        np.concatenate(parts)
        for parts in ((inside[0], far[0], far[0]), (far[1], inside[1], far[1]))
    )

    def forces(x, y):
        return np.stack(table_forces(table, x, y)) * [[weave.warp_count], [weave.weft_count]]

    def slopes(function, x, y):
        """By central differences, along x and along y."""
        along_x = (function(x + h, y) - function(x - h, y)) / (2 * h)
        return along_x, (function(x, y + h) - function(x, y - h)) / (2 * h)

    (k11, k21), (k12, k22) = slopes(forces, x, y)
    assert_allclose(k12, k21, atol=1e-4 * table.stiffness())
    middle = 0.5 * (k11 + k22)
    radius = np.hypot(0.5 * (k11 - k22), k12)
    assert np.min(middle - radius) > -1e-3 * table.stiffness()
    assert np.max(middle + radius) < table.stiffness()
    for k in range(0, x.size, 500):
        per = [2 * w for w in weave.w]
        by_stretch = slopes(partial(table_potential, table), x[k], y[k])
        N = [part[0] for part in table_forces(table, x[k : k + 1], y[k : k + 1])]
        assert_allclose(np.divide(by_stretch, per), N, atol=1e-3 * weave.warp.strength)
    edge = np.full(n, ends[1])
    assert_allclose(
        table_forces(table, inside[0], edge + 1e-9), table_forces(table, inside[0], edge), atol=1e-4
    )
    exact = table.model.solve(inside[0], far[1])["N1"]
    found = table_forces(table, inside[0], far[1])[0]
    assert np.max(abs(found - exact)) < 0.5 * weave.warp.strength


@pytest.mark.parametrize("name", ["S-720", "S-728", "S-731"])
def test_rest_is_the_lowest_energy(name):
    """A polynomial through the parabola that begins at first contact may dip below zero, and fabric at rest creep."""
    table = CellModel(catalogue.load(name)).table(61)
    grid = potential_grid(table)
    for x, y in np.random.default_rng(5).uniform(-1, 1, (4000, 2)) * table.steps + 1:
        assert relaxation_kernels.potential(x, y, *grid)[0] >= -1e-18
        assert table_potential(table, x, y) >= -1e-18
    # at the node itself there is none; a place is in a table to the last digit
    assert_allclose(table_forces(table, np.ones(1), np.ones(1)), 0.0, atol=1e-11)


def test_out_of_range(tables, fabric):
    """Below the table its edge is exact; above it tension goes on linearly, past the strength."""
    table = tables["equilibrium"]
    x = np.array([0.5, 0.9, table.stretch1[0] - 1e-3])
    y = np.full(3, 1.03)
    T1, T2 = table_forces(table, x, y)
    exact = table.model.solve(x, y)
    assert np.all(T1 == 0.0)
    assert_array_equal(exact["T1"], 0.0)
    assert_allclose(T2, exact["T2"], atol=1e-3 * fabric.weave.weft.strength)
    top = table.stretch1[-1] + np.array([0.0, 0.1, 0.2])
    T1, _ = table_forces(table, top, np.ones(3))
    assert np.all(T1 > fabric.weave.warp.strength)
    assert T1[2] - T1[1] == pytest.approx(T1[1] - T1[0], rel=1e-9)


@pytest.mark.parametrize("form", ["equilibrium", "variational"])
def test_values_and_slopes_are_continuous_from_cell_to_cell(form):
    c = table(form).spline.reshape(*table(form).spline.shape[:2], 3, 3)
    for coefficients in (c, np.moveaxis(c, (0, 2), (1, 3))):  # along the warp, along the weft
        value = np.moveaxis(coefficients, (2, 3), (0, 1))
        for part in (value, np.arange(1, 3)[:, None, None, None] * value[1:]):  # and its slope
            for across in np.linspace(0, 1, 5):
                ends = (
                    polyval2d(1.0, across, part[:, :, :-1]),
                    polyval2d(0.0, across, part[:, :, 1:]),
                )
                assert_allclose(*ends, rtol=0, atol=1e-12 * np.abs(ends).max())


def test_bound_of_a_single_cell_of_constant_tension():
    """Below its force nothing is known of it; at its force the tension is what it is above that; beyond, its own."""
    N = 3.0
    T = 4.0
    force, tension = np.zeros((2, 2, 3, 1))
    force[:, 0] = N
    tension[:, 0] = T
    steps, unit = packed_table._ceiling(*packed_table._bounds(force, tension))
    assert unit == pytest.approx(T / 256, rel=1e-12)
    first = round(N / unit)  # N lies where two steps meet, so that rounding puts it into both
    assert_array_equal(steps[: first - 1], 0.0)
    assert_allclose(steps[first - 1 : first + 1, 1], T - N, rtol=1e-8)
    assert_allclose(steps[first + 1 :], np.tile([T, 0.0], (256 - first, 1)), rtol=1e-8)


def test_stiffness_is_the_largest_eigenvalue_of_the_tangent():
    """By the cell itself in four states near the strengths, of tangents by differences: none is stiffer than the table
    says, and the stiffest is so to the table's steps. Warp and weft have unlike counts."""
    fabric = catalogue.load("glass-unbalanced")
    cell = CellModel(fabric)
    table = cell.table(81)
    weave = fabric.weave
    counts = (weave.warp_count, weave.weft_count)
    top = table.stretch1[-2], table.stretch2[-2]
    step = 1e-5
    stiffest = 0.0
    for state in (top, (top[0], 1.0), (1.0, top[1]), (1.004, 1.006)):
        K = np.empty((2, 2))
        for j in range(2):
            moved = step * np.eye(2)[j]
            more, less = (cell.solve(*(np.array(state) + sign * moved)) for sign in (1, -1))
            for i in range(2):
                name = f"N{i + 1}"
                K[i, j] = counts[i] * float(more[name] - less[name]) / (2 * step)
        stiffest = max(stiffest, np.linalg.eigvalsh(0.5 * (K + K.T)).max())
    assert table.stiffness() == pytest.approx(stiffest, rel=0.02)
