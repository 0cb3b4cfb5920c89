"""Equilibria at given pressures: derivatives against differences, and the same from a neighbour as from rest."""

import numpy as np
import pytest

from fabrics.errors import UnstableError
from meshing import crossover as mesher
from unitcell3d.identify.platen_states import LEVEL, PlatenSolver
from unitcell3d.identify.solid_record import with_solid_laws

SIZE = (4, 3, 2)
PRESSURE = np.geomspace(1e5, 5e6, 5)


@pytest.fixture
def solver(s720):
    mesh = mesher.build(s720, size=SIZE)
    found = PlatenSolver(mesh, s720, lambda x: with_solid_laws(s720, x, max(mesh.Vf0)), PRESSURE)
    yield found
    found.close()


X = np.log([2e9, 0.3, 0.02])


def test_equilibria_lie_beside_their_pressures_and_are_kept(solver):
    found = solver.at(X)
    assert found.failed == ""
    assert np.abs(np.log(found.pressure / PRESSURE)).max() < LEVEL
    assert np.all(np.diff(found.closures(PRESSURE)) > 0)
    assert solver.at(X.copy()) is found


def test_the_jacobian_is_the_change_from_trial_to_trial(solver):
    """Closures at fixed pressures: central differences of 1 % in each constant, from equilibria of their own."""
    J = solver.at(X).jacobian(PRESSURE)
    for k, unit in enumerate(np.eye(3)):
        ends = [solver.at(X + s * 0.01 * unit).closures(PRESSURE) for s in (-1, 1)]
        assert J[:, k] == pytest.approx((ends[1] - ends[0]) / 0.02, rel=0.1, abs=0.2e-6)
    assert solver.loaded == 1


def test_a_trial_is_the_same_from_a_neighbour_as_from_rest(solver, s720):
    solver.at(X)
    near = solver.at(X + np.array([-0.5, 0.2, 0.3]))
    assert solver.loaded == 1
    alone = PlatenSolver(solver.model.crossover, s720, solver._with, PRESSURE)
    rested = alone.at(near.x)
    alone.close()
    # ln P is straight over the LEVEL / 2 that equilibria lie from their pressures to 0.5 um
    assert near.closures(PRESSURE) == pytest.approx(rested.closures(PRESSURE), abs=0.5e-6)


def test_platens_that_no_yarn_meets(solver, monkeypatch):
    monkeypatch.setattr("unitcell3d.identify.platen_states.LEAST_DISTANCE", 0.99)
    with pytest.raises(UnstableError, match=r"platens are at 0\.99"):
        solver.at(X)
