"""The element: plain twins of its kernels, patch test, trellis law, kinetic energy, waves and time step.

Gradient, balance and rotation of its forces: see `test_forces`.
"""

import numpy as np
import pytest
from conftest_tools import advance, bring, grid, node_forces, out_of_reach
from numba import njit
from numpy.testing import assert_allclose
from panels import COARSER, FINER, HALF, STEPPED, THIRD, UNDAMPED, make_panel, rest, set_nodal
from scipy.integrate import quad

from fabrics.base.errors import UnstableError
from shellfabric.cell.model import CellModel
from shellfabric.jit.simd import load, store
from shellfabric.loop import ply_kernels
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane import membrane_kernels, trellis_kernels
from shellfabric.membrane.model import Panel
from shellfabric.membrane.numerics import Numerics
from shellfabric.state import REDO, WEFT


@njit
def shear_slopes(n, sine, G1, G2, gamma1, gamma2, slope):
    for j in range(0, n, 8):
        store(slope, j, trellis_kernels.shear_slope(load(sine, j), G1, G2, gamma1, gamma2))


@pytest.mark.parametrize("grading", [None, COARSER, FINER, HALF, STEPPED, THIRD])
@pytest.mark.parametrize(
    "strain", [[[1.02, 0.15], [0.03, 1.015], [0.2, -0.1]], [[0.6, 0.1], [0.05, 0.7], [0.1, -0.1]]]
)
def test_patch(grading, strain):
    """Under any uniform strain all stretches are the same and no inner node feels a force, in packed fabric too, in all
    zones and where they meet."""
    changes = {"symmetry": "whole", "yarn_failure": False, "grading": grading}
    panel = make_panel(0.06, boundary="free", numerics=UNDAMPED, **changes)
    state = bring(
        panel, panel.state(1.0), np.stack(panel.coordinates(), axis=-1) @ np.transpose(strain)
    )
    for L, y, column in zip(state.stretch, state.yarn_length, np.transpose(strain)):
        assert_allclose(L[y > 0], np.linalg.norm(column), rtol=1e-13)
    f = node_forces(panel, state)
    assert abs(f[1:-1, 1:-1]).max() < 1e-10 * abs(f).max()
    assert abs(f).max() > 1.0


def plain_gather(rows, s, rx, ry, A, B, on1, on2, cross):
    """(3, rows + 1, s) what edges and quadrilaterals give to their nodes, each on its own."""
    g = np.zeros((3, rows + 1, s))
    for c in range(3):
        for i in range(rows):
            for j in range(s):
                k = i * s + j
                up = (i + 1) * s + j
                pull = on1[k] * A[c][k]
                g[c, i, j] += pull
                g[c, i + 1, j] -= pull
                if j == s - 1:
                    continue
                pull = on2[k] * B[c][k]
                g[c, i, j] += pull
                g[c, i, j + 1] -= pull
                turned = rx * cross[k] * (B[c][k] + B[c][up])
                over = ry * cross[k] * (A[c][k] + A[c][k + 1])
                for m, n in ((0, 0), (0, 1), (1, 0), (1, 1)):
                    g[c, i + m, j + n] += (turned if m == 0 else -turned) + (
                        over if n == 0 else -over
                    )
    return g


@pytest.mark.parametrize("s", [5, 8, 21])
def test_gather_against_its_plain_twin(s):
    """Rows shorter than eight slots, of eight, and of more; neighbours come from the eight slots before."""
    rng, rows, m0, rx, ry = np.random.default_rng(4), 4, 2 * s, 3.0, 5.0
    state, const, work = random_block(
        rng, s, ni=rows + 1, rows_per_block=rows, inv_dx=rx, inv_dy=ry
    )
    on2 = work.f_over_stretch[WEFT]
    for idle in (on2, work.trellis_cross):
        idle[s - 1 :: s] = 0.0
    A = np.array(work.A)[:, m0:]
    B = np.array(work.B)[:, m0:]
    on1, on2 = np.array(work.f_over_stretch)[:, m0:]
    plain = plain_gather(rows, s, rx, ry, A, B, on1, on2, work.trellis_cross[m0:])
    membrane_kernels.scatter_forces(state, const, work, 0, 0, rows)
    end = (rows + 1) * s
    for c in range(3):
        found = state.f_int[c][:end].copy()
        found[rows * s :] = state.f_int_above[c][rows * s : end]
        assert_allclose(found, plain[c].ravel(), rtol=0, atol=1e-13)


def random_block(rng, s, **changes):
    """(state, const, work) of a panel whose rows have s slots, with random numbers in the scratch."""
    panel = make_panel(symmetry="whole", boundary="free", yarn_failure=False)
    const = panel.constants()._replace(nj=s - 1, row_stride=s, **changes)
    state, work = panel.state(1.0), panel.work()
    for name in ("A", "B", "stretch", "inv_stretch", "N", "f_over_stretch", "trellis_turn"):
        for part in getattr(work, name):
            part[:] = rng.normal(size=part.size)
    work.trellis_cross[:] = rng.normal(size=work.trellis_cross.size)
    return state, const, work


def bounded(damping, N):
    """The viscous force of an edge: no larger than its tension."""
    most = max(N, 0.0)
    return np.clip(damping, -most, most)


@pytest.mark.parametrize("again", [False, True])
def test_edges_of_a_step_against_their_plain_twin(again):
    """Pulls, what is kept for the next step, and the works of N and of cv dL, of taut and slack yarns that stretch and
    shorten."""
    s, cv, r = 11, (0.9, 0.7), (3.0, 5.0)
    rng = np.random.default_rng(2)
    bounds = set()
    state, const, work = random_block(rng, s, inv_dx=r[0], inv_dy=r[1], cv1=cv[0], cv2=cv[1])
    for part in (*state.stretch, *state.N, *state.dstretch, *state.yarn_length):
        part[:] = rng.normal(size=part.size)
    before = np.array([state.stretch, state.N, state.dstretch], float)
    if again:
        state.block_damage[0] = REDO
    membrane_kernels.pull_yarns(state, const, work, 0, 0, 1)
    works = np.zeros(2)
    for family, beside in enumerate((1, s)):
        L, P, D = before[:, family]
        y = state.yarn_length[family]
        stretch = work.stretch[family]
        N = work.N[family]
        turned = work.trellis_turn[family]
        for k in range(s):
            m = k + 2 * s
            d = stretch[m] - L[k]
            if again:
                d = D[k]
            damping = cv[family] * np.array([d, D[k]])
            now = bounded(damping[0], N[m])
            bounds.add((N[m] > 0, d > 0, now == damping[0]))
            pull = y[k] * (N[m] + now) - turned[m] - turned[m - beside]
            on = r[family] * work.inv_stretch[family][m] * pull
            assert work.f_over_stretch[family][m] == pytest.approx(on)
            assert state.stretch[family][k] == stretch[m]
            assert state.N[family][k] == N[m]
            assert state.dstretch[family][k] == np.float32(d)
            viscous = now + bounded(damping[1], P[k])
            works += y[k] * d * np.array([0.5 * (P[k] + N[m]), 0.5 * viscous])
        assert state.stretch[family][s] == L[s]
    assert len(bounds) == 6
    assert_allclose([state.edge_work[0], state.viscous_work[0]], works * (not again), rtol=1e-12)


def test_uniform_tension_cancels_exactly():
    """Fabric that is stretched evenly stays still to the last digit: no noise grows from rounding."""
    panel = make_panel(boundary="free", symmetry="whole", yarn_failure=False)
    state = panel.state(1.0)
    for c in range(3):
        state.f_int[c][:] = state.f_int_above[c][:] = 0.0
    # displacements whose differences are exact in binary
    s = panel.constants().row_stride
    k = np.arange(state.u[0].size)
    state.u[0][:] = (k // s) * 2.0**-16
    state.u[1][:] = (k % s) * 2.0**-16
    ply_kernels.initial_forces(state, panel.constants(), panel.work())
    f = node_forces(panel, state)
    assert abs(f).max() > 0.1
    assert abs(f[1:-1, 1:-1]).max() == 0.0


def test_trellis_against_the_law(fabric):
    """The kernels' shear, with and without branches, against fabrics.trellis and its integral; odd in the angle."""
    law = fabric.shear
    gamma = np.linspace(-1.4, 1.4, 281)
    constants = np.array([law.G1, law.G2, law.gamma1, law.gamma2])
    slope = np.empty(gamma.size + 8)
    shear_slopes(gamma.size, np.append(np.sin(gamma), np.zeros(8)), *constants, slope)
    assert_allclose(slope[:-8] * np.cos(gamma), law.stress(gamma), rtol=1e-11, atol=1e-6)
    stress, energy = np.transpose([trellis_kernels.trellis_law(g, *constants) for g in gamma])
    assert_allclose(stress, law.stress(gamma), rtol=1e-12, atol=1e-9)
    for g, stored in zip(gamma[::9], energy[::9]):
        assert stored == pytest.approx(
            quad(law.stress, 0, g, points=np.sign(g) * constants[2:])[0], rel=1e-9
        )


def test_kinetic_energy_of_free_nodes():
    """m v(n-1/2) v(n+1/2) / 2 of all nodes that no clamp holds, eight at a time."""
    panel = make_panel()
    rng = np.random.default_rng(5)
    out = np.empty(5)
    const = panel.constants()
    state = panel.state(50.0)
    free = panel.loose()
    for components in (state.v, state.f_int, state.f_int_above, state.f_contact):
        for part in components:
            part[: free.size] = rng.standard_normal(free.size)
    ply_kernels.energies(state, const, out)
    mass = grid(const, state.mass)
    expected = 0.0
    for c in range(3):
        v = grid(const, state.v[c])
        force = grid(const, state.f_int[c] + state.f_int_above[c] + state.f_contact[c])
        expected += 0.5 * np.sum((mass * v * (v + const.dt * force / mass))[free])
    assert out[ply_kernels.KINETIC] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    "weft_mass, share", [(1e-6, 1.0), (1.0, 0.5**0.5)], ids=["straight yarn", "woven yarn"]
)
def test_longitudinal_wave_speed(straight, weft_mass, share):
    """A straight yarn carries sqrt(E / rho); with a crossing yarn of its own mass to move, that over sqrt 2 (E-38)."""
    fabric = straight(weft_mass)
    model = CellModel(fabric, cell_model="decoupled")
    panel = Panel(model.table(201), (0.6, 0.0203), boundary="free", yarn_failure=False)
    solver, state, const = out_of_reach(panel)
    ni = const.ni
    s = const.row_stride
    # all fabric runs away from the plane of symmetry, which holds its end: a front of tension sets out from there
    state.v[0][: (ni + 1) * s] = 10.0
    state.v[0][:s] = 0.0
    stations = (ni // 5, 4 * ni // 5)
    arrivals = {}
    full = fabric.weave.warp.EA * 10.0 / (share * fabric.weave.warp.wave_speed)
    while len(arrivals) < 2:
        advance(solver, 1)
        assert state.steps < 5 * ni
        for i in stations:
            if i not in arrivals and state.N[0][i * s] > 0.5 * full:
                arrivals[i] = state.steps * const.dt
    speed = (stations[1] - stations[0]) * const.dx / (arrivals[stations[1]] - arrivals[stations[0]])
    assert speed == pytest.approx(
        share * (fabric.weave.warp.E / fabric.weave.warp.fibre_density) ** 0.5, rel=0.01
    )


# a thousand times as stiff as solid
BENT = {
    "form": "variational",
    "bending": (0.1, 0.1),
    "strain": 0.0,
    "cfl": 0.99,
}


@pytest.mark.parametrize(
    "changes, factor, holds",
    [({}, 0.99, True), ({}, 1.02, False), (BENT, 1.0, True), (BENT, 1.6, False)],
)
def test_time_step_bound(straight, monkeypatch, changes, factor, holds):
    """Straight yarns are as stiff as the bound supposes: above it a taut panel, and one of stiff yarns, blows up.

    In the equilibrium form; in the variational one half of a yarn's force follows from means, which are softer.
    """
    settings = {"form": "equilibrium", "bending": (0.0, 0.0), "strain": 0.02, "cfl": 1.0} | changes
    table = CellModel(
        straight(1.0), cell_model="decoupled", cell_formulation=settings["form"]
    ).table(51)
    numerics = Numerics(cfl=settings["cfl"], stretch_viscosity=0.0)
    panel = make_panel(
        table=table,
        boundary="free",
        yarn_failure=False,
        symmetry="whole",
        numerics=numerics,
        bending=settings["bending"],
    )
    monkeypatch.setattr(
        Panel, "time_step", factor * (panel.time_step if changes else panel.critical_step)
    )
    solver, state, const = out_of_reach(panel)
    inside = np.zeros(rest(panel).shape[:2])
    inside[1:-1, 1:-1] = 1.0
    state.dt_over_mass[: inside.size] = (
        const.dt * state.inverse_mass[: inside.size] * inside.ravel()
    )
    set_nodal(state.u, settings["strain"] * rest(panel))
    set_nodal(
        state.v,
        np.random.default_rng(0).normal(scale=1e-3, size=(*inside.shape, 3)) * inside[..., None],
    )
    ply_kernels.initial_forces(state, const, panel.work())
    advance(solver, 400)
    # what is no number any more is at rest
    assert (0.0 < max(abs(v).max() for v in state.v) < 0.02) == holds


def highest_frequency(panel, x):
    """[1/s] of the fabric at x, by power iteration on the change of its forces.

    Fabric that is pressed together buckles: some modes are pushed on instead of back. These have no frequency.
    """
    state = panel.state(1.0)
    mass = panel.masses()[..., None]

    def forces(x):
        """At rest: brought there twice, so that no stretch changes and nothing is damped."""
        return node_forces(panel, bring(panel, bring(panel, state, x), x))

    at_rest = forces(x)
    size = 1e-4 * min(panel.spacing)

    def furthest(origin):
        """The square of a frequency that is furthest from `origin`; below 0 of a mode that grows."""
        mode = np.random.default_rng(1).normal(size=x.shape)
        for _ in range(60):
            last = mode * size / abs(mode).max()
            mode = (at_rest - forces(x + last)) / mass - origin * last
        away = np.linalg.norm(mode) / np.linalg.norm(last)
        return origin + np.copysign(away, np.sum(mode * last))

    square = furthest(0.0)
    return np.sqrt(square if square > 0.0 else furthest(square))


@pytest.mark.parametrize(
    "stretches", [(1.0, 1.0), (0.7, 0.7), (0.3, 0.3), (0.1, 0.1), (0.02, 0.02), (0.02, 0.9)]
)
def test_cloth_that_is_drawn_together_stays_within_the_time_step(stretches):
    """The trellis alone, sheared beyond the angle at which it locks: along unit vectors its stiffness grows as the
    inverse square of the stretch, and the step of fabric at rest is ten times too long at a stretch of 0.1."""
    panel = make_panel(boundary="free", symmetry="whole")
    (X, Y), directions = (
        panel.coordinates(),
        ((np.cos(0.4), np.sin(0.4)), (np.sin(0.4), np.cos(0.4))),
    )
    x = np.stack(
        [stretches[0] * X * a + stretches[1] * Y * b for a, b in zip(*directions)] + [0 * X],
        axis=-1,
    )
    assert highest_frequency(panel, x) * panel.time_step < 2.0


@pytest.mark.parametrize("edge, whole", [("clamped", 0), (("free", "clamped"), 1), ("free", 2)])
def test_reach_is_bounded_along_yarns_that_are_held_at_both_ends(edge, whole):
    panel = make_panel(boundary=edge)
    assert sum(reach > x[-1] - x[0] for reach, x in zip(panel.reach(), panel.lines())) == whole


@pytest.mark.parametrize("velocity", [10.0, 400.0])
def test_nodes_may_be_ten_times_as_fast_as_what_sets_them_in_motion(velocity):
    """The projectile, or in a slow strike a yarn that breaks at the strain e: e c."""
    panel = make_panel()
    march = PackSolver(panel, velocity, 5e-6).run()
    speed = 10 * max(
        velocity, *(yarn.failure_strain * yarn.wave_speed for yarn in panel.weave.yarns)
    )
    assert (speed == 4000.0) == (velocity == 400.0)
    march.state.v[2][30] = 0.9 * speed
    march._guard()
    march.state.v[2][30] = 1.1 * speed
    with pytest.raises(UnstableError, match="a node moves at"):
        march._guard()
