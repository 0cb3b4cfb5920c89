"""Loads of a crossover along tests, trial after trial: against a path from rest, and their derivatives against
differences."""

import numpy as np
import pytest

from unitcell3d.cases.biaxial_and_platens import biaxial
from unitcell3d.identify import biaxial_states
from unitcell3d.identify.biaxial_states import BiaxialSolver, PulledTest
from unitcell3d.identify.solid_record import with_solid_laws
from unitcell3d.material.numerics import Numerics

X = np.log([1.1e9, 0.2, 0.03])


@pytest.fixture(scope="module")
def made(s720, meshed):
    mesh = meshed(size=(2, 2, 2))
    strain = np.linspace(0, 1, 13)[:, None] * [0.014, 0.009]
    # off the line by as much as strains scatter
    strain[5] += [-6e-4, 9e-4]
    test = PulledTest("one", strain, np.zeros_like(strain))

    def with_constants(x):
        return with_solid_laws(s720, x, max(mesh.Vf0))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(biaxial_states, "STATIONS", 6)
        solver = BiaxialSolver(mesh, s720, with_constants, [test])
        loads, slopes = solver.loads(X)[0]
        moved = [solver.loads(X + s * step)[0][0] for step in 0.02 * np.eye(3) for s in (-1, 1)]
        found = mesh, with_constants, test, loads, slopes, moved, solver.loaded
        solver.close()
    return found


def test_derivatives_are_those_of_trials_beside_it(made):
    *_, loads, slopes, moved, loaded = made
    assert loaded == 1  # the others began with the first one's equilibria
    for k in range(3):
        change = (moved[2 * k + 1] - moved[2 * k]) / 0.04
        assert abs(change).max() > 1e-3 * loads.max()
        # at the stations; between them stand cubics
        assert slopes[::2, :, k] == pytest.approx(change[::2], abs=5e-3 * abs(change).max())


def path_to(mesh, fabric, d):
    return biaxial(
        mesh,
        fabric,
        d,
        max_displacement=float(max(d)),
        numerics=Numerics(fibre_fraction="mesh"),
    )


def test_loads_are_those_of_a_path_from_rest(made, s720):
    mesh, with_constants, test, loads, *_ = made
    end = test.end * s720.weave.w
    path = path_to(mesh, with_constants(X), end)
    for m, name in enumerate(("T1", "T2")):
        along = np.interp(test.along, path["d1"] / end[0], path[name])
        on_line = np.arange(13) != 5
        # straight lines between the steps of the path, cubics between stations
        assert loads[on_line, m] == pytest.approx(along[on_line], abs=0.015 * along.max())


def test_what_a_strain_is_off_the_line_counts(made, s720):
    """As of a path that leads to it; without it the load would be another."""
    mesh, with_constants, test, loads, *_ = made
    path = path_to(mesh, with_constants(X), test.strain[5] * s720.weave.w)
    others = np.arange(13) != 5
    on_line = [np.interp(test.along[5], test.along[others], column[others]) for column in loads.T]
    away = np.array([path["T1"][-1], path["T2"][-1]]) - on_line
    assert abs(away[1]) > 0.02 * loads[-1, 1]
    assert loads[5] - on_line == pytest.approx(away, abs=0.4 * abs(away[1]))
