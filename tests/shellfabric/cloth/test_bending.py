"""Bending of yarns: gradient, invariance, plain twin, closed forms of beams, conservation, what fails."""

from dataclasses import replace

import numpy as np
import pytest
from conftest_tools import advance, bring, node_forces, solver_at_rest

from fabrics.errors import InputError
from shellfabric.cell.model import CellModel
from shellfabric.cloth import bending_kernels
from shellfabric.impact.simulation import ImpactSetup, run
from shellfabric.panel.model import Numerics, Panel
from shellfabric.solver.pack_solver import PackSolver

EI = 2e-6
NO_DAMPING = Numerics(stretch_viscosity=0.0)  # whose coefficient hangs on the time step, and that on bending


def plain_energy(panel, x):
    """Energy of all turns of a whole panel from the definition alone, ends in clamps."""
    total = 0.0
    for axis, (n, stiffness) in enumerate(zip(panel.yarns_a_line, panel.bending)):
        d = panel.spacing[axis]
        t = np.diff(x, axis=axis) / np.linalg.norm(np.diff(x, axis=axis), axis=-1, keepdims=True)
        t = np.moveaxis(t, axis, 0)
        turns = 0.5 * np.sum((t[1:] - t[:-1]) ** 2, axis=-1)
        if panel.edge == "clamped":
            straight = np.eye(3)[axis]
            turns = np.concatenate([turns, np.sum((t[[0, -1]] - straight) ** 2, axis=-1)])
        share = np.ones(turns.shape[1])
        share[[0, -1]] = 0.5
        total += n * stiffness / d * float((turns * share).sum())
    return total


@pytest.fixture
def bent(small):
    """A whole panel with bending alone between its nodes, crumpled."""

    def make(edge="free", **changes):
        panel = small(edge=edge, symmetry="whole", failure=False, bending=(EI, 2 * EI), numerics=NO_DAMPING, **changes)
        X, Y = panel.coordinates()
        x = np.stack([X, Y, 2e-4 * np.sin(300 * X) * np.cos(200 * Y)], axis=-1)
        return panel, x + np.random.default_rng(3).normal(scale=3e-5, size=x.shape)

    return make


def forces(panel, x):
    """(ni+1, nj+1, 3) [N] of the turns alone."""
    plain = replace(panel, bending=(0.0, 0.0))
    with_turns, without = (node_forces(p, bring(p, p.state(1.0), x)) for p in (panel, plain))
    return with_turns - without


def energy(panel, x):
    state = bring(panel, panel.state(1.0), x)
    const = panel.constants()
    return bending_kernels.bending_forces(const.bending, state, const, 0, panel.counts[0], False)


@pytest.mark.parametrize("edge", ["free", "clamped"])
def test_energy_and_its_gradient(bent, edge):
    panel, x = bent(edge)
    assert energy(panel, x) == pytest.approx(plain_energy(panel, x), rel=1e-12)
    f, step = forces(panel, x), 1e-9
    for node in [(0, 0), (0, 5), (1, 1), (12, 24), (11, 7), (24, 24)]:
        for c in range(3):
            up, down = x.copy(), x.copy()
            up[(*node, c)] += step
            down[(*node, c)] -= step
            slope = (plain_energy(panel, up) - plain_energy(panel, down)) / (2 * step)
            assert f[(*node, c)] == pytest.approx(-slope, rel=1e-5, abs=1e-6 * np.abs(f).max())


def test_rigid_motion_is_free(bent):
    """Turned and shifted, straight cloth stores nothing, and crumpled cloth what it did; forces balance."""
    panel, x = bent()
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    X, Y = panel.coordinates()
    flat = np.stack([X, Y, 0 * X], axis=-1) @ turn.T + 0.01
    scale = np.abs(forces(panel, x)).max()
    assert np.abs(forces(panel, flat)).max() < 1e-9 * scale
    assert energy(panel, x @ turn.T) == pytest.approx(energy(panel, x), rel=1e-12)
    f = forces(panel, x)
    assert np.abs(f.sum(axis=(0, 1))).max() < 1e-9 * scale
    assert np.abs(np.cross(x, f).sum(axis=(0, 1))).max() < 1e-9 * scale * np.ptp(x)


def test_parts_of_the_panel_agree(small):
    """A quarter stores a quarter of what the whole does, and its nodes off the planes feel the same."""
    whole, part = (small(symmetry=s, bending=(EI, EI), failure=False) for s in ("whole", "quarter"))
    shape = lambda X, Y: np.stack([X, Y, 1e-3 * np.cos(90 * X) * np.cos(70 * Y)], axis=-1)  # noqa: E731
    x, y = shape(*whole.coordinates()), shape(*part.coordinates())
    assert energy(part, y) == pytest.approx(0.25 * energy(whole, x), rel=1e-12)
    n = whole.counts[0] // 2
    np.testing.assert_allclose(forces(part, y)[1:, 1:], forces(whole, x)[n + 1 :, n + 1 :], atol=1e-12)
    np.testing.assert_allclose(2 * forces(part, y)[0, 1:, 2], forces(whole, x)[n, n + 1 :, 2], atol=1e-12)


def matrix(panel, axis, free):
    """Stiffness against small deflections along z of one line of nodes in the middle of the panel; `free` of them."""
    X, Y = panel.coordinates()
    flat, h, rows = np.stack([X, Y, 0 * X], axis=-1), 1e-7, []
    middle = panel.counts[1 - axis] // 2
    for k in free:
        x = flat.copy()
        x[(k, middle, 2) if axis == 0 else (middle, k, 2)] += h
        f = forces(replace(panel, bending=tuple(e if m == axis else 0.0 for m, e in enumerate(panel.bending))), x)
        rows.append(-(f[:, middle, 2] if axis == 0 else f[middle, :, 2])[free] / h)
    return np.array(rows)


@pytest.mark.parametrize("axis", [0, 1])
def test_clamped_yarn_under_a_point_load(small, axis):
    """F L^3 / 192 EI in the middle of a yarn clamped at both ends, and 8 / n^2 more with n segments."""
    panel = small(symmetry="whole", edge="clamped", bending=(EI, EI), failure=False)
    n, d = panel.counts[axis], panel.spacing[axis]
    free, F = np.arange(1, n), np.zeros(n - 1)
    F[n // 2 - 1] = 1.0
    w = np.linalg.solve(matrix(panel, axis, free), F)[n // 2 - 1]
    assert w == pytest.approx((1 + 8 / n**2) * (n * d) ** 3 / (192 * panel.yarns_a_line[axis] * EI), rel=5e-3)


def test_supported_strip_swings(small):
    """pi / 2 sqrt(EI / m L^4) of a strip on two supports (its ends free to turn), within 0.5 %."""
    panel = small(symmetry="whole", edge="free", bending=(EI, EI), failure=False)
    n, (dx, dy), m = panel.counts[0], panel.spacing, panel.weave.areal_density
    K = matrix(panel, 0, np.arange(1, n))
    lowest = np.sqrt(np.linalg.eigvalsh(0.5 * (K + K.T))[0] / (m * dx * dy)) / (2 * np.pi)
    stiffness = panel.yarns_a_line[0] * EI / dy  # per width
    assert lowest == pytest.approx(np.pi / 2 * np.sqrt(stiffness / (m * (n * dx) ** 4)), rel=5e-3)


def test_pure_bending_is_a_circle(small):
    """A yarn whose nodes lie on a circle stores 1/2 EI kappa^2 a length, to the chord's error."""
    panel = small(symmetry="whole", edge="free", bending=(EI, 0.0), failure=False)
    (n, lines), (dx, _), radius = panel.counts, panel.spacing, 0.02
    X, Y = panel.coordinates()
    angle = X / radius
    x = np.stack([radius * np.sin(angle), Y, radius * (1 - np.cos(angle))], axis=-1)
    expected = 0.5 * EI / radius**2 * (n - 1) * dx * panel.yarns_a_line[0] * lines
    assert energy(panel, x) == pytest.approx(expected, rel=5e-4)


def test_step_holds_with_stiff_yarns(straight, monkeypatch):
    """The time step's bound knows of bending: yarns a thousand times as stiff as solid ones do not blow up."""
    table = CellModel(straight(1.0), model="decoupled").table(51)
    knobs = Numerics(cfl=0.99, stretch_viscosity=0.0)
    panel = Panel(
        table, (0.0306, 0.0306), edge="free", failure=False, symmetry="whole", numerics=knobs, bending=(0.1, 0.1)
    )
    assert panel.critical_step < 0.5 * replace(panel, bending=(0.0, 0.0)).critical_step
    whole = panel.time_step
    for factor, holds in ((1.0, True), (1.6, False)):
        monkeypatch.setattr(Panel, "time_step", factor * whole)
        solver = solver_at_rest(replace(panel), 1.0)
        state, const = solver.state, solver.const
        state.projectile_position[2] = -1.0
        nodes = (panel.counts[0] + 1) * const.row_stride
        state.v[2][:nodes] = np.random.default_rng(0).normal(scale=1e-6, size=nodes)
        state.active_rows[:] = 0, const.ni
        advance(solver, 300)
        assert (np.nanmax(np.abs(state.v[2])) < 1e-4) == holds


def test_impact_with_bending_conserves(fabric):
    """Bending has a part of its own in the balance, goes with its yarns, and none of it is there without."""
    setup = ImpactSetup(fabric, 100.0, opening=0.0508, table_size=101, end_time=50e-6, bending=5e-5)
    result = run(setup)
    assert result.energies["bending"][-1] > 1e-4 * result.strike_energy
    assert result.energy_error_max < 5e-4
    assert not run(replace(setup, bending=0.0)).energies["bending"].any()
    broken = run(replace(setup, strike_velocity=260.0))
    assert broken.failed_segments[-1] > 0
    assert broken.energy_error_max < 1e-2
    march = PackSolver(broken.panel, 260.0, 50e-6)
    assert march.sample("bending")[0] == 0.0


def test_bad_bending(small):
    with pytest.raises(InputError, match="bending"):
        small(bending=(-1e-6, 0.0))
