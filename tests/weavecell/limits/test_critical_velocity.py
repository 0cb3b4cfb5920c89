"""`weavecell critical-velocity`: its folder, from a scene or a fabric, whatever the workers; errors and kept shots."""

import csv
import json
from importlib import resources

import numpy as np
import pytest

from fabrics.errors import UnstableError
from tests.scene_text import every, impact_scene
from weavecell.scenes import impact as scenes_impact
from weavecell.scenes import of_commands, target

FILES = ["critical-velocity.json", "residual-velocity.svg", "scene.toml", "shots.csv"]


@pytest.fixture
def written(tmp_path):
    def write(extra="", boundary="", name="small.toml"):
        path = tmp_path / name
        path.write_text(impact_scene(end_time="10 us", panel=boundary, run=every("10 us", "10 us"), extra=extra))
        return path

    return write


def read(folder):
    summary = json.loads((folder / "critical-velocity.json").read_text())
    return summary, list(csv.DictReader((folder / "shots.csv").open(encoding="utf-8")))


def test_scene(command, written, tmp_path):
    code, out, err = command("critical-velocity", written(), "--out", "results", "--residual-shots", 4, "--jobs", 1)
    assert code == 0
    assert not [line for line in err.splitlines() if "error" in line]
    folder = tmp_path / "results"
    assert sorted(path.name for path in folder.iterdir()) == FILES
    summary, rows = read(folder)
    low, high = summary["bracket_m_s"]
    assert 0 < high - low <= 1.0
    assert summary["critical_velocity_m_s"] == pytest.approx((low + high) / 2)
    assert f"critical velocity {summary['critical_velocity_m_s']:.1f} m/s" in out
    strike = [float(row["strike velocity [m/s]"]) for row in rows]
    assert strike == sorted(strike)
    assert len(strike) == len(summary["shots"]) > 4
    for row, velocity in zip(rows, strike):
        assert row["outcome"] == ("perforated" if velocity >= high - 1e-3 else "stopped")
        assert (float(row["residual velocity [m/s]"]) > 0) == (row["outcome"] == "perforated")
        assert float(row["energy error [-]"]) < 0.01
    assert min(abs(np.array(strike) - 2 * high)) < 1e-3
    fit = summary["lambert_jonas"]
    assert fit["limit"] == summary["critical_velocity_m_s"]
    assert 0 < fit["a"] <= 1
    assert "Lambert-Jonas: a = " in out
    assert (folder / "scene.toml").read_text() == written().read_text()
    assert b"<svg" in (folder / "residual-velocity.svg").read_bytes()
    assert summary["provenance"]["scene"] == written().read_text()


@pytest.fixture
def mixed_outcomes(monkeypatch):
    """Shots stop to 140 m/s and from 150 to 155 m/s, and perforate elsewhere."""
    from shellfabric.impact import ballistic_limit

    def fire(_, velocity, __):
        stops = velocity < 140.0 or 150.0 < velocity < 155.0
        residual = 0.0 if stops else (velocity**2 - 139.0**2) ** 0.5
        outcome = "stopped" if stops else "perforated"
        return ballistic_limit.Shot(velocity, residual, outcome, 1e-4, 0, (1.0, 1.0), 0.0, 0.0)

    monkeypatch.setattr(ballistic_limit, "_fire", fire)


def test_zone_of_mixed_outcomes(command, written, tmp_path, mixed_outcomes):
    """Without a single limit: no critical velocity, the zone in summary and on the terminal, and a doubtful result."""
    code, out, _ = command("critical-velocity", written(), "--out", "results", "--jobs", 1)
    assert code == 0
    summary, rows = read(tmp_path / "results")
    assert summary["critical_velocity_m_s"] is None
    assert summary["single_limit"] is False
    low, high = summary["mixed_zone_m_s"]
    assert (low, high) == (summary["lowest_perforation_m_s"], summary["highest_stop_m_s"])
    assert low == summary["bracket_m_s"][1] == pytest.approx(140.0, abs=1.0)
    assert 150.0 < high < 155.0
    assert summary["scan"] == {"above": 0.25, "below": 0.1, "step": 0.02}
    assert f"no single critical velocity, mixed outcomes from {low:.1f} to {high:.1f} m/s" in out
    assert f"checks: doubtful: mixed outcomes {high - low:.2f} m/s (limit 0 m/s)" in out
    assert summary["checks"]["status"] == "doubtful"
    strike = [float(row["strike velocity [m/s]"]) for row in rows]
    assert min(strike) < 0.92 * low
    assert max(strike) == pytest.approx(2 * high, rel=1e-4)  # the curve begins above the zone
    assert command("critical-velocity", written(), "--out", "strict", "--strict")[0] == 3
    assert sorted(path.name for path in (tmp_path / "strict").iterdir()) == FILES


def test_without_a_scan(command, written, tmp_path, mixed_outcomes):
    """The bisection alone sees one limit; its shots are those of the bracket."""
    words = ("--scan-above", "0 %", "--scan-below", "0 %", "--residual-shots", 0)
    code, out, _ = command("critical-velocity", written(), "--out", "results", *words)
    assert code == 0
    assert "critical velocity 1" in out
    assert "doubtful" not in out
    assert len(read(tmp_path / "results")[1]) < 12


def test_workers_change_nothing(command, written, tmp_path):
    path = written()
    for workers in (1, 2, 3):
        words = ("--residual-shots", 3, "--tolerance", "4 m/s", "--jobs", workers, "--out", f"results-{workers}")
        assert command("critical-velocity", path, *words)[0] == 0
    one, *others = (tmp_path / f"results-{workers}" for workers in (1, 2, 3))
    for other in others:
        for name in ("shots.csv", "residual-velocity.svg"):
            assert (other / name).read_bytes() == (one / name).read_bytes()


def test_fabric_is_shot_at_in_the_standard_way(tmp_path):
    """A fabric's name or file becomes the standard scene, which can be run again from where it is written."""
    found = target.read("S-726", tmp_path, of_commands.LIMITS)
    scene = found.case.scene
    assert (found.case.fabric.name, scene.panel.opening, scene.projectile.mass) == ("S-726", 0.203, 3e-3)
    file = tmp_path / "mine.toml"
    file.write_text((resources.files("fabrics.catalogue") / "S-731.toml").read_text())
    out = tmp_path / "deep" / "results"
    out.mkdir(parents=True)
    found = target.read(str(file), out, of_commands.LIMITS)
    assert found.case.fabric.name == found.title == "S-731"
    (out / "scene.toml").write_text(found.text)
    again, _ = scenes_impact.load(out / "scene.toml")
    assert np.isclose(again.panel.opening, 0.203)
    assert target.read(str(out / "scene.toml"), out, of_commands.LIMITS).case.fabric == found.case.fabric


def test_a_pack(command, written, tmp_path):
    """Its limit is above that of one ply; plies and projectile stand in the results."""
    path = written("", "plies = 2")
    few = ("--residual-shots", 0, "--scan-above", "0 %", "--scan-below", "0 %", "--tolerance", "8 m/s", "--jobs", 1)
    assert command("critical-velocity", written(name="one.toml"), "--out", "one", *few)[0] == 0
    code, out, _ = command("critical-velocity", path, "--out", "two", *few)
    assert code == 0
    one, two = (read(tmp_path / name)[0] for name in ("one", "two"))
    assert (one["plies"], two["plies"]) == (1, 2)
    assert one["bracket_m_s"][1] < two["bracket_m_s"][0]
    assert out.splitlines()[0] == f"projectile: {two['projectile']}"
    assert f"2 x {two['fabric']}: critical velocity" in out


def test_panel_without_a_limit(command, written, tmp_path, monkeypatch):
    monkeypatch.setattr("shellfabric.impact.ballistic_limit.UNDECIDED", 2e-5)
    path = written()
    code, _, err = command("critical-velocity", path, "--out", "results")
    assert code == 3
    assert err.splitlines()[-1].startswith(
        "error: the projectile struck at 136.3 m/s has neither stopped nor perforated"
    )
    assert "no critical velocity" in err.splitlines()[-1]
    assert len((tmp_path / "results/shots.csv").read_text().splitlines()) == 1


def test_unstable_shot_keeps_those_before(command, written, tmp_path, monkeypatch):
    from shellfabric.impact import ballistic_limit

    real = ballistic_limit._fire

    def fire(panel, velocity, give_up):
        if velocity < 130.0:
            raise UnstableError("a number is not finite", where="node (1, 2)", when="after 3 us (step 4)")
        return real(panel, velocity, give_up)

    monkeypatch.setattr(ballistic_limit, "_fire", fire)
    code, _, err = command("critical-velocity", written(), "--out", "results", "--jobs", 1)
    assert code == 3
    line = err.splitlines()[-1]
    assert line.startswith("error: a number is not finite, at node (1, 2), after 3 us (step 4), of the shot at 1")
    folder = tmp_path / "results"
    assert sorted(path.name for path in folder.iterdir()) == ["scene.toml", "shots.csv"]
    rows = list(csv.DictReader((folder / "shots.csv").open(encoding="utf-8")))
    assert rows
    assert {row["outcome"] for row in rows} == {"perforated"}
