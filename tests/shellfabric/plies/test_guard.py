"""The guard: what it is by proof, on random facets; what it finds; and that no ply passes through a ply."""

from dataclasses import replace

import numpy as np
import pytest
from conftest_tools import advance, momenta
from numpy.testing import assert_allclose

from fabrics import catalogue
from fabrics.base.errors import UnstableError
from shellfabric.cell.model import CellModel
from shellfabric.jit.compile import entry
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.model import Panel
from shellfabric.membrane.numerics import Numerics
from shellfabric.plies import guard_kernels, near_kernels, separation_kernels
from shellfabric.plies.model import Pack, at_angle
from shellfabric.state import ERODED, WARP_FAILED, WEFT_FAILED
from validation.models.ply_crossings import plies_cross, surfaces


@entry()
def project(contact, rows, nodes):
    return guard_kernels.project_constraints(contact, rows, nodes)


@entry()
def separation(x, nodes):
    return separation_kernels.separation(x, nodes)


@entry()
def lower_bound(x, nodes):
    return separation_kernels.lower_bound(x, nodes)


@entry()
def near_pairs(x, first, second, near, found):
    """Of all pairs of facets the nodes of those that are nearer than `near`, into found; their number."""
    count = 0
    nodes = np.empty(6, np.int32)
    for a in first:
        for b in second:
            nodes[:3] = a
            nodes[3:] = b
            if (
                separation_kernels.lower_bound(x, nodes) <= near
                and separation_kernels.separation(x, nodes)[0] <= near
            ):
                found[count] = nodes
                count += 1
    return count


@pytest.fixture
def ply(ply):
    return replace(ply, symmetry="whole")


def solver(ply, plies, gap=0.0, velocity=1.0):
    """A PackSolver at rest whose steps are made one by one."""
    march = PackSolver(Pack.stacked(ply, plies, gap=gap), velocity, 1.0)
    march.exchange = np.inf
    march.advance(np.empty((0, 3)))
    return march


def facet(rng, bare):
    """Three nodes of a triangle, or of a bare yarn with the last one twice."""
    nodes = rng.normal(size=(3, 3))
    return nodes[[0, 1, 1]] if bare else nodes


@pytest.mark.parametrize("bare", [(False, False), (True, False), (True, True)])
def test_distance_and_direction_of_facets(bare):
    """No two points of the facets are nearer, two are as near, and a slab of that width is between them."""
    rng = np.random.default_rng(1)
    a, b = rng.uniform(size=(2, 40, 40)).reshape(2, -1)
    shares = np.array([1 - a, a * (1 - b), a * b]).T
    numbers = [[0, 1, 2] if not one else [0, 1, 1] for one in bare]
    nodes = np.array([*numbers[0], *(np.array(numbers[1]) + 3)], np.int32)
    for _ in range(30):
        x = np.concatenate(
            [facet(rng, bare[0]), facet(rng, bare[1]) + np.array([0.0, 0.0, rng.uniform(0, 4)])]
        )
        columns = np.ascontiguousarray(x.T)
        width, n = separation(columns, nodes)
        apart = np.linalg.norm(
            (shares @ x[:3])[:, None, :] - (shares @ x[3:])[None, ::7], axis=-1
        ).min()
        assert lower_bound(columns, nodes) <= max(width, 0.0) + 1e-12
        if width > 0:
            assert np.linalg.norm(n) == pytest.approx(1.0)
            assert width <= apart <= width + 0.3
            assert (x[3:] @ n).min() - (x[:3] @ n).max() == pytest.approx(width)
            swapped = np.ascontiguousarray(columns[:, [3, 4, 5, 0, 1, 2]])
            back, m = separation(
                swapped, nodes[[3, 4, 5, 0, 1, 2]] if bare[0] != bare[1] else nodes
            )
            if bare[0] == bare[1]:
                assert back == pytest.approx(width)
                assert_allclose(m, -np.array(n), atol=1e-6)


class Cloud:
    """Rows of the guard between random facets of random nodes, some of which many rows share."""

    def __init__(self, ply, seed, nodes=60, facets=40):
        pack = Pack.stacked(ply, 2)
        consts = pack.constants()
        rng = np.random.default_rng(seed)
        self.contact = pack.plies_contact(consts, pack.states(1.0)[0])
        self.guard = self.contact.guard
        self.nodes = nodes
        self.contact.x[:, :nodes] = rng.normal(size=(3, nodes))
        self.guard.dt_over_mass[:nodes] = 10 ** rng.uniform(-1, 1, nodes)
        self.contact.plane_bits[:] = 0
        self.guard.nodes[:nodes] = np.arange(nodes)
        rows = 0
        for _ in range(facets):
            own = rng.choice(nodes, 6, replace=False).astype(np.int32)
            width, n = separation(self.contact.x, own)
            if width > 0:
                self.guard.constraint_nodes[rows] = own
                self.guard.normal[rows] = n
                self.guard.required_gap[rows] = guard_kernels.gap_to_keep.py_func(width, 1.0)
                self.guard.gap[rows] = width
                rows += 1
        self.rows = rows
        moved = self.contact.x[:, :nodes] + rng.normal(size=(3, nodes))
        self.guard.predicted_x[:, :nodes] = moved

    def project(self):
        """Return what `project` returns, and the positions before it."""
        before = self.guard.predicted_x[:, : self.nodes].copy()
        self.guard.impulse[:, : self.nodes] = 0.0
        return project(self.contact, self.rows, self.nodes), before

    def left(self):
        """(rows,) [-] of what is needed, what is left."""
        guard = self.guard
        found = []
        for nodes, n, need in zip(
            guard.constraint_nodes[: self.rows], guard.normal, guard.required_gap
        ):
            along = [guard.predicted_x[:, k] @ n if k >= 0 else 0.0 for k in nodes]
            found.append((min(along[3:]) - max(along[:3])) / need)
        return np.array(found)

    def kinetic(self, y):
        """Energy of the ways from x to y."""
        loose = self.guard.dt_over_mass[: self.nodes] > 0
        ways = ((y - self.contact.x[:, : self.nodes]) ** 2).sum(axis=0)
        return (ways[loose] / self.guard.dt_over_mass[: self.nodes][loose]).sum()


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("kind", ["free", "held", "planes"])
def test_rows_hold_momentum_stays_and_energy_never_grows(ply, seed, kind):
    # the latter too many for impulses alone
    cloud = Cloud(ply, seed, *((60, 40) if seed % 3 else (30, 200)))
    contact = cloud.contact
    guard = cloud.guard
    nodes = cloud.nodes
    if kind == "held":
        guard.dt_over_mass[:nodes:9] = 0.0
        guard.predicted_x[:, :nodes:9] = contact.x[:, :nodes:9]
    if kind == "planes":
        contact.plane_bits[:nodes:7] = 1 + np.arange(len(range(0, nodes, 7))) % 3
        for axis in (0, 1):
            on = contact.plane_bits[:nodes] >> axis & 1 > 0
            contact.x[axis, :nodes][on] = guard.predicted_x[axis, :nodes][on] = 0.0
        wall = [k for k in range(nodes) if contact.x[0, k] > 0 and not contact.plane_bits[k]]
        cloud.rows = (
            0  # the facets have moved: rows of the plane alone, and of facets as they are now
        )
        for row, k in enumerate(wall):
            guard.constraint_nodes[row] = [guard_kernels.PLANE_X] * 3 + [k] * 3
            guard.normal[row] = (1.0, 0.0, 0.0)
            guard.required_gap[row], cloud.rows = (
                guard_kernels.gap_to_keep.py_func(contact.x[0, k], 1.0),
                row + 1,
            )
            guard.gap[row] = contact.x[0, k]
    (given, resolved), before = cloud.project()
    assert given > 0
    assert resolved
    assert cloud.left().min() > 1 - 3e-3
    assert cloud.kinetic(guard.predicted_x[:, :nodes]) <= cloud.kinetic(before) * (1 + 1e-12)
    ways = guard.dt_over_mass[:nodes] * guard.impulse[:, :nodes]
    assert_allclose(guard.predicted_x[:, :nodes] - before, ways, atol=1e-12 * abs(before).max())
    if kind == "free":
        assert (
            abs(guard.impulse[:, :nodes].sum(axis=1)).max()
            < 1e-12 * abs(guard.impulse[:, :nodes]).sum()
        )


def test_a_stack_that_is_struck_does_not_move_as_one(ply):
    """Impulses alone hold sixteen nodes apart of which the first is struck: each keeps a velocity of its own."""
    cloud = Cloud(ply, 0)
    count = 16
    apart = 0.1
    contact = cloud.contact
    guard = cloud.guard
    cloud.nodes = count
    cloud.rows = count - 1
    guard.dt_over_mass[:count] = 1.0
    contact.x[:, :count] = 0.0
    contact.x[2, :count] = apart * np.arange(count)
    for row in range(cloud.rows):
        guard.constraint_nodes[row] = [row] * 3 + [row + 1] * 3
        guard.normal[row] = (0.0, 0.0, 1.0)
        guard.required_gap[row] = guard_kernels.gap_to_keep.py_func(apart, 1.0)
        guard.gap[row] = apart
    guard.predicted_x[:, :count] = contact.x[:, :count]
    guard.predicted_x[2, 0] += 30 * apart
    (_, resolved), before = cloud.project()
    ways = guard.predicted_x[2, :count] - contact.x[2, :count]
    assert resolved
    assert cloud.left().min() > 1 - 3e-3
    assert cloud.kinetic(guard.predicted_x[:, :count]) < cloud.kinetic(before)
    assert np.unique(np.round(ways, 9)).size > 4


def test_no_motion_satisfies_every_row(ply):
    cloud = Cloud(ply, 5)
    cloud.guard.predicted_x[:, : cloud.nodes] = cloud.contact.x[:, : cloud.nodes]
    assert cloud.project()[0] == (0, True)


def crumpled(ply, plies, seed=7):
    """A free pack of crumpled plies that fly through each other, torn here and there."""
    march = solver(replace(ply, boundary="free"), plies)
    rng = np.random.default_rng(seed)
    const = march.const
    apart = march.pack.places[1]
    nodes = (const.ni + 1) * const.row_stride
    for p, state in enumerate(march.states):
        for c in range(3):
            state.u[c][:nodes] = 0.2 * apart * rng.normal(size=nodes)
            state.v[c][:nodes] = 0.05 * apart / const.dt * rng.normal(size=nodes)
        cut = rng.integers(0, nodes, 12)
        state.element_flag[cut] |= WARP_FAILED
        state.intact_fraction[0][cut] = 0.0
        state.block_damage[:] = 1
        state.failures = 12
        state.first_row = 0
        state.end_row = const.ni
        march.stack.awake[p] = True
    return march


def pairs(rows):
    """The pairs of facets of rows (n, 6), whatever the order of both and of their nodes."""
    return {frozenset((tuple(sorted(row[:3])), tuple(sorted(row[3:])))) for row in rows.tolist()}


def test_every_pair_that_is_near_has_a_row(ply):
    """Lists that are remade after a motion have, in each step, the pairs of a search of all by all."""
    march = crumpled(ply, 3)
    contact = march.contact
    guard = contact.guard
    seen = 0
    found = np.empty((100_000, 6), np.int32)
    for _ in range(40):
        places, facets, bare, owner = surfaces(march)
        whole = np.concatenate([facets, bare[:, [0, 1, 1]]])
        size = len(places) // 3
        width = march.const.row_stride
        own = np.arange(len(places)) % size
        numbers = contact.base[owner] + own // width * contact.row_stride[0] + own % width
        x = np.zeros_like(contact.x)
        x[:, numbers] = places.T
        whole = numbers[whole].astype(np.int32)
        near = near_kernels.NEAR * contact.thickness[0]
        expected = set()
        for p, q in ((0, 1), (0, 2), (1, 2)):
            one, other = (whole[whole[:, 0] // contact.slots_per_ply == r] for r in (p, q))
            count = near_pairs(x, one, other, near, found)
            expected |= pairs(found[:count])
        advance(march, 1)
        assert expected <= pairs(guard.constraint_nodes[: guard.n_constraints])
        seen += len(expected)
    assert seen > 1000
    assert guard.fault == 0


def bore(march, p):
    """Cut all yarns of a ply."""
    state = march.states[p]
    state.element_flag[:] = WARP_FAILED | WEFT_FAILED | ERODED
    for family in (0, 1):
        state.intact_fraction[family][:] = 0.0
    state.block_damage[:] = 1
    state.failures = march.stack.ply_failures[p] = 1


def test_free_plies_keep_their_momentum_and_lose_what_is_booked(ply):
    """A ply flies through one that is all hole onto the next."""
    march = solver(replace(ply, boundary="free"), 3)
    bore(march, 1)
    const = march.const
    inner = slice(4, march.const.ni - 3)
    nodes = (const.ni + 1) * const.row_stride
    march.states[0].v[2][:nodes].reshape(-1, const.row_stride)[inner, inner] = 20.0
    march.states[0].first_row = 0
    march.states[0].end_row = const.ni

    def momentum():
        return momenta(march).sum(axis=0) + march.projectile.mass * march.stack.projectile_velocity

    march.samples.clear()
    march.energy_at_start = None  # a ply has been set in motion
    march._sample()
    before = momentum()
    for _ in range(20):
        advance(march, 100)
        march._sample()
        assert not plies_cross(march)
    assert_allclose(momentum(), before, atol=1e-12 * before[2])
    taken = march.sample("ply_contact") + march.sample("ply_collisions")
    assert 0.1 < taken[-1] / march.sample("kinetic_fabric")[0] < 1
    assert abs(march.sample("error")).max() < 1e-3 * taken[-1]


def test_all_places_are_in_the_frame_of_the_first_ply(ply):
    """They were in the pack's, and displacements in the first ply's: plies passed through each other."""
    pack = Pack((at_angle(ply, -0.9), at_angle(ply, 0.4)), (0.0,))
    contact = pack.plies_contact(pack.constants(), pack.states(1.0)[0])
    axes = pack.plies[0].axes
    for p, panel in enumerate(pack.plies):
        nodes = panel.in_pack(np.stack(panel.coordinates(), axis=-1)) @ axes.T
        rows, columns = np.indices(nodes.shape[:2])
        rest = np.moveaxis(
            contact.rest[:, contact.base[p] + rows * contact.row_stride[p] + columns], 0, -1
        )
        assert_allclose(rest[..., :2], nodes, atol=1e-15)
        assert_allclose(rest[..., 2], pack.places[p])


def test_a_node_that_makes_more_than_a_thickness_in_a_step_does_not_pass(ply):
    """From beyond what counts as near, and before the spline has come to touch."""
    thickness = ply.weave.thickness
    march = solver(ply, 2, gap=thickness)
    k = 6 * march.const.row_stride + 5
    for _ in range(6):
        march.states[0].v[2][k] = 1.2 * thickness / march.const.dt
        advance(march, 1)
        assert not plies_cross(march)
    assert march.held_apart > 0


def test_facets_on_wrong_courses_stay_on_their_sides(ply):
    """An element that is driven at the next ply; at the next but one where that is a hole."""
    for hole in (False, True):
        march = solver(ply, 3)
        const = march.const
        states = march.states
        apart = march.pack.places[1]
        k = 6 * const.row_stride + 5
        corners = k + np.array([0, 1, const.row_stride, const.row_stride + 1])
        if hole:
            bore(march, 1)
        for _ in range(12):
            states[0].v[2][corners] = (0.2 if hole else 0.4) * apart / const.dt
            advance(march, 1)
            assert not plies_cross(march)
        before, middle, behind = (
            z + state.u[2][corners].mean() for z, state in zip(march.pack.places, states)
        )
        assert 2.0 * apart < before < behind
        assert (middle < before) == hole


def test_torn_fabric_does_not_pass_a_plane_of_symmetry(ply):
    march = solver(replace(ply, symmetry="quarter"), 2)
    const = march.const
    state = march.states[0]
    k = 3 * const.row_stride + 4
    for _ in range(60):
        state.v[0][k] = -0.1 * const.dx / const.dt
        advance(march, 1)
    assert 0.0 < const.x0 + 3 * const.dx + state.u[0][k] < 0.3 * ply.weave.thickness


def test_torn_plies_do_not_pass_through_each_other():
    """Two plies of S-726 crossed twice in this shot, and eight 17 times, before there was a guard."""
    fabric = catalogue.load("S-726").with_effective_density()
    ply = Panel(CellModel(fabric).table(101), (0.04, 0.04), numerics=Numerics(threads=1))
    seen = []
    march = PackSolver(Pack.stacked(ply, 2), 250.0, 60e-6).run(
        (lambda run: seen.append(plies_cross(run)),)
    )
    assert march.sample("cut_yarns")[-1] > 50
    assert march.held_apart > 0
    assert not any(seen)
    assert 0.0 < march.sample("ply_collisions")[-1] < 0.005 * march.strike_energy
    assert march.contact.guard.least_gap_ratio > 0.04


@pytest.mark.parametrize("fault", ["converged", "room", "cross"])
def test_a_run_whose_guard_fails_ends(ply, fault):
    march = PackSolver(Pack.stacked(ply, 2), 158.0, 20e-6)
    march.contact.guard.fault = ("converged", "room", "cross").index(fault) + 1
    with pytest.raises(UnstableError, match=f"the guard between plies.*{fault}"):
        march.run()


def test_a_crossing_is_seen(ply):
    """A ply that is laid through another crosses it; through a hole it does not."""
    march = solver(ply, 2)
    march.states[0].u[2][200:] += 2.0 * ply.weave.thickness
    assert plies_cross(march)
    bore(march, 1)
    assert not plies_cross(march)
