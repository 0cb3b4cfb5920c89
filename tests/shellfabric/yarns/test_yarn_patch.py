"""Crossings and neighbours of a patch of yarns: gradients, invariants, and the unit cell."""

import numpy as np
import pytest
from yarn_patches import energy, free_zone, march, patch

from shellfabric.cell.model import CellModel
from shellfabric.jit.compile import entry
from shellfabric.yarns import crossing_kernels, neighbour_kernels, zone_kernels


def thrown(made, speed, seed=3):
    """A free patch whose nodes have random velocities, smooth over a few nodes, without momentum."""
    zone = free_zone(made)
    rng = np.random.default_rng(seed)
    wave = rng.normal(0, 2 * np.pi / 6e-3, (4, 2))
    phase = rng.uniform(0, 2 * np.pi, 4)
    size = rng.normal(0, speed, (4, 3))
    for k in range(4):
        zone.v[:] += np.cos(wave[k] @ zone.x[:2] + phase[k]) * size[k][:, None]
    zone.v[:] -= (zone.v @ zone.mass / zone.mass.sum())[:, None]
    return zone


def by_yarn(zone, values, family):
    """(yarns, nodes) of a family, of values of all nodes."""
    shape = (zone.yarns[family], zone.nodes[family])
    return values[zone.first[family] :][: np.prod(shape)].reshape(shape)


def pressed(made):
    """A patch drawn taut, some of its yarns pushed together, at rest: all forces act."""
    zone = free_zone(made)
    rng = np.random.default_rng(1)
    zone.x[:2] *= 1.02
    zone.x[1, zone.first[0] : zone.first[1]] *= 0.7
    zone.x[:] += rng.uniform(-3e-6, 3e-6, zone.x.shape)
    for _ in range(60):  # indices come to their places
        zone.f[:] = 0.0
        zone_kernels.inner_forces(zone)
    return zone


def test_forces_are_the_gradient_of_the_energy():
    """Whatever the feet do as nodes are moved: springs on points that run along a yarn would not pass."""
    zone = pressed(patch((5, 5), friction=0.0, failure=False))
    forces = zone.f.copy()
    assert min(zone.stored, zone.stored_at_crossings, zone.stored_at_neighbours) > 0
    rng = np.random.default_rng(2)
    worst = 0.0
    step = 2e-9
    for n in rng.choice(zone.mass.size, 12, replace=False):
        for c in range(3):
            found = []
            for way in (step, -step):
                zone.x[c, n] += way
                for _ in range(3):
                    zone_kernels.inner_forces(zone)
                found.append(
                    float(zone.stored + zone.stored_at_crossings + zone.stored_at_neighbours)
                )
                zone.x[c, n] -= way
            slope = -(found[0] - found[1]) / (2 * step)
            worst = max(worst, abs(slope - forces[c, n]))
    assert worst < 2e-4 * abs(forces).max()


@entry()
def drop_crossing(zone, i, j, whole):
    """Drop the contact of a crossing."""
    crossing_kernels.drop(zone, i, j, whole)


@pytest.mark.parametrize("whole", [True, False])
def test_a_dropped_crossing_gives_back_nothing_of_what_it_stored(whole):
    """The spring of friction has slipped along all three axes; the crossing counts a part of itself."""
    zone = free_zone(patch((3, 4)))
    zone.slider[:, 1, 2] = np.array([1.0, -2.0, 3.0]) * 1e-6
    zone.contact_energy[1, 2] = 4e-6
    zone.crossing_share[1, 2] = 0.25
    drop_crossing(zone, 1, 2, whole)
    stored = 0.25 * (4e-6 + 0.5 * zone.friction_stiffness * 14e-12)
    lost = {True: (stored, 0.0), False: (0.0, stored)}[whole]
    assert (zone.lost_when_slack, zone.lost_with_yarns) == pytest.approx(lost, rel=1e-12)
    assert not zone.slider[:, 1, 2].any()
    assert zone.contact_energy[1, 2] == 0.0


# what a call of `inner_forces` moves of a crossing and of a neighbour
OF_CROSSINGS = (
    "place",
    "slider",
    "contact_force",
    "contact_energy",
    "contact_onset",
    "contact_damping",
)
MOVED = (
    *OF_CROSSINGS,
    "foot",
    "foot_energy",
    "foot_onset",
    "foot_wait",
)


@entry()
def eight_at_once(zone, i):
    """The forces of the first eight crossings of a warp yarn: bits of those that are left."""
    return crossing_kernels.crossing_forces8(zone, i, 0, 255)[0]


@entry()
def one_by_one(zone, i, bits):
    """The forces of those of the first eight crossings of a warp yarn whose bits are set."""
    for j in range(8):
        if bits >> j & 1:
            crossing_kernels.crossing_force(zone, i, j)


def test_eight_crossings_at_once_are_those_one_by_one():
    """But for those of a yarn that is cut, and of a yarn that is slack, which are left."""
    eight, single = (pressed(patch((9, 5))) for _ in range(2))
    rng = np.random.default_rng(4)
    speeds = rng.normal(0, 3.0, eight.v.shape)
    for zone in (eight, single):
        zone.v[:] = speeds
        cut = zone.first[1] + 2 * zone.nodes[1] + 4
        zone.whole[cut] = False
        zone.torn[1, 2] = True
        zone.x[1, zone.first[1] + 5 * zone.nodes[1] :][: zone.nodes[1]] *= 0.5
        zone.f[:] = 0.0
    for i in range(5):
        left = eight_at_once(eight, i)
        assert left == 0b100100
        one_by_one(single, i, 255 & ~left)
    assert abs(eight.f).max() > 0
    assert eight.friction_work > 0
    for name in ("f", "friction_work", "damped", *OF_CROSSINGS):
        expected = getattr(single, name)
        scale = np.abs(expected).max()
        np.testing.assert_allclose(getattr(eight, name), expected, rtol=0, atol=1e-11 * scale)


def highest_frequency(zone, step=1e-9):
    """[1/s] of a patch, from differences of its forces: 2 over it is the longest stable step."""
    size = zone.x.size
    stiffness = np.zeros((size, size))
    kept = {name: getattr(zone, name).copy() for name in MOVED}
    for column in range(size):
        n, c = divmod(column, 3)
        for way in (step, -step):
            zone.x[c, n] += way
            zone.f[:] = 0.0
            zone_kernels.inner_forces(zone)
            stiffness[:, column] -= zone.f.T.ravel() / (2 * way)
            zone.x[c, n] -= way
            for name, values in kept.items():
                getattr(zone, name)[:] = values
    mass = np.repeat(zone.mass, 3)
    return np.sqrt(np.abs(np.linalg.eigvals(stiffness / mass[:, None])).max())


def test_the_bound_of_the_time_step_holds_the_stiffest_mode():
    """Of a patch that is taut and pressed, without its viscosity; no step is given away either."""
    made = patch((4, 4), friction=1e9, failure=False, viscosity=0.0)
    bound = 2 / made.critical_step
    assert 0.85 * bound < highest_frequency(pressed(made)) < 1.05 * bound


def test_a_patch_at_rest_has_no_forces():
    zone = free_zone(patch())
    zone_kernels.inner_forces(zone)
    assert abs(zone.f).max() < 1e-12
    assert energy(zone) < 1e-24


def test_a_free_patch_keeps_momentum_and_its_yarns_keep_their_order():
    zone = thrown(patch((8, 8), friction=0.1), 8.0)
    scale = (zone.mass * abs(zone.v)).sum()
    worst = [np.inf]

    def watch(zone):
        for family in range(2):
            lines = by_yarn(zone, zone.x[1 - family], family)
            worst[0] = min(worst[0], np.diff(lines, axis=0).min())

    start = energy(zone)
    friction = [0.0]
    for _ in range(5):
        march(zone, 260, watch)
        friction.append(float(zone.friction_work))
    assert abs(zone.v @ zone.mass).max() < 1e-12 * scale
    assert worst[0] > 0.0
    assert zone.tangled == 0
    assert (np.diff(friction) >= 0).all()
    assert friction[-1] > 0.01 * start
    assert energy(zone) == pytest.approx(start, rel=5e-3)


def test_a_patch_that_falls_apart_keeps_its_energy():
    """Slack yarns whose ends leave their crossings: held at the ends crossings made 3 % of the energy, at any step."""
    made = patch((5, 6))
    zone = made.arrays(0.3 * made.critical_step)
    zone.inverse_mass[:] = 1 / zone.mass
    zone.v[:] = np.random.default_rng(1).normal(0, 10, zone.v.shape)
    zone_kernels.inner_forces(zone)
    start = energy(zone)
    march(zone, 3000)
    assert not zone.touching.all()
    assert energy(zone) == pytest.approx(start, rel=3e-3)


@pytest.mark.parametrize("friction, cfl, error", [(0.2, 0.5, 3e-3), (0.05, 0.9, 8e-3)])
def test_cut_yarns_that_recoil_keep_their_energy(friction, cfl, error):
    """A taut patch of which six yarns are cut. Crossings whose indices run along whipping ends made 5 to 9 % of the
    energy, and took yarns that only whip for yarns that have changed sides."""
    made = patch((12, 12), friction=friction, failure=False)
    zone = free_zone(made, cfl)
    zone.x[:2] *= 1.035
    for _ in range(60):  # indices come to their places
        zone_kernels.inner_forces(zone)
    for name in ("damped", "friction_work", "lost_with_yarns", "lost_when_slack", "lost_in_snaps"):
        setattr(zone, name, 0.0)
    rng = np.random.default_rng(0)
    cut = [
        zone.first[family] + yarn * zone.nodes[family] + int(rng.integers(6, 18))
        for family in range(2)
        for yarn in (6, 7, 4)
    ]
    zone.breaking[cut] = True
    zone.segments_to_break = len(cut)
    start = energy(zone)
    march(zone, 2500)
    assert not zone.whole[cut].any()
    assert zone.lost_when_slack > 0.0
    assert zone.tangled == 0
    assert energy(zone) == pytest.approx(start, rel=error)


def lead(zone, stretch, steps):
    """Let the ends of all chains move apart by a stretch along x, y, z within so many steps."""
    place = zone.x[:, zone.tied_node]
    apart = place - place.mean(axis=1, keepdims=True)
    zone.v[:, zone.tied_node] = apart * stretch[:, None] / (steps * zone.dt)


def test_tensions_of_a_patch_are_those_of_the_unit_cell():
    """8 x 8 pinned crossings led apart along both families, against the cell at the stretches of the middle."""
    made = patch((8, 8), friction=np.inf, failure=False, viscosity=0.3)
    zone = made.arrays(0.5 * made.critical_step)
    tied = zone.tied_node
    steps = 6000
    stretch = np.array([0.035, 0.012, 0.0])
    lead(zone, stretch, steps)
    march(zone, steps)
    zone.v[:, tied] = 0.0
    march(zone, 4000)
    middle = slice(3, 5)
    tensions = []
    stretches = []
    for family in range(2):
        own = by_yarn(zone, zone.tension, family)[middle]
        place = by_yarn(zone, zone.x[family], family)[middle]
        tensions.append(own[:, 8:10].mean())
        stretches.append(((place[:, 12] - place[:, 6]) / (3 * made.spacing[family])).mean())
    cell = CellModel(made.model.fabric).solve(*stretches)
    assert tensions[0] == pytest.approx(float(cell["T1"]), rel=0.05)
    assert tensions[1] == pytest.approx(float(cell["T2"]), rel=0.05)


def test_a_yarn_is_pulled_through_at_the_coefficient_times_the_sum_of_contact_forces():
    """One warp drawn along between tensioned wefts: its ends differ by mu times the forces on it."""
    mu = 0.1
    made = patch((8, 3), friction=mu, failure=False, viscosity=0.3)
    zone = made.arrays(0.5 * made.critical_step)
    zone.foot[:] = -1.0
    first = zone.first[0] + zone.nodes[0]  # the middle warp
    last = first + zone.nodes[0] - 1
    tied = zone.tied_node
    lead(zone, np.array([0.02, 0.015, 0.0]), 3000)
    march(zone, 3000)
    zone.v[:, tied] = 0.0
    march(zone, 2000)
    zone.v[0, last] = zone.v[0, first] = 2.0
    pressing = []
    difference = []

    def watch(zone):
        pressing.append(zone.contact_force[1].sum())
        difference.append(zone.tension[last - 1] - zone.tension[first])

    march(zone, 10_000, watch)
    way = np.abs(zone.place[:, 1].T - made.rest[0][1])
    assert 0.5 * way.max(axis=-1).min() > 0.2
    assert np.mean(difference[4000:]) == pytest.approx(mu * np.mean(pressing[4000:]), rel=0.15)


def test_neighbours_touch_at_their_width_and_stand_off_at_the_closest():
    made = patch((4, 4))
    zone = made.arrays(made.critical_step)
    touch = zone.touch_distance[0]
    start = zone.first[0]
    n = start + 4
    zone.x[2, zone.first[0] : zone.first[1]] = 0.0
    span = start + np.arange(zone.nodes[0])
    zone.v[1, span] = 100.0  # so fast that they are looked at in each step
    for share in (1.01, 0.95):
        zone.x[1, span] = zone.x[1, span + zone.nodes[0]] - share * touch
        zone.f[:] = 0.0
        neighbour_kernels.neighbour_force(zone, 0, start + zone.nodes[0], n)
        force = zone.f[1, span].sum()
        expected = -max(1 - share, 0.0) * touch * zone.touch_stiffness[0]
        assert force == pytest.approx(expected, rel=1e-6)
        zone.foot_wait[:] = 0.0
