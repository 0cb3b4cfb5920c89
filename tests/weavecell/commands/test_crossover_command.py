"""`weavecell crossover`: the numbers of each case, and what it keeps of a failed one; a pull-out is a session's run."""

import json
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("dolfinx")

from fabrics import catalogue
from fabrics.plate_curve import PlateCurve
from unitcell3d.cases import load_path
from unitcell3d.solver.record import Record
from weavecell.commands import crossover as commands_crossover
from weavecell.report import crossover_cases, pictures_crossover

EXAMPLE = Path(__file__).parents[3] / "examples" / "crossover-path.csv"


@pytest.fixture
def run(command, tmp_path):
    """Exit code, outputs, case.json and Record of a case of S-720 on a mesh of 3 x 2 x 2."""

    def called(*words, path=None):
        if path is not None:
            (tmp_path / "p.csv").write_text(path)
        code, out, err = command("crossover", "S-720", "--case", *words, "--mesh", "3,2,2", "--out", "c")
        content = json.loads((tmp_path / "c" / "case.json").read_text())
        return code, out, err, content, Record.read(tmp_path / "c" / "case.h5")

    return called


def test_a_yarn_that_is_pulled_has_its_stiffness_when_taut(run):
    code, out, err, content, record = run("yarn", "--yarn", "weft")
    assert (code, content["case"], record.failed) == (0, "yarn weft", ""), err
    found = content["found"]
    assert found["stiffness when taut over E A / (1 + crimp) [-]"] == pytest.approx(1, abs=1e-3)
    assert record["T"][-1] == pytest.approx(found["greatest tension [N]"])
    assert record.meanings["T"].startswith("[N]")
    assert "strain at which it is straight" in out


def test_a_path_from_a_file_unloads_and_leaves_yarns_slack(run):
    path = "# up, back, and the weft slack\nd2 [um], d1 [mm]\n4, 0.004\n-1, 0.002\n"
    code, _, err, _, record = run("path", "--path", "p.csv", path=path)
    assert code == 0, err
    corner = int(np.argmax(record["d2"]))
    ends = [record[name][row] for name in ("d1", "d2") for row in (corner, -1)]
    assert ends == pytest.approx([4e-6, 2e-6, 4e-6, -1e-6])
    assert abs(record["T2"][-1]) < 1e-2 * record["T2"][corner]


def test_plates_stand_beside_the_pressure_law(run):
    code, _, err, content, _ = run("platens", "--pressure", "60 kPa")
    assert code == 0, err
    reached, by_law = (content["found"][key] for key in (
        "pressure at the end [MPa]", "the same by the pressure law (eq. 2-6) [um]"))  # fmt: skip
    assert reached == pytest.approx(0.06, rel=1e-3)
    law = PlateCurve.pressure_law(catalogue.load("S-720").areal_density_measured)
    low, end, high = np.array([law.pressure[0], 1e6 * reached, law.pressure[-1]]) ** (-1 / 3)
    # the closure is linear in P^(-1/3); the law is tabulated at 24 pressures and interpolated in ln P: up to 0.4 % off
    assert by_law == pytest.approx(1e6 * law.closure[-1] * (low - end) / (low - high), rel=4e-3)


def test_shear_tells_its_fit_beside_the_fabrics_data(run):
    words = ("--shear-angle", "12 deg", "--end-displacement", "4 um", "--section", "conforming")
    code, out, err, content, _ = run("shear", *words)
    assert code == 0, err
    assert content["found"]["shear angle reached [rad]"] == pytest.approx(np.radians(12))
    assert content["found"]["fabric's data (Table 4-1): gamma1 [rad]"] == 0.24
    assert "gamma2" in out


def test_a_failed_case_keeps_what_it_computed(run):
    """Crushed in the plane by a third of the cell: no equilibrium, exit code 3, states until then on disk."""
    code, _, err, content, record = run("path", "--path", "p.csv", path="d1 [mm], d2 [mm]\n0.002, 0.002\n-0.2, -0.2\n")
    assert code == 3
    assert err.splitlines()[-1].startswith("error: the crossover found no equilibrium")
    assert content["failed"]
    assert len(record["T1"]) == content["rows"] > 2


def test_the_example_of_a_path_is_good():
    corners = load_path.read(EXAMPLE)
    assert corners.shape == (4, 2)
    assert np.abs(corners).max() == pytest.approx(20e-6)
    assert f"weavecell crossover S-720 --case path --path examples/{EXAMPLE.name}" in EXAMPLE.read_text()


@pytest.mark.slow
def test_the_example_of_a_path_runs(run):
    """There and back again: at rest nothing is left."""
    code, _, err, _, record = run("path", "--path", EXAMPLE)
    assert code == 0, err
    assert record["T1"].max() > 100
    assert abs(record["T1"][-1] - record["T1"][0]) < 1e-3 * record["T1"].max()


def test_every_case_has_its_parts():
    names = {case.value for case in commands_crossover.Case}
    parts = commands_crossover.CASES, crossover_cases.SUMMARIES, commands_crossover.DOMAINS, pictures_crossover.CURVES
    assert all(names == set(part) for part in parts)
