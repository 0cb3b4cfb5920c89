"""Quality indicators, and the energy guard between audits."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from panels import make_panel, table

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ELEMENT_SIDE, ImpactSetup
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane import quality
from shellfabric.membrane.numerics import Numerics
from shellfabric.membrane.quality_kernels import alternation
from shellfabric.plies.model import Pack
from shellfabric.projectile.projectile import Projectile
from validation.cases.impact import Unchecked
from validation.models.variants import with_law_form


def small_panel(side=0.1, **numerics):
    cell = CellModel(catalogue.load("S-720").with_effective_density())
    return make_panel(
        side, table=cell.table(51), numerics=Unchecked(threads=1, **numerics), yarn_failure=False
    )


@pytest.mark.parametrize(
    "numerics, expected",
    [
        ({}, set()),
        ({"stretch_viscosity": 0.0}, {"tension oscillation"}),
        ({"nose_stiffness": 0.006}, {"nose penetration"}),
        ({"contact_points": 2}, {"contact point spacing"}),
        ({"cfl": 1.2}, {"time step"}),
    ],
)
def test_what_a_knob_spoils_is_indicated(numerics, expected):
    solver = PackSolver(small_panel(**numerics), 92.5, 100e-6).run()
    assert {one.name for one in quality.of_solver(solver) if not one.ok} == expected


def test_a_printed_law_and_a_law_beyond_its_fit_are_indicated():
    fabric = table().model.fabric
    printed = quality.of_cell(CellModel(with_law_form(fabric, "printed")).table(51), (10.0, 10.0))
    assert {one.name for one in printed if not one.ok} == {"swelling under contact"}
    for highest, ok in ((1e-3, False), (1e6, True)):
        laws = tuple(replace(law, F_range=(0.0, highest)) for law in fabric.laws)
        assert (
            all(
                one.ok for one in quality.of_cell(CellModel(fabric, laws).table(51), (100.0, 100.0))
            )
            == ok
        )


def test_alternation_of_a_known_wave():
    """Tensions 10 +- 1 N from node to node: the alternation is a tenth; a smooth slope has none."""
    found = np.zeros(2)
    slope = np.zeros(2)
    i = np.arange(1600)
    alternation(10.0 + (-1.0) ** i, 0, 1, 400, 400, 0.0, found)
    assert np.sqrt(found[0] / found[1]) == pytest.approx(0.1, rel=0.02)
    alternation(20.0 - 0.01 * (i % 400), 0, 1, 400, 400, 0.0, slope)
    assert slope[0] == pytest.approx(0.0, abs=1e-12)
    assert slope[1] > 0


def test_viscous_energy_is_split_before_the_first_failure():
    energies = {
        "kinetic_projectile": np.array([90.0, 70.0, 50.0, 30.0]),
        "viscous": np.array([0.0, 1.0, 4.0, 6.0]),
    }
    for failed, expected in (
        ([0, 0, 0, 0], (0.1, 0.0)),
        ([0, 0, 3, 3], (0.05, 5.0)),
        ([0, 2, 3, 3], (0.0, 6.0)),
    ):
        assert quality.split_viscous(np.array(failed), energies) == pytest.approx(expected)


def narrow(velocity=300.0, **changes):
    """A shot whose projectile is narrow: an element of one crossover is 1.2 times as long as its radius."""
    changes = {
        "projectile": Projectile(mass=0.44e-3, radius=1.06e-3),
        "opening": 0.06,
        "table_size": 51,
    } | changes
    return ImpactSetup(
        table().model.fabric, velocity, end_time=100e-6, numerics=Numerics(threads=1), **changes
    )


def test_the_default_mesh_follows_projectile_and_failure_length():
    table = narrow().table()
    length = narrow().fabric.failure_length
    oblique = Projectile(mass=0.44e-3, radius=1.06e-3, obliquity=0.5)
    for changes, side in (
        ({}, 0.5 * length),
        ({"boundary": "free"}, 0.5 * length),
        ({"weave_angle": 0.5, "symmetry": "whole"}, 0.5 * length),
        ({"projectile": oblique, "symmetry": "whole"}, 0.5 * length),
        ({"grading": ((16, 1), (np.inf, 2))}, 1),
    ):
        assert max(narrow(**changes).panel(table).spacing) <= side
    tiny = {"projectile": Projectile(mass=0.1e-3, radius=0.3e-3)}
    assert max(narrow(**tiny).panel(table).spacing) < ELEMENT_SIDE * 0.3e-3 < 0.5 * length
    assert narrow(elements_per_crossover=1).panel(table).lines_per_crossover == 1


@pytest.mark.parametrize("lean", [{"obliquity": 0.5}, {"yaw": 0.3}])
def test_the_fine_mesh_holds_the_path_of_an_oblique_projectile(lean):
    """A shot on the default mesh perforates before its projectile comes to the end of the fine mesh."""
    shot = run_impact(narrow(300.0, projectile=Projectile(**lean), symmetry="whole"))
    (path,) = (one.value for one in shot.checks if one.name == "path over fine mesh")
    assert shot.outcome == "perforated"
    assert 0.5 < path < 1


def test_viscosity_is_split_at_the_last_sample_before_a_failure_is_seen():
    """By hand: yarns are cut from the fourth sample on; without a cut the end counts."""
    energies = {
        "viscous": np.array([0.0, 0.3, 0.7, 1.6, 2.9]),
        "kinetic_projectile": np.array([50.0, 47.0, 43.0, 36.0, 31.0]),
    }
    found = quality.split_viscous(np.array([0.0, 0.0, 0.0, 2.0, 5.0]), energies)
    assert found == pytest.approx((0.7 / 7.0, 2.9 - 0.7))
    assert quality.split_viscous(np.zeros(5), energies) == pytest.approx((2.9 / 19.0, 0.0))


def test_the_path_of_a_pack_is_that_of_the_ply_that_is_left_furthest():
    """A ply without a fine mesh has none, nor has one whose contact does not follow the projectile."""

    def ply(share, sides=(1.0,), follows=True):
        panel = SimpleNamespace(sides=sides, share_of_first_zone=lambda nose: share * nose[0])
        state = SimpleNamespace(projectile_position=np.array([2.0, 0.0, 0.0]))
        return panel, SimpleNamespace(window_follows=follows), state

    plies = [ply(0.31), ply(0.46), ply(0.22), ply(0.9, sides=None), ply(0.8, follows=False)]
    (found,) = quality._path(SimpleNamespace(plies=plies))
    assert found.value == pytest.approx(0.92)
    assert quality._path(SimpleNamespace(plies=plies[3:])) == []


def test_the_default_mesh_is_fine_enough_for_a_narrow_projectile():
    """Elements longer than its radius absorb less than shorter ones do."""
    velocities = (190.0, 240.0, 300.0, 360.0)
    table = narrow().table()
    fine, usual, coarse = (
        [run_impact(narrow(v, elements_per_crossover=n), table=table) for v in velocities]
        for n in (6, None, 1)
    )
    residual = [
        np.array([shot.residual_velocity for shot in shots]) / velocities
        for shots in (fine, usual, coarse)
    ]
    assert abs(residual[1] - residual[0]).max() < 0.03
    assert abs(residual[2] - residual[0]).max() > 0.04
    for shot in coarse:
        beyond = {check.name for check in shot.checks if not check.ok}
        assert beyond == {"element side", "element over failure length"}
    assert all(check.ok for shot in usual for check in shot.checks)
    for shot in usual:
        share, recoil = quality.split_viscous(shot.cut_yarns, shot.energies)
        assert quality.indicator("viscous energy", share) in shot.checks
        assert 0 < recoil < shot.energies["viscous"][-1]


def framed(cuts, metal=True, opening=(0.16, 0.12), plies=4, boundary="clamped"):
    """What the check of the echo looks at of a run whose yarns are cut at `cuts`, {time [us]: yarns so far}."""
    fabric = catalogue.load("S-728").with_effective_density()
    setup = ImpactSetup(fabric, 400.0, opening=opening, plies=plies, boundary=boundary)
    pack = Pack.of(setup.target())
    shot = SimpleNamespace(body="metal" if metal else "rigid", radius=4.5e-3)
    columns = {"t": 1e-6 * np.arange(0, 101, 2.0)}
    columns["cut_yarns"] = np.interp(columns["t"], 1e-6 * np.array(list(cuts)), list(cuts.values()))
    panel = SimpleNamespace(projectile=shot)
    return SimpleNamespace(pack=pack, panel=panel, plies=pack.plies, sample=columns.get), columns


def test_yarns_cut_after_the_echo_of_the_frame_are_counted():
    """S-728 of 96 GPa: 5.6 to 5.9 mm/us along straight yarns, back from the nearer pair of sides, 60 mm away, after
    20 to 22 us."""
    weave = catalogue.load("S-728").with_effective_density().weave
    counts = weave.warp_count, weave.weft_count
    weft = (weave.yarns[1].EA * counts[1] / weave.areal_density) ** 0.5
    late = {0: 0, 18: 0, 20: 3, 40: 3, 60: 11, 100: 12}
    solver, columns = framed(late)
    (found,) = quality._echo(solver, columns["cut_yarns"])
    back = 2 * solver.pack.plies[0].lines()[1][-1] / weft
    assert back == pytest.approx(0.12 / weft, rel=0.03)
    assert back == pytest.approx(21e-6, rel=0.1)
    assert found.value == pytest.approx(9 / 12)
    assert found.doubtful
    assert "cuts go on to 100 us" in found.meaning
    fastest = max(weft, (weave.yarns[0].EA * counts[0] / weave.areal_density) ** 0.5)
    assert f"an opening of {1e3 * fastest * 100e-6:.0f} mm" in found.meaning
    (fragment,) = quality._echo(*with_cuts(framed(late, metal=False)))
    assert (fragment.value, fragment.status) == (found.value, "noted")
    (early,) = quality._echo(*with_cuts(framed({0: 0, 4: 0, 12: 11, 60: 11, 100: 14})))
    assert early.value == pytest.approx(3 / 14)
    assert early.status == "ok"
    for none in (
        framed(late, plies=1),
        framed({0: 0, 100: 0}),
        framed(late, boundary="free", opening=(0.05, 0.04)),
    ):
        assert quality._echo(*with_cuts(none)) == []


def with_cuts(framed_run):
    """The arguments of the check."""
    solver, columns = framed_run
    return solver, columns["cut_yarns"]


def test_mesh_and_echo_are_foreseen():
    fabric = catalogue.load("S-728").with_effective_density()
    bullet = SimpleNamespace(body="metal", radius=4.5e-3)
    read = "weave", "lines", "supports", "spacing", "fabric", "yarn_failure"

    def foreseen(opening, **changes):
        setup = ImpactSetup(fabric, 430.0, opening=opening, plies=3, **changes)
        plies = [
            SimpleNamespace(projectile=bullet, **{name: getattr(ply, name) for name in read})
            for ply in Pack.of(setup.target()).plies
        ]
        found = quality.foresee(SimpleNamespace(plies=plies), 430.0)
        return {one.name for one in found if one.doubtful}

    coarse = ((17, 1), (25, 2), (np.inf, 4))
    assert foreseen(0.15, grading=coarse) == {
        "cut after the echo of the frame",
        "element over failure length",
    }
    assert foreseen(0.3, grading=coarse) == {"element over failure length"}
    assert foreseen(0.15, grading=coarse, yarn_failure=False) == {"cut after the echo of the frame"}
    assert foreseen(0.3, grading=((17, 0.5), (25, 1), (np.inf, 2))) == set()


def test_the_fastest_node_of_a_ply_counts_until_the_ply_tears():
    """Two plies of a pack: the rear one flies ahead, and runs on after it has torn."""
    fabric = catalogue.load("S-728").with_effective_density()
    setup = ImpactSetup(fabric, 400.0, opening=0.03, plies=2, end_time=1e-6, table_size=51)
    solver = PackSolver(setup.target(), 400.0, 1e-6)
    monitor = solver.monitor
    front, rear = solver.states
    front.v[2][7] = 500.0
    rear.v[2][9] = 900.0
    rear.v[0][9] = 2000.0
    monitor.sampled(solver)
    rear.v[2][9] = 1600.0
    front.v[2][7] = 100.0
    solver.stack.ply_failures[1] = 1
    monitor.sampled(solver)
    assert monitor.fastest.tolist() == [500.0, 900.0]
    found = quality.indicator("node ahead of the strike", monitor.fastest.max() / 400.0)
    assert found.doubtful
    assert quality.indicator("node ahead of the strike", 1.9).status == "ok"
