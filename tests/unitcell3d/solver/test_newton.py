"""Newton's method with updates between factorisations: the same states, fewer tangents, no cycles."""

import numpy as np
import pytest
from equations import loaded
from numpy.testing import assert_allclose

from fabrics.base.errors import UnstableError
from unitcell3d.assembly.linear_solver import DirectSolver
from unitcell3d.model.crossover import CrossoverModel, Load
from unitcell3d.solver import newton
from unitcell3d.solver.load_stepping import Steps, continue_to, rest_state


@pytest.fixture
def tangents(monkeypatch):
    """Counts factorisations, those of steps that fail included."""
    taken = []
    factor = DirectSolver.factor
    monkeypatch.setattr(DirectSolver, "factor", lambda solver: (taken.append(1), factor(solver)))
    return taken


def _loaded(tiny, s720, monkeypatch, near):
    """Forces (T1, T2, F_c) at four loads from taut to tauter."""
    monkeypatch.setattr(newton, "NEAR", near)
    model = CrossoverModel(tiny, s720)
    first = Load((8e-6, 8e-6))
    last = Load((20e-6, 20e-6))
    solver, start = loaded(model, first)
    found = [
        state for _, state in continue_to(model, solver, start.q, first, last, np.linspace(0, 1, 9))
    ]
    solver.close()
    return np.array([[*model.tensions(state.forces), 4 * state.contact] for state in found])


def test_updates_change_no_state_and_save_tangents(tiny, s720, monkeypatch, tangents):
    """Both ways end at |r| <= 1e-8 of the forces."""
    plain = _loaded(tiny, s720, monkeypatch, near=0.0)
    without = len(tangents)
    tangents.clear()
    updated = _loaded(tiny, s720, monkeypatch, near=1e-2)
    assert_allclose(updated, plain, rtol=1e-7)
    assert len(tangents) < 0.8 * without


def test_broyden_update_is_the_secant_one():
    """The step from stored steps is -B^-1 r with B built up by Broyden's rank-one updates as matrices."""
    random = np.random.default_rng(1)
    B = np.eye(6) + 0.2 * random.normal(size=(6, 6))
    first = B.copy()
    x = random.normal(size=6)
    taken = []

    def residual(x):
        return x + 0.3 * np.sin(x) + 0.1 * x[::-1] ** 2

    r = residual(x)
    for _ in range(4):
        step = newton._corrected(-np.linalg.solve(first, r), taken)
        assert np.allclose(step, -np.linalg.solve(B, r))
        after = residual(x + step)
        B = B + np.outer(after - r - B @ step, step) / (step @ step)
        taken.append(step)
        x = x + step
        r = after


def test_a_step_that_overshoots_is_shortened(tiny, s720):
    """To where the residual no longer pulls back; whole steps across a slack kink went round in cycles."""
    model = CrossoverModel(tiny, s720)
    load = Load((2e-6, 8e-6))
    solver, state = loaded(model, load)
    q = state.q
    astray = 1e-11 * np.random.default_rng(0).normal(size=model.size)
    # beyond equilibrium, on this side, and away from it
    for times, share in (
        (-8.0, 1 / 8),
        (-0.5, 1.0),
        (8.0, 1.0),
    ):
        state = solver._evaluate(q + astray, load)
        pull = -(state.residual @ (times * astray))
        found, kept = solver._move(state, times * astray, load)
        assert kept == pytest.approx(share, rel=0.6 if share < 1 else 0)
        left = found.residual @ (times * astray)
        assert times > 0 or left <= newton.OVERSHOT * pull
    solver.close()


def test_a_kink_met_from_its_soft_side_is_found():
    """1 N/m up to 0.9 of the step, 1e4 N/m from there on: false position alone creeps along the soft side."""

    class Kinked(newton.Newton):
        def _evaluate(self, q, load):
            r = np.array([q[0] - 1.0 + 1e4 * max(q[0] - 0.9, 0.0)])
            return newton.Equilibrium(q, None, r, 0.0, np.zeros(2), abs(r[0]), 1.0)

    solver = Kinked(model=None)
    state = solver._evaluate(np.zeros(1), None)
    step = np.ones(1)
    found, share = solver._along(state, step, solver._evaluate(step, None), None)
    assert abs(found.residual[0]) < newton.OVERSHOT
    assert 0.5 < share < 0.91


def test_trials_along_a_step_stay_between_what_pulls_on_and_what_pulls_back():
    """0.1 N/m up to 0.9 of the step, so that no trial before the kink ends the search; they halve the way to it."""
    tried = []

    class Kinked(newton.Newton):
        def _evaluate(self, q, load):
            tried.append(q[0])
            r = np.array([0.1 * q[0] - 1.0 + 1e4 * max(q[0] - 0.9, 0.0)])
            return newton.Equilibrium(q, None, r, 0.0, np.zeros(2), abs(r[0]), 1.0)

    solver = Kinked(model=None)
    state = solver._evaluate(np.zeros(1), None)
    step = np.ones(1)
    end = solver._evaluate(step, None)
    tried.clear()
    _, share = solver._along(state, step, end, None)
    assert tried == pytest.approx([0.1, 0.55, 0.595, 0.7975, 0.81775])
    assert share == tried[-1]


def test_linear_guess_follows_the_load(tiny, s720):
    """Halving the load's step divides what the guess leaves by four."""
    model = CrossoverModel(tiny, s720)
    here = Load((15e-6, 15e-6))
    there = Load((15.4e-6, 15.4e-6))
    assert newton.Newton(model).linear_guess(np.zeros(model.size), Load(), here) is None
    solver, state = loaded(model, here)
    q = state.q
    model.forces(q, here)
    model.system(q, here)
    solver._solver.factor()
    left = []
    for share in (1.0, 0.5):
        load = here.towards(there, share)
        left.append(solver._evaluate(solver.linear_guess(q, here, load), load).norm)
    held = solver._evaluate(q, there).norm
    solver.close()
    assert left[0] < 0.05 * held
    assert left[0] / left[1] == pytest.approx(4, rel=0.3)


def test_compression_is_measured_by_the_plates(tiny, s720):
    """Pressed yarns are slack: their tensions are a few thousandths of the plates' force, which sets the scale."""
    model = CrossoverModel(tiny, s720)
    solver = newton.Newton(model)
    rest = model.plates.at_rest
    q = rest_state(model, solver, Load(plates=rest)).q
    *_, (_, found) = continue_to(
        model, solver, q, Load(plates=rest), Load(plates=0.7 * rest), np.linspace(0.1, 1, 10)
    )
    state = solver._evaluate(found.q, Load(plates=0.7 * rest))
    solver.close()
    ends = [abs(model.constraints.end_force(state.forces, yarn)) for yarn in (0, 1)]
    assert max(ends) < 0.2 * found.plates.max()
    assert state.scale == pytest.approx(max(*found.plates, found.contact))
    assert state.norm <= 1e-8 * state.scale


def test_where_there_is_no_equilibrium_the_least_step_says_so(tiny, s720):
    """Loads beyond a third of the way are refused: steps are halved down to the least, and end there."""

    class Refusing(newton.Newton):
        def solve(self, q, load, tolerance=newton.TOLERANCE):
            asked.append(load.d[0] / 3e-6)
            if load.d[0] > 1e-6:
                self._refuse("no way", q, load)
            return super().solve(q, load, tolerance)

    model = CrossoverModel(tiny, s720)
    asked = []
    solver = Refusing(model)
    with pytest.raises(UnstableError, match=r"no way, at .* element .*, d1 = "):
        list(continue_to(model, solver, np.zeros(model.size), Load(), Load((3e-6, 0.0)), [1.0]))
    assert min(share for share in asked if share > 1 / 3) - 1 / 3 < 2 * Steps().least
    with pytest.raises(UnstableError, match="the first guess"):
        solver.solve(np.full(model.size, np.nan), Load())
    solver.close()
