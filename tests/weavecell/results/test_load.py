"""Results of an earlier run are opened again by `load`, and drawn in one picture by `overlay`."""

import shutil
from fnmatch import fnmatch
from pathlib import Path

import numpy as np
import pandas.testing
import pytest

import weavecell as wc
from fabrics import catalogue
from fabrics.base.errors import InputError
from fabrics.compression import CompressionLaw
from tests.scene_text import toml
from tests.weavecell.golden_texts import cases
from tests.weavecell.session_runs import small_calibration
from weavecell.answers.study_result import DrawnResult
from weavecell.report import installed
from weavecell.results import keys, one_table
from weavecell.studies import ballistic_limit

MADE_TESTS = Path(__file__).parents[3] / "examples" / "records" / "glass-biaxial.csv"
SHORT = {"opening": "20 mm", "end_time": "10 us"}


@pytest.fixture(scope="module")
def shots(tmp_path_factory):
    """Two shots, and the folder of the first."""
    folder = tmp_path_factory.mktemp("shot") / "yesterday"
    first = wc.impact("S-720", "150 m/s", **SHORT, out=folder)
    return first, wc.impact("S-728", "120 m/s", **SHORT), folder


def test_a_shot_is_opened_with_its_histories(shots):
    first, _, folder = shots
    again = wc.load(folder)
    assert again.outcome == first.outcome
    np.testing.assert_array_equal(again.velocity, first.velocity)
    np.testing.assert_array_equal(again.contact_force, first.contact_force)
    assert again.target.setup.fabric.name == "S-720"
    assert [axes.get_ylabel() for axes in again.plot().axes]


def test_completion_of_a_shot_offers_what_a_user_needs(shots):
    offered = dir(shots[0])
    assert len(offered) <= 42
    for name in offered:
        assert hasattr(shots[0], name), name
    assert not {"quads", "z_rest", "from_result", "rear"} & set(offered)


def test_checks_are_a_table(shots):
    table = shots[0].checks_table()
    assert list(table["name"]) == [check.name for check in shots[0].checks]
    assert list(table["limit"]) == [check.limit for check in shots[0].checks]
    assert set(table["status"]) <= {"ok", "noted", "doubtful"}


def test_shots_in_one_picture(shots):
    first, second, _ = shots
    axes = wc.overlay(first, second).axes
    assert [len(one.lines) for one in axes] == [2, 2, 2]
    drawn = axes[0].lines[1]
    np.testing.assert_allclose(drawn.get_xdata(), 1e6 * second.time)
    np.testing.assert_allclose(drawn.get_ydata(), second.velocity)
    np.testing.assert_allclose(axes[1].lines[0].get_ydata(), 1e3 * first.deflection)


SMALL = {"opening": "50 mm", "elements_per_crossover": 1}
OVER = {"panel.opening": ["40 mm", "0.05 m"], "panel.plies": [2, 3]}
YARNS = {"opening": "40 mm", "crossovers": "yarns", "zone": "12 mm"}
# {kind of result: how to make it}; shots of studies are invented
MADE = {
    "impact": lambda out: wc.impact("S-720", "150 m/s", **SHORT, out=out),
    "critical_velocity": lambda out: wc.critical_velocity(
        "S-720", residual_shots=1, **SMALL, out=out
    ),
    "critical_velocity of a pack": lambda out: wc.critical_velocity(
        "S-728", plies=2, **SMALL, out=out
    ),
    "v50": lambda out: wc.v50("S-728", shots=8, batch=4, **SMALL, out=out),
    "difference": lambda out: wc.compare("S-720", "S-728", shots=6, **SMALL, out=out),
    "sweep": lambda out: wc.sweep("S-720", over=OVER, quantity="critical-velocity", out=out),
    "tests": lambda out: wc.reduce_tests("tests.csv", out=out),
    "compression": lambda out: wc.reduce_compression("ply.csv", platen_area="361 mm^2", out=out),
    "pull-outs": lambda out: wc.reduce_pull_out("S-728", "peaks.csv", tension="2 N", out=out),
    "shot": lambda out: wc.reduce_shot("flight.csv", mass="3 g", bandwidth="20 kHz", out=out),
    "coupon": lambda out: wc.coupon(
        "S-720", "picture_frame", shear_angle="4 deg", crossovers=2, steps=2, out=out
    ),
    "coupon, pull-out": lambda out: wc.coupon(
        "S-726",
        "pull_out",
        crossings=10,
        displacement="1.2 mm",
        crossover_cohesion="0.5 N",
        out=out,
    ),
    "biaxial": lambda out: wc.biaxial("S-731", ratio=["1:0", "1:2"], out=out),
    "biaxial fit": lambda out: wc.calibrate(
        "glass-balanced", biaxial=MADE_TESTS, fitted=["k = 1", "k = 2"], out=out
    ),
    "mesh": lambda out: wc.mesh("S-720", mesh="coarse", out=out),
}
# of all files, and of results that have a range or a provenance
SHARED = {
    "format",
    "provenance",
    "assumed",
    "left_out",
    "checks",
    "doubts",
    "answer",
}


@pytest.mark.parametrize("name", MADE)
def test_a_loaded_result_has_the_table_of_the_live_one(name, tmp_path, monkeypatch):
    """Names, values to the last digit; and each key of its JSON file and each column is declared."""
    if name == "mesh":
        pytest.importorskip("gmsh")
    monkeypatch.chdir(tmp_path)
    # pages have their own tests
    monkeypatch.setattr(installed, "can_draw", lambda: False)
    cases.write_records()
    with cases.invented():
        live = MADE[name]("before")
    shutil.move("before", "moved")
    loaded = wc.load("moved")
    check_kept(live, loaded)


OWN = {
    "fabric": {"file": "data/mine.toml", "law": "law.json"},
    "projectile": {
        "mass": "2 g",
        "diameter": "5.5 mm",
        "edge_radius": "0.3 mm",
        "strike_velocity": "150 m/s",
    },
    "panel": {"opening": "50 mm"},
    "run": {"end_time": "10 us", "elements_per_crossover": 1},
}
# studies that go on from the runs in their folder; shots and coupons: test_result_folder.py
STUDIES = {
    "critical_velocity": lambda of, **more: wc.critical_velocity(of, residual_shots=1, **more),
    "v50": lambda of, **more: wc.v50(of, shots=8, batch=4, **more),
    "difference": lambda of, **more: wc.compare(of, "S-720", shots=6, opening="50 mm", **more),
    "sweep": lambda of, **more: wc.sweep(of, over=OVER, quantity="critical-velocity", **more),
}


@pytest.mark.parametrize("name", STUDIES)
def test_a_moved_study_of_an_own_fabric_is_loaded_cited_drawn_and_resumed(
    name, tmp_path, monkeypatch
):
    """Its fabric and law are gone; nothing is fired again."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(installed, "can_draw", lambda: False)
    cases.write_records()
    text = (Path(catalogue.__file__).parent / "S-728.toml").read_text("utf-8")
    Path("here/data").mkdir(parents=True)
    Path("here/data/mine.toml").write_text(text.replace('"S-728"', '"mine"', 1))
    CompressionLaw(4.45e-5, 6.47e-5).to_json("here/law.json")
    Path("here/own.toml").write_text(toml(OWN))
    with cases.invented():
        live = STUDIES[name]("here/own.toml", out="before")
    shutil.move("before", "moved")
    shutil.rmtree("here")
    loaded = wc.load("moved")
    check_kept(live, loaded)
    assert "mine" in str(wc.cite("moved"))
    if name in ("critical_velocity", "v50"):
        assert len(wc.overlay(loaded, live).axes[0].lines) > 1
    if name == "difference":
        # its two inputs are given again, and one is gone
        return
    monkeypatch.setattr(ballistic_limit, "_fire", None)
    again = STUDIES[name]("moved/scene.toml", out="moved", resume=True)
    pandas.testing.assert_frame_equal(again.to_dataframe(), live.to_dataframe())


SMALL_CELL = {"mesh": "3,2,2"}
SOLID = {
    "case": lambda out: wc.crossover.yarn("S-720", yarn="weft", **SMALL_CELL, out=out),
    "surface": lambda out: wc.surface(
        "S-720", mesh="4,3,2", points=5, d1="0 mm .. 0.01 mm", d2="0 um .. 8 um", out=out
    ),
    "law": lambda out: wc.calibrate("S-720", mesh="coarse", out=out),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SOLID)
def test_a_loaded_result_of_the_3d_crossover_has_the_table_of_the_live_one(name, tmp_path):
    pytest.importorskip("dolfinx")
    with small_calibration():
        live = SOLID[name](tmp_path / "before")
    shutil.move(tmp_path / "before", tmp_path / "moved")
    check_kept(live, wc.load(tmp_path / "moved"))


def check_kept(live, loaded):
    """A loaded result has the table of the live one, and nothing that keys.toml does not name."""
    table = live.to_dataframe()
    assert len(table) > 0
    assert not any("\n" in str(column) for column in table)
    pandas.testing.assert_frame_equal(loaded.to_dataframe(), table)
    if live.kind == "impact":
        return
    if isinstance(live, DrawnResult):
        assert loaded.answer == live.answer
        assert live.answer.value in loaded.lines()[0]
        assert len(loaded.table()) == len(table)
    kind = live.kind
    varied = getattr(live, "keys", ())
    if kind not in ("coupon", "case", "mesh"):
        columns = [column for column in table if column not in varied]
        assert [name for name in columns if one_table.find_column(name, kind) is None] == []
    tables = (kind, "tests") if kind == "comparison" else (kind,)
    if kind == "coupon":
        tables = ("run", kind)
    declared = {key.name.partition(".")[0] for key in keys.table(*tables)} - {"rows"} | SHARED
    if kind in ("sweep", "case"):
        declared.add("rows")
    found = [name for name in loaded.content if not any(fnmatch(name, one) for one in declared)]
    assert found == []


def test_a_column_of_texts_keeps_those_that_look_like_numbers_or_like_nothing(tmp_path):
    live = one_table.frame(
        {"outcome": ["", "7", None], "shots": [3, 4, 5], "lower_m_s": [None, 0.1 + 0.2, 7.0]},
        "sweep",
    )
    (tmp_path / "t.csv").write_text(one_table.csv(live))
    again = one_table.read_csv(tmp_path / "t.csv", "sweep")
    pandas.testing.assert_frame_equal(again, live)
    assert list(again["outcome"]) == ["", "7", ""]
    assert again["lower_m_s"][1] == 0.1 + 0.2


def test_what_is_no_folder_of_results_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"must be a folder with one of histories.h5, difference"):
        wc.load(tmp_path)
    with pytest.raises(InputError, match="must be a folder of results"):
        wc.load(tmp_path / "none")
    with pytest.raises(InputError, match="results: is missing"):
        wc.overlay()
