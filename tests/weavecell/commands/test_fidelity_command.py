"""A scene that says how well it wants to know something: what is chosen, told, kept and resumed."""

import json

import h5py
import pytest
from test_impact import datasets, small_scene

ACCURACY = '\n[accuracy]\nresidual_velocity = "5 %"\n'


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(small_scene('["report"]', ACCURACY))
    return path


def test_the_promise_is_reported_and_kept(command, scene, tmp_path):
    """The residual velocity is as near to that of the full model, run beside it by hand, as the scene wants."""
    code, out, err = command("impact", scene, "--out", "results")
    assert code == 0, err
    told = json.loads((tmp_path / "results/summary.json").read_text())["accuracy"]
    assert told["targets"] == {"residual_velocity": 0.05}
    assert told["symmetry"] == "quarter"
    assert told["confirmed"] is True
    assert f"accuracy confirmed: {told['model']}, quarter panel" in out
    assert "The model that was chosen" in (tmp_path / "results/report.html").read_text()
    assert not list((tmp_path / "results").glob("checkpoint*"))
    full = "elements_per_crossover = 3\nend_time"
    scene.write_text(scene.read_text().replace(ACCURACY, "").replace("end_time", full))
    assert command("impact", scene, "--out", "full")[0] == 0
    shares = {}
    for name in ("results", "full"):
        with h5py.File(tmp_path / name / "histories.h5") as file:
            shares[name] = file["histories/velocity"][-1] / file["histories/velocity"][0]
    assert 0.5 < shares["full"] < 0.95  # it has been slowed
    assert told["values"]["residual_velocity"] == pytest.approx(shares["results"], rel=1e-3)  # of the run in the folder
    off = abs(told["values"]["residual_velocity"] - shares["full"])
    assert off <= told["estimated_errors"]["residual_velocity"] <= 0.05


def test_explain_runs_nothing(command, scene, tmp_path):
    code, out, _ = command("impact", scene, "--explain")
    assert code == 0
    assert "->" in out
    assert "targets: residual velocity 5 %" in out
    assert not (tmp_path / "results").exists()


def test_resumed_run_is_the_uninterrupted_one(command, scene, tmp_path, monkeypatch):
    assert command("impact", scene, "--out", "whole")[0] == 0
    calls = []

    def stop(march):
        calls.append(march)
        if len(calls) == 20:
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("shellfabric.output.hooks.Progress.__call__", lambda self, march: stop(march))
        patch.setattr("shellfabric.output.checkpoint.LEAST_WALL", 0.0)
        assert command("impact", scene, "--out", "resumed")[0] == 130
    assert [path.suffix for path in (tmp_path / "resumed").iterdir()] == [".h5"]
    assert command("impact", scene, "--out", "resumed", "--resume")[0] == 0
    assert datasets(tmp_path / "whole/histories.h5") == datasets(tmp_path / "resumed/histories.h5")
