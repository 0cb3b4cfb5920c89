"""Loading paths of the crossover: symmetry, equilibrium, failure, plates, and histories that survive."""

from pathlib import Path

import numpy as np
import pytest
from equations import loaded
from numpy.testing import assert_array_equal

from fabrics.base.record import Record
from unitcell3d.assembly.linear_solver import DirectSolver
from unitcell3d.cases import biaxial_and_platens
from unitcell3d.cases.biaxial_and_platens import first_reached
from unitcell3d.identify.calibrate import BOTH, PATHS
from unitcell3d.model.crossover import CrossoverModel, Load
from unitcell3d.solver.load_stepping import Steps
from unitcell3d.solver.path_following import follow


@pytest.fixture(scope="module")
def equibiaxial(calibrated):
    return calibrated.found.histories["equibiaxial"]


@pytest.mark.slow(30)
def test_quarter_equals_whole(s720, tiny, whole):
    ends = [
        biaxial_and_platens.biaxial(mesh, s720, (1, 1), max_displacement=8e-6)
        for mesh in (tiny, whole)
    ]
    for column in ("T1", "T2", "F_c", "h1", "h2", "d_c"):
        a, b = (history[column][-1] for history in ends)
        assert a == pytest.approx(b, rel=1e-6), column
    assert ends[0]["F_c"][-1] > 1


def test_contact_is_in_equilibrium_with_the_ends(tiny, s720):
    """The contact force on a yarn is what its end face carries down: the vertical balance of the whole yarn."""
    model = CrossoverModel(tiny, s720)
    solver, found = loaded(model, Load((6e-6, 6e-6)), steps=1)
    solver.close()
    assert found.contact > 0.1
    for yarn, sign in ((0, -1), (1, 1)):
        end = found.forces[model.constraints.ends[yarn], 2].sum()
        assert end == pytest.approx(sign * found.contact, rel=1e-6)


def test_numbers_stay(equibiaxial):
    """Stored at the state of equal end displacements 0.0225 mm: the coarse mesh has 238.7, 289.9 and 87.78 N.

    The tolerance admits another compiler's rounding through the steps, not another answer.
    """
    assert equibiaxial.failed == ""
    for column, stored in (("T1", 238.89), ("T2", 290.16), ("F_c", 86.96)):
        values = equibiaxial[column]
        there = first_reached(values, equibiaxial["d1"], 0.0225e-3)
        assert there == pytest.approx(stored, rel=3e-3)
        assert np.all(np.diff(values[2:]) > 0)


def test_path_ends_at_the_mean_failure_strain_and_tells_both_criteria(equibiaxial, s720):
    mean = equibiaxial["fibre_strain_mean"]
    assert mean[-1].max() == pytest.approx(0.03, rel=2e-3)
    assert np.all(mean[:-1] < 0.03)
    worst, average = biaxial_and_platens.failure(equibiaxial, s720)
    assert worst.criterion == "worst bar"
    assert average.criterion == "mean of bars"
    assert max(worst.d) < max(average.d)
    assert worst.yarn == average.yarn == 1
    # at its failure a yarn carries about its strength, 0.03 E A_s
    assert average.T[1] == pytest.approx(s720.weave.weft.strength, rel=0.02)


def test_both_passes_keep_the_tips_of_the_sections_out(calibrated):
    """Stretched to failure and beyond: no deeper than the penalty lets them; one pass alone left 1.3 um."""
    for name in (*PATHS, BOTH):
        last = calibrated.found.histories[name].last
        for face in ("gaps_warp", "gaps_weft"):
            assert -last[face].min() < 0.85e-6, (name, face)


def test_crimp_is_exchanged_when_one_yarn_is_pulled(tiny, s720):
    """Section 4.3.4: warp stretch at fixed weft lowers the warp and raises the weft; hooks see every step."""
    seen = []
    h = biaxial_and_platens.biaxial(
        tiny,
        s720,
        (1, 0),
        max_displacement=0.02e-3,
        hooks=(lambda share, row: seen.append((share, row["T1"])),),
    )
    assert h["h1"][-1] < 0.7 * h["h1"][0]
    assert h["h2"][-1] > 1.05 * h["h2"][0]
    assert seen == list(zip(h["path"][1:], h["T1"][1:]))


def test_plates_press_ever_harder(calibrated, s720):
    """Up to the highest pressure of the source, 19.4 MPa."""
    h = calibrated.found.plates
    assert h.failed == ""
    pressed = h["F_plate"].mean(axis=1)
    assert pressed[-1] == pytest.approx(7000 / 0.019**2 * s720.weave.cell_area, rel=3e-3)
    start = np.argmax(pressed > 1e-3)
    assert np.all(np.diff(pressed[start:]) > 0)
    assert np.all(np.diff(h["d_c"][start:]) > 0)
    # both plates and the contact between the yarns carry the same load, but for the slack yarns' own stiffness
    assert abs(h["T1"][-1]) < 0.3
    assert h["F_plate"][-1] == pytest.approx(h["F_c"][-1], rel=5e-3)


def test_a_path_that_fails_keeps_its_history(tiny, s720, tmp_path):
    """A weft pushed to half its length finds no equilibrium; what came before stays, with where and when."""
    model = CrossoverModel(tiny, s720)
    corners = [Load(), Load((0.0, -0.3e-3))]
    h = follow(model, corners, biaxial_and_platens.row(model), steps=Steps(least=0.04))
    assert 1 < len(h["path"])
    assert h["path"][-1] < 1
    assert "element" in h.failed
    assert "d2 = -" in h.failed
    assert np.all(np.isfinite(h["T1"]))
    h.write(tmp_path / "h.h5")
    again = Record.read(tmp_path / "h.h5")
    assert again.failed == h.failed
    assert_array_equal(again["d_c"], h["d_c"])
    assert_array_equal(again.last["gaps_weft"], h.last["gaps_weft"])


def test_a_path_that_stops_just_before_its_end_comes_to_an_end(tiny, s720):
    """The last step was laid out to the end again and again: the weft of S-731, which fails at 0.995 of its path."""
    asked = []

    def stop(row):
        asked.append(row["path"])
        assert len(asked) < 60, "the same step for ever"
        return row["path"] / 0.995

    model = CrossoverModel(tiny, s720)
    corners = [Load(), Load((5e-6, 5e-6))]
    history = follow(model, corners, biaxial_and_platens.row(model), stop=stop)
    assert history.failed == ""
    assert abs(history["path"][-1] - 0.995) < 0.002


def test_memory_is_flat_over_factorisations(tiny, s720):
    """petsc4py keeps factors alive through some wrappers; many systems must not add up."""
    model = CrossoverModel(tiny, s720)
    model.forces(np.zeros(model.size), Load())
    model.system(np.zeros(model.size), Load())
    system = model.pattern.starts, model.pattern.columns, model.pattern.entries

    def rounds(n):
        for _ in range(n):
            solver = DirectSolver(*system)
            solver.factor()
            assert solver.solve(np.ones(model.size)) is not None
            solver.close()
        resident = next(
            line
            for line in Path("/proc/self/status").read_text().splitlines()
            if line.startswith("VmRSS")
        )
        return int(resident.split()[1])

    first = rounds(10)
    assert rounds(60) - first < 8000  # KiB; one factorisation of this mesh is about 500
