"""A zone of resolved yarns in the membrane of a panel: energy, the tie, the end of a shot, checkpoints."""

import re
from dataclasses import replace
from math import inf, radians

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.base.errors import InputError, UnstableError
from fabrics.pattern import Pattern
from fabrics.variants import rotated_90
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.loop.checkpoint import Checkpoints
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane import arrays
from shellfabric.membrane.numerics import Numerics
from shellfabric.projectile.projectile import Projectile
from shellfabric.state import DAMAGED, GONE
from shellfabric.yarns.model import YarnZone, aim

SPHERE = Projectile(mass=0.69e-3, radius=2.78e-3, shape="sphere")
SETUP = ImpactSetup(
    catalogue.load("S-726"),
    60.0,
    projectile=SPHERE,
    opening=0.04,
    symmetry="whole",
    impact_point=aim(catalogue.load("S-726").weave),
    crossovers=YarnZone(8e-3, 0.2),
    table_size=51,
    end_time=40e-6,
)


@pytest.fixture(scope="module")
def table():
    return SETUP.table(kept=True)


def energies_hold(result, error=0.005):
    return result.energy_error_max < error


def test_a_shot_keeps_its_energy_and_the_rim_moves_with_the_membrane(table):
    result = run_impact(SETUP, table=table)
    assert energies_hold(result, 1e-3)
    zone = result.target.plies[0].zone()
    assert result.energies["crossover_friction"][-1] > 1e-3 * result.strike_energy
    assert zone.stored == zone.friction_work == 0.0  # a run leaves the panel at rest
    assert 1e-4 < result.max_deflection < 60.0 * 40e-6


def test_a_membrane_that_is_gone_would_have_no_forces(table):
    """To the bit, where all yarns are resolved up to clamps that hold them; it stays before free sides."""
    own = replace(SETUP, crossovers=YarnZone(inf, 0.2), opening=0.02)
    skipped, computed = (PackSolver(own.target(table), 60.0, 30e-6) for _ in range(2))
    assert (skipped.state.block_damage == GONE).all()
    computed.state.block_damage[:] = DAMAGED
    for name in skipped.run().sample_names + computed.run().sample_names:
        assert np.array_equal(skipped.sample(name), computed.sample(name)), name
    assert skipped.sample("reaction_warp")[-1] > 1.0
    for other in (SETUP, replace(own, boundary=("clamped", "free"))):
        state = PackSolver(other.target(table), 60.0, 30e-6).state
        assert not (state.block_damage == GONE).any()


@pytest.mark.parametrize("name", ["plain", "basket 2x2", "twill 2/1"])
def test_a_shot_is_the_same_turned_by_a_right_angle(name):
    """To rounding, torn yarns included: the yarn is on top that was, and no step prefers a family."""
    weave = catalogue.load("S-726").weave
    fabric = replace(catalogue.load("S-726"), weave=replace(weave, pattern=Pattern.read(name)))
    x, y = 0.3e-3, -0.9e-3
    own = ImpactSetup(
        fabric,
        220.0,
        opening=(0.024, 0.03),
        impact_point=(x, y),
        symmetry="whole",
        end_time=20e-6,
        crossovers=YarnZone(friction=0.2),
        projectile=Projectile(mass=0.4e-3, radius=2.75e-3, shape="sphere"),
    )
    # the weft yarns are the warp yarns from the other end
    turned = replace(
        own, fabric=rotated_90(fabric), opening=own.opening[::-1], impact_point=(y, -x)
    )
    first, second = map(run_impact, (own, turned))
    assert first.plies["cut_yarns"][-1].sum() >= 3
    assert second.velocity == pytest.approx(first.velocity, rel=1e-9)
    exchanged = second.peak_tension[::-1]
    assert exchanged == pytest.approx(first.peak_tension, rel=1e-9)


def test_nose_membrane_and_zone_keep_their_momentum(table):
    """Of a free panel, to rounding: the zone's own steps are shorter, so is what its last force gives."""
    solver = PackSolver(replace(SETUP, boundary="free").target(table), 60.0, 40e-6)
    solver.run()
    zone = solver.part("yarns").zone
    state = solver.state
    const = solver.const
    assert zone.substeps == 2
    given = SPHERE.mass * 60.0
    kept = SPHERE.mass * solver.stack.projectile_velocity[2]
    kept += const.dt * state.f_contact_nose[2]
    kept += state.mass @ state.v[2] + const.dt * (state.f_int[2] + state.f_int_above[2]).sum()
    kept += (zone.mass * zone.v[2] + zone.dt * zone.f[2])[zone.inverse_mass > 0].sum()
    assert abs(zone.outer_force[:, 2]).max() > 1.0
    kept -= 0.5 * (const.dt - zone.dt) * zone.outer_force[:, 2].sum()
    assert kept == pytest.approx(given, rel=1e-12)


def test_a_panel_that_is_sheared_keeps_its_energy_at_the_corners_of_the_zone(table):
    """Two sides are free and come in; the trellis of an element there pulled on a node that nothing moves: 0.26 %."""
    setup = replace(
        SETUP, boundary=("clamped", "free"), crossovers=YarnZone(8e-3, 0.4), end_time=120e-6
    )
    result = run_impact(setup, table=table)
    assert result.energies["shear"][-1] > 0.02 * result.strike_energy
    assert energies_hold(result, 2e-4)


@pytest.mark.parametrize("velocity", [80.0, 110.0])
def test_yarns_that_recoil_to_the_rim_keep_their_energy(table, velocity):
    """With the mean force on the rim extrapolated from the step before they made 0.13 %."""
    nose = Projectile(mass=2e-3, radius=4e-3, shape="hemisphere", edge_radius=0.2e-3)
    setup = replace(SETUP, projectile=nose, crossovers=YarnZone(10e-3, 0.08), end_time=150e-6)
    result = run_impact(replace(setup, strike_velocity=velocity), table=table)
    assert result.outcome == "perforated"
    assert result.cut_yarns[-1] > 5
    assert energies_hold(result, 6e-4)


def test_mass_of_panel_and_zone_is_that_of_the_fabric(table):
    panel = SETUP.panel(table)
    state = panel.state(60.0)
    zone = panel.zone()
    own = zone.mass[zone.inverse_mass > 0].sum()
    plain = arrays.undeformed(panel, panel.constants(), 60.0)
    (i0, i1), (j0, j1) = panel.rim_rows
    assert own + state.mass.sum() == pytest.approx(plain.mass.sum(), rel=2e-3)
    assert own > 0.15 * plain.mass.sum()
    assert i1 - i0 == j1 - j0 == 18
    assert panel.spacing == tuple(2 * w for w in panel.weave.w)


def test_the_nose_starts_half_a_yarn_before_the_yarn_that_stands_out_most(table):
    """Before the middle line of the yarn that is nearest, where a membrane starts at its mid-plane."""
    panel = SETUP.panel(table)
    moved = panel.state(60.0).projectile_position
    moved = moved - arrays.undeformed(panel, panel.constants(), 60.0).projectile_position
    nearest = panel.zone().x[2].min()
    assert nearest < -1e-5
    assert nearest - moved[2] == pytest.approx(0.25 * panel.weave.thickness, rel=0.02)


def test_a_nose_stops_at_a_zone_of_pinned_yarns_as_at_the_membrane(table):
    """Time, deflection and tension of the straighter family; the warp gives up its crimp later than in the cell."""
    base = replace(SETUP, strike_velocity=45.0, impact_point=(0.0, 0.0), end_time=250e-6)
    # a line under the nose, as the nodes of the membrane are
    line = YarnZone(8e-3, inf, edge=0.0)
    zone = run_impact(replace(base, crossovers=line), table=table)
    plain = run_impact(replace(base, crossovers=None, elements_per_crossover=1), table=table)
    assert energies_hold(zone, 1e-3)
    assert (zone.outcome, plain.outcome) == ("stopped", "stopped")
    assert zone.time[-1] == pytest.approx(plain.time[-1], rel=0.02)
    assert zone.max_deflection == pytest.approx(plain.max_deflection, rel=0.05)
    assert zone.peak_tension[1] == pytest.approx(plain.peak_tension[1], rel=0.03)


def test_a_fast_nose_tears_yarns_and_perforates_and_the_energy_holds(table):
    result = run_impact(replace(SETUP, strike_velocity=250.0, end_time=80e-6), table=table)
    assert result.outcome == "perforated"
    assert result.cut_yarns[-1] >= 1
    assert 150.0 < result.residual_velocity < 250.0
    assert energies_hold(result)
    assert result.energies["failure_dissipation"][-1] > 0.0


def test_a_nose_passes_between_yarns_that_slip_freely(table):
    result = run_impact(
        replace(
            SETUP,
            strike_velocity=120.0,
            crossovers=YarnZone(12e-3, 0.0, edge=0.0),
            end_time=150e-6,
        ),
        table=table,
    )
    assert result.outcome == "perforated"
    assert result.cut_yarns[-1] == 0
    assert energies_hold(result)


def test_oblique_and_rough_noses_keep_the_energy(table):
    chisel = Projectile(
        mass=1.1e-3, radius=2.7e-3, shape="chisel", flat_width=2.5e-3, flat_angle=radians(35), edge_radius=0.2e-3,
        obliquity=radians(20), friction=0.2,
    )  # fmt: skip
    result = run_impact(
        replace(SETUP, projectile=chisel, crossovers=YarnZone(12e-3, 0.2), end_time=30e-6),
        table=table,
    )
    assert energies_hold(result, 2e-3)
    assert result.energies["friction"][-1] > 0.0


def test_a_resumed_run_is_the_same_to_the_last_bit(table, tmp_path):
    path = tmp_path / "run.h5"
    first = run_impact(SETUP, table=table, hooks=[Checkpoints(path, 12e-6)])
    again = run_impact(SETUP, table=table, resume=path)
    assert np.array_equal(first.step_history, again.step_history)
    for name, energy in first.energies.items():
        assert np.array_equal(energy, again.energies[name]), name


def test_snapshots_and_the_deflection_have_the_yarns_of_the_zone(table):
    """Places and tensions of the elements under the nose are those of the yarns, continuous across the rim."""
    # a line under the nose, whose tension still rises at the end
    zone = YarnZone(8e-3, inf, edge=0.0)
    result = run_impact(replace(SETUP, crossovers=zone), table=table)
    last = result.last[0]
    (i0, i1), (j0, j1) = result.panel.rim_rows
    assert result.peak_tension[1] == pytest.approx(last.tension[..., 1].max(), rel=0.1)
    middle = last.tension[(i0 + i1) // 2, :, 1]
    assert middle[j0 - 1] == pytest.approx(middle[j0], rel=0.2)
    assert last.nodes[i0 + 1 : i1, j0 + 1 : j1, 2].max() == result.deflection[-1]
    assert not last.failed.any()


def test_a_run_that_loses_its_energy_says_which_part_has_it(table):
    """By the books of the zone: made by the yarns, by their tie to rim and nose, or by the rest."""
    shot = replace(SETUP, strike_velocity=250.0)
    solver = PackSolver(shot.target(table), 250.0, 30e-6, energy_error_limit=0.01)
    solver.run()
    part = solver.part("yarns")
    assert part.zone.torn_segments > 0
    made = solver.energy_made()
    assert sum(made.values()) == pytest.approx(solver.sample("error")[-1])
    assert min(map(abs, made.values())) > 0.0
    assert max(map(abs, made.values())) < 1e-3 * solver.strike_energy

    def push(run):
        if run.time > 20e-6:
            run.part("yarns").zone.v[:] *= 1.3

    disturbed = PackSolver(shot.target(table), 250.0, 30e-6, energy_error_limit=0.01)
    with pytest.raises(UnstableError) as caught:
        disturbed.run((push,))
    text = str(caught.value)
    assert "at the resolved yarns (" in text
    assert re.search(r"grew most between (19|2\d)\.?\d* and 2\d", text)
    assert re.search(r"the fastest is node \d+ of the resolved (warp|weft) yarn", text)


def test_crossings_whose_yarns_have_changed_sides_are_a_doubt(table):
    part = PackSolver(SETUP.target(table), 60.0, 20e-6).part("yarns")
    (found,) = part.indicators()
    assert (found.name, found.doubtful) == ("yarns that changed sides", False)
    part.zone.tangled += 1
    assert part.indicators()[0].doubtful


def test_each_yarn_of_the_zone_has_the_strength_of_its_own_line(table):
    panel = replace(SETUP, length_effect=False).panel(table)
    factors = tuple(np.linspace(0.8, 1.2, count) for count in panel.yarn_counts)
    drawn = replace(panel, strength_factors=factors)
    zone = drawn.zone()
    (i0, _), (j0, _) = drawn.rim_rows
    for family, line in ((0, j0 + 3), (1, i0 + 3)):
        n = zone.first[family] + 2 * zone.nodes[family]
        expected = factors[family][line] * panel.weave.yarns[family].strength
        assert zone.strength[n] == pytest.approx(expected)


def test_a_nose_that_flies_out_of_the_zone_ends_the_run(table):
    solver = PackSolver(SETUP.target(table), 60.0, 1e-6)
    solver.guard_model()
    solver.state.projectile_position[1] = 4e-3
    with pytest.raises(UnstableError, match="leaves the zone of resolved yarns"):
        solver.guard_model()


@pytest.mark.parametrize(
    ("values", "key"),
    [
        ({"symmetry": "quarter"}, "impact_point"),
        ({"elements_per_crossover": 2}, "elements_per_crossover"),
        ({"grading": ((20, 1), (inf, 2))}, "grading"),
        ({"bending": 1e-9}, "bending"),
        ({"cell_formulation": "equilibrium"}, "cell_formulation"),
        ({"crossovers": YarnZone(3e-3)}, "zone"),
        ({"round": True, "crossovers": YarnZone(25e-3)}, "zone"),
        ({"numerics": Numerics(nose_stiffness=0.5)}, "nose_stiffness"),
        ({"numerics": Numerics(contact_damping=0.0)}, "contact_damping"),
        ({"numerics": Numerics(contact_points=2)}, "contact_points"),
        ({"numerics": Numerics(erosion_gap=2.0)}, "erosion_gap"),
    ],
)
def test_what_a_zone_does_not_have_is_refused(table, values, key):
    setup = replace(SETUP, **values)
    with pytest.raises(InputError) as caught:
        setup.target(table if "cell_formulation" not in values else None)
    assert caught.value.key == key


@pytest.mark.parametrize(
    ("plies", "side", "friction", "width"),
    [
        (1, 0.12, 0.2, inf),
        (1, 0.13, 0.2, 40e-3),
        (1, 0.13, 0.3, 40e-3),
        (1, 0.13, 0.1, 80e-3),
        (2, 0.1, 0.2, 40e-3),
        (2, 0.1, 0.1, 80e-3),
        (2, 0.1, 0.0, inf),
    ],
)
def test_the_default_zone_is_all_yarns_of_a_small_ply_and_wider_with_less_friction(
    plies, side, friction, width
):
    setup = replace(
        SETUP,
        plies=plies,
        opening=(0.9 * side, side),
        crossovers=YarnZone(friction=friction),
        ply_friction=0.2,
        symmetry="whole",
    )
    assert setup.zone.width == pytest.approx(width)
    assert replace(setup, crossovers=YarnZone(8e-3, friction)).zone.width == 8e-3


@pytest.mark.parametrize(
    "shape",
    [
        {"weave_angle": 0.4},
        {"round": True},
        {"round": True, "impact_point": (3e-3, -5e-3)},
    ],
    ids=str,
)
def test_no_scene_is_refused_for_a_zone_that_nobody_gave(shape):
    """It is narrowed to what the edges leave, by no more than a spacing; one that is given is refused there."""
    rows = {"opening": (0.06, 0.06), "symmetry": "whole", "crossovers": YarnZone(friction=0.0)}
    setup = replace(SETUP, **rows | shape)
    (panel,) = setup.plain_target().plies
    width = panel.zone_width
    assert 10e-3 < width < 0.5 * max(panel.opening)
    assert panel._is_free(width)
    assert not panel._is_free(width + 1.01 * max(panel.spacing))
    given = replace(setup, crossovers=YarnZone(inf, 0.0))
    with pytest.raises(InputError) as caught:
        given.plain_target()
    assert caught.value.key == "zone"


def test_a_random_aim_is_that_of_its_seed_within_a_cell_of_the_weave():
    weave = SETUP.fabric.weave
    aims = {aim(weave, seed) for seed in range(20)}
    assert len(aims) == 20
    assert aim(weave, 3) in aims
    w1, w2 = weave.w
    assert aim(weave) == (0.5 * w1, 0.5 * w2)
    assert max(abs(x) for x, _ in aims) < 2 * w1
    assert max(abs(y) for _, y in aims) < 2 * w2


def test_a_yarn_is_as_wide_as_its_edges_where_a_nose_meets_it(table):
    """A sphere in a gap: with a width it meets yarns beside it sooner, is held harder, and the energy holds."""
    sphere = Projectile(mass=0.11e-3, radius=1.5e-3, shape="sphere")
    spacing = 2 * np.array(table.model.fabric.weave.w)
    gap = replace(
        SETUP,
        strike_velocity=60.0,
        projectile=sphere,
        impact_point=tuple(0.5 * spacing),
        end_time=25e-6,
    )
    left = {}
    for edge in (0.0, 0.2, 0.45):
        shot = replace(gap, crossovers=YarnZone(8e-3, 0.2, edge=edge))
        result = run_impact(shot, table=table)
        assert energies_hold(result, 1e-3)
        left[edge] = result.velocity[-1]
    assert left[0.0] - 0.5 > left[0.2] > left[0.45] + 0.3


def test_the_width_under_the_nose_is_told_as_assumed():
    (sentence,) = (line for line in YarnZone().assumptions if "meets the nose" in line)
    assert sentence.endswith("0.2 of its width beside it, assumed 0.1 to 0.45.")
    (given,) = (line for line in YarnZone(edge=0.3).assumptions if "meets the nose" in line)
    assert given.endswith("0.3 of its width beside it.")
    with pytest.raises(InputError, match=r"edge = 0\.7: must be 0 to 0\.5"):
        YarnZone(edge=0.7)


@pytest.mark.parametrize("opening", [0.04, (0.04, 0.042), (0.042, 0.04), 0.042])
@pytest.mark.parametrize("spacings", [(0.25, 0.25), (0.25, 0.75)])
def test_an_aim_meets_the_same_place_of_the_weave_in_a_panel_of_any_size(table, opening, spacings):
    """The warp lies on top at the middle crossover, from which an aim is counted."""
    point = tuple(2 * share * half for share, half in zip(spacings, SETUP.fabric.weave.w))
    panel = replace(SETUP, opening=opening, impact_point=point).panel(table)
    middle = [lines[count // 2] for lines, count in zip(panel.lines(), panel.counts)]
    zone = panel.zone()
    second = int(zone.first[1])
    heights = []
    for nodes in (slice(None, second), slice(second, None)):
        away = np.hypot(*(zone.x[:2, nodes] - np.array(middle)[:, None]))
        assert away.min() < 1e-6
        heights.append(zone.x[2, nodes][away.argmin()])
    assert heights[0] > heights[1]


def test_ends_that_whip_make_no_energy_at_the_rim():
    """Yarns resolved up to two free edges: with two steps of theirs in one of the rim it makes 1e-5 of the
    energy here, and 3e-3 in a longer shot; with one step it makes rounding."""
    fabric = catalogue.load("S-731")
    spacing = 2 * max(fabric.weave.w)
    nose = Projectile(mass=0.9e-4, radius=1.4 * spacing, shape="hemisphere", edge_radius=0.1e-3)
    setup = ImpactSetup(
        fabric,
        200.0,
        projectile=nose,
        opening=(22 * spacing, 27 * spacing),
        boundary=("clamped", "free"),
        symmetry="whole",
        impact_point=aim(fabric.weave, 5),
        crossovers=YarnZone(np.inf, 0.19),
        end_time=80e-6,
    )
    panel = setup.panel()
    assert panel.ends_free
    solver = PackSolver(panel, 200.0, 80e-6)
    solver.run()
    rim = solver.energy_made()["the rim of the resolved yarns"]
    assert abs(rim) < 1e-9 * solver.strike_energy
    assert abs(solver.sample("error")).max() < 1e-3 * solver.strike_energy
    held = replace(setup, boundary="clamped").panel()
    inner = replace(setup, crossovers=YarnZone(9 * spacing, 0.19)).panel()
    for other in (held, inner):
        assert not other.ends_free
        assert other.zone().substeps == 2
