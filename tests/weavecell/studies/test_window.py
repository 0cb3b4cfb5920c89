"""Means over a window of strike velocities: closed forms, and a shot that perforates with --uncertainty."""

import json
import warnings
from math import sqrt

import numpy as np
import pytest
from scipy.stats import linregress

import weavecell as wc
from tests.scene_text import impact_scene
from weavecell.report import chapters_discretisation
from weavecell.studies.window import FACTORS, QUANTITIES, Window

V = 100.0 * np.array(FACTORS)


def mean(residuals, outcomes=("perforated",) * 5):
    """Mean and standard error of residual velocities about 100 m/s."""
    rows = zip(V.tolist(), outcomes, residuals)
    keys = "strike_velocity_m_s", "outcome", QUANTITIES["residual_velocity"][0]
    return Window(100.0, tuple(dict(zip(keys, row)) for row in rows)).mean("residual_velocity")


def test_a_staircase_has_mean_and_standard_error_of_its_line():
    """By hand: the line 30 + 3.5 k of the shots k = -2 .. 2, 3 degrees of freedom. A trend alone is no scatter."""
    steps = np.array([23.0, 29.0, 25.0, 36.0, 37.0])
    line = 30 + 3.5 * np.arange(-2, 3)
    assert mean(steps) == pytest.approx((30.0, sqrt((steps - line) @ (steps - line) / 3 / 5)))
    assert mean(line) == pytest.approx((30.0, 0.0), abs=1e-9)


def test_an_unstable_shot_counts_in_no_mean():
    """What is left is not even about the middle: value and standard error there by SciPy."""
    values = np.array([0.0, 25.0, 25.0, 35.0, 1e9])
    line = linregress(V[:4] - 100, values[:4])
    outcomes = "stopped", *("perforated",) * 3, "unstable"
    assert mean(values, outcomes) == pytest.approx((line.intercept, line.intercept_stderr))
    assert np.isnan(mean(values, ("perforated", "perforated", *("unstable",) * 3))).all()


def window(energies):
    """A window about 450 m/s with these absorbed energies."""
    keys = "strike_velocity_m_s", "outcome", *(key for key, *_ in QUANTITIES.values())
    rows = [
        dict(zip(keys, (factor * 450.0, "perforated", 300.0 + n, energy, 40.0)))
        for n, (factor, energy) in enumerate(zip(FACTORS, energies))
    ]
    return Window(450.0, tuple(rows))


def test_no_mean_is_quoted_over_a_jump():
    """Free edges, S-726 (energies of runs), which jump by 1.8; not over a sawtooth, a trend or scatter."""
    jump = window([15.99, 14.4, 8.6, 8.89, 8.8]).jump
    assert jump.velocities == pytest.approx((0.96 * 450, 450))
    assert jump.energies == pytest.approx((np.mean([15.99, 14.4]), np.mean([8.6, 8.89, 8.8])))
    assert "no mean over it" in jump.words
    summary = window([15.99, 14.4, 8.6, 8.89, 8.8]).summary()
    assert set(summary["mean"].values()) == {None}
    for energies in (
        [11.69, 12.2, 10.86, 11.16, 11.75],  # yawed cylinder, S-720
        [10.0, 13.0, 16.0, 19.0, 22.0],
        [10.0, 13.0, 9.5, 12.5, 9.8],
    ):
        assert window(energies).jump is None
        assert window(energies).summary()["mean"]["absorbed_energy_J"] is not None


def test_the_text_of_a_window_says_its_jump_in_place_of_means():
    steady = window([9.0, 8.9, 8.8, 8.9, 8.8])
    jumping = window([15.99, 14.4, 8.6, 8.89, 8.8])
    assert "jumps between 432 and 450" in chapters_discretisation._describe_window(jumping)
    assert "jump" not in chapters_discretisation._describe_window(steady)
    assert chapters_discretisation._list_means(jumping) == []
    assert len(chapters_discretisation._list_means(steady)) == 3


@pytest.fixture(scope="module")
def perforated(tmp_path_factory):
    """Fire a shot that perforates, with its uncertainty: (ShotResult, summary.json, folder, input file)."""
    folder = tmp_path_factory.mktemp("window")
    scene = folder / "scene.toml"
    scene.write_text(impact_scene(opening="30.6 mm", end_time="200 us", run='outputs = ["report"]'))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", wc.DoubtfulResult)
        shot = wc.impact(scene, uncertainty=True, out=folder / "r")
    return shot, json.loads((folder / "r/summary.json").read_text()), folder / "r", scene


def test_the_answer_has_the_velocity_left_with_its_uncertainty(perforated):
    shot, summary, _, _ = perforated
    result = summary["discretisation"]["results"]["residual velocity"]
    said = f"mesh error: mean residual velocity {result['value']:.1f} +- {result['uncertainty']:.2g} m/s"
    assert said in shot.answer.value
    assert shot.summary()["discretisation"] == summary["discretisation"]


RESULTS = [("residual_velocity_m_s", "residual velocity"), ("absorbed_energy_J", "absorbed energy")]


@pytest.mark.parametrize("key, name", RESULTS)
def test_a_result_of_a_perforating_shot_is_the_mean_over_its_window(perforated, key, name):
    _, summary, _, _ = perforated
    result = summary["discretisation"]["results"][name]
    assert result["value"] == summary["window"]["mean"][key]
    assert result["standard_error"] == summary["window"]["standard_error"][key]


@pytest.mark.parametrize("key, name", RESULTS)
def test_the_uncertainty_of_a_mean_has_the_scatter_on_both_meshes(perforated, key, name):
    _, summary, _, _ = perforated
    result = summary["discretisation"]["results"][name]
    mean = summary["window"]["mean"][key]
    scatter = np.hypot(result["standard_error"], result["finer_standard_error"])
    assert result["uncertainty"] == pytest.approx(4 * abs(result["finer"] - mean) + scatter)


@pytest.mark.parametrize("key, name", RESULTS)
def test_means_are_printed_with_their_standard_error(perforated, key, name):
    shot, summary, _, _ = perforated
    mean, error = (summary["window"][part][key] for part in ("mean", "standard_error"))
    assert f"{name} {mean:.4g} +- {error:.2g}" in shot.details()


def test_the_shots_of_a_window_lie_about_the_strike_velocity(perforated):
    _, summary, _, _ = perforated
    shots = summary["window"]["shots"]
    strikes = [155 * factor for factor in FACTORS]
    assert [shot["strike_velocity_m_s"] for shot in shots] == pytest.approx(strikes)
    for key, _ in RESULTS:
        assert shots[2][key] == summary[key]


def test_the_report_has_the_means_and_no_run_of_the_window_is_left(perforated):
    _, _, folder, _ = perforated
    assert "mean and standard error" in (folder / "report.html").read_text()
    assert not (folder / "window").exists()


@pytest.mark.filterwarnings("ignore::weavecell.DoubtfulResult")
def test_a_perforating_shot_alone_says_that_its_values_jump(perforated):
    alone = wc.impact(perforated[3])
    assert alone.window is None
    assert "values jump with the velocity" in alone.details()


def test_only_a_perforating_shot_without_a_window_says_so(perforated):
    in_flight = wc.impact("S-720", 40.0, opening="60 mm", end_time="10 us")
    assert "values jump with the velocity" not in perforated[0].details() + in_flight.details()
