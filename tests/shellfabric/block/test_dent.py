"""The dent behind a pack: how deep it has been, whether it rests, and the block that goes on alone."""

from dataclasses import replace
from types import SimpleNamespace

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from fabrics import backings
from shellfabric.block import coupling, dent
from shellfabric.block.block import Backing, Block
from shellfabric.impact.result import collect_result
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.loop import checkpoint, dent_checks
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane import quality
from shellfabric.membrane.numerics import Numerics
from shellfabric.projectile.projectile import Projectile

CLAY = backings.load("Roma Plastilina No. 1")
BLOCK = Backing(
    CLAY,
    size=(0.06, 0.06, 0.03),
    min_size=2.5e-3,
    refined_depth=7.5e-3,
    growth=1.5,
    after_stop=0.105e-3,
)
LEFT = {  # a free ply throws a light nose back, and leaves the clay
    "projectile": Projectile(mass=0.1e-3, radius=3e-3),
    "opening": 0.03,
    "boundary": "free",
    "table_size": 61,
    "end_time": 1e-3,
    "elements_per_crossover": 1,
    "backing": BLOCK,
}


def test_a_dent_rests_where_neither_motion_nor_change_is_left():
    """It springs back as a cosine: at its deepest it is without motion, and does not rest."""
    time = np.linspace(0, 4e-3, 401)
    depth = 0.03 + 0.004 * np.cos(np.pi * np.clip(time / 1e-3 - 1, 0, 1))
    depth[time < 1e-3] *= time[time < 1e-3] / 1e-3
    window = 0.405e-3  # between samples, which are 10 us apart
    for end, at_rest, change in (
        (1.0e-3, False, 0.4),
        (1.5e-3, False, 0.004 * (np.cos(0.1 * np.pi) - np.cos(0.5 * np.pi)) / 0.034),
        (1.9e-3, False, 0.004 * (np.cos(0.5 * np.pi) - np.cos(0.9 * np.pi)) / 0.034),
        (3.0e-3, True, 0.0),
    ):
        known = time <= end + 1e-9
        found = dent.change(time[known], depth[known], window)
        assert found == pytest.approx(change, abs=1e-9)
        assert dent.at_rest(0.009, time[known], depth[known], window) is at_rest
    assert not dent.at_rest(0.011, time, depth, window)
    # nobody has looked for that long
    assert not dent.at_rest(0.009, time[-20:], depth[-20:], window)
    assert np.isnan(dent.change(time[-20:], depth[-20:], window))


def test_the_block_goes_on_alone_behind_a_pack_that_has_left(fabric, tmp_path, monkeypatch):
    """The dent is that of the run with the pack to the end, no energy is lost between the two, pack and projectile
    stay as they are; a run resumed before and after the hand-over is the same to the bit, with any threads."""
    setup = ImpactSetup(fabric, 60.0, **LEFT)
    kept = {}

    def keep(solver):
        for name, due in (
            ("before", solver.time > 15e-6),
            ("after", solver.fabric_ended and solver.time > solver.alone_from + 30e-6),
        ):
            if due and name not in kept:
                kept[name] = tmp_path / f"{name}.h5"
                checkpoint.write(solver, kept[name])

    alone = run_impact(setup, hooks=(keep,))
    block = alone.backing
    assert alone.outcome == "stopped"
    assert 20e-6 < block.alone_from < 0.6 * alone.time[-1]
    assert alone.time[-1] > alone.time[np.argmax(alone.velocity <= 0)] + BLOCK.after_stop
    ended = alone.time >= block.alone_from
    assert np.count_nonzero(ended) > 3
    for name in ("kinetic_fabric", "yarn_strain", "contact", "kinetic_projectile"):
        of_end = alone.energies[name][ended]
        assert abs(of_end).min() > 0
        assert_array_equal(of_end, of_end[0])
    # the step history ends with the pack
    assert alone.step_history[-1, 0] == pytest.approx(block.alone_from)
    assert alone.energies["backing_contact"][-1] == 0.0
    # what the block holds and loses stays the same, through the hand-over and in its longer steps
    of_block = sum(values for name, values in alone.energies.items() if "backing_" in name)
    assert of_block[ended][0] > 0.4 * alone.strike_energy
    lost = abs(of_block[ended] - of_block[ended][0]).max()
    assert lost < 1e-3 * alone.energies["backing_kinetic"][ended][0]

    for path in kept.values():
        solver = PackSolver(setup.target(), 60.0, setup.end_time)
        checkpoint.read(solver, path)
        resumed = collect_result(setup, solver.run())
        assert_array_equal(resumed.backing.nodes, block.nodes)
        assert_array_equal(resumed.backing.dent, block.dent)
        assert_array_equal(resumed.time, alone.time)
    numba.set_num_threads(2)
    shared = run_impact(replace(setup, numerics=Numerics(threads=2)))
    numba.set_num_threads(1)
    assert_array_equal(shared.backing.nodes, block.nodes)
    for name, energy in alone.energies.items():
        assert_array_equal(shared.energies[name], energy, err_msg=name)

    # what it does lose is an error of its steps
    usual = Block.alone_step.fget
    with monkeypatch.context() as patch:
        patch.setattr(Block, "alone_step", property(lambda block: 0.25 * usual(block)))
        finer = run_impact(setup)
    assert finer.backing.alone_from == block.alone_from
    of_block = sum(values for name, values in finer.energies.items() if "backing_" in name)
    ended = finer.time >= block.alone_from
    assert abs(of_block[ended] - of_block[ended][0]).max() < 0.5 * lost

    monkeypatch.setattr(coupling, "APART", 10**9)
    together = run_impact(replace(setup, end_time=0.108e-3))
    assert np.isnan(together.backing.alone_from)
    assert together.steps > 2 * alone.steps
    # 60 us after the hand-over, in which the dent has grown by 80 %
    both = together.backing
    at = block.alone_from + 60e-6
    assert both.time[-1] > at < block.time[-1]
    depths = [np.interp(at, one.time, one.dent) for one in (block, both)]
    # the gauge reaches to the rim, which the pack still touches: 0.8 %, where the deepest node differs by 0.5 %
    assert depths[0] == pytest.approx(depths[1], rel=1e-2)
    assert depths[0] > 1.7 * np.interp(block.alone_from, block.time, block.dent)


def leaves_at(gaps, touched, depth):
    """The sample at which a pack has left a dent, from all samples so far; None if it has not."""
    # at rest the distance is 0, and the first sample is beyond
    before = [0.0, *gaps]
    for end in range(coupling.APART - 1, len(gaps)):
        last = range(end - coupling.APART + 1, end + 1)
        grown = all(gaps[k] > before[k] and not touched[k] for k in last)
        if grown and gaps[end] > coupling.FAR * depth:
            return end
    return None


@settings(max_examples=100, deadline=None)
@given(
    steps=st.lists(
        st.sampled_from([1e-4] * 9 + [0.0, -1e-4, -5e-4]),
        min_size=coupling.APART,
        max_size=5 * coupling.APART,
    ),
    touches=st.sets(st.integers(1, 5 * coupling.APART), max_size=2),
    depth=st.sampled_from([1e-3, 30e-3]),
    free=st.booleans(),
)
def test_a_pack_has_left_once_it_moves_away_at_as_many_samples_in_a_row(
    steps, touches, depth, free
):
    """A sample at which it comes nearer, or touches, begins the count anew. Of a free pack the floor
    counts, of one that is held the rim too."""
    gaps = np.cumsum([2e-3, *steps])
    touched = [k in touches for k in range(len(gaps))]
    points = SimpleNamespace(inside=np.zeros(4), force=np.zeros((4, 3)), x=np.zeros((4, 3)))
    block = SimpleNamespace(
        points=points,
        depth_map=lambda: np.full((1, 1, 3), depth),
        row=SimpleNamespace(nose_force=np.zeros(3)),
        backing=SimpleNamespace(standoff=0.0),
    )
    part = SimpleNamespace(
        block=block,
        hand_over=coupling.HandOver(**coupling.HandOver.totals()),
        thickness=1e-4,
        _free=free,
        _on_floor=lambda: np.array([True, False, False, False]),
    )
    found = None
    for number, gap in enumerate(gaps):
        points.inside[:] = -gap, 1e-3, 1e-3, 1e-3
        points.force[0, 2] = -5.0 * touched[number]
        # on the rim a free pack always presses, a held one in its turn alone
        points.force[1, 2] = -7.0 * (free or touched[number])
        points.force[3, 2] = -7.0 * free
        if found is None and coupling.BackingCoupling.has_left(part, None):
            found = number
    assert found == leaves_at(gaps, touched, depth)


def test_a_pack_that_is_held_keeps_down_the_rim(fabric):
    """Its floor is as bare as that of a free one, but the block does not go on alone."""
    held = run_impact(
        ImpactSetup(fabric, 60.0, **LEFT | {"boundary": "clamped", "end_time": 75e-6})
    )
    assert held.time[-1] > 70e-6
    assert np.isnan(held.backing.alone_from)
    assert held.backing.back_face_signature is None  # 70 us are no rest
    assert held.backing.deepest_dent >= held.backing.gauge_depth > 1e-3
    assert held.backing.dent.size == held.time.size


@pytest.mark.parametrize("nose, disc", [(3e-3, dent.GAUGE), (7e-3, 7e-3)])
def test_the_gauge_is_as_wide_as_the_nose(fabric, nose, disc):
    """A flat nose that still moves: the depth at its last sample, at the end and in the check are read off its own
    disc; one of the other width reads differently."""
    given = LEFT | {"projectile": Projectile(mass=0.4e-3, radius=nose), "end_time": 30e-6}
    solver = PackSolver(ImpactSetup(fabric, 70.0, **given).target(), 70.0, 30e-6)
    solver.run()
    face = solver.part("block").block.depth_map()
    depth = dent.gauge(face, (True, True), disc)
    assert depth > 0.5e-3
    assert dent.gauge(face, (True, True), 12e-3 - disc) != pytest.approx(depth, rel=0.05)
    found = collect_result(ImpactSetup(fabric, 70.0, **given), solver).backing
    assert found.gauge_depth == depth
    assert found.dent[-1] == pytest.approx(depth, rel=0.02)  # the block is one step ahead
    checks = {one.name: one.value for one in dent_checks.indicators(solver)}
    assert checks["deepest node of the dent"] == dent.deepest(face) / depth


def test_motion_far_from_a_dent_does_not_change_it():
    """Each node of a block at 1 m/s, in a tenth of its energy: what is about a dent of 5 mm counts, and no more."""
    block = replace(BLOCK, size=(0.08, 0.08, 0.04)).block(1e-7)
    assert dent.motion_about(block, 5e-3) == 0.0
    block.v[:, 2] = 1.0
    block.row.plastic_work[0] = 0.5
    block.row.kinetic_energy[0] = 0.5 * block.mass.sum()
    taken = 0.5 + 0.5 * block.mass.sum()
    x, y, z = block.rest.T
    near = (x**2 + y**2 <= 0.01**2) & (z <= 0.01)
    assert 8 < np.count_nonzero(near) < 0.1 * len(near)
    found = dent.motion_about(block, 5e-3)
    assert found == pytest.approx(0.5 * block.mass[near].sum() / taken, rel=1e-9)
    assert found < 0.02 < dent.motion_about(block, 40e-3)


def block_with(shape, backing=BLOCK, **changes):
    """A block whose nodes stand deeper by shape(x, y) [m] times what is left of the depth below them."""
    block = replace(backing, **changes).block(1e-7)
    x, y, z = block.rest.T
    block.x[:, 2] += shape(x, y) * (1 - z / block.backing.size[2])
    return block


def bowl(x, y):
    """A dent of 10 mm, half as deep at 12 mm."""
    return 0.01 * 0.5 ** ((x**2 + y**2) / 0.012**2)


@pytest.mark.parametrize("radius", [dent.GAUGE, 7e-3])
@pytest.mark.parametrize("mirrors", [(True, True), (False, False), (True, False)])
def test_a_gauge_finds_the_mean_over_its_disc(mirrors, radius):
    """The mean of a paraboloid over a disc, on bricks of 2.5 and 1.25 mm; a node that goes down
    alone is no dent; nor is a face that has risen."""
    wide = 0.015

    def paraboloid(x, y):
        return 0.01 * (1 - (x**2 + 2 * y**2) / wide**2)

    for size in (2.5e-3, 1.25e-3):
        block = block_with(paraboloid, mirrors=mirrors, min_size=size)
        found = dent.gauge(block.depth_map(), mirrors, radius)
        # a chord of x^2 between nodes is h^2 / 6 above it in the mean
        of_disc = (0.25 + 0.5) * radius**2 + (1 + 2) * size**2 / 6
        assert found == pytest.approx(0.01 * (1 - of_disc / wide**2), rel=2e-3)
    alone = block_with(lambda x, y: bowl(x, y) + 0.03 * (np.hypot(x, y) < 1e-6), mirrors=mirrors)
    for block, ok in ((block_with(bowl, mirrors=mirrors), True), (alone, False)):
        face = block.depth_map()
        ratio = face[..., 2].max() / dent.gauge(face, mirrors, radius)
        assert quality.indicator("deepest node of the dent", ratio).ok is ok
    assert dent.gauge(block_with(lambda x, y: 0 * x - 1e-3).depth_map(), mirrors) == 0.0


@pytest.mark.parametrize("mirrors", [(True, True), (False, False)])
def test_a_gauge_stands_where_it_reads_most_whichever_node_is_deepest(mirrors):
    """A node 4.5 mm beside the axis of a paraboloid is made the deepest: the disc stays on the
    axis, and reads what the node adds to it in the mean, with its images."""
    wide, size, extra = 0.015, 1.25e-3, 2e-3

    def dented(x, y):
        spike = np.hypot(x - 3.75e-3, y - 2.5e-3) < 1e-6
        return 0.01 * (1 - (x**2 + 2 * y**2) / wide**2) + extra * spike

    face = block_with(dented, mirrors=mirrors, min_size=size).depth_map()
    deepest_node = np.unravel_index(np.argmax(face[..., 2]), face.shape[:2])
    assert np.hypot(*face[deepest_node][:2]) == pytest.approx(4.507e-3, rel=1e-3)
    of_disc = (0.25 + 0.5) * dent.GAUGE**2 + (1 + 2) * size**2 / 6
    images = 2 ** sum(mirrors)
    # the pyramid of one node has h^2 times its height; the disc cuts a part of it off
    added = images * extra * size**2 / (np.pi * dent.GAUGE**2)
    on_axis = 0.01 * (1 - of_disc / wide**2)
    found = dent.gauge(face, mirrors)
    assert on_axis + 0.5 * added < found < on_axis + 1.1 * added


def test_a_gauge_sees_beyond_a_plane_of_symmetry():
    """A trough beside a plane of symmetry, of the half and of the whole."""

    def trough(x, y):
        return 0.01 * np.exp(-((np.abs(x) - 2.5e-3) ** 2) / 8e-3**2 - (y - 5e-3) ** 2 / 9e-3**2)

    half = block_with(trough, mirrors=(True, False)).depth_map()
    whole = block_with(trough, mirrors=(False, False)).depth_map()
    found = dent.gauge(half, (True, False))
    assert found == pytest.approx(dent.gauge(whole, (False, False)), rel=1e-9)
    # about its deepest node the disc reaches across the plane, where the trough has its image
    images = np.array([(1, 1), (-1, 1)])
    mean = [
        dent._disc_mean(half, np.array([2.5e-3, 5e-3]), seen, dent.GAUGE)
        for seen in (images[:1], images)
    ]
    assert mean[1] > mean[0]


def test_a_gauge_weighs_facets_by_their_area():
    """Bricks half as wide on one side, where the face falls off a third as steeply: the mean of |x| over half
    of a disc is 4 R / (3 pi)."""
    narrow, wide = (size * np.arange(1, 17) for size in (0.4e-3, 0.8e-3))
    lines = np.concatenate([-narrow[::-1], [0.0], wide]), 0.7e-3 * np.arange(-10, 11)
    x, y = np.meshgrid(*lines, indexing="ij")
    face = np.stack([x, y, 0.01 - np.where(x < 0, -0.2 * x, 0.6 * x)], axis=-1)
    expected = 0.01 - 0.5 * (0.2 + 0.6) * 4 * dent.GAUGE / (3 * np.pi)
    found = dent._disc_mean(face, np.zeros(2), np.ones((1, 2)), dent.GAUGE)
    assert found == pytest.approx(expected, rel=1e-3)
    # on the gentler side it reads more
    assert dent.gauge(face, (False, False)) > found


def test_the_brick_on_the_floor_is_measured_as_it_is():
    """Bricks on the floor drawn out to twice their length: noted beyond half of the radius, doubtful beyond all."""
    block = block_with(bowl)
    face = block.depth_map()
    face[..., :2] *= 2.0
    for radius, status in ((12e-3, "ok"), (8e-3, "noted"), (4e-3, "doubtful")):
        found = dent.floor_brick(face, radius)
        assert found == pytest.approx(5e-3 / radius)
        assert quality.indicator("brick on the dent's floor", found).status == status


def test_a_corner_inside_out_folds_its_brick():
    """A node of the face driven down an edge of 2.5 mm: noted below a tenth of the mean height, doubtful past it."""
    for left, status in ((1.25e-3, "ok"), (0.1e-3, "noted"), (-0.4e-3, "doubtful")):
        block = block_with(lambda x, y: 0 * x)
        assert dent.folding(block) == pytest.approx(0.0, abs=1e-12)
        block.x[block.nodes[0, 0, 0], 2] = block.x[block.nodes[0, 0, 1], 2] - left
        found = dent.folding(block)
        mean = 0.75 * 2.5e-3 + 0.25 * left
        assert found == pytest.approx(1 - left / mean, abs=1e-9)
        assert quality.indicator("folded bricks", found).status == status


def test_bricks_that_are_turned_and_flattened_are_not_folded():
    block = block_with(lambda x, y: 0 * x)
    turned = np.array([[0, -1.0, 0], [1, 0, 0], [0, 0, 1]]) @ np.diag([2.0, 1.7, 0.1])
    block.x[:] = block.rest @ turned.T
    assert dent.folding(block) == pytest.approx(0.0, abs=1e-9)


def test_a_node_across_a_plane_of_symmetry_and_motion_beside_held_faces_are_found():
    block = block_with(lambda x, y: 0 * x)
    assert dent.crossing(block) == dent.held_motion(block) == 0.0
    block.x[block.nodes[1, 3, 0], 0] = -4.5e-3
    block.x[block.nodes[2, 1, 1], 1] = -1.5e-3
    assert dent.crossing(block) == pytest.approx(4.5e-3)
    block.backing = replace(block.backing, mirrors=(False, True))
    assert dent.crossing(block) == pytest.approx(1.5e-3)
    assert dent.held_motion(block) == pytest.approx(7e-3)  # its first sheet is held as well
    block = BLOCK.block(1e-7)
    # a brick from the far face, from its bottom, and in the middle
    for place, counts in (((-2, 3, 0), 2e-3), ((3, 3, -2), 5e-3), ((3, 3, 3), 5e-3)):
        block.x[block.nodes[place]] += np.array([0.0, counts * 0.6, counts * 0.8])
        assert dent.held_motion(block) == pytest.approx(counts)
    block.backing = replace(block.backing, outer_boundary="absorbing")
    assert dent.held_motion(block) == 0.0


def test_a_held_pack_over_most_of_the_face_is_doubtful(fabric):
    """Held on all sides over 0.69 of the face; a smaller one, a round one and one with a free side are not."""
    for opening, changes, share in (
        (0.05, {}, 0.694),
        (0.03, {}, 0.25),
        (0.05, {"round": True}, 0.545),
        (0.05, {"boundary": ("free", "clamped")}, 0.0),
    ):
        setup = ImpactSetup(
            fabric, 60.0, **LEFT | {"boundary": "clamped", "opening": opening} | changes
        )
        found = dent.covered(setup.target().plies[-1])
        assert found == pytest.approx(share, rel=0.1, abs=1e-12)
        assert quality.indicator("face under held fabric", found).ok is (share < 0.5)


def solver_with(time, depth, block, **changes):
    """What `dent_checks.indicators` looks at of a solver that has stopped, and followed its block after that."""
    columns = {"t": time, "dent": depth, "held_motion": 0.002 * depth, "crossing": 0 * time}
    columns |= dict.fromkeys(coupling.NAMES, 0 * time)
    columns |= {"backing_plastic": 60 + 0 * time, "backing_hourglass": 3 * depth / depth.max()}
    left = SimpleNamespace(deepest_ply=5e-3)
    part = SimpleNamespace(block=block, hand_over=left, gauge_radius=dent.GAUGE)
    panel = SimpleNamespace(
        supports=(("free", "free"),) * 2, opening=(0.03, 0.03), round=False, backing=block.backing
    )
    made = {
        "part": lambda name: part,
        "sample": (columns | changes.pop("columns", {})).get,
        "plies": ((panel, None, None),),
        "alone_from": np.nan,
        "fabric_ended": False,
        "stack": SimpleNamespace(after_stop=1e-3, stop_step=5),
        "strike_energy": 300.0,
    }
    return SimpleNamespace(**made | changes)


def test_each_check_speaks_where_it_should_and_is_silent_where_all_is_well():
    """A dent of 10 mm with a radius of 12 mm, which a shear wave crosses in 0.36 ms."""
    block = block_with(bowl)
    time = np.linspace(0.0, 2e-3, 201)
    rests = 0.01 * np.minimum(time / 0.5e-3, 1.0)

    def told(depth=rests, **changes):
        found = dent_checks.indicators(solver_with(time, depth, block, **changes))
        return {one.name: one.status for one in found if one.status != "ok"}

    assert told() == {}
    assert "deepest node of the dent" in {
        one.name for one in dent_checks.indicators(solver_with(time, rests, block))
    }
    still = 0.01 * time / 2e-3
    assert told(still) == {"change of the dent": "doubtful"}
    slow = rests - 0.0003 * np.clip((time - 1.5e-3) / 0.5e-3, 0, 1)
    assert told(slow) == {"change of the dent": "noted"}
    closing = 0.04 * np.minimum(time / 0.5e-3, 1.0) - 0.03 * np.clip((time - 0.5e-3) / 0.5e-3, 0, 1)
    assert told(closing) == {"springback of the dent": "doubtful"}
    elastic = 0.0128 * np.minimum(time / 0.5e-3, 1) - 0.0028 * np.clip(time / 0.5e-3 - 1, 0, 1)
    assert told(elastic) == {"springback of the dent": "noted"}
    assert told(columns={"held_motion": 0.05 * rests}) == {"motion at held faces": "noted"}
    assert told(columns={"held_motion": 0.08 * rests}) == {"motion at held faces": "doubtful"}
    assert told(columns={"crossing": 1e-3 * (time > 1e-3)}) == {"face across symmetry": "doubtful"}
    for largest, status in ((5.0, "noted"), (8.0, "doubtful")):
        pushed = {"backing_hourglass": np.where(time > 1e-3, 3.0, largest)}
        assert told(columns=pushed) == {"hourglass energy of the block": status}
    # alone behind a pack 5 mm deep: below it, and back at it
    assert told(fabric_ended=True, alone_from=0.6e-3) == {}
    back = rests - 0.006 * np.clip(time / 0.5e-3 - 1, 0, 1)
    found = told(back, fabric_ended=True, alone_from=0.6e-3)
    assert found["dent back at the pack"] == "doubtful"
    # a run that ends as the projectile turns has no dent at rest, and none is asked for
    at_once = SimpleNamespace(after_stop=0.0, stop_step=0)
    assert told(still, stack=at_once) == {}
    assert dent_checks.indicators(SimpleNamespace(part=lambda name: None)) == ()
