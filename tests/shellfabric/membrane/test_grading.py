"""Graded panels: what they are made of, equal gradings against the plain panel, waves, failing yarns, shots.

Forces of their elements: see `test_forces` and `membrane/test_membrane`.
"""

from fractions import Fraction

import numpy as np
import pytest
from conftest_tools import advance, grid, out_of_reach
from numpy.testing import assert_allclose, assert_array_equal
from panels import (
    BLOCK,
    COARSER,
    FINER,
    HALF,
    INF,
    SERIAL,
    STEPPED,
    THIRD,
    make_panel,
    rest,
    set_nodal,
    table,
)

import weavecell as wc
from shellfabric.cell.model import CellModel
from shellfabric.loop import ply_kernels
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane import grading, quality
from shellfabric.membrane.numerics import Numerics
from shellfabric.projectile.projectile import Projectile

ZONES = [FINER, HALF, STEPPED, THIRD]


# [m]: panels of a whole number of it need no longer elements
CROSSOVER = 2 * table().model.fabric.weave.w[0]


def shoot(strike_velocity, end_time, side=0.06, **changes):
    return PackSolver(make_panel(side, numerics=SERIAL, **changes), strike_velocity, end_time).run()


@pytest.mark.parametrize(
    "given, side",
    [
        (1, 1),
        (2.0, 2),
        (0.5, Fraction(1, 2)),
        (0.33, Fraction(1, 3)),
        (0.3333, Fraction(1, 3)),
        (0.0625, Fraction(1, 16)),
    ],
)
def test_sides_are_whole_numbers_or_parts_of_one(given, side):
    assert grading.exact(given) == side


@pytest.mark.parametrize("length", [16, 23, 31, 79, 80])
@pytest.mark.parametrize(
    "zones", [COARSER, ((4, 1), (INF, 8)), ((5, 2), (INF, 4)), ((INF, 1),), *ZONES]
)
def test_elements_fill_the_panel(zones, length):
    """No side is missing, none shrinks outwards, zones reach at least as far as they were asked to, and every yarn of a
    fine one has its axis."""
    sides = grading.sides(zones, length)
    places = np.insert(np.cumsum(sides), 0, 0.0)
    assert places[-1] == pytest.approx(length, abs=1e-12)
    assert np.all(np.diff(sides) >= 0)
    for until, side in zones:
        assert np.all(sides[:-1][places[1:-1] <= min(until, length)] <= side + 1e-12)
    if zones[0][1] <= 1:
        whole = places[abs(places - np.rint(places)) < 1e-9]
        assert set(np.rint(whole)) >= set(range(min(zones[0][0], length) + 1))
    assert grading.tributary(sides).sum() == pytest.approx(sides.sum(), rel=1e-12)


@pytest.mark.parametrize("zones", ZONES)
@pytest.mark.parametrize("symmetry", ["quarter", "whole"])
def test_each_line_has_the_nearest_yarn(zones, symmetry):
    """Against a plain loop; of two yarns that are as near it is the inner one, so that halves are alike."""
    panel = make_panel(0.06, grading=zones, symmetry=symmetry)
    for x, axes, yarns, w in zip(
        panel.lines(), panel.yarn_axes, panel.nearest_yarns, panel.weave.w
    ):
        places = np.fix((1 + 1e-9) * x / (2 * w))  # of the yarns, the last at the edge
        places = np.where(abs(x) < 0.999999 * x.max(), x / (2 * w), places)
        assert np.all(abs(places[axes] - np.rint(places[axes])) < 1e-9)
        for place, yarn in zip(places, yarns):
            distance = np.round(abs(place - places[axes]), 9)
            nearest = axes[distance == distance.min()]
            assert axes[yarn] == nearest[abs(places[nearest]).argmin()]


@pytest.mark.parametrize("symmetry", ["quarter", "whole"])
def test_edges_stand_for_all_segments_of_the_panel(symmetry):
    """Warp and weft of a panel of m x n crossovers have m n segments each, on every mesh."""
    for zones in (None, *ZONES):
        panel = make_panel(0.06, grading=zones, symmetry=symmetry)
        crossovers = [side.sum() / (2 * w) for side, w in zip(panel.element_sides, panel.weave.w)]
        for segments in panel.segments:
            assert segments.sum() == pytest.approx(np.prod(crossovers), rel=1e-12)


@pytest.mark.parametrize("symmetry", ["quarter", "whole"])
def test_mass_and_yarn_are_those_of_the_plain_panel(symmetry):
    panel, plain = (make_panel(0.06, symmetry=symmetry, grading=zones) for zones in (COARSER, None))
    assert panel.elements < 0.5 * plain.elements
    assert_allclose(panel.lines()[0][[0, -1]], plain.lines()[0][[0, -1]], rtol=1e-12)
    assert panel.masses().sum() == pytest.approx(plain.masses().sum(), rel=1e-12)
    for mine, other in zip(panel.state(1.0).yarn_length, plain.state(1.0).yarn_length):
        assert mine.sum() == pytest.approx(other.sum(), rel=1e-12)


@pytest.mark.parametrize("strike_velocity", [60.0, 180.0])
@pytest.mark.parametrize("elements", [1, 2])
def test_equal_elements_are_the_plain_panel(elements, strike_velocity):
    """Also where yarns fail: a grading of one zone to the bit; by way of the arrays that other gradings have, all of
    whose entries are equal, in all digits but the last."""
    uniform = {"elements_per_crossover": elements}
    panels = [
        make_panel(24 * CROSSOVER, numerics=SERIAL, **mesh)
        for mesh in (uniform, {"grading": ((INF, 1 / elements),)}, uniform)
    ]
    if elements == 1:
        panels[2].__dict__["sides"] = tuple(map(np.full, panels[2].counts, panels[2].spacing))
    plain, same, equal = (PackSolver(panel, strike_velocity, 40e-6).run() for panel in panels)
    assert (plain.state.failures > 0) == (strike_velocity > 100)
    assert_array_equal(plain.samples, same.samples)
    for name in ("u", "v", "stretch", "N", "f_int", "failed", "intact_fraction"):
        for a, b, c in zip(*(getattr(solver.state, name) for solver in (plain, same, equal))):
            assert_array_equal(a, b)
            assert_allclose(c, a, rtol=0, atol=1e-9 * max(abs(a).max(), 1e-12))


def reflected(table, zones, wavelength):
    """Share of a pulse's kinetic energy that is behind it once it is through; its length is in crossovers."""
    edge = ("clamped", "free")
    numerics = Numerics(stretch_viscosity=0.0)
    panel = make_panel(
        table=table,
        opening=(0.6, 0.0203),
        boundary=edge,
        yarn_failure=False,
        grading=zones,
        numerics=numerics,
    )
    solver, state, const = out_of_reach(panel)
    x = rest(panel)
    weave = panel.weave
    d = panel.spacing[0]
    speed = (weave.warp.EA * weave.warp_count / weave.areal_density) ** 0.5
    length = wavelength * d
    k = np.pi / (wavelength * d)

    def within(X):
        return np.clip(X - 40 * d, -0.5 * length, 0.5 * length)

    # taut fabric, and a pulse u = f(X - c t) on it
    X = x[..., 0]
    along = np.array([1.0, 0.0, 0.0])
    set_nodal(state.u, (0.01 * X + 1e-6 * np.cos(k * within(X)) ** 2)[..., None] * along)
    set_nodal(
        state.v,
        (speed * 1e-6 * k * np.sin(2 * k * within(X + 0.5 * speed * const.dt)))[..., None] * along,
    )
    ply_kernels.initial_forces(state, const, panel.work())
    advance(solver, int(150 * d / speed / const.dt))
    kinetic = (grid(const, state.mass) * grid(const, state.v[0]) ** 2).sum(axis=1)
    return float(kinetic[X[:, 0] < 95 * d].sum() / kinetic.sum())


@pytest.mark.parametrize(
    "zones, wavelength, most",
    [
        (None, 16, 1e-3),
        (((100, 1), (INF, 2)), 32, 1.5e-3),
        (((100, 1), (110, 2), (INF, 4)), 32, 2e-2),
    ],
)
def test_waves_pass_where_zones_meet(straight, zones, wavelength, most):
    """A pulse along the warp: a hundredth comes back from elements eight to its length, a thousandth from sixteen."""
    table = CellModel(straight(1e-6), cell_model="decoupled").table(201)
    assert reflected(table, zones, wavelength) < most


def test_a_line_has_the_strength_of_the_weakest_yarn_that_it_stands_for():
    """Against a plain loop over all pairs of yarn and line."""
    factors = np.random.default_rng(3).uniform(0.5, 1.5, 41)
    places = np.array([-20, -12, -8, -6, -5, -4, 0, 4, 6, 16])
    for line, factor in enumerate(grading.weakest(factors, places, 20)):
        mine = []
        for yarn in range(-20, 21):
            distance = abs(places - yarn)
            if distance[line] == distance.min() and places[0] <= yarn <= places[-1]:
                mine.append(factors[yarn + 20])
        assert factor == min(mine)


def test_off_the_middle_lines_take_the_yarns_of_their_side_and_those_in_the_clamp_the_last():
    """Six yarns on one side of the impact point and two on the other; the lines reach four on both."""
    factors = np.array([0.9, 1.3, 0.7, 1.1, 1.2, 0.8, 1.4, 1.6, 1.5])
    places = [-4, -3, -2, -1, 0, 1, 2, 3, 4]
    expected = [0.7, 1.1, 1.2, 0.8, 1.4, 1.6, 1.5, 1.5, 1.5]
    assert grading.weakest(factors, places, 6).tolist() == expected
    assert grading.weakest(factors[::-1], places, 2).tolist() == expected[::-1]


@pytest.mark.parametrize("impact_point", [("0.2 mm", "0.3 mm"), ("5 mm", "-2 mm")])
def test_drawn_strengths_of_a_graded_panel_that_is_struck_off_its_middle(impact_point):
    options = {"opening": "30 mm", "symmetry": "whole", "impact_point": impact_point}
    setup = wc.setup("S-720", "300 m/s", strength={"weibull_shape": 14.0}, **options)
    ply = setup.target().plies[0]
    for factors, axes in zip(ply.strength_factors, ply.yarn_axes[::-1]):
        assert len(factors) == len(axes)
        assert np.ptp(factors) > 0.1


@pytest.mark.parametrize(
    "changes",
    [
        {"backing": BLOCK},
        {"symmetry": "half", "projectile": Projectile(obliquity=0.3, azimuth=0.5 * np.pi)},
    ],
)
def test_shots_at_blocks_and_aslant_are_those_of_a_finer_rim(changes):
    """Energy balance and velocity are those of a panel that is as fine everywhere, whose yarns fail too; the contact
    window follows the projectile over the first zone."""
    graded, fine = (
        shoot(250.0, 20e-6, 46 * CROSSOVER, grading=zones, **changes)
        for zones in (((11, 0.5), (INF, 1)), ((INF, 0.5),))
    )
    assert graded.state.failures > 0
    assert graded.sample("v")[-1] == pytest.approx(fine.sample("v")[-1], abs=1e-3 * 250.0)
    errors = [solver.sample("error")[-1] / solver.strike_energy for solver in (graded, fine)]
    assert errors[0] == pytest.approx(errors[1], abs=5e-4)


@pytest.mark.parametrize("end_time, doubtful", [(5e-6, False), (100e-6, True)])
def test_a_shot_whose_projectile_leaves_the_fine_mesh_is_doubtful(end_time, doubtful):
    shot = Projectile(obliquity=1.0, azimuth=0.5 * np.pi)
    zones = ((13, 0.5), (INF, 1))
    solver = shoot(200.0, end_time, grading=zones, symmetry="half", projectile=shot)
    (path,) = (one for one in quality.of_solver(solver) if one.name == "path over fine mesh")
    assert path.doubtful is doubtful


@pytest.mark.parametrize(
    "zones, elements, side, end, near",
    [
        (((10, 1), (14, 2), (INF, 4)), 1, 0.0762, 150e-6, 0.01),
        (((9, 0.5), (INF, 1)), 2, 0.05, 80e-6, 0.005),
    ],
)
def test_a_coarse_rim_changes_a_shot_little(zones, elements, side, end, near):
    """A panel that is fine about the nose alone against one that is fine everywhere."""
    graded, plain = (
        shoot(70.0, end, side, **mesh)
        for mesh in ({"grading": zones}, {"elements_per_crossover": elements})
    )
    assert graded.sample("v")[-1] == pytest.approx(plain.sample("v")[-1], abs=near * 70.0)
    assert graded.sample("z")[-1] == pytest.approx(plain.sample("z")[-1], rel=0.01)
    assert_allclose(graded.state.peak_tension, plain.state.peak_tension, rtol=0.05)
    assert abs(graded.sample("error")).max() < 5e-4 * graded.strike_energy
