"""`weavecell crossover`: its folder and numbers for each case, what it keeps of a failed one, and its errors."""

import json
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("dolfinx")

from fabrics import catalogue
from fabrics.compression import CompressionLaw
from fabrics.friction.pull_out import PullOutLaw
from fabrics.plate_curve import PlateCurve
from unitcell3d.cases import load_path
from unitcell3d.solver.record import Record
from weavecell.commands import crossover as commands_crossover

PATH = "# up, back, and the weft slack\nd2 [um], d1 [mm]\n4, 0.004\n-1, 0.002\n"


def told(folder):
    return json.loads((folder / "case.json").read_text())


def test_yarn_is_pulled_and_reported(command, tmp_path):
    code, out, err = command("crossover", "S-720", "--case", "yarn", "--yarn", "weft", "--mesh", "3,2,2", "--out", "c")
    assert code == 0, err
    folder = tmp_path / "c"
    assert sorted(path.name for path in folder.iterdir()) == ["case.h5", "case.json", "pictures"]
    assert sorted(path.name for path in (folder / "pictures").iterdir()) == ["curve.svg", "deformed.png"]
    content = told(folder)
    assert content["case"] == "yarn weft"
    assert content["found"]["stiffness when taut over E A / (1 + crimp) [-]"] == pytest.approx(1, abs=1e-3)
    assert "commit" in content["provenance"]
    record = Record.read(folder / "case.h5")
    assert record.failed == ""
    assert record["T"][-1] == pytest.approx(content["found"]["greatest tension [N]"])
    assert record.meanings["T"].startswith("[N]")
    assert "strain at which it is straight" in out


def test_path_from_a_file_unloads_and_leaves_yarns_slack(command, tmp_path):
    (tmp_path / "p.csv").write_text(PATH)
    code, _, err = command("crossover", "S-720", "--case", "path", "--path", "p.csv", "--mesh", "3,2,2", "--out", "c")
    assert code == 0, err
    record = Record.read(tmp_path / "c" / "case.h5")
    assert [record["d1"][-1], record["d2"][-1]] == pytest.approx([2e-6, -1e-6])
    corner = int(np.argmax(record["d2"]))
    assert [record["d1"][corner], record["d2"][corner]] == pytest.approx([4e-6, 4e-6])
    assert abs(record["T2"][-1]) < 1e-2 * record["T2"][corner]


def test_plates_stand_beside_the_pressure_law(command, tmp_path):
    options = ("--case", "platens", "--pressure", "60 kPa", "--mesh", "3,2,2")
    code, _, err = command("crossover", "S-720", *options, "--out", "c")
    assert code == 0, err
    found = told(tmp_path / "c")["found"]
    assert found["pressure at the end [MPa]"] == pytest.approx(0.06, rel=1e-3)
    law = PlateCurve.pressure_law(catalogue.load("S-720").areal_density_measured)
    inverse_root = lambda pressure: pressure ** (-1 / 3)  # noqa: E731
    share = (inverse_root(law.pressure[0]) - inverse_root(1e6 * found["pressure at the end [MPa]"])) / (
        inverse_root(law.pressure[0]) - inverse_root(law.pressure[-1])
    )
    expected = 1e6 * share * law.closure[-1]  # the closure is linear in P^(-1/3)
    # the law is tabulated at 24 pressures and interpolated in ln P: up to 0.4 % below the closed form between them
    assert found["the same by the pressure law (eq. 2-6) [um]"] == pytest.approx(expected, rel=4e-3)


def test_shear_tells_its_fit_beside_the_fabrics_data(command, tmp_path):
    options = (
        "--case",
        "shear",
        "--shear-angle",
        "12 deg",
        "--end-displacement",
        "4 um",
        "--mesh",
        "3,2,2",
        "--section",
        "conforming",
    )
    code, out, err = command("crossover", "S-720", *options, "--out", "c")
    assert code == 0, err
    found = told(tmp_path / "c")["found"]
    assert found["shear angle reached [rad]"] == pytest.approx(np.radians(12))
    assert found["fabric's data (Table 4-1): gamma1 [rad]"] == 0.24
    assert "gamma2" in out


def test_a_failed_case_keeps_what_it_computed(command, tmp_path):
    """Crushed in the plane by a third of the cell: no equilibrium, exit code 3, states until then on disk."""
    (tmp_path / "p.csv").write_text("d1 [mm], d2 [mm]\n0.002, 0.002\n-0.2, -0.2\n")
    code, _, err = command("crossover", "S-720", "--case", "path", "--path", "p.csv", "--mesh", "3,2,2", "--out", "c")
    assert code == 3
    assert err.splitlines()[-1].startswith("error: the crossover found no equilibrium")
    content = told(tmp_path / "c")
    assert content["failed"]
    assert len(Record.read(tmp_path / "c" / "case.h5")["T1"]) == content["rows"] > 2


def test_example_path_is_good():
    path = Path(__file__).parents[3] / "examples" / "crossover-path.csv"
    corners = load_path.read(path)
    assert corners.shape == (4, 2)
    assert np.abs(corners).max() == pytest.approx(20e-6)
    assert f"weavecell crossover S-720 --case path --path examples/{path.name}" in path.read_text()


@pytest.mark.slow
def test_example_path_runs(command, tmp_path):
    """There and back again: at rest nothing is left."""
    path = Path(__file__).parents[3] / "examples" / "crossover-path.csv"
    code, _, err = command("crossover", "S-720", "--case", "path", "--path", str(path), "--mesh", "3,2,2", "--out", "c")
    assert code == 0, err
    record = Record.read(tmp_path / "c" / "case.h5")
    assert record["T1"].max() > 100
    assert abs(record["T1"][-1] - record["T1"][0]) < 1e-3 * record["T1"].max()


def test_a_yarn_pulled_out_adds_its_threshold_to_a_law(command, tmp_path):
    CompressionLaw(4.5e-5, 5.8e-5).to_json(tmp_path / "law.json")
    options = ("--case", "pull-out", "--mu", "0.15", "--end-displacement", "5 um,9 um", "--mesh", "3,2,2")
    code, out, err = command("crossover", "S-720", *options, "--law", "law.json", "--out", "c")
    assert code == 0, err
    found = told(tmp_path / "c")["found"]
    law = PullOutLaw.from_json(tmp_path / "law.json")
    assert law.friction == found["Coulomb's coefficient of the contact [-]"] == 0.15
    assert list(law.F_c) == pytest.approx(found["contact forces in slip [N]"])
    assert law.mu_eff == pytest.approx(found["effective coefficient, mu_eff [-]"])
    assert CompressionLaw.from_json(tmp_path / "law.json").a == 4.5e-5
    assert "slip thresholds [N]" in out
    assert (tmp_path / "c" / "pictures" / "curve.svg").exists()


def test_every_case_has_its_parts():
    from weavecell.report import crossover_cases, pictures_crossover

    names = {case.value for case in commands_crossover.Case}
    assert (
        names
        == set(commands_crossover.CASES)
        == set(crossover_cases.SUMMARIES)
        == set(commands_crossover.DOMAINS)
        == set(pictures_crossover.CURVES)
    )
