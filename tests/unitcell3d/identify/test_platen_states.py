"""Equilibria at given pressures: derivatives against differences, and the same from a neighbour as from rest."""

import numpy as np
import pytest

from fabrics.base.errors import UnstableError
from unitcell3d.identify.platen_states import LEVEL, PlatenSolver
from unitcell3d.identify.solid_record import with_solid_laws

PRESSURE = np.geomspace(1e5, 5e6, 5)
X = np.log([2e9, 0.3, 0.02])


@pytest.fixture(scope="module")
def opened(tiny, s720):
    """A function that opens a solver; all are closed at the end."""
    solvers = []

    def another():
        solvers.append(
            PlatenSolver(tiny, s720, lambda x: with_solid_laws(s720, x, max(tiny.Vf0)), PRESSURE)
        )
        return solvers[-1]

    yield another
    for solver in solvers:
        solver.close()


@pytest.fixture(scope="module")
def solver(opened):
    return opened()


def test_equilibria_lie_beside_their_pressures_and_their_jacobian_is_the_change_from_trial_to_trial(
    solver,
):
    """Closures at fixed pressures: central differences of 1 % in each constant, from equilibria of their own."""
    found = solver.at(X)
    assert found.failed == ""
    assert abs(np.log(found.pressure / PRESSURE)).max() < LEVEL
    assert np.all(np.diff(found.closures(PRESSURE)) > 0)
    assert solver.at(X.copy()) is found
    J = found.jacobian(PRESSURE)
    for k, unit in enumerate(np.eye(3)):
        ends = [solver.at(X + s * 0.01 * unit).closures(PRESSURE) for s in (-1, 1)]
        assert J[:, k] == pytest.approx((ends[1] - ends[0]) / 0.02, rel=0.1, abs=0.2e-6)
    assert solver.loaded == 1


def test_a_trial_is_the_same_from_a_neighbour_as_from_rest(solver, opened):
    solver.at(X)
    near = solver.at(X + np.array([-0.5, 0.2, 0.3]))
    assert solver.loaded == 1
    # ln P is straight over the LEVEL / 2 that equilibria lie from their pressures to 0.5 um
    assert near.closures(PRESSURE) == pytest.approx(
        opened().at(near.x).closures(PRESSURE), abs=0.5e-6
    )


def test_platens_that_no_yarn_meets(opened, monkeypatch):
    monkeypatch.setattr("unitcell3d.identify.platen_states.LEAST_DISTANCE", 0.99)
    with pytest.raises(UnstableError, match=r"platens are at 0\.99"):
        opened().at(X)
