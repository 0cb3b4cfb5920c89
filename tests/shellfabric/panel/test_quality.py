"""Quality indicators, and the energy guard between audits."""

from dataclasses import replace

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.errors import UnstableError
from shellfabric.cell.model import CellModel
from shellfabric.impact import simulation
from shellfabric.panel import quality
from shellfabric.panel.model import Numerics, Panel
from shellfabric.panel.quality import Indicator
from shellfabric.panel.quality_kernels import alternation
from shellfabric.plies.model import Pack
from shellfabric.projectile.projectile import Projectile
from shellfabric.solver.pack_solver import PackSolver
from validation.models.variants import with_law_form
from validation.verification.stability import shots


@pytest.fixture(scope="module")
def panel():
    return Panel(shots.table(), (0.05, 0.05), numerics=Numerics(threads=1))


def names(solver):
    return {one.name for one in quality.of_solver(solver) if not one.ok}


def inject(solver, step, factor):
    """Let the nodes' velocities be `factor` times as large after `step` steps, unseen by hooks."""
    advance = solver.advance

    def spoiled(history):
        left = step - solver.steps
        if not 0 < left <= len(history):
            return advance(history)
        made, reason = advance(history[:left])
        if reason:
            return made, reason
        for _, _, state in solver.parts:
            for component in state.v:
                component *= factor
        more, reason = advance(history[left:])
        return made + more, reason

    solver.advance = spoiled


class TestGuard:
    """An energy error is found soon after it arises, not at the next audit: here there is none before the end."""

    @pytest.mark.parametrize(("plies", "velocity", "end", "step"), [(1, 92.5, 60e-6, 150), (2, 150.0, 40e-6, 80)])
    def test_an_injected_error_is_found_with_place_and_step(self, panel, plies, velocity, end, step):
        solver = PackSolver(Pack.stacked(panel, plies), velocity, end, interval=end)
        inject(solver, step, 3.0)
        where = r"node \(\d+, \d+\)" if plies == 1 else ""
        with pytest.raises(UnstableError, match=f"energy balance is off by .* {where}.* after .* \\(step"):
            solver.run()
        assert step < solver.steps < 0.7 * solver.last_step
        assert solver.checks > 0
        assert sum(map(len, solver.step_history)) == solver.steps  # what was computed is kept

    def test_an_instability_is_caught_while_it_is_small(self):
        """1.6 times the allowed step: energy grows by orders within an interval between audits."""
        panel = Panel(
            shots.table(), (0.1, 0.1), numerics=shots.Beyond(cfl=1.6, threads=1), failure=False,
        )  # fmt: skip
        solver = PackSolver(panel, 92.5, 100e-6, interval=100e-6)
        with pytest.raises(UnstableError, match=r"\(step \d+\)"):
            solver.run()
        assert np.isfinite(solver.samples[-1]).all()
        assert solver.sample("kinetic_fabric")[-1] < 2 * solver.strike_energy


class TestIndicators:
    def test_the_default_is_ok(self, panel):
        solver = PackSolver(panel, 92.5, 40e-6).run()
        assert names(solver) == set()

    @pytest.mark.parametrize(
        ("knobs", "expected"),
        [
            ({"stretch_viscosity": 0.0}, "tension oscillation"),
            ({"penalty": 0.02}, "nose penetration"),
            ({"contact_points": 2}, "contact point spacing"),
            ({"cfl": 1.2}, "time step"),
        ],
    )
    def test_what_a_knob_spoils(self, knobs, expected):
        panel = Panel(shots.table(), (0.1, 0.1), numerics=shots.Beyond(threads=1, **knobs), failure=False)
        assert names(PackSolver(panel, 92.5, 100e-6).run()) == {expected}

    def test_a_printed_law(self, panel):
        table = CellModel(with_law_form(panel.fabric, "printed")).table(51)
        assert {one.name for one in quality.of_cell(table, (10.0, 10.0)) if not one.ok} == {"swelling under contact"}

    def test_a_law_beyond_its_fit(self, panel):
        fabric = panel.fabric
        for highest, ok in ((1e-3, False), (1e6, True)):
            laws = tuple(replace(law, F_range=(0.0, highest)) for law in fabric.laws)
            table = CellModel(fabric, laws).table(51)
            assert all(one.ok for one in quality.of_cell(table, (100.0, 100.0))) == ok

    def test_alternation_of_a_known_wave(self):
        """Tensions 10 +- 1 N from node to node: the alternation is a tenth; a smooth slope has none."""
        found, i = np.zeros(2), np.arange(1600)
        alternation(10.0 + (-1.0) ** i, 0, 1, 400, 400, 0.0, found)
        assert np.sqrt(found[0] / found[1]) == pytest.approx(0.1, rel=0.02)
        found = np.zeros(2)
        alternation(20.0 - 0.01 * (i % 400), 0, 1, 400, 400, 0.0, found)
        assert found[0] == pytest.approx(0.0, abs=1e-12)
        assert found[1] > 0

    def test_a_number_that_is_not_finite_is_not_ok(self):
        assert not Indicator("x", float("nan"), 1.0).ok
        assert Indicator("x", float("nan"), 1.0).excess == float("inf")

    @pytest.mark.parametrize(
        ("value", "number"),
        [(1.0, "1.00"), (1.00042, "1.0004"), (1.014, "1.01"), (12.345, "12.35"), (0.00231, "0.00231"), (0.3, "0.300"),
         (float("nan"), "nan")],
    )  # fmt: skip
    def test_a_number_beyond_its_limit_is_printed_beyond_it(self, value, number):
        assert str(Indicator("x", value, 1.0)) == f"x {number} (limit 1)"

    def test_the_worst_of_several_runs(self):
        one, two = (Indicator("x", value, 1.0) for value in (0.5, 2.0))
        assert quality.worst([(one,), (two,)]) == (two,)


class TestDefaultMesh:
    """Elements longer than the projectile's radius absorb less than shorter ones do."""

    @staticmethod
    def setup(velocity=300.0, **changes):
        shot = Projectile(mass=0.44e-3, radius=1.06e-3)  # 1.2 times as long an element of one crossover
        return simulation.ImpactSetup(
            catalogue.load("S-720").with_effective_density(), velocity, projectile=shot, opening=0.06, end_time=100e-6,
            table_size=51, numerics=Numerics(threads=1), **changes,
        )  # fmt: skip

    def test_follows_the_projectile(self):
        table = self.setup().table()
        panel = self.setup().panel(table)
        assert panel.elements_per_crossover == 2
        assert max(panel.spacing) < simulation.ELEMENT_SIDE * panel.projectile.radius
        assert self.setup(elements_per_crossover=1).panel(table).elements_per_crossover == 1
        assert self.setup(grading=((16, 1), (np.inf, 2))).panel(table).elements_per_crossover == 1
        assert replace(self.setup(), projectile=Projectile()).panel(table).elements_per_crossover == 1

    def test_is_fine_enough_for_a_narrow_projectile(self):
        velocities, table = (180.0, 240.0, 300.0, 360.0), self.setup().table()
        fine, usual, one = (
            [simulation.run(self.setup(v, elements_per_crossover=n), table=table) for v in velocities]
            for n in (3, None, 1)
        )
        residual = [np.array([run.residual_velocity for run in runs]) / velocities for runs in (fine, usual, one)]
        assert np.abs(residual[1] - residual[0]).max() < 0.03
        assert np.abs(residual[2] - residual[0]).max() > 0.04
        assert all({check.name for check in run.checks if not check.ok} == {"element side"} for run in one)
        assert all(check.ok for run in usual for check in run.checks)
