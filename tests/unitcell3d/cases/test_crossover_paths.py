"""Loading paths of the crossover: symmetry, path independence, failure, plates, and histories that survive."""

from pathlib import Path

import numpy as np
import pytest

from fabrics.errors import InputError
from meshing import crossover as mesher
from unitcell3d.cases import biaxial_and_platens
from unitcell3d.model.crossover import CrossoverModel, Load
from unitcell3d.solver.history import History
from unitcell3d.solver.load_stepping import Steps, solve_load_path
from unitcell3d.solver.newton import Newton


@pytest.fixture(scope="module")
def equibiaxial(coarse, s720):
    return biaxial_and_platens.biaxial(coarse, s720, (1, 1))


def test_quarter_equals_whole(s720, tiny):
    whole = mesher.build(s720, domain="whole", size=(4, 3, 2))
    ends = [biaxial_and_platens.biaxial(mesh, s720, (1, 1), max_displacement=8e-6) for mesh in (tiny, whole)]
    for column in ("T1", "T2", "F_c", "h1", "h2", "d_c"):
        a, b = (getattr(history, column)[-1] for history in ends)
        assert a == pytest.approx(b, rel=1e-6), column
    assert ends[0].F_c[-1] > 1


def test_answer_does_not_depend_on_the_route(s720, tiny):
    """Both at once, one after the other, and back from beyond: the same state to 1e-5."""
    model = CrossoverModel(tiny, s720)
    solver = Newton(model)
    goal = (0.012e-3, 0.012e-3)
    routes = (
        [(0.006e-3, 0.006e-3), goal],
        [(0.006e-3, 0), (0.012e-3, 0), (0.012e-3, 0.006e-3), goal],
        [(0.006e-3, 0.006e-3), (0.012e-3, 0.012e-3), (0.018e-3, 0.018e-3), goal],
    )
    results = []
    for route in routes:
        q, at = np.zeros(model.size), np.zeros(2)
        for target in route:
            for share in np.linspace(0, 1, 7)[1:]:
                found = solver.solve(q, Load(tuple(at + share * (np.array(target) - at))))
                q = found.q
            at = np.array(target)
        results.append([*model.tensions(found.forces), 4 * found.contact])
    solver.close()
    assert min(results[0]) > 5
    assert np.allclose(results[1:], results[0], rtol=1e-5)


def test_contact_is_in_equilibrium_with_the_ends(tiny, s720):
    """The contact force on a yarn is what its end face carries down: the vertical balance of the whole yarn."""
    model = CrossoverModel(tiny, s720)
    solver = Newton(model)
    found = solver.solve(np.zeros(model.size), Load((6e-6, 6e-6)))
    solver.close()
    assert found.contact > 0.1
    for yarn, sign in ((0, -1), (1, 1)):
        end = found.forces[model.constraints.ends[yarn], 2].sum()
        assert end == pytest.approx(sign * found.contact, rel=1e-6)


def test_coarse_numbers_stay(equibiaxial):
    """Stored at the state of equal end displacements 0.0225 mm: the next finer mesh is within 0.1 %.

    The tolerance admits another compiler's rounding through the steps, not another answer.
    """
    at = {c: equibiaxial.at(getattr(equibiaxial, c), equibiaxial.d1, 0.0225e-3) for c in ("T1", "T2", "F_c")}
    assert equibiaxial.failed == ""
    assert at["T1"] == pytest.approx(238.7, rel=3e-3)
    assert at["T2"] == pytest.approx(289.9, rel=3e-3)
    assert at["F_c"] == pytest.approx(87.78, rel=3e-3)


def test_path_ends_at_the_mean_failure_strain_and_tells_both_criteria(equibiaxial, s720):
    mean = equibiaxial.fibre_strain_mean
    assert mean[-1].max() == pytest.approx(0.03, rel=2e-3)
    assert np.all(mean[:-1] < 0.03)
    worst, average = biaxial_and_platens.failure(equibiaxial, s720)
    assert (worst.criterion, average.criterion) == ("worst bar", "mean of bars")
    assert max(worst.d) < max(average.d)
    assert worst.yarn == average.yarn == 1
    # at its failure a yarn carries about its strength, 0.03 E A_s
    assert average.T[1] == pytest.approx(s720.weave.weft.strength, rel=0.02)


def test_tensions_and_contact_grow_along_the_path(equibiaxial):
    for column in (equibiaxial.T1, equibiaxial.T2, equibiaxial.F_c, equibiaxial.d_c):
        assert np.all(np.diff(column[2:]) > 0)


def test_crimp_is_exchanged_when_one_yarn_is_pulled(tiny, s720):
    """Section 4.3.4: warp stretch at fixed weft lowers the warp and raises the weft."""
    h = biaxial_and_platens.biaxial(tiny, s720, (1, 0), max_displacement=0.02e-3)
    assert h.h1[-1] < 0.7 * h.h1[0]
    assert h.h2[-1] > 1.05 * h.h2[0]


def test_plates_press_ever_harder(coarse, s720):
    h = biaxial_and_platens.plate_compression(coarse, s720, pressure=2e6)
    assert h.failed == ""
    pressed = h.F_plate.mean(axis=1)
    assert pressed[-1] == pytest.approx(2e6 * s720.weave.cell_area, rel=3e-3)
    start = np.argmax(pressed > 1e-3)
    assert np.all(np.diff(pressed[start:]) > 0)
    assert np.all(np.diff(h.d_c[start:]) > 0)
    assert abs(h.T1[-1]) < 0.3
    # both plates and the contact between the yarns carry the same load, but for the slack yarns' own stiffness
    assert np.allclose(h.F_plate[-1], h.F_c[-1], rtol=0.05)


def test_a_path_that_fails_keeps_its_history(tiny, s720, tmp_path):
    """A weft pushed to half its length finds no equilibrium; what came before stays, with where and when."""
    model = CrossoverModel(tiny, s720)
    h = solve_load_path(model, Load(), Load((0.0, -0.3e-3)), steps=Steps(least=0.02))
    assert 1 < len(h.path)
    assert h.path[-1] < 1
    assert "element" in h.failed
    assert "d2 = -" in h.failed
    assert np.all(np.isfinite(h.T1))
    h.write(tmp_path / "h.h5")
    again = History.read(tmp_path / "h.h5")
    assert again.failed == h.failed
    assert np.array_equal(again.d_c, h.d_c)
    assert np.array_equal(again.gaps[1], h.gaps[1])


def test_hooks_see_every_step(tiny, s720):
    seen = []
    h = biaxial_and_platens.biaxial(
        tiny, s720, (1, 1), max_displacement=2e-6, hooks=(lambda share, row: seen.append((share, row["T1"])),)
    )
    assert [share for share, _ in seen] == list(h.path[1:])
    assert [T for _, T in seen] == list(h.T1[1:])


def test_memory_is_flat_over_factorisations(tiny, s720):
    """petsc4py keeps factors alive through some wrappers; many systems must not add up."""
    model = CrossoverModel(tiny, s720)
    solver = Newton(model)

    def rounds(n):
        for _ in range(n):
            solver.solve(np.zeros(model.size), Load((2e-6, 2e-6)))
            solver.close()
        resident = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmRSS"))
        return int(resident.split()[1])

    first = rounds(10)
    assert rounds(60) - first < 8000  # KiB; one factorisation of this mesh is about 500
    solver.close()


def test_bad_input_is_one_line(tiny, s720, tmp_path):
    for make, word in (
        (lambda: biaxial_and_platens.biaxial(tiny, s720, (0, -1)), "ratio"),
        (lambda: biaxial_and_platens.biaxial(tiny, s720, "both"), "ratio"),
        (lambda: biaxial_and_platens.biaxial(tiny, s720, (1, 1), max_displacement=-1.0), "max_displacement"),
        (lambda: biaxial_and_platens.plate_compression(tiny, s720, pressure=0.0), "pressure"),
        (lambda: History.read(tmp_path / "none.h5"), "none.h5"),
    ):
        with pytest.raises(InputError, match=word) as caught:
            make()
        assert "\n" not in str(caught.value)
