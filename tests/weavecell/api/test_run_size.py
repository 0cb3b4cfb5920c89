"""`impact --check`: what it says a run takes is what the run takes, and nothing is written."""

from dataclasses import replace

import pytest

import weavecell as wc
from shellfabric.impact.run import run_impact_or_partial
from tests.scene_text import impact_scene
from weavecell.api.run_size import SHOTS_OF_A_SEARCH
from weavecell.studies import assumed_range

PACK = {"opening": "30 mm", "plies": 2, "ply_gap": "0.1 mm", "end_time": "10 us"}


@pytest.mark.parametrize(
    "panel", [{"opening": "30 mm", "end_time": "10 us"}, PACK], ids=["ply", "pack"]
)
def test_elements_and_steps_are_those_of_the_run(panel):
    size = wc.size_of("S-720", "90 m/s", **panel)
    setup = wc.setup("S-720", "90 m/s", **panel)
    result, _ = run_impact_or_partial(setup)
    assert size.elements == setup.target().elements
    assert size.steps == round(result.time[-1] / size.time_step)
    assert size.cpu_time[0] < size.cpu_time[1]
    assert "; 0.98 to 1,200 s of CPU time" in str(replace(size, cpu_time=(0.98, 1234.5)))


def test_the_command_writes_nothing(succeed, tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(impact_scene("90 m/s", "30 mm", "10 us"))
    out = succeed("impact", scene, "--check", "--out", "out")
    assert "nothing is run" in out
    assert not (tmp_path / "out").exists()


def test_the_forecast_of_a_v50_counts_its_shots_and_a_search():
    plain = wc.v50("S-720", shots=20, opening="50 mm", check=True)
    assert plain.shots == 20 + SHOTS_OF_A_SEARCH
    assert plain.searches == 1


def test_the_forecast_of_a_v50_with_a_range_counts_six_times_the_shots_and_two_searches_an_assumption():
    ends = sum(map(len, assumed_range.changes(wc.setup("S-720", 1.0, opening="50 mm")).values()))
    whole = wc.v50("S-720", shots=20, assumed_range=True, opening="50 mm", check=True)
    assert whole.searches == 1 + ends + 2
    assert whole.shots == 7 * 20 + SHOTS_OF_A_SEARCH * whole.searches


def test_the_forecast_of_a_limit_counts_residual_shots_and_scan():
    limit = wc.critical_velocity("S-720", opening="50 mm", check=True)
    assert limit.shots == SHOTS_OF_A_SEARCH + 2 + 2
    more = {"residual_shots": 8, "scan": True}
    limit = wc.critical_velocity("S-720", opening="50 mm", check=True, **more)
    assert limit.shots == SHOTS_OF_A_SEARCH + 8 + 18
    assert 0 < limit.cpu_time[0] < limit.cpu_time[1]


def test_the_forecast_of_a_sweep_is_the_sum_over_its_rows(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    over = {"panel.plies": [1, 2]}
    swept = wc.sweep("S-720", over=over, quantity="critical-velocity", check=True)
    assert swept.shots == 2 * (SHOTS_OF_A_SEARCH + 2)
    assert swept.searches == 2
    assert not list(tmp_path.iterdir())
