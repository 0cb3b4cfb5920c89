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
        ({"penalty": 0.02}, {"nose penetration"}),
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
    velocities = (180.0, 240.0, 300.0, 360.0)
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
    assert all(
        {check.name for check in shot.checks if not check.ok} == {"element side"} for shot in coarse
    )
    assert all(check.ok for shot in usual for check in shot.checks)
    for shot in usual:
        share, recoil = quality.split_viscous(shot.cut_yarns, shot.energies)
        assert quality.indicator("viscous energy", share) in shot.checks
        assert 0 < recoil < shot.energies["viscous"][-1]
