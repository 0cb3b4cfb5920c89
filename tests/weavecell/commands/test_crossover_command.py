"""`weavecell crossover`: the numbers of each case are those of its record, and what it keeps of a failed one."""

import json
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("dolfinx")


from fabrics import catalogue
from fabrics.base.record import Record
from fabrics.plate_curve import PlateCurve
from tests.weavecell.written import table_of
from unitcell3d.cases import load_path, periodic_cell
from unitcell3d.solver.path_following import follow
from weavecell.answers import crossover_result

EXAMPLE = Path(__file__).parents[3] / "examples" / "crossover-path.csv"
CASES = {
    "yarn": "--yarn weft",
    "platens": "--pressure '60 kPa'",
    "biaxial": "--end-displacement '4 um'",
    "path": "--path p.csv",
    "shear": "--shear-angle '12 deg' --end-displacement '4 um' --section conforming",
}
PATH = "# up, back, and the weft slack\nd2 [um], d1 [mm]\n4, 0.004\n-1, 0.002\n"


@pytest.fixture
def run(command, tmp_path):
    """Exit code, outputs, case.json and Record of a case of S-720 on a mesh of 3 x 2 x 2."""

    def called(case, words, path=PATH):
        (tmp_path / "p.csv").write_text(path)
        code, out, err = command(f"crossover {case} S-720 {words} --mesh 3,2,2 --out c --verbose")
        folder = tmp_path / "c"
        return code, out, err, table_of(folder, "case.json"), Record.read(folder / "case.h5")

    return called


@pytest.mark.parametrize("case", CASES)
def test_the_numbers_of_a_case_are_those_of_its_record(run, tmp_path, case):
    code, out, err, content, record = run(case, CASES[case])
    assert code == 0, err
    assert record.failed == "", err
    found = content["found"]
    again = crossover_result.CASES[case].summary(catalogue.load("S-720"), record)
    assert json.loads(json.dumps(again)) == found
    assert all(key in out for key in found)
    if case == "path":
        corner = int(np.argmax(record["d2"]))
        ends = [record[name][row] for name in ("d1", "d2") for row in (corner, -1)]
        assert ends == pytest.approx([4e-6, 2e-6, 4e-6, -1e-6])
    if case == "platens":
        reached = found["pressure at the end [MPa]"]
        assert reached == pytest.approx(0.06, rel=1e-3)
        law = PlateCurve.pressure_law(catalogue.load("S-720").areal_density_measured)
        low, end, high = np.array([law.pressure[0], 1e6 * reached, law.pressure[-1]]) ** (-1 / 3)
        # the closure is linear in P^(-1/3); the law is tabulated at 24 pressures, linear in ln P between: 0.4 % off
        by_law = 1e6 * law.closure[-1] * (low - end) / (low - high)
        assert found["the same by the pressure law (eq. 2-6) [um]"] == pytest.approx(
            by_law, rel=4e-3
        )
    if case == "shear":
        assert found["shear angle reached [rad]"] == pytest.approx(np.radians(12))
        assert found["fabric's data (Table 4-1): gamma1 [rad]"] == 0.24


def test_a_tension_that_no_yarn_bears_is_a_doubt(run):
    """Fibres do not fail on a path of given displacements: S-720 has yarns of 316 N."""
    _, _, _, content, record = run("biaxial", "--end-displacement '34 um'")
    assert record["T1"].max() > 1.05 * 316
    assert "tension beyond the strength" in content["doubts"]
    assert "tension beyond the strength" not in run("biaxial", CASES["biaxial"])[3].get(
        "doubts", ""
    )


def test_a_pressure_that_is_not_reached_is_a_doubt(run):
    content, record = run("platens", "--pressure '2 GPa'")[3:]
    assert record["pressure"][-1] < 1e9
    assert "pressure not reached" in content["doubts"]


def test_a_failed_case_keeps_what_it_computed(run, monkeypatch):
    """How a path comes to fail is of the solver (`test_a_path_that_fails_keeps_its_history`)."""

    def fail(*words, **more):
        return replace(follow(*words, **more), failed="no equilibrium beyond d1 = 0.002 mm")

    monkeypatch.setattr(load_path, "follow", fail)
    code, _, err, content, record = run("path", CASES["path"])
    assert code == 3
    assert err.splitlines()[-1] == "error: no equilibrium beyond d1 = 0.002 mm"
    assert content["failed"] == record.failed == "no equilibrium beyond d1 = 0.002 mm"
    assert len(record["T1"]) == content["rows"] > 2


def test_the_example_of_a_path_is_good():
    assert abs(load_path.read(EXAMPLE)).max() == pytest.approx(20e-6)
    assert f"weavecell crossover path S-720 --path examples/{EXAMPLE.name}" in EXAMPLE.read_text()


@pytest.mark.slow
def test_the_example_of_a_path_runs(run):
    """There and back again: at rest nothing is left."""
    code, _, err, _, record = run("path", f"--path {EXAMPLE}")
    assert code == 0, err
    assert record["T1"].max() > 100
    assert abs(record["T1"][-1] - record["T1"][0]) < 1e-3 * record["T1"].max()


TWILL = 'weave = "twill 2/2"\nname = "t"\nsection = "conforming"\n' + "".join(
    f"""[{family}]
linear_density = "158 tex"
fibre_density = "1.44 g/cm^3"
modulus = "90 GPa"
tenacity = "2000 mN/tex"
failure_strain = "3.3 %"
count = "{count} / cm"
crimp = "{crimp} %"
"""
    for family, count, crimp in (("warp", 7.9, 1.1), ("weft", 7.5, 0.7))
)


def test_a_twill_is_stretched_in_its_own_cell(succeed, command, tmp_path, monkeypatch):
    """Two by two yarns, half of the repeat; one crossover of it, its shear and a crowfoot are refused in a line."""
    monkeypatch.setattr(periodic_cell, "biaxial", partial(periodic_cell.biaxial, rows=1))
    (tmp_path / "t.toml").write_text(TWILL)
    line = "crossover biaxial t.toml --end-displacement '0.1 um' --mesh 3,2,1"
    succeed(f"{line} --domain periodic --out c")
    record = Record.read(tmp_path / "c" / "case.h5")
    assert record.facts["crossings"] == 4
    assert record.failed == ""
    assert record["d_c"].shape == record["T1"].shape
    (tmp_path / "b.toml").write_text(TWILL.replace("twill 2/2", "crowfoot"))
    for words, said in (
        (line, "domain = 'whole': must be periodic: one crossover of a twill 2/2 is no cell of it"),
        (
            f"{line} --domain periodic".replace("t.toml", "b.toml"),
            "FABRIC = 't': is a crowfoot, no symmetry of which turns each yarn round",
        ),
        (
            "crossover shear t.toml --domain periodic",
            "whose cell is solved in biaxial tension alone",
        ),
    ):
        code, _, err = command(f"{words} --out d")
        assert code == 2
        assert said in err
    assert not (tmp_path / "d").exists()
