"""Tests of a laboratory: read from a table, and their statistics."""

import json

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import weavecell as wc
from weavecell.runs import laboratory_tests
from weavecell.studies import protocol

TABLE = """# a pack, made up
outcome, velocity [km/h], residual velocity [m/s]
PP, 360,
CP, 432, 40
complete, 468, 70
stopped, 396, 0
perforated, 504,
"""


def read(folder, text):
    (folder / "tests.csv").write_text(text)
    return laboratory_tests.read(folder / "tests.csv")


def test_a_table_is_read_in_any_unit_and_order(tmp_path):
    found = read(tmp_path, TABLE)
    assert_allclose(found["velocity"], [100, 120, 130, 110, 140])
    assert [name[0] for name in found["outcome"]] == ["s", "p", "p", "s", "p"]
    assert_array_equal(found["residual velocity"], [0, 40, 70, 0, np.nan])


def test_v50_of_tests_lies_between_the_fastest_stop_and_the_slowest_perforation(tmp_path):
    """110 m/s, stopped, and 120 m/s, perforated."""
    summary = laboratory_tests.reduce(read(tmp_path, TABLE)).summary()
    low, high = summary["tested_v50_interval_m_s"]
    assert summary["tested_v50_m_s"] == pytest.approx(115.0, rel=0.01)
    assert low < 115 < high


def test_too_few_perforations_determine_no_lambert_jonas_curve(tmp_path):
    tests = laboratory_tests.reduce(read(tmp_path, TABLE))
    assert tests.lambert_jonas.words() == (
        "not determined, because 1 of 3 perforations have no residual velocity"
    )


def test_the_v50_that_laboratories_state(tmp_path):
    """430 PP, 445 PP, 452 CP, 455 PP, 470 CP, 480 CP: by hand 2732 / 6 ft/s within 50 ft/s."""
    fired = "velocity [ft/s], outcome\n430,PP\n445,PP\n452,CP\n455,PP\n470,CP\n480,CP\n"
    tests = read(tmp_path, fired)
    found = laboratory_tests.reduce(tests).six_shots
    assert found.velocity == pytest.approx(2732 / 6 * 0.3048)
    assert found.spread == pytest.approx(50 * 0.3048)
    assert found.met == 60


@pytest.mark.parametrize("spread, met", [(60.0, 60), (60.5, 90), (125.0, 125), (126.0, None)])
def test_the_spread_of_the_standard_that_six_shots_meet(spread, met):
    feet = np.array([0.0, 0.0, 0.0, spread, spread, spread]) + 1000.0
    found = protocol.six_shots(0.3048 * feet, feet > 1000.0)
    assert found.met == met
    assert found.velocity == pytest.approx(0.3048 * (1000.0 + spread / 2))
    few = protocol.six_shots([100.0, 110.0, 120.0], [False, True, True])
    assert few.words().endswith("not determined, because 1 shot stopped and 2 perforated")


def test_tests_are_reduced_to_a_folder(succeed, tmp_path):
    (tmp_path / "tests.csv").write_text(TABLE)
    out = succeed("reduce", "tests", "tests.csv", "--out", "r")
    assert sorted(path.name for path in (tmp_path / "r").glob("[!.]*")) == [
        "shots.csv",
        "tests.json",
        "tests.svg",
    ]
    told = json.loads((tmp_path / "r" / "tests.json").read_text())
    assert told["tested_v50_m_s"] == pytest.approx(115.0, rel=0.01)
    assert "tests: V50 of six shots (MIL-STD-662F)" in out


def test_of_one_outcome_there_is_no_v50(tmp_path):
    tests = read(tmp_path, "velocity [m/s], outcome\n100, CP\n110, CP\n")
    found = laboratory_tests.reduce(tests)
    assert found.words() == "V50 not determined: all 2 shots end alike"
    assert np.isnan(found.summary()["tested_v50_m_s"])


@pytest.mark.parametrize(
    "text",
    [
        "Velocity [m/s],Outcome\n96,PP\n110,CP\n",
        "VELOCITY (m/s), outcome\n96,partial penetration\n110,Complete Penetration\n",
        "shot,velocity [m/s],outcome,remark\n1,96,PP,\n2,110,CP,off centre\n",
    ],
)
def test_headings_as_laboratories_write_them(tmp_path, text, caplog):
    with caplog.at_level("INFO", "weavecell"):
        found = read(tmp_path, text)
    assert list(found["velocity"]) == [96.0, 110.0]
    assert list(found["outcome"]) == ["stopped", "perforated"]
    told = [record.getMessage() for record in caplog.records]
    if "remark" in text:
        assert told[0].endswith("left out, columns that are not known: shot, remark")
    else:
        assert told == []


def test_the_residual_velocity_of_a_rebound_is_refused_with_what_is_allowed(tmp_path):
    text = "velocity [m/s], outcome, residual velocity [m/s]\n96,PP,-5\n110,CP,20\n"
    with pytest.raises(wc.InputError, match="at least 0: a projectile that rebounds has stopped"):
        read(tmp_path, text)


def test_the_spread_of_the_tests_is_told(tmp_path):
    """V10, V50 and V90 of mixed outcomes, in the terminal and in tests.json."""
    outcomes = [
        "90,PP",
        "95,CP",
        "100,PP",
        "104,PP",
        "108,CP",
        "111,PP",
        "116,CP",
        "121,CP",
        "127,CP",
    ]
    rows = "\n".join(["velocity [m/s],outcome", *outcomes])
    reduced = laboratory_tests.reduce(read(tmp_path, rows))
    summary = reduced.summary()
    middles = []
    for name, span in reduced.posterior.velocities.items():
        value = summary[f"tested_{name.lower()}_m_s"]
        low, high = summary[f"tested_{name.lower()}_interval_m_s"]
        assert (value, low, high) == span
        assert low < value < high
        middles.append(value)
    assert middles == sorted(middles)
    # by eye: as many perforations below as stops above
    assert middles[1] == pytest.approx(105.0, abs=4.0)
    assert any("V50 10" in line and "V90" in line for line in reduced.lines("t"))
