"""Results of an earlier run are opened again by `load`, and drawn in one picture by `overlay`."""

import json

import numpy as np
import pandas.testing
import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from weavecell.results.result_folder import KINDS

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


@pytest.mark.parametrize("name", [name for name in KINDS if name != "summary.json"])
def test_any_other_folder_has_numbers_and_tables(tmp_path, name):
    (tmp_path / name).write_text(json.dumps({"format": "weavecell x 1", "speed_m_s": 97.5}))
    if KINDS[name]:
        table = "strike velocity [m/s],residual velocity [m/s]\n90,0\n130,60.5\n"
        (tmp_path / KINDS[name]).write_text(table)
    found = wc.load(tmp_path)
    assert found.summary()["speed_m_s"] == 97.5
    assert f"speed_m_s: {97.5}" in str(found)
    assert found.report is None
    if KINDS[name]:
        assert list(found.to_dataframe()["residual velocity [m/s]"]) == [0.0, 60.5]
        axis = wc.overlay(found, found).axes[0]
        np.testing.assert_array_equal(axis.lines[1].get_ydata(), [0.0, 60.5])
    else:
        with pytest.raises(InputError, match="must be shots, or results with strike"):
            wc.overlay(found)


def test_a_loaded_search_has_the_table_of_the_live_one(tmp_path):
    """Names, values to the last digit, and one line a column."""
    quick = {"scan": False, "residual_shots": 1, "opening": "50 mm", "tolerance": "25 m/s"}
    limit = wc.critical_velocity("S-720", out=tmp_path / "limit", **quick)
    live = limit.to_dataframe()
    assert {"outcome", "peak_tension_warp_N", "peak_tension_weft_N"} <= set(live)
    assert not any("\n" in name for name in live)
    pandas.testing.assert_frame_equal(wc.load(tmp_path / "limit").to_dataframe(), live)
    pandas.testing.assert_frame_equal(
        wc.load(tmp_path / "limit")._labelled_columns(), limit._labelled_columns()
    )


def test_what_is_no_folder_of_results_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"must be a folder with one of histories.h5, difference"):
        wc.load(tmp_path)
    with pytest.raises(InputError, match="must be a folder of results"):
        wc.load(tmp_path / "none")
    with pytest.raises(InputError, match="results: is missing"):
        wc.overlay()
