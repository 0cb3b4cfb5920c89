"""`weavecell critical-velocity`: what its shots say, mixed outcomes, errors and the shots before them."""

from importlib import resources

import numpy as np
import pytest

from fabrics.base.errors import UnstableError
from tests.scene_text import every, impact_scene
from tests.weavecell.written import names, rows_of, table_of
from weavecell.api import target
from weavecell.scenes import honoured
from weavecell.studies import ballistic_limit

FILES = "critical-velocity.json report.html residual-velocity.svg runs scene.toml shots.csv"


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(impact_scene(end_time="10 us", run=every("10 us", "10 us")))
    return path


def read(folder):
    return table_of(folder, "critical-velocity.json"), rows_of(folder, "shots.csv")


def test_shots_stop_below_the_bracket_and_perforate_above(results):
    run = results("critical-velocity")
    summary, rows = read(run.folder)
    low, high = summary["bracket_m_s"]
    assert 0 < high - low <= 1.0
    assert f"critical velocity {0.5 * (low + high):.1f} m/s" in run.out
    strike = np.array([float(row["strike velocity [m/s]"]) for row in rows])
    assert np.all(np.diff(strike) >= 0)
    for row, velocity in zip(rows, strike):
        assert row["outcome"] == ("perforated" if velocity >= high - 1e-3 else "stopped")
        assert (float(row["residual velocity [m/s]"]) > 0) == (row["outcome"] == "perforated")
        assert float(row["energy error [-]"]) < 0.01
    assert abs(strike - 2 * high).min() < 1e-3
    assert summary["lambert_jonas"]["limit"] == summary["critical_velocity_m_s"]
    assert 0 < summary["lambert_jonas"]["a"] <= 1
    assert "Lambert-Jonas: a = " in run.out


@pytest.fixture
def mixed(command, scene, tmp_path, monkeypatch):
    """A search with options, of a pack that stops below 140 m/s and again from 150 to 155 m/s.

    search(options) is (exit code, standard output, folder).
    """

    def fire(_, velocity, __):
        stops = velocity < 140.0 or 150.0 < velocity < 155.0
        residual = 0.0 if stops else (velocity**2 - 139.0**2) ** 0.5
        outcome = "stopped" if stops else "perforated"
        return ballistic_limit.Shot(velocity, residual, outcome, 1e-4, 0, (1.0, 1.0), 0.0, 0.0)

    def search(options=""):
        code, out, _ = command(f"critical-velocity {scene} --jobs 1 --out r {options}")
        return code, out, tmp_path / "r"

    monkeypatch.setattr(ballistic_limit, "_fire", fire)
    return search


@pytest.mark.parametrize("last", [0, 1, 7, 15])
def test_an_interrupted_search_goes_on_behind_its_last_shot(command, mixed, monkeypatch, last):
    whole, *_ = read(mixed("--out whole")[2].parent / "whole")
    fire = ballistic_limit._fire
    fired = []

    def until(panel, velocity, give_up):
        if len(fired) == last:
            raise KeyboardInterrupt
        fired.append(velocity)
        return fire(panel, velocity, give_up)

    with monkeypatch.context() as ending:
        ending.setattr(ballistic_limit, "_fire", until)
        assert mixed()[0] == 130
    before = [*fired]
    with monkeypatch.context() as going_on:
        last = 1000
        going_on.setattr(ballistic_limit, "_fire", until)
        code, _, folder = mixed("--resume")
    assert code == 0
    # the shot that was under way may have ended before it was written
    assert len(set(fired)) >= len(fired) - 1
    assert fired[: len(before)] == before
    found, _ = read(folder)
    for summary in (whole, found):
        del summary["wall_time_s"], summary["provenance"]
    assert found == whole


def test_mixed_outcomes_are_a_zone_without_a_critical_velocity(mixed):
    code, _, folder = mixed()
    summary, rows = read(folder)
    low, high = summary["mixed_zone_m_s"]
    assert code == 0
    assert summary["critical_velocity_m_s"] is None
    assert low == summary["lowest_perforation_m_s"] == summary["bracket_m_s"][1]
    assert low == pytest.approx(140.0, abs=1.0)
    assert 150.0 < high == summary["highest_stop_m_s"] < 155.0
    strike = [float(row["strike velocity [m/s]"]) for row in rows]
    assert min(strike) < 0.92 * low
    assert max(strike) == pytest.approx(2 * high, rel=1e-4)  # the curve begins above the zone


def test_a_zone_of_mixed_outcomes_is_doubtful(mixed):
    _, out, folder = mixed()
    summary, _ = read(folder)
    low, high = summary["mixed_zone_m_s"]
    assert summary["checks"]["status"] == "doubtful"
    assert f"no single critical velocity, mixed outcomes from {low:.1f} to {high:.1f} m/s" in out
    assert f"checks: doubtful: mixed outcomes {high - low:.2f} m/s (limit 0 m/s)" in out


def test_a_doubtful_zone_is_an_error_that_leaves_all_files_if_that_is_wanted(mixed):
    code, _, folder = mixed("--strict")
    assert code == 3
    assert names(folder) == FILES


def test_without_a_scan_the_bisection_sees_one_limit_alone(mixed):
    _, out, folder = mixed("--scan-above '0 %' --scan-below '0 %' --residual-shots 0")
    assert "critical velocity 1" in out
    assert "doubtful" not in out
    assert len(read(folder)[1]) < 12


def test_a_fabric_is_shot_at_in_the_standard_way(tmp_path):
    """A fabric's name or file becomes the standard scene, which can be run again from where it is written."""
    found = target.read_target("S-726", tmp_path, honoured.LIMITS)
    scene = found.case.scene
    assert found.case.fabric.name == "S-726"
    assert scene.panel.opening == 0.203
    assert scene.projectile.mass == 3e-3
    file = tmp_path / "mine.toml"
    out = tmp_path / "deep" / "results"
    file.write_text((resources.files("fabrics.catalogue") / "S-731.toml").read_text())
    out.mkdir(parents=True)
    found = target.read_target(str(file), out, honoured.LIMITS)
    assert found.case.fabric.name == found.title == "S-731"
    (out / "scene.toml").write_text(found.text)
    assert target.read_target(str(out / "scene.toml"), out, honoured.LIMITS).setup == found.setup


def test_an_error_keeps_the_shots_before(command, scene, tmp_path, monkeypatch):
    real = ballistic_limit._fire

    def fire(panel, velocity, give_up):
        if velocity < 130.0:
            raise UnstableError(
                "a number is not finite", where="node (1, 2)", when="after 3 us (step 4)"
            )
        return real(panel, velocity, give_up)

    def fails(patched, value):
        with monkeypatch.context() as patch:
            patch.setattr(ballistic_limit, patched, value)
            code, _, err = command(f"critical-velocity {scene} --out r --jobs 1")
        assert code == 3
        assert names(tmp_path / "r").removeprefix("runs ") == "scene.toml shots.csv"
        return err.splitlines()[-1], (tmp_path / "r" / "shots.csv").read_text().splitlines()[1:]

    said, shots = fails("_fire", fire)
    assert said.startswith(
        "error: a number is not finite, at node (1, 2), after 3 us (step 4), of the shot at 1"
    )
    assert shots
    assert all(",perforated," in shot for shot in shots)
    said, shots = fails("UNDECIDED", 2e-5)
    assert said.startswith(
        "error: the projectile struck at 136.3 m/s has neither stopped nor perforated"
    )
    assert "no critical velocity" in said
    assert not shots
