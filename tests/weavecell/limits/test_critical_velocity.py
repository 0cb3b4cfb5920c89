"""`weavecell critical-velocity`: what its shots say, mixed outcomes, errors and the shots before them."""

import re
from importlib import resources

import numpy as np
import pytest

from fabrics.base.errors import UnstableError
from tests.scene_text import every, impact_scene
from tests.weavecell.written import names, rows_of, table_of
from weavecell.api import target
from weavecell.studies import ballistic_limit

FILES = "critical-velocity.json report.html residual-velocity.svg runs scene.toml shots.csv"


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(impact_scene(end_time="10 us", run=every("10 us", "10 us")))
    return path


def read(folder):
    return table_of(folder, "critical-velocity.json"), rows_of(folder, "shots.csv")


@pytest.fixture
def searched(results):
    """Return (run, critical-velocity.json, rows of shots.csv) of a search."""
    run = results("critical-velocity")
    return run, *read(run.folder)


def test_the_bracket_is_as_narrow_as_the_tolerance_and_its_middle_is_printed(searched):
    run, summary, _ = searched
    low, high = summary["bracket_m_s"]
    assert 0 < high - low <= 1.0
    assert (
        f"answer      {0.5 * (low + high):.3g} m/s, between {low:.3g} and {high:.3g}\n" in run.out
    )


def test_shots_stop_below_the_bracket_and_perforate_above(searched):
    _, summary, rows = searched
    _, high = summary["bracket_m_s"]
    for row in rows:
        above = float(row["strike_velocity_m_s"]) >= high - 1e-3
        assert row["outcome"] == ("perforated" if above else "stopped")
        assert (float(row["residual_velocity_m_s"]) > 0) == above


def test_the_table_of_shots_is_sorted_and_their_energy_errors_are_small(searched):
    _, _, rows = searched
    assert np.all(np.diff([float(row["strike_velocity_m_s"]) for row in rows]) >= 0)
    assert max(float(row["energy_error_max"]) for row in rows) < 0.01


def test_residual_shots_go_up_to_twice_the_limit_and_give_a_lambert_jonas_curve(searched):
    run, summary, rows = searched
    strikes = np.array([float(row["strike_velocity_m_s"]) for row in rows])
    assert abs(strikes - 2 * summary["bracket_m_s"][1]).min() < 1e-3
    assert summary["lambert_jonas"]["limit"] == summary["critical_velocity_m_s"]
    assert 0 < summary["lambert_jonas"]["a"] <= 1
    page = re.sub("<[^>]*>", "", (run.folder / "report.html").read_text())
    assert "Lambert-Jonas: a = " in page


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

    def search(options="--scan --residual-shots 4"):
        code, out, _ = command(f"critical-velocity {scene} --jobs 1 --out r {options}")
        return code, out, tmp_path / "r"

    monkeypatch.setattr(ballistic_limit, "_fire", fire)
    return search


@pytest.mark.parametrize("last", [0, 1, 7, 15])
def test_an_interrupted_search_goes_on_behind_its_last_shot(command, mixed, monkeypatch, last):
    whole, *_ = read(mixed("--scan --residual-shots 4 --out whole")[2].parent / "whole")
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
        code, _, folder = mixed("--scan --residual-shots 4 --resume")
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
    strike = [float(row["strike_velocity_m_s"]) for row in rows]
    assert min(strike) < 0.92 * low
    assert max(strike) == pytest.approx(2 * high, rel=1e-4)  # the curve begins above the zone


def test_a_zone_of_mixed_outcomes_is_doubtful(mixed):
    _, out, folder = mixed()
    summary, _ = read(folder)
    low, high = summary["mixed_zone_m_s"]
    assert summary["checks"]["status"] == "doubtful"
    zone = f"no single limit, outcomes mix from {low:.3g} to {high:.3g} m/s"
    assert f"answer      DOUBTFUL: {zone}\n" in out
    assert f"doubts      mixed outcomes {high - low:.3g} m/s (limit 0 m/s)\n" in out
    assert "next        state the zone, or V50 of yarns that scatter; " in out


def test_a_doubtful_zone_is_an_error_that_leaves_all_files_if_that_is_wanted(mixed):
    code, _, folder = mixed("--scan --strict")
    assert code == 3
    assert names(folder) == FILES


def test_without_a_scan_the_bisection_sees_one_limit_alone(mixed):
    _, out, folder = mixed("--no-scan")
    assert "answer      140 m/s, between " in out
    assert "doubtful" not in out.lower()
    assert len(read(folder)[1]) < 12


@pytest.fixture
def looked(command, scene, tmp_path, monkeypatch):
    """A search with options, of a panel that stops below 140 m/s and where `stops` says so: summary, rows, output."""

    def search(stops, options=""):
        def fire(_, velocity, __):
            held = velocity < 140.0 or stops(velocity)
            residual = 0.0 if held else (velocity**2 - 139.0**2) ** 0.5
            outcome = "stopped" if held else "perforated"
            return ballistic_limit.Shot(velocity, residual, outcome, 1e-4, 0, (1, 1), 0.0, 0.0)

        monkeypatch.setattr(ballistic_limit, "_fire", fire)
        code, out, _ = command(f"critical-velocity {scene} --jobs 1 --out {tmp_path}/r {options}")
        assert code == 0
        return *read(tmp_path / "r"), out

    return search


def test_by_default_a_limit_takes_a_third_of_the_shots(looked):
    """One limit is found by its search and two looks at most; its curve has a shot at twice the limit."""
    summary, rows, out = looked(lambda _: False)
    _, all_rows, _ = looked(lambda _: False, "--scan --residual-shots 8")
    assert len(rows) <= 0.45 * len(all_rows)  # fast ones, which end first, among them
    assert summary["scan"] is None
    assert summary["critical_velocity_m_s"] == pytest.approx(140.0, abs=0.5)
    assert "; --scan\n" in out
    low, high = summary["bracket_m_s"]
    strikes = np.array([float(row["strike_velocity_m_s"]) for row in rows])
    for beyond in (strikes / high - 1, 1 - strikes / low):
        assert ((beyond >= 0.02) & (beyond <= 0.08)).any()
    # v_r^2 = v^2 - 139^2
    assert summary["lambert_jonas"]["a"] == pytest.approx(1.0, abs=0.05)


def test_outcomes_that_mix_beside_the_bracket_are_scanned(looked):
    """The search ends at 152 m/s; the look 3 % below perforates: the zone is that of the whole scan."""
    beside = lambda velocity: 148.0 < velocity < 152.0  # noqa: E731
    summary, rows, out = looked(beside)
    assert "answer      DOUBTFUL: no single limit, outcomes mix from " in out
    low, high = summary["mixed_zone_m_s"]
    assert 140.0 < low < 148.0 < high < 152.0
    assert summary["scan"]["above"] == 0.25
    whole, all_rows, _ = looked(beside, "--scan")
    assert whole["mixed_zone_m_s"] == [low, high]
    # looks that the search has not fired itself are all that it has more
    assert 0 <= len(rows) - len(all_rows) <= 2


@pytest.fixture
def scattering(command, tmp_path, monkeypatch):
    """A search with options, of two plies whose shots each have a limit of their own about 140 m/s: (code, output)."""
    path = tmp_path / "pack.toml"
    path.write_text(impact_scene(panel="plies = 2"))

    def fire(_, velocity, __):
        limit = 140.0 * (1 + 0.02 * np.random.default_rng(int(1e6 * velocity)).standard_normal())
        through = velocity > limit
        residual = (velocity**2.3 - limit**2.3) ** (1 / 2.3) if through else 0.0
        outcome = "perforated" if through else "stopped"
        return ballistic_limit.Shot(velocity, residual, outcome, 1e-4, 0, (1, 1), 0.0, 0.0)

    def search(options=""):
        line = f"critical-velocity {path} --jobs 1 --out {tmp_path}/r {options}"
        return command(line)[:2]

    monkeypatch.setattr(ballistic_limit, "_fire", fire)
    return search


def test_the_limit_of_a_pack_is_a_v50_with_its_interval(scattering, tmp_path):
    code, out = scattering()
    summary, rows = read(tmp_path / "r")
    found = summary["v50"]
    assert code == 0
    assert len(rows) <= 14
    assert summary["critical_velocity_m_s"] == found["velocity"]
    assert found["low"] < 140.0 < found["high"]
    assert found["high"] - found["low"] < 0.12 * 140
    span = f"V50 {found['velocity']:.1f} m/s, {found['low']:.1f} to {found['high']:.1f} m/s"
    assert f"answer      {span} with 95 % confidence; single shots scatter by" in out
    assert "mixed outcomes" not in out
    assert scattering("--resume") == (code, out)


def test_a_bracket_of_a_pack_is_not_given_for_an_error(scattering, tmp_path):
    _, out = scattering("--v50-shots 0 --residual-shots 0 --no-scan --verbose")
    assert "the bracket is no error: shots of a pack scatter by some 2 %" in out
    assert read(tmp_path / "r")[0]["v50"] is None


def test_a_fabric_is_shot_at_in_the_standard_way(tmp_path):
    """A fabric's name or file becomes the standard scene, which can be run again from where it is written."""
    found = target.read_target("S-726", tmp_path, "limit")
    scene = found.case.scene
    assert found.case.fabric.name == "S-726"
    assert scene.panel.opening == 0.203
    assert scene.projectile.mass == 3e-3
    file = tmp_path / "mine.toml"
    out = tmp_path / "deep" / "results"
    file.write_text((resources.files("fabrics.catalogue") / "S-731.toml").read_text())
    out.mkdir(parents=True)
    found = target.read_target(str(file), out, "limit")
    assert found.case.fabric.name == found.title == "S-731"
    (out / "scene.toml").write_text(found.text)
    assert target.read_target(str(out / "scene.toml"), out, "limit").setup == found.setup


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
