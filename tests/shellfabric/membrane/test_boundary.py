"""Edges that slip, sides that differ, rectangles, round openings, and a weave at an angle to its frame."""

from math import radians

import numpy as np
import pytest
from conftest_tools import advance, grid, solver_at_rest
from numpy.testing import assert_allclose, assert_array_equal
from panels import make_panel, rest, set_nodal

from shellfabric.loop import histories, ply_kernels
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane import boundary_kernels, edges
from shellfabric.membrane.boundary import Grip, PullIn

SLIP = PullIn(pull_in=0.4e-3, start=5e-6, end=35e-6, zone=20e-3)


def fire(panel, speed=100.0, steps=400):
    solver = solver_at_rest(panel, speed)
    history = advance(solver, steps)
    return solver.state, solver.const, history


@pytest.mark.parametrize("symmetry", ["quarter", "whole"])
def test_pull_in_is_a_triangle_that_grows_evenly(symmetry):
    """At the weft's ends alone: u_y = - length (1 - |x| / (zone / 2)) (t - start) / (end - start)."""
    panel = make_panel(boundary=("clamped", SLIP), symmetry=symmetry)
    solver = solver_at_rest(panel, 50.0)
    state = solver.state
    const = solver.const
    triangle = SLIP.pull_in * np.maximum(1 - abs(panel.lines()[0]) / (0.5 * SLIP.zone), 0)
    for share in (0.0, 0.25, 0.8, 1.0, 1.0):
        steps = int((SLIP.start + share * (SLIP.end - SLIP.start)) / const.dt) - int(state.steps)
        advance(solver, max(steps, 30))
        part = np.clip((state.steps * const.dt - SLIP.start) / (SLIP.end - SLIP.start), 0, 1)
        u = np.array([grid(const, each) for each in state.u])
        assert_allclose(u[1, :, -1], -part * triangle, atol=1e-15)
        assert not u[[0, 2], :, -1].any()
        if symmetry == "whole":
            assert_allclose(u[1, :, 0], part * triangle, atol=1e-15)
    assert not u[:, -1].any()  # warp ends are clamped


def test_the_pull_in_is_sampled():
    """What is prescribed, at its time; of grips what the nodes have moved, which grows; of clamps nothing."""
    solver = PackSolver(make_panel(boundary=("clamped", SLIP)), 90.0, 1.2 * SLIP.end).run()
    part = np.clip((solver.sample("t") - SLIP.start) / (SLIP.end - SLIP.start), 0, 1)
    assert_allclose(solver.ply_sample("pull_in")[:, 0], part * SLIP.pull_in, rtol=1e-9, atol=1e-12)
    gripped = PackSolver(make_panel(boundary=Grip(5.0)), 90.0, 60e-6).run().ply_sample("pull_in")
    assert gripped[-1, 0] > 1e-5
    assert not PackSolver(make_panel(), 90.0, 20e-6).run().ply_sample("pull_in").any()


@pytest.mark.parametrize("symmetry", ["quarter", "whole"])
@pytest.mark.parametrize("elements", [1, 2])
def test_grip_holds_up_to_its_force_and_slips_with_it(symmetry, elements):
    """Fabric stretched evenly: below the grip the ends rest, above they gain dt (T - F) / m in one step inwards, with
    the share of F that their line has in a yarn."""
    changes = {"symmetry": symmetry, "elements_per_crossover": elements}
    panel = make_panel(boundary=(Grip(20.0), "clamped"), yarn_failure=False, **changes)
    const = panel.constants()
    held = np.full(panel.counts[1], 20.0 / elements)
    held[0] *= 0.5 if symmetry == "quarter" else 1.0  # a plane of symmetry halves a yarn
    for strain in (0.002, 0.02):
        state = panel.state(1.0)
        set_nodal(state.u, strain * rest(panel) * [1, 0, 0])
        ply_kernels.initial_forces(state, const, panel.work())
        boundary_kernels.update_slip_nodes(state, const, 0.0)
        force, v = (
            grid(const, part)[-1, :-1]
            for part in (state.f_int[0] + state.f_int_above[0], state.v[0])
        )
        inside = slice(int(not panel.mirrors[1]), None)  # corners are held
        gained = const.dt * np.minimum(force + held, 0.0) / grid(const, state.mass)[-1, :-1]
        assert np.all((gained < 0.0)[inside] == (strain == 0.02))
        assert_allclose(v[inside], gained[inside], rtol=1e-12, atol=1e-18)
        if symmetry == "whole":  # the other end
            assert_allclose(grid(const, state.v[0])[0, 1:-1], -gained[1:], rtol=1e-9, atol=1e-18)


def test_each_side_on_its_own():
    """Which nodes are held, led or gripped, corners among them."""
    panel = make_panel(boundary=(("clamped", "free"), (Grip(5.0), "free")), symmetry="whole")
    loose = panel.loose()
    assert not loose[0].any()
    assert not loose[:, 0].any()
    assert loose[1:, 1:].all()
    rim = edges.rim(panel)
    assert set(rim["slip_axis"]) == {1}
    # the corner at the clamp is held, the free one gripped
    assert_array_equal(rim["slip_node"], np.arange(1, 25) * 25)
    assert_allclose(rim["slip_grip"], [5.0] * 23 + [2.5])
    state, const, _ = fire(make_panel(boundary=("clamped", "free")), 100.0, 500)
    assert abs(grid(const, state.u[1])[:, -1]).max() > 1e-5


def test_slip_across_the_panel_brings_new_cloth_under_the_projectile():
    """The elements that contact looks at widen by as much as the edges have slipped."""
    panel = make_panel(boundary=(Grip(2.0), Grip(2.0)))
    state, _, _ = fire(panel, 60.0, 500)
    assert abs(state.u[0]).max() > 1e-3
    assert state.contact_window[1] > panel.state(60.0).contact_window[1]


def test_grips_are_struck_off_the_middle():
    """Also beside a crossover: the near end slips more, points on both sides are alike, and the energy balances."""
    x = 4.3 * 2 * make_panel().weave.w[0]
    sides = {"symmetry": "whole", "boundary": (Grip(5.0), "clamped")}
    right, left = (
        PackSolver(make_panel(impact_point=(at, 0.0), **sides), 90.0, 60e-6).run() for at in (x, -x)
    )
    assert_allclose(right.sample("v"), left.sample("v"), rtol=1e-9)
    far, near = (abs(grid(right.const, right.state.u[0])[end]).max() for end in (0, -1))
    assert near > 1.5 * far > 0
    assert abs(right.sample("error")).max() < 1e-3 * right.strike_energy


# oblique weaves, round openings, and impacts off the middle

FRAMES = [
    *({"weave_angle": radians(angle)} for angle in (1.0, 30.0, 45.0, -60.0, 89.0)),
    {"weave_angle": radians(40.0), "impact_point": (5e-3, 3e-3)},
    {"weave_angle": radians(30.0), "opening": (0.04, 0.04), "round": True},
    {"impact_point": (5e-3, 3e-3)},
    {"opening": (0.04, 0.04), "round": True},
    {"opening": (0.04, 0.04), "round": True, "symmetry": "quarter"},
]


def framed(changes):
    return make_panel(**{"opening": (0.04, 0.03), "symmetry": "whole"} | changes)


@pytest.mark.parametrize("changes", FRAMES)
def test_loose_nodes_are_those_inside_the_opening(changes):
    """The grid covers it with held nodes all round, and yarns end at the first of these."""
    panel = framed(changes)
    X, Y = panel.coordinates()
    place = (X + 1j * Y) * np.exp(1j * panel.weave_angle) + complex(*panel.impact_point)
    inside = (abs(place.real) < 0.02) & (abs(place.imag) < 0.5 * panel.opening[1])
    inside = abs(place) < 0.02 if panel.round else inside
    inside[-1] = inside[:, -1] = False  # the last lines are held, as of any clamped panel
    for rows, mirrored in ((inside, panel.mirrors[0]), (inside.T, panel.mirrors[1])):
        rows[0] &= mirrored
    loose = panel.loose()
    assert_array_equal(loose, inside)
    (i, j), (k, l) = edges.ends(panel)
    assert [loose[i - 1, j], loose[i, j], loose[k, l - 1], loose[k, l]] == [
        True,
        False,
        True,
        False,
    ]


@pytest.mark.parametrize("changes", [*FRAMES, {"impact_point": (0.0, 0.0)}])
def test_what_is_shown_ends_at_the_opening(changes):
    """Nodes within it are shown where they are, and those that lie in the clamp on the edge."""
    panel = framed(changes)
    held = ~panel.loose()
    shown = np.array(edges.shown(panel))
    assert_array_equal(shown[:, ~held], np.array(panel.coordinates())[:, ~held])
    place = (shown[0] + 1j * shown[1]) * np.exp(1j * panel.weave_angle) + complex(
        *panel.impact_point
    )
    sides = (abs(place), abs(place)) if panel.round else (abs(place.real), abs(place.imag))
    assert all(side.max() <= 0.5 * length + 1e-12 for side, length in zip(sides, panel.opening))


def test_an_oblique_weave_is_the_same_cloth_until_its_edge_is_felt():
    """The deceleration does not depend on the angle until waves have come back from the frame."""
    panels = [
        make_panel(0.05842, symmetry="whole", weave_angle=radians(angle)) for angle in (0.0, 40.0)
    ]
    straight, turned = (fire(panel, 80.0, 500)[2][:, 1] for panel in panels)
    assert_allclose(turned[:60], straight[:60], rtol=1e-6)
    assert abs(turned[-1] - straight[-1]) > 0.2


def test_an_edge_is_felt_by_its_distance_from_the_impact():
    """15 crossovers from the near edge and 31 from the far one: until waves come back from that, the near one feels
    what it does where both are 15 away, at the far one nothing is felt yet. Mirrored points are alike.

    In the equilibrium form: in the other the line in the clamp has half a crossover out there.
    """
    side, width = (2 * w for w in make_panel().weave.w)

    def pull(crossovers, point=0.0):
        sides = {"opening": (crossovers * side, 30 * width), "impact_point": (point * side, 0.0)}
        panel = make_panel(symmetry="whole", cell_formulation="equilibrium", **sides)
        solver = PackSolver(panel, 90.0, 16e-6).run()
        return solver.sample("reaction_warp")[-1], solver.sample("v")[-1]

    near = pull(46, 8.0)
    far = pull(46, -8.0)
    assert near[0] == pytest.approx(pull(30)[0], rel=1e-7)
    assert near[0] > 20.0
    assert abs(far[0]) < 0.1
    assert near[1] == pytest.approx(far[1], rel=1e-9)


@pytest.mark.parametrize(("opening", "is_round"), [((0.04, 0.04), True), ((0.04, 0.036), False)])
def test_edge_forces_of_an_opening(opening, is_round):
    """A quarter, both halves and the whole have the same pull and lift at the four parts of the edge."""
    pulls = []
    for symmetry in ("whole", "quarter", "half", "other half"):
        panel = make_panel(opening=opening, round=is_round, symmetry=symmetry)
        state = PackSolver(panel, 90.0, 30e-6).run().state
        sides = histories.edge_nodes(panel)
        force = np.add(state.f_int, state.f_int_above)
        total = [(weights * force[:, nodes]).sum(axis=1) for nodes, weights, _ in sides]
        pulls.append(
            [
                [-normal[0] * f[0] - normal[1] * f[1], f[2]]
                for f, (_, _, normal) in zip(total, sides)
            ]
        )
    for part in pulls[1:]:
        assert_allclose(part, pulls[0], rtol=1e-6)
    assert pulls[0][0][0] > 100.0
