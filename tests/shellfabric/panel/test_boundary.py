"""Edges that slip, sides that differ, rectangles, and a weave at an angle to its frame."""

from math import radians

import numpy as np
import pytest
from conftest_tools import advance, bring, solver_at_rest

from fabrics.errors import InputError
from shellfabric.cloth import boundary_kernels
from shellfabric.output import histories
from shellfabric.panel import boundary
from shellfabric.panel.boundary import Grip, PullIn
from shellfabric.panel.model import Panel
from shellfabric.projectile.projectile import Projectile
from shellfabric.solver.pack_solver import PackSolver

SLIP = PullIn(length=0.4e-3, start=5e-6, end=35e-6, zone=20e-3)


def fire(panel, speed=100.0, steps=400):
    solver = solver_at_rest(panel, speed)
    fine = advance(solver, steps)
    return solver.state, solver.const, fine


def field(state, const, c):
    return state.u[c][: (const.ni + 1) * const.row_stride].reshape(const.ni + 1, const.row_stride)


@pytest.mark.parametrize("symmetry", ["quarter", "whole"])
def test_pull_in_is_a_triangle_that_grows_evenly(small, symmetry):
    """At the weft's ends alone: u_y = - length (1 - |x| / (zone / 2)) (t - start) / (end - start)."""
    panel = small(edge=("clamped", SLIP), symmetry=symmetry)
    solver = solver_at_rest(panel, 50.0)
    state, const = solver.state, solver.const
    X = panel.coordinates()[0][:, -1]
    triangle = SLIP.length * np.maximum(1 - np.abs(X) / (0.5 * SLIP.zone), 0)
    for share in (0.0, 0.25, 0.8, 1.0, 1.0):
        steps = int((SLIP.start + share * (SLIP.end - SLIP.start)) / const.dt) - int(state.counter[0])
        advance(solver, max(steps, 30))
        time = state.counter[0] * const.dt
        part = min(max((time - SLIP.start) / (SLIP.end - SLIP.start), 0), 1)
        np.testing.assert_allclose(field(state, const, 1)[:, -1], -part * triangle, atol=1e-15)
        assert not field(state, const, 0)[:, -1].any()
        assert not field(state, const, 2)[:, -1].any()
        if symmetry == "whole":
            np.testing.assert_allclose(field(state, const, 1)[:, 0], part * triangle, atol=1e-15)
    assert not np.array([field(state, const, c)[-1] for c in range(3)]).any()  # warp ends are clamped


@pytest.mark.parametrize("edge", [("clamped", SLIP), (SLIP, SLIP), ("free", SLIP), Grip(15.0), ("clamped", Grip(3.0))])
@pytest.mark.parametrize("form", ["equilibrium", "variational"])
def test_energy_balances_while_edges_slip(small, tables, edge, form):
    panel = small(table=tables[form], edge=edge)
    march = PackSolver(panel, 90.0, 60e-6).run()
    assert np.abs(march.sample("error")).max() < 2e-3 * march.strike_energy
    gripped = isinstance(edge, Grip) or isinstance(edge[-1], Grip)
    spent = march.sample("clamp_friction" if gripped else "boundary_work")
    assert abs(spent[-1]) > 1e-3 * march.strike_energy
    if gripped:
        assert np.diff(spent).min() >= -1e-9 * march.strike_energy  # friction gives nothing back
        assert not march.sample("boundary_work").any()


def test_the_pull_in_is_sampled(small):
    """What is prescribed, at its time; of grips what the nodes have moved, which grows; of clamps nothing."""
    march = PackSolver(small(edge=("clamped", SLIP)), 90.0, 1.2 * SLIP.end).run()
    part = np.clip((march.sample("t") - SLIP.start) / (SLIP.end - SLIP.start), 0, 1)
    np.testing.assert_allclose(march.ply_sample("pull_in")[:, 0], part * SLIP.length, rtol=1e-9, atol=1e-12)
    gripped = PackSolver(small(edge=Grip(5.0)), 90.0, 60e-6).run().ply_sample("pull_in")
    assert gripped[-1, 0] > 1e-5
    assert not PackSolver(small(), 90.0, 20e-6).run().ply_sample("pull_in").any()


def test_pull_in_softens_the_panel(small):
    """The cloth does work on the edges that give way, and slows the projectile less (source section 6.4.3)."""
    held, slipping = (fire(small(edge=edge, failure=False), 90.0, 330) for edge in ("clamped", ("clamped", SLIP)))
    before = int(SLIP.start / held[1].dt)
    np.testing.assert_allclose(slipping[2][:before, 1], held[2][:before, 1], rtol=1e-9)
    assert slipping[2][-1, 1] > held[2][-1, 1] + 0.5
    assert slipping[0].slip_energy[boundary_kernels.BOUNDARY_WORK] > 0


def test_grip_holds_up_to_its_force_and_slips_with_it(small):
    """Cloth stretched evenly: below the grip the ends rest, above it they gain dt (T - F) / m in one step."""
    panel = small(edge=(Grip(20.0), "clamped"), symmetry="whole")
    for strain in (0.002, 0.02):
        state, const = panel.state(1.0), panel.constants()
        X, Y = panel.coordinates()
        bring(panel, state, np.stack([(1 + strain) * X, Y, 0 * X], axis=-1))
        boundary_kernels.update_slip_nodes(state, const, 0.0)
        tension = -(state.f_int[0] + state.f_int_above[0])[const.ni * const.row_stride + 12]
        node = const.ni * const.row_stride + 12
        expected = -const.dt * max(tension - 20.0, 0.0) / state.mass[node]
        assert (tension > 20.0) == (strain == 0.02)
        assert state.v[0][node] == pytest.approx(expected, rel=1e-12, abs=1e-18)
        assert state.v[0][12] == pytest.approx(-expected, rel=1e-9, abs=1e-18)  # the other end, inwards too


def test_reaction_of_a_gripped_yarn_is_its_grip(small):
    """No yarn is held by more than the grip, and those that slip by just that."""
    state, const, _ = fire(small(edge=(Grip(12.0), "clamped")), 90.0, 110)
    share = np.where(const.slip_node % const.row_stride == 0, 0.5, 1.0)  # a plane of symmetry halves a yarn
    assert np.all(np.abs(state.slip_force) <= 12.0 * share * (1 + 1e-12))
    speed = state.v[0][const.slip_node]
    slipping = speed < 0
    assert 3 < slipping.sum() < speed.size
    np.testing.assert_allclose(state.slip_force[slipping], -12.0 * share[slipping], rtol=1e-9)


def test_firm_grip_is_a_clamp_and_loose_grip_is_free_along_the_yarn(small):
    clamped, firm = (fire(small(edge=edge))[2] for edge in ("clamped", Grip(1e6)))
    np.testing.assert_array_equal(firm, clamped)
    sliding = [fire(small(edge=Grip(force)), 90.0, 300)[0] for force in (40.0, 10.0, 1.0)]
    slips = [np.abs(state.u[0]).max() for state in sliding]
    assert slips[0] < slips[1] < slips[2]


def test_each_side_on_its_own(small):
    """Which nodes are held, led or gripped, corners among them."""
    panel = small(edge=(("clamped", "free"), (Grip(5.0), "free")), symmetry="whole")
    loose = boundary.loose(panel)
    assert not loose[0].any()
    assert not loose[:, 0].any()
    assert loose[1:, 1:].all()
    nodes, axes, values = boundary.rim(panel)
    assert set(axes) == {1}
    np.testing.assert_array_equal(nodes, np.arange(1, 25) * 25)  # the corner at the clamp is held, the free one gripped
    np.testing.assert_allclose(values[:, 3], [5.0] * 23 + [2.5])
    free = fire(small(edge=("clamped", "free")), 100.0, 500)[0]
    assert np.abs(field(free, panel.constants()._replace(ni=12, row_stride=13), 1)[:, -1]).max() > 1e-5


def test_slip_across_the_panel_brings_new_cloth_under_the_projectile(small):
    """The elements that contact looks at widen by as much as the edges have slipped."""
    panel = small(edge=(Grip(2.0), Grip(2.0)))
    state, _, _ = fire(panel, 60.0, 500)
    assert np.abs(state.u[0]).max() > 1e-3
    assert state.contact_window[1] > panel.state(60.0).contact_window[1]


def test_symmetric_panels_have_equal_ends(small):
    with pytest.raises(InputError, match="edge"):
        small(edge=(("clamped", "free"), "free"))
    small(edge=(("clamped", "free"), "free"), symmetry="whole")


@pytest.mark.parametrize("bad", ["glued", ("clamped",), ("free", ("free", "glued")), ("free", ("free",) * 3)])
def test_bad_edges(small, bad):
    with pytest.raises(InputError, match="edge"):
        small(edge=bad)


@pytest.mark.parametrize(
    ("kind", "bad"),
    [
        (PullIn, {"length": 0.0}),
        (PullIn, {"end": 5e-6}),
        (PullIn, {"start": -1e-6}),
        (PullIn, {"zone": 0.0}),
        (Grip, {"force": 0.0}),
    ],
)
def test_bad_slips(kind, bad):
    good = {"length": 1e-3, "start": 5e-6, "end": 1e-5} if kind is PullIn else {}
    with pytest.raises(InputError, match=next(iter(bad))):
        kind(**(good | bad))


def test_any_rectangle(tables):
    """As many whole crossovers along each yarn as fit; the shorter way feels its edge sooner."""
    panel = Panel(tables["equilibrium"], (0.06, 0.03))
    assert panel.counts == (23, 11)
    march = PackSolver(panel, 80.0, 12e-6).run()
    assert march.sample("reaction_weft")[-1] > 1.5 * march.sample("reaction_warp")[-1]
    turned = PackSolver(Panel(tables["equilibrium"], (0.03, 0.06)), 80.0, 12e-6).run()
    assert turned.sample("reaction_warp")[-1] > 1.5 * turned.sample("reaction_weft")[-1]


# oblique weave


def oblique(table, degrees, opening=(0.04, 0.03), **changes):
    return Panel(table, opening, weave_angle=radians(degrees), symmetry="whole", **changes)


def test_frame_of_an_oblique_weave(tables):
    """Loose nodes are those inside the turned opening; the grid covers it with held ones all round."""
    for degrees in (1.0, 30.0, 45.0, -60.0, 89.0):
        panel = oblique(tables["equilibrium"], degrees)
        X, Y = panel.coordinates()
        loose, turn = boundary.loose(panel), radians(degrees)
        places = (X + 1j * Y) * np.exp(1j * turn)  # warp leans by the angle from the first side
        inside = (np.abs(places.real) < 0.02) & (np.abs(places.imag) < 0.015)
        np.testing.assert_array_equal(loose, inside)
        for rim in (loose[:1], loose[-1:], loose[:, :1].T, loose[:, -1:].T):
            assert not rim.any()
        area = np.prod(panel.spacing) * loose.sum()
        assert area == pytest.approx(0.04 * 0.03, rel=0.05)
        (i, j), (k, l) = boundary.ends(panel)
        assert not loose[i, j]
        assert loose[i - 1, j]
        assert not loose[k, l]
        assert loose[k, l - 1]


def test_an_oblique_weave_is_the_same_cloth_until_its_edge_is_felt(tables):
    """The deceleration does not depend on the angle until waves have come back from the frame."""
    table = tables["equilibrium"]
    straight = fire(Panel(table, (0.06, 0.06), symmetry="whole"), 80.0, 60)[2]
    turned = fire(oblique(table, 40.0, (0.06, 0.06)), 80.0, 60)[2]
    np.testing.assert_allclose(turned, straight, rtol=1e-6, atol=1e-6)
    later = [
        fire(panel, 80.0, 500)[2][-1, 1]
        for panel in (Panel(table, (0.06, 0.06), symmetry="whole"), oblique(table, 45.0, (0.06, 0.06)))
    ]
    assert abs(later[0] - later[1]) > 0.2


def test_energy_of_an_oblique_weave(tables):
    march = PackSolver(
        oblique(tables["variational"], 30.0, projectile=Projectile(shape="sphere", obliquity=0.3, azimuth=1.0)),
        90.0,
        60e-6,
    ).run()
    assert np.abs(march.sample("error")).max() < 1e-3 * march.strike_energy
    assert march.sample("reaction_warp")[-1] > 1.0


def test_what_an_oblique_weave_needs(tables):
    table = tables["equilibrium"]
    with pytest.raises(InputError, match="symmetry"):
        Panel(table, (0.04, 0.03), weave_angle=0.3)
    with pytest.raises(InputError, match="edge"):
        oblique(table, 30.0, edge="free")
    with pytest.raises(InputError, match="weave_angle"):
        oblique(table, 95.0)


# round openings, and impacts off the middle


def test_loose_nodes_of_a_round_opening(tables):
    for symmetry, degrees in (("quarter", 0.0), ("whole", 30.0)):
        panel = Panel(tables["equilibrium"], (0.04, 0.04), symmetry=symmetry, weave_angle=radians(degrees), round=True)
        X, Y = panel.coordinates()
        inside = np.hypot(X, Y) < 0.02
        inside[-1, :] = inside[:, -1] = False  # the last lines are held, as of any clamped panel
        np.testing.assert_array_equal(boundary.loose(panel), inside)
    assert np.prod(panel.spacing) * boundary.loose(panel).sum() == pytest.approx(np.pi * 0.02**2, rel=0.05)


def test_loose_nodes_of_an_impact_off_the_middle(tables):
    """The grid's middle is the impact point, 5 mm from the middle along the first side and 3 mm along the second."""
    table, point = tables["equilibrium"], (5e-3, 3e-3)
    plain = Panel(table, (0.04, 0.03), symmetry="whole", impact_point=point)
    X, Y = plain.coordinates()
    inside = (np.abs(X + 5e-3) < 0.02) & (np.abs(Y + 3e-3) < 0.015)
    inside[-1, :] = inside[:, -1] = inside[0, :] = inside[:, 0] = False  # the last lines are held
    np.testing.assert_array_equal(boundary.loose(plain), inside)
    turned = oblique(table, 40.0, impact_point=point)
    X, Y = turned.coordinates()
    place = (X + 1j * Y) * np.exp(1j * radians(40)) + complex(*point)
    inside = (np.abs(place.real) < 0.02) & (np.abs(place.imag) < 0.015)
    np.testing.assert_array_equal(boundary.loose(turned), inside)
    for rim in (inside[:1], inside[-1:], inside[:, :1].T, inside[:, -1:].T):
        assert not rim.any()


def test_an_edge_is_felt_by_its_distance_from_the_impact(tables):
    """15 crossovers from the near edge and 30 from the far one: the near one feels what it does in a panel that ends at
    15 on both sides, but for half a crossover that lies in the clamp; at 30 nothing is felt yet. Mirrored points are
    alike."""
    table = tables["variational"]
    side, width = (2 * w for w in table.model.fabric.weave.w)

    def pull(crossovers, point=0.0):
        panel = Panel(table, (crossovers * side, 30 * width), symmetry="whole", impact_point=(point * side, 0.0))
        march = PackSolver(panel, 90.0, 14e-6).run()
        return march.sample("reaction_warp")[-1], march.sample("v")[-1]

    near, (far, last) = pull(45, 7.5), pull(45, -7.5)
    assert near[0] == pytest.approx(pull(30)[0], rel=0.2)
    assert near[0] > 20.0
    assert abs(far) < 0.1
    assert near[1] == pytest.approx(last, rel=1e-9)


def test_half_of_a_panel_struck_on_its_axis_is_like_the_whole(tables):
    """A point on the second axis leaves the plane x = 0 a plane of symmetry; a round opening too."""
    given = {"impact_point": (0.0, 4e-3), "round": True}
    half, whole = (Panel(tables["variational"], (0.04, 0.04), symmetry=s, **given) for s in ("half", "whole"))
    speeds = [fire(panel, 90.0, 400)[2][-1, 1] for panel in (half, whole)]
    assert speeds[0] == pytest.approx(speeds[1], rel=1e-9)
    assert speeds[0] < 80.0


def test_energy_and_edge_forces_of_a_round_opening(tables):
    """The energy closes, with and without failure; a quarter, a half and the whole have the same pull and lift at the
    four parts of the edge."""
    pulls = []
    for symmetry in ("quarter", "half", "whole"):
        panel = Panel(tables["variational"], (0.04, 0.04), symmetry=symmetry, round=True)
        march = PackSolver(panel, 90.0, 30e-6).run()
        assert np.abs(march.sample("error")).max() < 1e-3 * march.strike_energy
        sides, state = histories.edge_nodes(panel), march.state
        nodal = [a + b for a, b in zip(state.f_int, state.f_int_above)]
        of = [[(weights * force[nodes]).sum() for force in nodal] for nodes, weights, _ in sides]
        pulls.append([[-normal[0] * f[0] - normal[1] * f[1], f[2]] for f, (_, _, normal) in zip(of, sides)])
    np.testing.assert_allclose(pulls[0], pulls[2], rtol=1e-6)
    np.testing.assert_allclose(pulls[1], pulls[2], rtol=1e-6)
    assert pulls[2][0][0] > 100.0
    failing = PackSolver(Panel(tables["variational"], (0.04, 0.04), round=True), 160.0, 100e-6).run()
    assert failing.outcome == "perforated"
    assert np.abs(failing.sample("error")).max() < 1e-3 * failing.strike_energy


def test_what_stepped_edges_need(tables):
    table = tables["equilibrium"]
    for changes, key in (
        ({"impact_point": (5e-3, 0.0)}, "impact_point"),
        ({"impact_point": (0.0, 5e-3), "symmetry": "quarter"}, "impact_point"),
        ({"impact_point": (19e-3, 0.0), "symmetry": "whole"}, "impact_point"),
        ({"impact_point": (13e-3, 11e-3), "symmetry": "whole", "round": True}, "impact_point"),
        ({"round": True, "opening": (0.04, 0.03)}, "opening"),
        ({"round": True, "edge": "free"}, "edge"),
        ({"impact_point": (5e-3, 0.0), "symmetry": "whole", "edge": PullIn(1e-3, 0.0, 1e-5)}, "edge"),
    ):
        with pytest.raises(InputError, match=key):
            Panel(table, **({"opening": (0.04, 0.04)} | changes))


@pytest.mark.parametrize(
    "given",
    [{"weave_angle": radians(30)}, {"round": True}, {"impact_point": (3e-3, 0.0)}, {"impact_point": (0.0, 0.0)}],
)
def test_what_is_shown_ends_at_the_opening(small, given):
    """Nodes within it are shown where they are, and those that lie in the clamp on the edge."""
    panel = small(symmetry="whole", **given)
    held, at = ~boundary.loose(panel), np.array(boundary.shown(panel))
    assert np.array_equal(at[:, ~held], np.array(panel.coordinates())[:, ~held])
    c, s = np.cos(panel.weave_angle), np.sin(panel.weave_angle)
    x, y = np.stack([c * at[0] - s * at[1], s * at[0] + c * at[1]]) + np.array(panel.impact_point)[:, None, None]
    reach = np.hypot(x, y) if panel.round else np.maximum(np.abs(x), np.abs(y))
    assert reach.max() <= 0.5 * panel.opening[0] + 1e-12
