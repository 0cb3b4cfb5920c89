"""Resolved yarns cut by planes of symmetry, the middle lines of yarns: what the whole panel does."""

from dataclasses import replace
from math import ceil, radians

import numpy as np
import pytest

import weavecell as wc
from fabrics import catalogue
from fabrics.base.errors import InputError
from shellfabric.block.block import Backing
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup, Ply
from shellfabric.loop.checkpoint import Checkpoints
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.projectile.projectile import Projectile
from shellfabric.yarns.model import YarnZone

FABRIC = catalogue.load("S-728")
CHISEL = Projectile(
    mass=1.10e-3,
    radius=2.73e-3,
    shape="chisel",
    edge_radius=0.3e-3,
    flat_width=2.57e-3,
    flat_angle=radians(35),
    length=6.16e-3,
    friction=0.2,  # without it a share that is missing in its book is not seen
)
SETUP = ImpactSetup(
    FABRIC,
    165.0,
    projectile=CHISEL,
    opening=0.06,
    crossovers=YarnZone(seed=3),
    table_size=51,
    length_effect=False,
)
# symmetry, aim [spacings], roll [deg], sides [m]: on a yarn, on either crossover, between
PLACES = [
    ("quarter", (0, 0), 0, 0.06),
    ("half", (0, 0.5), 0, 0.06),
    ("half", (0, 1), 90, (0.06, 0.0632)),
    ("half", (0, 0.3), 90, (0.0617, 0.06)),
    ("other half", (0.5, 0), 90, 0.06),
    ("other half", (1, 0), 0, 0.06),
]


@pytest.fixture(scope="module")
def table():
    return SETUP.table(kept=True)


def setup(symmetry, aim, roll=0, opening=0.06, **other):
    point = tuple(2 * float(share) * w for share, w in zip(aim, FABRIC.weave.w))
    nose = replace(CHISEL, roll=radians(roll))
    values = {"symmetry": symmetry, "impact_point": point, "projectile": nose, "opening": opening}
    return replace(SETUP, **values, **other)


def fly(target, velocity, end):
    return PackSolver(target, velocity, end).run()


def assert_alike(part, whole, within=1e-9):
    """Velocity to `within`, energies and cut yarns."""
    np.testing.assert_allclose(part.sample("v"), whole.sample("v"), rtol=within)
    assert part.sample("cut_yarns")[-1] == pytest.approx(whole.sample("cut_yarns")[-1])
    for name in part.sample_names[6:]:
        apart = np.abs(part.sample(name) - whole.sample(name)).max()
        assert apart < 1e-4 * whole.strike_energy, name


@pytest.mark.parametrize(("symmetry", "aim", "roll", "opening"), PLACES)
def test_a_part_does_what_the_whole_panel_does_through_slip_and_tearing(
    table, symmetry, aim, roll, opening
):
    """To rounding, before and after yarns slip and tear: the whole panel's arithmetic is symmetric."""
    own = [
        fly(setup(name, aim, roll, opening).target(table), 165.0, 50e-6)
        for name in (symmetry, "whole")
    ]
    whole = own[1]
    assert whole.sample("crossover_friction")[-1] > 1e-3 * whole.strike_energy
    assert whole.sample("friction")[-1] > 1e-4 * whole.strike_energy  # on the nose
    assert_alike(*own)


@pytest.mark.parametrize(("symmetry", "aim"), [("half", (0, 0.5)), ("other half", (0.5, 0))])
def test_yarns_of_a_part_that_are_cut_are_those_of_the_whole(table, symmetry, aim):
    own = [fly(setup(name, aim).target(table), 190.0, 50e-6) for name in (symmetry, "whole")]
    assert own[1].sample("cut_yarns")[-1] > 0.5
    assert_alike(*own)


def test_the_whole_panel_is_its_own_mirror_image(table):
    """Where neighbours touch too, which points of one yarn and the line of another make."""
    line = replace(SETUP.crossovers, edge=0.0)
    whole = setup("whole", (0, 0.5), crossovers=line)
    solver = fly(whole.target(table), 165.0, 50e-6)
    zone = solver.part("yarns").zone
    assert solver.sample("neighbour_contact")[-1] > 0
    warp, weft = (
        zone.x[:, first : first + yarns * nodes].reshape(3, yarns, nodes)
        for first, yarns, nodes in zip(zone.first, zone.yarns, zone.nodes)
    )
    turn = np.array([-1.0, 1.0, 1.0])[:, None, None]
    np.testing.assert_allclose(warp, turn * warp[:, :, ::-1], atol=1e-10)
    np.testing.assert_allclose(weft, turn * weft[:, ::-1], atol=1e-10)


@pytest.mark.parametrize(
    ("symmetry", "aim", "axis"), [("half", (0, 0.5), 0), ("other half", (0.5, 0), 1)]
)
def test_a_plane_of_symmetry_is_the_middle_line_of_a_yarn_in_each_ply(table, symmetry, aim, axis):
    pack = setup(symmetry, aim, plies=2).target(table)
    shifts = np.array([ply.shift for ply in pack.plies])
    assert np.all(shifts[:, axis] == 0)
    assert shifts[1, 1 - axis] != 0
    whole = setup("whole", aim, plies=2).target(table)
    plies = tuple(replace(ply, shift=tuple(way)) for ply, way in zip(whole.plies, shifts.tolist()))
    own = [fly(target, 260.0, 24e-6) for target in (pack, replace(whole, plies=plies))]
    assert own[1].sample("cut_yarns")[-1] > 0.5
    assert_alike(*own)


def test_half_of_a_pack_with_a_turned_ply_of_another_fabric_is_that_of_the_whole(table):
    """A ply at a right angle has its own spacings in the plane, and its own yarn there."""
    lay_up = (Ply(FABRIC), Ply(catalogue.load("S-720"), angle=radians(90)))
    own = [
        setup(name, (0, 0.5), plies=2, lay_up=lay_up, ply_friction=0.2).target(table)
        for name in ("half", "whole")
    ]
    plies = tuple(replace(ply, shift=part.shift) for ply, part in zip(own[1].plies, own[0].plies))
    flown = [fly(target, 190.0, 20e-6) for target in (own[0], replace(own[1], plies=plies))]
    assert flown[1].sample("crossover_friction")[-1] > 1e-4 * flown[1].strike_energy
    assert_alike(*flown)


def test_a_quarter_before_a_block_is_that_of_the_whole(table):
    """The block's elements are cut by the same planes."""
    block = Backing(size=(0.06, 0.06, 0.02), min_size=3e-3)
    nose = Projectile(mass=0.69e-3, radius=2.78e-3, shape="sphere", friction=0.2)
    backed = replace(
        SETUP, projectile=nose, opening=0.04, crossovers=YarnZone(10e-3), backing=block
    )
    quarter, whole = (
        run_impact(
            replace(backed, symmetry=name, impact_point=(0.0, 0.0), end_time=14e-6), table=table
        )
        for name in ("quarter", "whole")
    )
    assert whole.backing.depth > 1e-4
    assert quarter.backing.depth == pytest.approx(whole.backing.depth, rel=1e-6)
    assert quarter.step_history[-1, 2] == pytest.approx(whole.step_history[-1, 2], rel=1e-7)
    assert quarter.energy_error_max < 2e-3


def test_images_reach_as_far_as_the_mean_of_the_criterion(table):
    wide = replace(FABRIC, failure_length=5e-3)
    model = replace(table.model, fabric=wide)
    half = replace(setup("half", (0, 0.5)).panel(table), table=replace(table, model=model))
    assert half.images == (ceil(5e-3 / half.spacing[0] + 0.5), 0)
    zone = half.zone()
    number = int(zone.yarns[0] + half.images[0])  # the weft yarn on the plane
    own = zone.mean_weights[number]
    np.testing.assert_allclose(own[own > 0], own[own > 0][::-1])
    assert own.sum() == pytest.approx(1.0)


def test_a_part_is_drawn_as_that_of_the_whole(table):
    parts = [setup(name, (0, 0.5)).panel(table).make_parts()[-1] for name in ("half", "whole")]
    half, whole = (part.draw() for part in parts)
    for family in range(2):
        own, all_of = (
            drawn["yarn_surface"][drawn["yarn_family"] == family].mean(axis=1)
            for drawn in (half, whole)
        )
        behind = all_of[all_of[:, 0] > -1e-6]
        np.testing.assert_allclose(own[own[:, 0] > -1e-6], behind, atol=1e-6)


def test_half_before_a_block_is_refused(table):
    for name in ("half", "other half"):
        with pytest.raises(InputError, match="quarter or whole in front of a backing"):
            setup(name, (0, 0), backing=Backing(size=(0.06, 0.06, 0.02))).panel(table)


@pytest.mark.parametrize("side", [-1, 1])
def test_of_two_lines_as_near_to_the_aim_the_first_is_the_middle(table, side):
    """Whatever the digits of the sums that place them: half a spacing off, in panels of several sizes."""
    for opening in (0.04, 0.0412, 0.0424, 0.0436, 0.06, 0.0617):
        panel = setup("whole", (side * 0.5, 0), opening=opening).panel(table)
        place = panel.lines()[0][panel.nearest_lines[0]]
        assert place == pytest.approx(-0.5 * panel.spacing[0], rel=1e-6)


def test_an_aim_off_the_plane_is_refused(table):
    with pytest.raises(InputError) as caught:
        setup("half", (0.5, 0)).panel(table)
    assert caught.value.key == "impact_point"


def test_a_zone_of_a_part_is_refused_where_that_of_the_whole_is(table):
    for width in (6e-3, 7e-3, 8e-3, 9e-3, 10e-3):
        messages = []
        for name in ("half", "whole"):
            try:
                setup(name, (0, 0), crossovers=YarnZone(width)).panel(table)
                messages.append("")
            except InputError as error:
                messages.append(str(error))
        assert messages[0] == messages[1]


def test_a_resumed_half_is_the_same_to_the_last_bit(table, tmp_path):
    half = replace(setup("half", (0, 0.5)), end_time=16e-6)
    first = run_impact(half, table=table, hooks=[Checkpoints(tmp_path / "run.h5", 8e-6)])
    again = run_impact(half, table=table, resume=tmp_path / "run.h5")
    assert np.array_equal(first.step_history, again.step_history)
    for name, energy in first.energies.items():
        assert np.array_equal(energy, again.energies[name]), name


@pytest.mark.parametrize(
    ("symmetry", "spacings"),
    [("quarter", (0, 0)), ("half", (0, 0.25)), ("other half", (0.25, 0)), (None, (0.25, 0.25))],
)
def test_a_part_is_struck_where_its_planes_cross_yarns(symmetry, spacings):
    """The middle line of a yarn is a plane of symmetry, a quarter of a spacing off it is none."""
    given = {} if symmetry is None else {"symmetry": symmetry}
    made = wc.setup("S-728", "150 m/s", opening="60 mm", crossovers="yarns", **given)
    wanted = [2 * share * w for share, w in zip(spacings, FABRIC.weave.w)]
    np.testing.assert_allclose(made.impact_point, wanted)
    assert made.symmetry == (symmetry or "whole")
