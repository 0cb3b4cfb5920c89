"""Zones of resolved yarns in each ply of a pack: shadow nodes, momentum, energy, threads, checkpoints, windowing."""

from dataclasses import replace
from math import radians

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.base.errors import InputError
from fabrics.variants import rotated_90
from shellfabric.block.block import Backing
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup, Ply
from shellfabric.loop.checkpoint import Checkpoints
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.numerics import Numerics
from shellfabric.membrane.slots import by_node
from shellfabric.plies.model import Pack
from shellfabric.projectile.projectile import Projectile
from shellfabric.yarns.model import YarnZone, aim
from shellfabric.yarns.part import shadow_slots
from shellfabric.yarns.past_ply import nodes_past
from validation.models.ply_crossings import plies_cross

SPHERE = Projectile(mass=0.69e-3, radius=2.78e-3, shape="sphere")
SETUP = ImpactSetup(
    catalogue.load("S-726"),
    120.0,
    projectile=SPHERE,
    opening=0.04,
    symmetry="whole",
    impact_point=aim(catalogue.load("S-726").weave),
    crossovers=YarnZone(8e-3, 0.2),
    table_size=51,
    plies=2,
    ply_friction=0.2,
    end_time=16e-6,
)
# plies of two fabrics, one at an angle
HYBRID = replace(
    SETUP,
    plies=3,
    lay_up=(
        Ply(catalogue.load("S-726")),
        Ply(catalogue.load("S-728"), angle=radians(30)),
        Ply(catalogue.load("S-726"), angle=radians(90)),
    ),
)


@pytest.fixture(scope="module")
def table():
    return SETUP.table(kept=True)


def zones(solver):
    return [part.zone for parts in solver.parts for part in parts if part.name == "yarns"]


def test_plies_and_nose_keep_their_momentum(table):
    """Of two free plies: to rounding, since a zone makes one step in one of its ply."""
    free = replace(SETUP, boundary="free", ply_friction=0.0)
    solver = PackSolver(free.target(table), 120.0, 16e-6).run()
    velocity = solver.stack.projectile_velocity[2]
    kept = SPHERE.mass * velocity + solver.const.dt * solver.stack.f_contact_nose[:, 2].sum()
    shares = []
    for (_, const, state), zone, pushes in zip(solver.plies, zones(solver), range(2)):
        assert zone.substeps == 1
        force = state.f_int[2] + state.f_int_above[2]
        own = zone.inverse_mass > 0
        part = state.mass @ state.v[2] + const.dt * force[state.mass > 0].sum()
        part += (zone.mass * zone.v[2] + zone.dt * zone.f[2])[own].sum()
        part += const.dt * sum(f[2].sum() for f in solver.neighbour_forces(pushes))
        shares.append(part)
        kept += part
    assert min(shares) > 5e-3 * SPHERE.mass * 120.0
    assert kept == pytest.approx(SPHERE.mass * 120.0, rel=1e-12)


def test_a_push_on_a_shadow_node_is_one_on_its_two_yarns(table):
    """The mobility of a shadow node is that of its chains, and no other node of the zone has part in it."""
    panel = SETUP.target(table).plies[0]
    state = panel.state(0.0)
    zone = panel.zone()
    slots = shadow_slots(zone)
    w = zone.warp_share
    assert 0.2 < w < 0.8
    mobility = np.asarray(state.dt_over_mass)[slots] / panel.time_step
    a = zone.first[0] + np.arange(zone.yarns[0])[:, None] * zone.nodes[0]
    a = a + 2 * (np.arange(zone.yarns[1]) + 1)
    b = zone.first[1] + np.arange(zone.yarns[1])[None, :] * zone.nodes[1]
    b = b + 2 * (np.arange(zone.yarns[0])[:, None] + 1)
    assert np.unique(np.concatenate([a.ravel(), b.ravel()])).size == 2 * slots.size
    expected = w**2 * zone.inverse_mass[a] + (1 - w) ** 2 * zone.inverse_mass[b]
    assert mobility == pytest.approx(expected)
    assert w * zone.x[2, a] + (1 - w) * zone.x[2, b] == pytest.approx(0.0, abs=1e-12)
    lightest = 1 / mobility.max() / np.prod(panel.spacing)
    assert panel.contact_density == pytest.approx(lightest)
    pack = SETUP.target(table)
    stiffest = pack.contact_laws[0].steepest
    assert pack.time_step <= 1.0001 * pack.contact.courant * (lightest / stiffest) ** 0.5


def test_shadow_nodes_stay_where_their_yarns_are(table):
    solver = PackSolver(SETUP.target(table), 120.0, 10e-6).run()
    for (panel, const, state), zone in zip(solver.plies, zones(solver)):
        slots = shadow_slots(zone)
        X, Y = panel.coordinates()
        n = np.arange(zone.yarns[0])[:, None], np.arange(zone.yarns[1])
        a = zone.first[0] + n[0] * zone.nodes[0] + 2 * (n[1] + 1)
        b = zone.first[1] + n[1] * zone.nodes[1] + 2 * (n[0] + 1)
        for c, rest in enumerate((X, Y, 0 * X)):
            place = (by_node(state.u[c], const) + rest).ravel()[slots.T].T
            middle = zone.warp_share * zone.x[c, a] + (1 - zone.warp_share) * zone.x[c, b]
            assert place == pytest.approx(middle, abs=1e-12)
    moved = [abs(zone.v[2]).max() for zone in zones(solver)]
    assert min(moved) > 1.0


def test_a_hybrid_pack_at_angles_keeps_its_energy_and_its_bits(table, tmp_path):
    """Of three plies, friction between them: with two threads, and resumed from a checkpoint."""
    path = tmp_path / "run.h5"
    first = run_impact(HYBRID, hooks=[Checkpoints(path, 6e-6)])
    assert first.energy_error_max < 2e-3
    for name in ("ply_contact", "ply_friction", "crossover_friction"):
        assert first.energies[name][-1] > 1e-4 * first.strike_energy, name
    again = run_impact(HYBRID, resume=path)
    shared = run_impact(replace(HYBRID, numerics=Numerics(threads=2)))
    for other in (again, shared):
        assert np.array_equal(first.step_history, other.step_history)
        for name, energy in first.energies.items():
            assert np.array_equal(energy, other.energies[name]), name


def test_no_ply_passes_through_another_and_yarns_that_do_are_counted(table):
    solver = PackSolver(replace(SETUP, strike_velocity=250.0).target(table), 250.0, 16e-6)
    seen = []
    solver.run((lambda run: seen.append(plies_cross(run)),))
    assert len(seen) > 5
    assert not any(seen)
    zone = zones(solver)[0]
    both = zip(*solver.plies)
    panels, consts, states = both
    apart = solver.pack.places[1]
    before = np.count_nonzero(nodes_past(zone, panels, consts, states, apart))
    n = zone.first[0] + (zone.yarns[0] // 2 + 4) * zone.nodes[0] + zone.nodes[0] // 2
    assert zone.whole[n]
    assert zone.whole[n - 1]
    zone.x[2, n] += 2.5 * apart
    assert np.count_nonzero(nodes_past(zone, panels, consts, states, apart)) > before
    zone.most_past = 100
    found = {check.name: check for check in solver.part_indicators}["yarns past the next ply"]
    assert found.value == pytest.approx(100 / zone.mass.size)


def test_a_pack_with_a_block_behind_it_keeps_its_energy(table):
    block = Backing(size=(0.036, 0.036, 0.02), min_size=3e-3)
    backed = replace(SETUP, opening=0.026, backing=block, end_time=12e-6)
    result = run_impact(backed, table=table)
    assert result.energy_error_max < 2e-3
    assert result.backing.depth > 1e-4
    alone = replace(backed, plies=1, ply_friction=0.0)
    assert run_impact(alone, table=table).energy_error_max < 2e-3


def test_plies_lie_anywhere_by_the_seed_of_the_aim(table):
    def shifts(seed, **others):
        setup = replace(SETUP, plies=4, crossovers=YarnZone(8e-3, 0.2, seed=seed), **others)
        return [ply.shift for ply in setup.target(table).plies]

    first = shifts(1)
    assert first[0] == (0.0, 0.0)
    assert len(set(first)) == 4
    assert shifts(1) == first
    assert shifts(2)[1] != first[1]
    assert shifts(None) == shifts(0)
    assert set(shifts(1, boundary="free")) == {(0.0, 0.0)}


def test_zones_in_some_plies_alone_are_refused(table):
    resolved = SETUP.target(table).plies[0]
    pinned = replace(SETUP, crossovers=None, elements_per_crossover=1).target(table).plies[0]
    with pytest.raises(InputError) as caught:
        Pack.laid_up([(resolved, 0.0), (pinned, 0.0)], gaps=[None])
    assert caught.value.key == "crossovers"


@pytest.mark.slow
def test_a_sphere_passes_between_the_yarns_of_two_plies_that_stop_it_pinned():
    """Friction 0.2, 110 m/s, yarns as lines under the nose: with their assumed width they stop it. As
    pinned yarns do, yarns that hardly slip stop it."""
    fabric = catalogue.load("S-726")
    setup = replace(
        SETUP, strike_velocity=110.0, opening=0.1, table_size=201, end_time=200e-6, ply_friction=0.0
    )
    shots = {}
    for name, zone in (
        ("slipping", YarnZone(20e-3, 0.2, edge=0.0)),
        ("held", YarnZone(20e-3, 2.0, edge=0.0)),
        ("pinned", None),
    ):
        shot = replace(setup, crossovers=zone, impact_point=aim(fabric.weave) if zone else (0, 0))
        shots[name] = run_impact(shot)
        assert shots[name].energy_error_max < 2e-3, name
    assert {name: shot.outcome for name, shot in shots.items()} == {
        "slipping": "perforated", "held": "stopped", "pinned": "stopped",
    }  # fmt: skip
    assert shots["slipping"].residual_velocity > 40.0
    assert shots["slipping"].cut_yarns[-1] == 0


@pytest.mark.parametrize("angle", [0, 90])
def test_a_pack_is_the_same_turned_by_a_right_angle(angle):
    """To rounding, torn yarns and friction between unlike plies included, however they are shifted."""
    x, y = 0.3e-3, -0.9e-3
    opening = (0.024, 0.03)
    kinds = [catalogue.load("S-726"), catalogue.load("S-720")]

    def fly(fabrics, opening, impact_point, shifts=None):
        front, rear = fabrics
        setup = ImpactSetup(
            front,
            240.0,
            opening=opening,
            impact_point=impact_point,
            symmetry="whole",
            crossovers=YarnZone(8e-3, 0.2),
            plies=2,
            lay_up=(Ply(front), Ply(rear, angle=radians(angle))),
            ply_friction=0.2,
            projectile=Projectile(mass=0.4e-3, radius=2.75e-3, shape="sphere"),
        )
        pack = setup.target()
        if shifts is not None:
            plies = tuple(replace(ply, shift=to) for ply, to in zip(pack.plies, shifts))
            pack = replace(pack, plies=plies)
        return PackSolver(pack, 240.0, 17e-6, interval=1e-6).run()

    own = fly(kinds, opening, (x, y))
    # the weft yarns are the warp yarns from the other end
    moved = [(across, -along) for along, across in (ply.shift for ply in own.pack.plies)]
    assert min(map(abs, moved[1])) > 1e-5
    turned = fly([rotated_90(kind) for kind in kinds], opening[::-1], (y, -x), moved)
    assert own.sample("cut_yarns")[-1] >= 3
    assert own.sample("ply_friction")[-1] > 1e-5 * own.strike_energy
    for quantity in ("kinetic_projectile", "ply_friction", "crossover_friction"):
        assert turned.sample(quantity) == pytest.approx(own.sample(quantity), rel=1e-9)
