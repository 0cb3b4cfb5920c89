"""Packs: one ply is a single ply, momentum and energy, nothing goes through, stacking, gaps, resuming to the bit."""

import sys
from collections import namedtuple
from dataclasses import replace

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.errors import InputError, UnstableError
from fabrics.ply_law import PlyLaw
from shellfabric.cell.model import CellModel
from shellfabric.impact.simulation import ImpactSetup, run
from shellfabric.jit.borrowed_list import Items, borrowed_item
from shellfabric.jit.compile import entry, kernel
from shellfabric.output import checkpoint
from shellfabric.panel.model import Numerics, Panel
from shellfabric.plies import contact_simd_kernels
from shellfabric.plies.contact_simd_kernels import MAX_SQUEEZE
from shellfabric.plies.gap import compression_gap, ply_gap
from shellfabric.plies.model import Pack, PlyContact, turned
from shellfabric.solver.pack_solver import PackSolver
from shellfabric.solver.step_kernels import NOT_FINITE

GAP = 0.1e-3


@pytest.fixture(scope="module")
def ply():
    """S-726, whose warp and weft are far from alike, on 40 mm."""
    fabric = catalogue.load("S-726").with_effective_density()
    return Panel(CellModel(fabric).table(81), (0.04, 0.04), numerics=Numerics(threads=1))


def same(one, other):
    """Whether two states are the same to the last bit."""
    return all(np.array_equal(np.array(a), np.array(b)) for a, b in zip(one, other))


def test_far_behind_is_a_single_ply(ply, monkeypatch):
    far = Pack((ply, ply), (0.5,), PlyContact(courant=10.0))  # which leaves the step to the plies
    monkeypatch.setattr(Pack, "_firmer", lambda pack, ply: 0.0)  # the nose's stiffness of a pack is another
    alone = far._in_step(ply)
    single, pack = PackSolver(alone, 120.0, 40e-6).run(), PackSolver(far, 120.0, 40e-6).run()
    assert same(single.state, pack.states[0]._replace(**far._foreseen(0)))  # room that a firm nose would need
    assert not pack.stack.awake[1]
    assert not any(u.any() for u in pack.states[1].u)


def test_fast_shots_at_thin_plies_have_a_stiffer_law(ply):
    """The wave that a nose drives into a pack leaves plies nearer to each other by v sqrt(A / K): they came through
    each other within their first steps, where that was more than their thickness."""
    pack = Pack.stacked(ply, 4, gap=0.0, law=PlyLaw.solid(ply.fabric))
    thickness, step = ply.weave.thickness, pack.time_step
    assert step == pytest.approx(0.45 * (ply.weave.areal_density / pack.laws[0].stiffness) ** 0.5)
    assert step < ply.time_step
    assert pack.in_step_with(1000.0) is pack
    fast = pack.in_step_with(2000.0)
    assert fast.time_step < step
    depth = 1.5 * 2000.0 * fast.time_step / pack.contact.courant
    assert depth == pytest.approx(MAX_SQUEEZE * thickness - pack.laws[0].travel, rel=1e-9)
    soft = Pack.stacked(ply, 4, gap=0.0, law=PlyLaw.of_packs(ply.fabric))  # with a travel
    assert soft.in_step_with(2000.0).laws[0].stiffness > fast.laws[0].stiffness
    march = PackSolver(pack, 2000.0, 30 * fast.time_step, interval=fast.time_step)
    march._guard = march.guard_model  # cloth tears at once; this is of the depth
    march.run()
    assert march.const.dt == fast.time_step
    assert march.deepest.max() < 1.0


def collide(ply, damping, steps, speed=20.0, opening=(0.023, 0.023)):
    """Two free plies, the front one flying at the rear one, far ahead of the projectile; (march, momentum before)."""
    free = replace(ply, edge="free", symmetry="whole", opening=opening)
    pack = Pack.stacked(free, 2, stacking="alternating", gap=20e-6, contact=PlyContact(damping=damping))
    march = PackSolver(pack, 1e-3, 1.0)
    march.exchange = np.inf  # no checks between the steps
    march.stack.projectile_position[:, 2] -= 1.0
    march.stack.awake[:] = True
    for state, const in zip(march.states, march.consts):
        state.active_rows[:] = 0, const.ni
    front = march.states[0]
    front.v[2][:] = np.where(front.mass > 0, speed, 0.0)
    march.samples.clear()
    march.energy_at_start = None  # the plies have been set in motion
    march._sample()
    march.advance(np.empty((steps, 3)))
    march._sample()
    return march, front.mass.sum() * speed


def test_colliding_plies_keep_momentum_and_energy(ply):
    for damping in (0.7, 0.0):
        march, before = collide(ply, damping, 300)
        sums = np.array([[state.mass @ v for v in state.v] for state in march.states])
        np.testing.assert_allclose(sums.sum(axis=0), [0.0, 0.0, before], atol=1e-12 * before)
        assert sums[1, 2] > 0.4 * before
        energy = 0.5 * before * 20.0
        assert abs(march.sample("error")[-1]) < 1e-6 * energy
        taken = march.sample("ply_contact")[-1] / energy
        # all of the rear ply but its rim is met; of what meets, the dead contact keeps less than half
        assert taken > 0.35 if damping else taken < 0.01


@pytest.mark.parametrize("velocity", [158.0, 474.0])
def test_no_ply_goes_through_another(ply, velocity):
    """At the usual speed and at three times that: measured anew, from every element that is whole at the end."""
    wide = replace(ply, opening=(0.16, 0.16))  # waves do not come back in the time
    march = PackSolver(Pack.stacked(wide, 4, stacking="alternating", gap=GAP), velocity, 30e-6).run()
    assert march.deepest.max() < 1.0
    assert (march.ply_samples[-1][:, 0].sum() > 0) == (velocity > 200)
    assert np.abs(march.sample("error")).max() < 5e-3 * march.strike_energy
    assert min(clearance(march, p) for p in range(3)) > 0.0


def test_without_stiffness_they_are_stopped(ply):
    march = PackSolver(Pack((ply, ply), (GAP,)), 158.0, 20e-6)
    for pair in march.pairs:
        pair.law[:] *= 1e-9
    march.run()
    assert 0.85 < march.deepest[0] < 1.0
    assert clearance(march, 0) > 0.0


def test_a_run_ends_where_a_ply_has_come_through(ply):
    march = PackSolver(Pack((ply, ply), (GAP,)), 158.0, 20e-6)
    march.pairs[0].energy[[contact_simd_kernels.PASSED_COUNT, contact_simd_kernels.PASSED_STEP]] = 1.0
    with pytest.raises(UnstableError, match=r"ply 1 has come through ply 2.*ply 1, element \(\d+, \d+\).*step \d+"):
        march.run()


def clearance(march, p):
    """[m] least height of the rear ply's whole elements over the middles of the front ply's, along the flight."""
    tops = []
    for q in (p, p + 1):
        c, state = march.consts[q], march.states[q]
        u = [a[: (c.ni + 1) * c.row_stride].reshape(c.ni + 1, c.row_stride) for a in state.u]
        x = c.x0 + c.dx * np.arange(c.ni + 1)[:, None] + u[0]
        y = c.y0 + c.dy * np.arange(c.row_stride) + u[1]
        z = u[2] + march.pack.places[q]
        whole = (state.element_flag[: c.ni * c.row_stride].reshape(c.ni, c.row_stride)[:, :-1]) == 0
        tops.append((x, y, z, whole))
    (x, y, z, front), (X, Y, Z, rear) = tops
    middle = [0.25 * (a[1:, 1:] + a[:-1, 1:] + a[1:, :-1] + a[:-1, :-1])[front] for a in (x, y, z)]
    least = np.inf
    for i, j in zip(*np.nonzero(rear)):
        # two triangles of the element, straight over the points
        for corners in (((i, j), (i + 1, j), (i, j + 1)), ((i + 1, j + 1), (i, j + 1), (i + 1, j))):
            (ax, ay, az), (bx, by, bz), (cx, cy, cz) = ((X[k], Y[k], Z[k]) for k in corners)
            area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
            s = ((middle[0] - ax) * (cy - ay) - (middle[1] - ay) * (cx - ax)) / area
            t = ((middle[1] - ay) * (bx - ax) - (middle[0] - ax) * (by - ay)) / area
            inside = (s >= 0) & (t >= 0) & (s + t <= 1)
            if inside.any():
                height = az + s * (bz - az) + t * (cz - az) - middle[2]
                least = min(least, float(height[inside].min()))
    return least


def test_pressed_plies_keep_their_thickness_apart(ply):
    """Behind the nose, where plies have been pressed on each other for long, they are nearly a thickness apart."""
    march = PackSolver(Pack.stacked(replace(ply, opening=(0.16, 0.16)), 3, gap=GAP), 100.0, 40e-6).run()
    assert not march.ply_samples[-1][:, 0].any()
    between = np.diff(march.pack.places + march.ply_samples[-1][:, 4])
    assert np.all(between > 0.7 * ply.weave.thickness)
    assert np.all(between < 1.2 * ply.weave.thickness + GAP)


def test_a_turned_ply_is_the_panel_seen_from_its_other_side(ply):
    other = turned(ply)
    assert other.counts == ply.counts[::-1]
    assert other.weave.warp == ply.weave.weft
    one, two = PackSolver(ply, 120.0, 30e-6).run(), PackSolver(other, 120.0, 30e-6).run()
    fields = []
    for march in (one, two):
        c = march.const
        fields.append([u[: (c.ni + 1) * c.row_stride].reshape(c.ni + 1, c.row_stride) for u in march.state.u])
    size = np.abs(fields[0][2]).max()
    np.testing.assert_allclose(fields[1][2], fields[0][2].T, atol=1e-6 * size)
    np.testing.assert_allclose(fields[1][0], fields[0][1].T, atol=1e-6 * size)


LAWS = {
    "solid": None,
    "weave": PlyLaw([0.0, 20e-6, 35e-6, 45e-6], [0.0, 0.5e6, 4e6, 19e6], 1.4e13),
}


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("plies", [2, 4, 8])
def test_a_pack_between_platens_has_the_law(ply, plies, law):
    """Closed check, up to 50 MPa: the outer plies are moved towards each other and held, those between them are free.

    The pack is N - 1 closures nearer; each of them is that of the law at the pressure of the pack.
    """
    free = replace(ply, edge="free", symmetry="whole", opening=(0.012, 0.012))
    pack = Pack.stacked(free, plies, gap=0.0, law=LAWS[law])
    march = PackSolver(pack, 1e-3, 1.0)
    march.exchange = np.inf
    march.stack.projectile_position[:, 2] -= 1.0
    march.stack.awake[:] = True
    for state, const in zip(march.states, march.consts):
        state.active_rows[:] = 0, const.ni
    for p in (0, -1):
        march.states[p].dt_over_mass[:] = 0.0  # platens: no force moves them
    area, closed = march.const.ni * march.const.dx * march.const.nj * march.const.dy, 0.0
    for pressure in (1e6, 5e6, 19e6, 50e6):
        closure = float(pack.laws[0].closure_at(pressure))
        for p, state in enumerate(march.states):
            state.v[2][:] = (plies - 1 - p) * (closure - closed) / (100 * march.const.dt)
        march.advance(np.empty((100, 3)))
        for state in march.states:
            state.v[2][:] = 0.0
        closed = closure
        march.advance(np.empty((100, 3)))
        for pair in march.pairs[: plies - 1]:
            assert -sum(pair.f_front[2]) / area == pytest.approx(pressure, rel=0.02)


def test_stacking_chooses_the_plies(ply):
    aligned, alternating = (Pack.stacked(ply, 4, stacking=name, gap=GAP) for name in ("aligned", "alternating"))
    assert {one.counts for one in aligned.plies} == {ply.counts}
    assert [one.counts for one in alternating.plies] == [ply.counts, ply.counts[::-1]] * 2
    assert len({const.dt for const in alternating.constants()}) == 1
    nested = [PackSolver(pack, 100.0, 60e-6).run().sample("v")[-1] for pack in (aligned, alternating)]
    assert nested[0] != nested[1]


def test_gap_from_the_compression_of_packs():
    """Table 5-2, which the reading of Table 2-2 by erratum E-02 gives within 7 %."""
    for name, printed in (("S-726", 0.10e-3), ("S-728", 0.12e-3), ("S-731", 0.14e-3)):
        fabric = catalogue.load(name)
        assert compression_gap(fabric.areal_density_measured) == pytest.approx(printed, rel=0.07)
        assert ply_gap(fabric).value == pytest.approx(printed, rel=1e-12)
    untested = catalogue.load("S-720")
    assert ply_gap(untested).value == pytest.approx(0.134e-3, rel=0.01)


@pytest.mark.parametrize(("plies", "velocity", "at"), [(3, 260.0, 14e-6), (5, 280.0, 25e-6)])
def test_a_resumed_run_goes_on_bit_for_bit(ply, tmp_path, plies, velocity, at):
    """Also where torn cloth is held apart before and after, as in the second."""
    setup = ImpactSetup(
        ply.fabric, velocity, opening=0.04, end_time=2 * at + 2e-6, table_size=81, snapshot_interval=10e-6,
        numerics=Numerics(threads=1), plies=plies, stacking="alternating", ply_gap=GAP,
    )  # fmt: skip
    whole = run(setup)

    class Stop(Exception):
        pass

    def stop(march):
        if march.time > at:
            raise Stop

    path = tmp_path / "checkpoint.h5"
    with pytest.raises(Stop):
        run(setup, hooks=(checkpoint.Checkpoints(path, 2e-6), stop))
    again = run(setup, resume=path)
    assert whole.failed_segments[-1] > 0
    np.testing.assert_array_equal(whole.held_apart, again.held_apart)
    np.testing.assert_array_equal(whole.step_history, again.step_history)
    for name in whole.energies:
        np.testing.assert_array_equal(whole.energies[name], again.energies[name])
    for name in whole.plies:
        np.testing.assert_array_equal(whole.plies[name], again.plies[name])
    assert len(whole.snapshots) == len(again.snapshots)
    for one, two in zip(whole.last, again.last):
        np.testing.assert_array_equal(one.nodes, two.nodes)
    np.testing.assert_array_equal(whole.deepest, again.deepest)
    other = replace(setup, ply_gap=2 * GAP)
    with pytest.raises(InputError, match="another run"):
        run(other, resume=path)


def test_threads_change_nothing(ply):
    marches = []
    for threads in (1, 2):
        chosen = replace(ply, numerics=Numerics(threads=threads))
        marches.append(PackSolver(Pack.stacked(chosen, 3, gap=GAP), 200.0, 8e-6).run())
    assert [march.threads for march in marches] == [1, 2]
    for one, two in zip(*(march.states for march in marches)):
        assert same(one, two)


def test_an_unstable_pack_says_where(ply):
    march = PackSolver(Pack.stacked(ply, 2, gap=GAP), 100.0, 1e-4, interval=1e-7)
    march.states[1].v[2][5 * march.consts[1].row_stride + 5] = 1e4
    march.states[1].active_rows[:] = 0, march.consts[1].ni
    march.stack.awake[1] = True
    with pytest.raises(UnstableError, match="ply 2"):
        march.run()
    assert march.reason == NOT_FINITE


def test_bad_packs_are_reported(ply):
    with pytest.raises(InputError, match="plies"):
        Pack(())
    with pytest.raises(InputError, match="gaps"):
        Pack((ply, ply))
    with pytest.raises(InputError, match="gap"):
        Pack((ply, ply), (-1e-6,))
    with pytest.raises(InputError, match="symmetry"):
        Pack((ply, replace(ply, symmetry="whole")), (GAP,))
    with pytest.raises(InputError, match="stacking"):
        Pack.stacked(ply, 2, stacking="crossed")
    with pytest.raises(InputError, match="stacking"):
        Pack.stacked(replace(ply, symmetry="whole", weave_angle=0.5), 2, stacking="alternating", gap=GAP)
    for bad in ({"courant": 0.0}, {"stiffness": -1.0}, {"damping": -1.0}, {"points": 0}, {"form": "soft"}):
        with pytest.raises(InputError, match=next(iter(bad))):
            PlyContact(**bad)


Thing = namedtuple("Thing", "numbers factor")


@kernel(_nrt=False)
def weighed(things):
    found = 0.0
    for n in range(len(things)):
        thing = borrowed_item(things, n)
        found = 10.0 * found + thing.factor * thing.numbers[1]
        thing.numbers[0] += 1.0
    return found


@entry()
def weigh(things):
    return weighed(things)


def test_items_of_a_list_are_looked_at_where_they_lie():
    arrays = [np.array([0.0, 2.0 + n]) for n in range(3)]
    counts = [sys.getrefcount(array) for array in arrays]
    things = Items([Thing(array, 1.0) for array in arrays])
    held = [sys.getrefcount(array) for array in arrays]
    assert weigh(things) == 234.0
    assert weigh(things) == 234.0
    assert [array[0] for array in arrays] == [2.0, 2.0, 2.0]
    assert [sys.getrefcount(array) for array in arrays] == held
    with pytest.raises(TypeError, match="2 types"):
        Items([things.values[0], Thing(np.zeros(2, np.float32), 1.0)])
    del things
    assert [sys.getrefcount(array) for array in arrays] == counts
