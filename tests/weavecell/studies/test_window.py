"""Means over a window of strike velocities: closed forms, and a shot that perforates with --uncertainty."""

import json
from math import sqrt

import numpy as np
import pytest
from scipy.stats import linregress

import weavecell as wc
from tests.scene_text import impact_scene
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


@pytest.mark.filterwarnings("ignore::weavecell.DoubtfulResult")
def test_means_on_both_meshes_are_stated_where_a_shot_perforates(succeed, tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(impact_scene(opening="30.6 mm", end_time="200 us", run='outputs = ["report"]'))
    out = succeed("impact", scene, "--uncertainty", "--out", "r")
    told = json.loads((tmp_path / "r/summary.json").read_text())
    means, errors, shots = (told["window"][part] for part in ("mean", "standard_error", "shots"))
    for key, name in (
        ("residual_velocity_m_s", "residual velocity"),
        ("absorbed_energy_J", "absorbed energy"),
    ):
        result = told["discretisation"]["results"][name]
        assert result["value"] == means[key]
        assert result["standard_error"] == errors[key]
        scatter = np.hypot(errors[key], result["finer_standard_error"])
        assert result["uncertainty"] == pytest.approx(
            4 * abs(result["finer"] - means[key]) + scatter
        )
        assert f"{name} {means[key]:.4g} +- {errors[key]:.2g}" in out
        assert shots[2][key] == told[key]
    assert [shot["strike_velocity_m_s"] for shot in shots] == pytest.approx(
        [155 * factor for factor in FACTORS]
    )
    assert "mean and standard error" in (tmp_path / "r/report.html").read_text()
    assert not (tmp_path / "r/window").exists()
    alone = wc.impact(scene)
    assert alone.window is None
    assert "values jump with the velocity" in str(alone)
    assert "at one velocity" not in out + str(
        wc.impact("S-720", 40.0, opening="60 mm", end_time="10 us")
    )
