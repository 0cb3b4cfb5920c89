"""Gradings with elements shorter than a crossover: their lines and yarns, failure, and all that goes with a panel."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from conftest_tools import assert_balance, assert_gradient, bring, crumple, grid, node_forces

from fabrics.errors import InputError, UnstableError
from shellfabric.backing.block import Backing
from shellfabric.cloth import bending_kernels, failure_kernels, jamming_kernels
from shellfabric.panel import grading, motion_kernels
from shellfabric.panel.boundary import Grip, PullIn
from shellfabric.panel.model import Numerics, Panel
from shellfabric.projectile.projectile import Projectile
from shellfabric.solver import ply_audit
from shellfabric.solver.pack_solver import PackSolver

INF = np.inf
THIRD = 1 / 3
PLAIN = Numerics(threads=1)
UNDAMPED = Numerics(stretch_viscosity=0.0, threads=1)
ZONES = ((7, THIRD), (13, 1), (INF, 2))
GRADINGS = [ZONES, ((7, 0.5), (INF, 1)), ((7, 0.25), (9, 0.5), (13, 1), (INF, 4)), ((8, THIRD), (INF, 2))]


@pytest.fixture
def refined(tables):
    def make(zones=ZONES, **changes):
        return Panel(tables["variational"], changes.pop("opening", (0.06, 0.06)), grading=zones, **changes)

    return make


@pytest.mark.parametrize(("given", "side"), [
    (1, 1), (2.0, 2), (0.5, Fraction(1, 2)), (0.33, Fraction(1, 3)), (0.3333, Fraction(1, 3)), (0.125, Fraction(1, 8)),
])  # fmt: skip
def test_sides_are_whole_numbers_or_parts_of_one(given, side):
    assert grading.exact(given) == side


@pytest.mark.parametrize("bad", [0.0, -1, 0.4, 1.5, 65, 0.1, INF])
def test_other_sides_are_refused(bad):
    with pytest.raises(InputError):
        grading.exact(bad)


@pytest.mark.parametrize("zones", GRADINGS)
@pytest.mark.parametrize("length", [16, 23])
def test_zones_fill_the_panel_and_end_between_whole_elements(zones, length):
    sides = grading.sides(zones, length)
    assert sides.sum() == pytest.approx(length, abs=1e-12)
    assert np.all(np.diff(sides) >= 0)
    places = np.insert(np.cumsum(sides), 0, 0.0)
    whole = places[np.abs(places - np.rint(places)) < 1e-9]
    assert set(np.rint(whole)) >= set(range(zones[0][0] + 1))  # every yarn of the first zone has its axis


@pytest.mark.parametrize("zones", GRADINGS)
@pytest.mark.parametrize("symmetry", ["quarter", "whole"])
def test_lines_are_shared_out_among_the_yarns(refined, zones, symmetry):
    """Shares of a line add up to one; in the first zone each yarn has the cloth of one crossover, as a whole."""
    panel = refined(zones, symmetry=symmetry)
    for lines, sides, w in zip(panel.yarn_lines, panel.sides, panel.weave.w):
        axes = np.flatnonzero(lines.yarn >= 0)
        crossovers = sides / (2 * w)
        np.testing.assert_array_equal(lines.yarn[axes], np.arange(axes.size))
        assert lines.elements[axes[:-1]].sum() == sides.size
        assert np.all(lines.share[axes] == 1.0)
        between = np.setdiff1d(np.arange(lines.yarn.size), axes)
        assert np.all((lines.share[between] > 0) & (lines.share[between] < 1))
        widths = grading.yarn_widths(crossovers, lines)
        assert widths.sum() == pytest.approx(crossovers.sum() + 0.5 * crossovers[-1], rel=1e-12)
        first = 0 if symmetry == "quarter" else axes.size // 2
        np.testing.assert_allclose(widths[axes[first + 1 : first + 6]], 1.0, rtol=1e-12)
        np.testing.assert_allclose(grading.segment_lengths(crossovers, lines)[axes[first : first + 6]], 1.0, rtol=1e-12)


@pytest.mark.parametrize("strike_velocity", [60.0, 180.0])
def test_one_zone_is_the_uniform_panel(tables, strike_velocity):
    """Bit for bit, also where yarns fail."""
    panels = (Panel(tables["variational"], (0.0306, 0.0306), numerics=PLAIN, **mesh) for mesh in (
        {"elements_per_crossover": 2}, {"grading": ((INF, 0.5),)}))  # fmt: skip
    one, other = (PackSolver(panel, strike_velocity, 40e-6).run() for panel in panels)
    assert (one.state.counter[motion_kernels.FAILURES] > 0) == (strike_velocity > 100)
    np.testing.assert_array_equal(one.samples, other.samples)
    for a, b in zip(one.state.u, other.state.u):
        np.testing.assert_array_equal(a, b)


@pytest.fixture(params=GRADINGS)
def crumpled(refined, request):
    """A stretched, sheared, crumpled refined panel without viscosity, with its node positions."""
    panel = refined(request.param, failure=False, edge="free", symmetry="whole", numerics=UNDAMPED)
    return panel, crumple(panel, 2e-6)


def test_forces_balance(crumpled):
    panel, x = crumpled
    assert_balance(x, node_forces(panel, bring(panel, panel.state(1.0), x)))


@pytest.mark.parametrize("zones", GRADINGS)
def test_uniform_strain_has_no_inner_forces(refined, zones):
    """In all zones and where they meet, with jamming too where the cloth is pressed together."""
    panel = refined(zones, edge="free", symmetry="whole", failure=False, numerics=UNDAMPED, jam=(100.0, 1.0))
    X, Y = panel.coordinates()
    for F in ([[1.02, 0.15], [0.03, 1.015], [0.2, -0.1]], [[0.95, 0.0], [0.0, 0.97], [0.0, 0.0]]):
        f = node_forces(panel, bring(panel, panel.state(1.0), np.stack([X, Y], axis=-1) @ np.array(F).T))
        assert np.abs(f[1:-1, 1:-1]).max() < 1e-10 * np.abs(f).max()


def turns(panel, x):
    """[J] of all turns of a whole panel with free edges, from the definition alone."""
    total = 0.0
    for axis, (count, EI) in enumerate(zip((panel.weave.warp_count, panel.weave.weft_count), panel.bending)):
        own, other = panel.sides[axis], panel.sides[1 - axis]
        t = np.diff(x, axis=axis)
        t = np.moveaxis(t / np.linalg.norm(t, axis=-1, keepdims=True), axis, 0)
        turn = 0.5 * np.sum((t[1:] - t[:-1]) ** 2, axis=-1)
        B = EI * np.multiply.outer(2 / (own[1:] + own[:-1]), count * grading.tributary(other))
        total += float((B * turn).sum())
    return total


def test_bending_of_a_graded_panel(crumpled):
    """Energy and its gradient against a plain twin."""
    panel, x = crumpled
    stiff = replace(panel, bending=(2e-6, 4e-6))
    state = bring(stiff, stiff.state(1.0), x)
    found = bending_kernels.bending_forces(
        stiff.constants().bending, state, stiff.constants(), 0, stiff.counts[0], False
    )
    assert found == pytest.approx(turns(stiff, x), rel=1e-10)
    f = node_forces(stiff, state) - node_forces(panel, bring(panel, panel.state(1.0), x))
    border = int(np.flatnonzero(np.diff(panel.sides[0]))[0]) + 1
    assert_gradient(stiff, x, f, [(0, 0), (border, border), (border, 5), (panel.counts[0] // 2, border + 1)], turns)
    assert np.abs(f.sum(axis=(0, 1))).max() < 1e-9 * np.abs(f).max()


def test_yarns_of_a_circle_bend_alike_in_all_zones(refined):
    """1/2 EI kappa^2 a length, to the chords' error."""
    panel, radius = refined(symmetry="whole", edge="free", bending=(2e-6, 0.0), failure=False), 0.05
    X, Y = panel.coordinates()
    x = np.stack([radius * np.sin(X / radius), Y, radius * (1 - np.cos(X / radius))], axis=-1)
    state = bring(panel, panel.state(1.0), x)
    found = bending_kernels.bending_forces(
        panel.constants().bending, state, panel.constants(), 0, panel.counts[0], False
    )
    length = panel.sides[0].sum() - 0.5 * panel.sides[0][[0, -1]].sum()
    expected = 0.5 * 2e-6 / radius**2 * length * panel.weave.warp_count * panel.sides[1].sum()
    assert found == pytest.approx(expected, rel=2e-3)


def test_jamming_of_a_graded_panel(refined):
    """Even pressing stores 1/2 K ln^2 a length of yarn, in all zones."""
    panel = refined(symmetry="whole", edge="free", failure=False, jam=(50.0, 0.99))
    X, Y = panel.coordinates()
    state = bring(panel, panel.state(1.0), np.stack([0.95 * X, Y, 0 * X], axis=-1))
    found = jamming_kernels.jamming_forces(
        panel.constants().jamming, state, panel.constants(), 0, panel.counts[0], False
    )
    yarn = panel.weave.warp_count * panel.sides[0].sum() * panel.sides[1].sum()
    assert found == pytest.approx(0.5 * 50.0 * np.log(0.95 / 0.99) ** 2 * yarn, rel=1e-9)


def test_a_yarn_breaks_with_its_share_of_all_its_lines(refined):
    """The mean over its lines counts; what breaks is one yarn, and all yarns of a line leave nothing of it."""
    panel = refined(symmetry="whole", edge="free")
    state, const = panel.state(1.0), panel.constants()
    lines = panel.yarn_lines[1]
    middle = panel.counts[1] // 2
    row = panel.counts[0] // 2
    assert lines.yarn[middle] >= 0
    assert lines.yarn[middle + 3] == lines.yarn[middle] + 1
    T = grid(const, state.T[0])
    T[row : row + 3, middle - 2 : middle + 3] = const.min_strength1 * np.array([0.3, 0.9, 1.5, 1.2, 0.6])
    expected = (0.3 / 3 + 0.9 * 2 / 3 + 1.5 + 1.2 * 2 / 3 + 0.6 / 3) / 3 * const.min_strength1
    assert failure_kernels.yarn_tension(const, state.T[0], 0, row, middle) == pytest.approx(expected, rel=1e-12)
    state.active_rows[:] = 0, const.ni
    assert failure_kernels.detect_failures(const, state, 0, 0, const.ni) == 1
    intact = grid(const, state.intact_fraction[0])
    broken = [1, 2 / 3, 1 / 3, 0, 1 / 3, 2 / 3, 1]
    np.testing.assert_allclose(intact[row + 1, middle - 3 : middle + 4], broken, atol=1e-15)
    assert np.all(intact[[row - 1, row + 3]][:, : const.nj] == 1.0)
    assert ply_audit.failed_segments(panel, const, state) == pytest.approx(1.0, rel=1e-12)
    T[:-1] = 2 * const.min_strength1
    failure_kernels.detect_failures(const, state, 0, 0, const.ni)
    assert np.all(intact == 0.0)
    assert np.all(grid(const, state.yarn_length[0]) == 0.0)


@pytest.mark.parametrize("strike_velocity", [70.0, 250.0])
@pytest.mark.parametrize("changes", [
    {}, {"bending": (1e-6, 1e-6)}, {"edge": PullIn(0.3e-3, 5e-6, 35e-6, 20e-3)}, {"jam": (50.0, 0.95)},
    {"edge": "free"}, {"weave_angle": 0.5, "symmetry": "whole"},
])  # fmt: skip
def test_energy_is_kept(refined, changes, strike_velocity):
    """To 0.1 % of the strike energy, of shots that break yarns too, with all that a plain panel may have."""
    zones = ((8, 0.5), (13, 1), (INF, 2))
    solver = PackSolver(refined(zones, numerics=PLAIN, **changes), strike_velocity, 30e-6).run()
    if changes.get("edge") != "free":  # whose yarns are drawn in
        assert (solver.state.counter[motion_kernels.FAILURES] > 0) == (strike_velocity > 100)
    assert np.abs(solver.sample("error")).max() < 1e-3 * solver.strike_energy


@pytest.mark.parametrize("strike_velocity", [100.0, 250.0])
def test_before_a_block(refined, strike_velocity):
    """Energy balance and residual velocity are those of the panel that is as fine everywhere."""
    block, found = Backing(size=(0.06, 0.06, 0.03), min_size=3e-3, refined_depth=6e-3, growth=1.5), []
    for zones in (((8, 0.5), (13, 1), (INF, 2)), ((INF, 0.5),)):
        solver = PackSolver(refined(zones, numerics=PLAIN, backing=block), strike_velocity, 20e-6).run()
        found.append((solver.sample("v")[-1], solver.sample("error")[-1] / solver.strike_energy))
    assert found[0][0] == pytest.approx(found[1][0], abs=1e-3 * strike_velocity)
    assert found[0][1] == pytest.approx(found[1][1], abs=5e-4)


OBLIQUE = Projectile(obliquity=0.3, azimuth=0.5 * np.pi)  # along y


@pytest.mark.parametrize("strike_velocity", [70.0, 250.0])
def test_oblique_shots_stay_over_the_first_zone(refined, strike_velocity):
    """The contact window follows the projectile within it; energy is kept; results are those of a finer rim."""
    found = []
    for zones in (((11, 0.5), (INF, 1)), ((11, 0.5), (INF, 0.5))):
        panel = refined(zones, symmetry="half", projectile=OBLIQUE, numerics=PLAIN)
        solver = PackSolver(panel, strike_velocity, 30e-6).run()
        assert np.abs(solver.sample("error")).max() < 1e-3 * solver.strike_energy
        found.append(solver.sample("v")[-1])
    assert (solver.state.counter[motion_kernels.FAILURES] > 0) == (strike_velocity > 100)
    assert found[0] == pytest.approx(found[1], rel=5e-3)


def test_a_projectile_that_leaves_the_first_zone_ends_the_run(refined):
    panel = refined(((9, 0.5), (INF, 1)), symmetry="half", projectile=replace(OBLIQUE, obliquity=1.2), numerics=PLAIN)
    with pytest.raises(UnstableError, match="first zone"):
        PackSolver(panel, 200.0, 100e-6).run()


def test_momentum_is_kept(refined):
    """Of free cloth and projectile along the flight, with bending and broken yarns."""
    panel = refined(edge="free", bending=(1e-6, 1e-6), numerics=PLAIN)
    solver = PackSolver(panel, 250.0, 20e-6).run()
    state, const = solver.state, solver.const
    waiting = const.dt * (state.f_contact[2].sum() + state.f_contact_nose[2])
    found = float(state.mass @ state.v[2]) + const.projectile_mass * state.projectile_velocity[2] + waiting
    assert found == pytest.approx(const.projectile_mass * 250.0, rel=1e-9)


def test_quarter_against_whole(refined):
    found = [PackSolver(refined(symmetry=kind, numerics=PLAIN), 280.0, 30e-6).run() for kind in ("quarter", "whole")]
    assert found[0].state.counter[motion_kernels.FAILURES] > 0
    np.testing.assert_allclose(*(one.sample("v") for one in found), rtol=1e-9)


def test_shot_against_the_uniform_panel(tables):
    """A panel that is fine about the nose alone against one that is fine everywhere."""
    meshes = {"elements_per_crossover": 2}, {"grading": ((9, 0.5), (INF, 1))}
    (v, *peak), (v_g, *peak_g) = (
        (found.sample("v")[-1], *found.state.peak_tension)
        for found in (
            PackSolver(Panel(tables["variational"], (0.05, 0.05), numerics=PLAIN, **mesh), 70.0, 80e-6).run()
            for mesh in meshes
        )
    )
    assert abs(v_g - v) < 0.005 * 70.0
    np.testing.assert_allclose(peak_g, peak, rtol=0.03)


@pytest.mark.parametrize("changes", [
    {"zones": ((7, THIRD), (9, 0.5), (INF, 1))}, {"zones": ((7, 0.4), (INF, 1))}, {"zones": ((2, 0.5), (INF, 1))},
    {"elements_per_crossover": 2}, {"edge": Grip(10.0)},
])  # fmt: skip
def test_what_does_not_go_with_a_grading(refined, changes):
    with pytest.raises(InputError) as refusal:
        refined(**changes)
    assert len(str(refusal.value).splitlines()) == 1
