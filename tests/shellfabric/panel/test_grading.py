"""Graded panels: what they are made of, equal gradings against the plain panel, forces, waves, shots."""

import numpy as np
import pytest
from conftest_tools import (
    advance,
    assert_balance,
    assert_gradient,
    bring,
    crumple,
    node_forces,
    plain_energy,
    solver_at_rest,
)

from fabrics.errors import InputError
from shellfabric.cell.model import CellModel
from shellfabric.panel import grading, motion_kernels
from shellfabric.panel.model import Numerics, Panel
from shellfabric.solver import ply_kernels
from shellfabric.solver.pack_solver import PackSolver

INF = np.inf
PLAIN = Numerics(threads=1)


def forced(panel):
    """The same panel, all of whose elements are alike, by way of the arrays that graded ones have."""
    panel.__dict__["sides"] = tuple(np.full(n, d) for n, d in zip(panel.counts, panel.spacing))
    return panel


@pytest.fixture
def graded(tables):
    def make(zones=((9, 1), (13, 2), (INF, 4)), **changes):
        return Panel(changes.pop("table", tables["variational"]), (0.06, 0.06), grading=zones, **changes)

    return make


@pytest.mark.parametrize("length", [16, 23, 31, 79, 80])
@pytest.mark.parametrize("zones", [((9, 1), (13, 2), (INF, 4)), ((4, 1), (INF, 8)), ((5, 2), (INF, 4)), ((INF, 1),)])
def test_elements_fill_the_panel(zones, length):
    """No side is missing, none shrinks outwards, zones reach at least as far as they were asked to."""
    sides = grading.sides(zones, length)
    places = np.cumsum(sides)
    assert places[-1] == length - length % zones[0][1]
    assert np.all(np.diff(sides) >= 0)
    for until, side in zones:
        inside = places <= min(until, length)
        assert np.all(sides[inside] <= side)
    assert grading.tributary(sides).sum() == sides.sum()


@pytest.mark.parametrize("symmetry", ["quarter", "whole"])
def test_mass_and_yarn_are_those_of_the_plain_panel(graded, symmetry):
    panel = graded(symmetry=symmetry)
    plain = Panel(panel.table, panel.opening, symmetry=symmetry)
    assert panel.elements < 0.5 * plain.elements
    np.testing.assert_allclose(panel.lines()[0][[0, -1]], plain.lines()[0][[0, -1]], rtol=1e-12)
    assert panel.masses().sum() == pytest.approx(plain.masses().sum(), rel=1e-12)
    for mine, other in zip(panel.state(1.0).yarn_length, plain.state(1.0).yarn_length):
        assert mine.sum() == pytest.approx(other.sum(), rel=1e-12)


@pytest.mark.parametrize("strike_velocity", [60.0, 155.0])
def test_equal_elements_are_the_plain_panel(tables, strike_velocity):
    """Also where yarns fail. Arrays of equal entries change the last digit at most; a grading of one zone has none."""
    panels = [
        Panel(tables["variational"], (0.04, 0.04), numerics=PLAIN, grading=zones) for zones in (None, ((INF, 1),))
    ]
    panels.append(forced(Panel(tables["variational"], (0.04, 0.04), numerics=PLAIN)))
    one, same, other = (PackSolver(panel, strike_velocity, 60e-6).run() for panel in panels)
    assert (one.state.counter[motion_kernels.FAILURES] > 0) == (strike_velocity > 100)
    for name in ("u", "v", "stretch", "N", "f_int", "failed", "intact_fraction"):
        for a, b, c in zip(*(getattr(march.state, name) for march in (one, same, other))):
            np.testing.assert_array_equal(a, b)
            np.testing.assert_allclose(c, a, rtol=0, atol=1e-9 * max(np.abs(a).max(), 1e-12))
    np.testing.assert_allclose(one.samples[-1], other.samples[-1], rtol=1e-9, atol=1e-12)


@pytest.fixture
def crumpled(graded, tables):
    """A stretched, sheared, crumpled graded panel without viscosity, with its node positions."""
    panel = graded(
        table=tables["variational"].model.table(401), failure=False, edge="free", symmetry="whole",
        numerics=Numerics(stretch_viscosity=0.0),
    )  # fmt: skip
    return panel, crumple(panel)


def test_nodal_forces_are_the_slopes_of_the_energy(crumpled):
    """In every zone, where zones meet, on the rim and at a corner."""
    panel, x = crumpled
    f = node_forces(panel, bring(panel, panel.state(1.0), x))
    last, change = panel.counts[0], np.flatnonzero(np.diff(panel.sides[0])) + 1
    nodes = [
        (0, 0),
        (1, 2),
        (change[0], change[1]),
        (change[0] + 1, 6),
        (last // 2, last // 2),
        (last, change[-1]),
    ]
    assert_gradient(panel, x, f, nodes, plain_energy)


def test_forces_balance(crumpled):
    """They add up to nothing and have no moment."""
    panel, x = crumpled
    assert_balance(x, node_forces(panel, bring(panel, panel.state(1.0), x)))


def test_patch(graded):
    """Under any uniform strain no inner node feels a force, nor any where zones meet."""
    panel = graded(edge="free", symmetry="whole", failure=False, numerics=Numerics(stretch_viscosity=0.0))
    X, Y = panel.coordinates()
    F = np.array([[1.02, 0.15], [0.03, 1.015], [0.2, -0.1]])
    f = node_forces(panel, bring(panel, panel.state(1.0), np.stack([X, Y], axis=-1) @ F.T))
    assert np.abs(f[1:-1, 1:-1]).max() < 1e-10 * np.abs(f).max()


def test_whole_against_quarter(graded):
    quarter, whole = (
        PackSolver(graded(symmetry=kind, numerics=PLAIN), 90.0, 60e-6).run() for kind in ("quarter", "whole")
    )
    assert quarter.sample("v")[-1] == pytest.approx(whole.sample("v")[-1], rel=1e-9)


def test_shot_against_the_plain_panel(tables):
    """A coarse rim changes the shot little, and loses no energy: 0.05 % with no failure."""
    found = []
    for zones in (None, ((10, 1), (14, 2), (INF, 4))):
        march = PackSolver(
            Panel(tables["variational"], (0.0762, 0.0762), numerics=PLAIN, grading=zones), 70.0, 150e-6
        ).run()
        assert np.abs(march.sample("error")).max() < 5e-4 * march.strike_energy
        found.append((march.sample("v")[-1], march.sample("z")[-1], *march.state.peak_tension))
    (v, z, *peak), (v_g, z_g, *peak_g) = found
    assert abs(v_g - v) < 0.01 * 70.0
    assert z_g == pytest.approx(z, rel=0.01)
    np.testing.assert_allclose(peak_g, peak, rtol=0.05)


def reflected(table, zones, wavelength):
    """Share of a pulse's kinetic energy that is behind it once it is through; its length is in crossovers."""
    edge, knobs = ("clamped", "free"), Numerics(stretch_viscosity=0.0)
    panel = Panel(table, (0.6, 0.0203), edge=edge, failure=False, grading=zones, numerics=knobs)
    solver = solver_at_rest(panel, 1.0)
    state, const = solver.state, solver.const
    state.projectile_position[2], state.active_rows[:] = -1.0, (0, const.ni)
    X, weave, d = panel.coordinates()[0], panel.weave, panel.spacing[0]
    speed = (weave.warp.EA * weave.warp_count / weave.areal_density) ** 0.5
    start, length, k = 40 * d, wavelength * d, np.pi / (wavelength * d)

    def at(x):
        return np.clip(x - start, -0.5 * length, 0.5 * length)

    # taut cloth, and a pulse u = f(X - c t) on it
    state.u[0][: X.size] = (0.01 * X + 1e-6 * np.cos(k * at(X)) ** 2).ravel()
    state.v[0][: X.size] = (speed * 1e-6 * k * np.sin(2 * k * at(X + 0.5 * speed * const.dt))).ravel()
    ply_kernels.initial_forces(state, const, None, panel.work())
    advance(solver, int(150 * d / speed / const.dt))
    kinetic = (state.mass[: X.size] * state.v[0][: X.size] ** 2).reshape(X.shape).sum(axis=1)
    return float(kinetic[X[:, 0] < 95 * d].sum() / kinetic.sum())


@pytest.mark.parametrize(("zones", "wavelength", "most"), [
    (None, 16, 1e-3),
    (((100, 1), (INF, 2)), 32, 1.5e-3),
    (((100, 1), (110, 2), (INF, 4)), 32, 2e-2),
])  # fmt: skip
def test_waves_pass_where_zones_meet(straight, zones, wavelength, most):
    """A pulse along the warp: a hundredth comes back from elements eight to its length, a thousandth from sixteen."""
    table = CellModel(straight(1e-6), model="decoupled").table(201)
    assert reflected(table, zones, wavelength) < most


@pytest.mark.parametrize("changes", [
    {"zones": ((9, 1), (13, 2))}, {"zones": ((9, 1), (5, 2), (INF, 4))}, {"zones": ((9, 2), (INF, 3))},
    {"zones": ()}, {"zones": "coarse"}, {"zones": ((2, 1), (INF, 2))}, {"elements_per_crossover": 2},
])  # fmt: skip
def test_bad_gradings(graded, changes):
    with pytest.raises(InputError) as told:
        graded(**changes)
    assert len(str(told.value).splitlines()) == 1


def test_a_line_has_the_strength_of_the_weakest_yarn_that_it_stands_for():
    """Against a plain loop over all pairs of yarn and line."""
    factors, places = np.random.default_rng(3).uniform(0.5, 1.5, 41), np.array([-20, -12, -8, -6, -5, -4, 0, 4, 6, 16])
    found = grading.weakest(factors, places)
    for line, factor in enumerate(found):
        mine = []
        for yarn in range(-20, 21):
            distance = abs(places - yarn)
            if distance[line] == distance.min() and places[0] <= yarn <= places[-1]:
                mine.append(factors[yarn + 20])
        assert factor == min(mine)
