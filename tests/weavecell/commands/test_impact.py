"""`weavecell impact`: its folder, resuming to the bit, instability with what was computed, nothing half-written."""

import json
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import trapezoid

from shellfabric.output import checkpoint
from tests.scene_text import datasets, every, impact_scene
from weavecell.commands import impact as commands_impact
from weavecell.report.shot import view
from weavecell.results import out_folder, paraview, progress
from weavecell.results.impact import ImpactRecord

EXAMPLES = sorted((Path(__file__).parents[3] / "examples").glob("*.toml"))
EVERYTHING = ["histories.h5", "panel", "panel.pvd", "pictures", "report.html", "scene.toml", "summary.json"]


@pytest.fixture
def scene(tmp_path):
    def write(name="scene.toml", outputs="[]", extra=""):
        path = tmp_path / name
        path.write_text(small_scene(outputs, extra))
        return path

    return write


def small_scene(outputs, extra=""):
    run = every("20 us", "10 us") + f"outputs = {outputs}\n"
    return impact_scene(head='title = "a small panel"', run=run, extra=extra)


def names(folder):
    return sorted(path.name for path in folder.iterdir() if path.name != out_folder.LOCK)


def interrupt_at(monkeypatch, share, least_wall=0.0):
    """From now on the user presses Ctrl-C when `share` of a run is done; checkpoints may be `least_wall` [s] apart."""
    from contextlib import contextmanager

    @contextmanager
    def bar(_title):
        def advance(done, _text=""):
            if done >= share:
                raise KeyboardInterrupt

        yield advance

    monkeypatch.setattr(progress, "bar", bar)
    monkeypatch.setattr(checkpoint, "LEAST_WALL", least_wall)


def test_everything_asked_for_is_written(command, scene, tmp_path):
    path = scene(outputs='["paraview", "pictures", "report"]')
    code, out, _ = command("impact", path, "--out", "results")
    folder = tmp_path / "results"
    assert code == 0
    assert names(folder) == EVERYTHING
    pictures = ["cell.svg", "cuts.svg", "energies.svg", "histories.svg", "panel.png", "reactions.svg"]
    assert names(folder / "pictures") == pictures
    assert (folder / "scene.toml").read_text() == path.read_text()
    record = ImpactRecord.read(folder / "histories.h5")
    assert record.energy_error_max < 0.01
    assert record.velocity[0] == 155.0
    np.testing.assert_allclose(record.energies["kinetic_projectile"], 0.5 * 3e-3 * record.velocity**2, rtol=1e-5)
    path_length = trapezoid(record.velocity, record.time)
    assert record.nose_position[-1] - record.nose_position[0] == pytest.approx(path_length, rel=1e-3)
    total = sum(values for name, values in record.energies.items() if name != "error")
    np.testing.assert_allclose(total, record.strike_energy + record.energies["error"], rtol=1e-9)
    series = paraview.read_series(folder / "panel.pvd")
    assert [file.exists() for file, _ in series] == [True] * len(series)
    assert [time for _, time in series] == sorted(time for _, time in series)
    assert series[-1][1] == pytest.approx(record.time[-1], rel=1e-8)
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["outcome"] == record.outcome
    assert summary["outcome"] in out
    assert summary["provenance"]["scene"] == path.read_text()
    assert "numpy" in summary["provenance"]["packages"]


def test_view_draws_the_result(command, scene, tmp_path, monkeypatch):
    command("impact", scene(outputs='["paraview"]'), "--out", "results")
    assert command("view", "results", "--screenshot", "panel.png")[:2] == (0, "written to panel.png\n")
    assert (tmp_path / "panel.png").read_bytes().startswith(b"\x89PNG")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    line = "error: there is no display for a window: give --screenshot FILE.png or --movie FILE.gif\n"
    assert command("view", "results") == (2, "", line)


def test_view_shows_the_whole_panel_and_the_projectile(command, scene, tmp_path):
    command("impact", scene(outputs='["paraview"]'), "--out", "results")
    file = view.find(tmp_path / "results")
    panel = view.panel_of(tmp_path / "results", file)
    assert panel.mirrors == (True, True)
    assert view.panel_of(tmp_path / "results" / "panel.pvd", file).series == panel.series
    last, t = panel.series[-1]
    assert last == file
    body = panel.body(panel.record.final[-1].nose_position, t)
    assert body[..., 2].max() == pytest.approx(panel.record.final[-1].nose_position)
    image = view.frame(panel, file, t)
    quarters = [
        np.any(half < 240, axis=2).sum() for rows in np.array_split(image, 2) for half in np.array_split(rows, 2, 1)
    ]
    assert min(quarters) > 0.15 * sum(quarters)  # cloth on all four sides of the impact point
    steel = np.ptp(image.astype(int), axis=2) < 25
    assert np.any(steel & (image.mean(axis=2) < 180))
    (tmp_path / "results" / "histories.h5").unlink()
    assert view.panel_of(tmp_path / "results", file) is None


def test_a_long_title_of_a_view_is_beside_nothing():
    """Title, outcome, and time and velocity below them: no text lies on another or goes over the edge."""
    record = SimpleNamespace(title="one ply of S-720 " * 9, outcome="perforated")
    panel = SimpleNamespace(record=record, caption=lambda t: f"{1e6 * t:.0f} µs after the strike, projectile at 92 m/s")
    with view.plots() as pyplot, pyplot.rc_context({"figure.constrained_layout.use": False}):
        figure = view.compose(pyplot, panel, np.zeros((2, 2, 3)), 250e-6)
        figure.canvas.draw()
        title, caption = (text.get_window_extent() for text in figure.texts)
        assert "..." in figure.texts[0].get_text()
        assert not title.overlaps(caption)
        assert max(title.x1, caption.x1) < figure.bbox.x1
        pyplot.close(figure)


def test_view_writes_a_movie(command, scene, tmp_path, monkeypatch):
    from PIL import Image

    command("impact", scene(outputs='["paraview"]'), "--out", "results")
    assert command("view", "results", "--movie", "shot.gif")[:2] == (0, "written to shot.gif\n")
    with Image.open(tmp_path / "shot.gif") as movie:
        assert movie.n_frames == len(paraview.read_series(tmp_path / "results" / "panel.pvd"))
    monkeypatch.setitem(sys.modules, "imageio.v2", None)
    code, _, err = command("view", "results", "--movie", "shot.mp4")
    assert (code, err.count("\n")) == (2, 1)
    assert "imageio" in err
    code, _, err = command("view", "results", "--movie", "shot.avi")
    assert (code, err) == (2, "error: --movie = 'shot.avi': must be a file named *.gif or *.mp4\n")
    (tmp_path / "results" / "histories.h5").unlink()
    code, _, err = command("view", "results", "--movie", "shot.gif")
    assert code == 2
    assert "histories.h5" in err


def test_resumed_run_is_the_uninterrupted_one(command, scene, tmp_path, monkeypatch):
    path = scene(outputs='["paraview"]')
    assert command("impact", path, "--out", "whole")[0] == 0
    with monkeypatch.context() as patch:
        interrupt_at(patch, 0.45)
        code, _, err = command("impact", path, "--out", "resumed")
    assert code == 130
    assert err == "error: interrupted; --resume goes on from its last checkpoint\n"
    assert names(tmp_path / "resumed") == ["checkpoint.h5"]
    assert command("impact", path, "--out", "resumed", "--resume")[0] == 0
    one, other = tmp_path / "whole", tmp_path / "resumed"
    assert names(other) == names(one)
    assert datasets(other / "histories.h5") == datasets(one / "histories.h5")
    for file in ("panel.pvd", *(f"panel/{name}" for name in names(one / "panel"))):
        assert (other / file).read_bytes() == (one / file).read_bytes()


def test_a_run_of_seconds_leaves_no_checkpoint(command, scene, tmp_path, monkeypatch):
    interrupt_at(monkeypatch, 0.95, least_wall=checkpoint.LEAST_WALL)
    assert command("impact", scene(), "--out", "results")[::2] == (130, "error: interrupted\n")
    assert not (tmp_path / "results").exists()


def test_resume_of_another_scene_is_refused(command, scene, tmp_path, monkeypatch):
    with monkeypatch.context() as patch:
        interrupt_at(patch, 0.45)
        command("impact", scene(), "--out", "results")
    other = scene("other.toml", extra="\n[numerics]\npenalty = 0.02\n")
    code, _, err = command("impact", other, "--out", "results", "--resume")
    assert code == 2
    assert err == "error: results/checkpoint.h5: is the checkpoint of another run\n"
    assert names(tmp_path / "results") == ["checkpoint.h5"]


def test_resume_begins_a_new_run_and_leaves_a_finished_one(command, scene, tmp_path):
    path = scene()
    assert command("impact", path, "--out", "results", "--resume")[0] == 0
    written = (tmp_path / "results" / "summary.json").read_text()
    code, out, _ = command("impact", path, "--out", "results", "--resume")
    assert code == 0
    assert out.endswith("; done before with the same input and code, in results\n")
    assert (tmp_path / "results" / "summary.json").read_text() == written
    other = scene("other.toml", extra="\n[numerics]\npenalty = 0.02\n")
    assert command("impact", other, "--out", "results", "--resume")[1].startswith("replaces the results of ")


def test_unstable_run_keeps_what_it_computed(command, scene, tmp_path):
    path = scene(outputs='["paraview", "pictures", "report"]', extra="\n[numerics]\ncontact_damping = 30.0\n")
    code, out, err = command("impact", path, "--out", "results")
    folder = tmp_path / "results"
    assert code == 3
    line = next(line for line in err.splitlines() if line.startswith("error: "))
    assert "at node" in line
    assert " us (step " in line
    assert "unstable" in out
    assert names(folder) == EVERYTHING
    record = ImpactRecord.read(folder / "histories.h5")
    assert record.outcome == "unstable"
    assert line == f"error: {record.failure_message}"
    assert len(record.time) >= 2
    assert np.isfinite(record.velocity).all()
    assert 'class="card unstable"' in (folder / "report.html").read_text()
    assert record.failure_message in (folder / "report.html").read_text()


def test_shorter_run_leaves_nothing_of_a_longer_one(command, scene, tmp_path):
    command("impact", scene(outputs='["paraview"]'), "--out", "results")
    before = names(tmp_path / "results" / "panel")
    short = scene("short.toml", outputs='["paraview"]')
    short.write_text(short.read_text().replace('end_time = "60 us"', 'end_time = "20 us"'))
    command("impact", short, "--out", "results")
    assert len(names(tmp_path / "results" / "panel")) < len(before)


def test_failure_while_writing_leaves_whole_files_only(command, scene, tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(commands_impact.report_page, "render", full)
    monkeypatch.setattr(checkpoint, "LEAST_WALL", 0.0)
    path = scene(outputs='["report"]')
    with pytest.raises(OSError, match="No space"):
        commands_impact.run(path, tmp_path / "results")
    kept = names(tmp_path / "results")
    assert "checkpoint.h5" in kept
    assert not [name for name in kept if name.startswith(".") or name == "report.html"]
    ImpactRecord.read(tmp_path / "results" / "histories.h5")


@pytest.mark.parametrize("example", [pytest.param(p, id=p.stem) for p in EXAMPLES])
def test_examples_run(command, tmp_path, example):
    assert command("impact", example, "--out", "results")[0] == 0
    told = json.loads((tmp_path / "results" / "summary.json").read_text())
    assert told["outcome"] in ("stopped", "perforated")
    assert told["energy_error_max"] < 0.01


def test_a_projectile_at_rest_has_no_sign():
    record = SimpleNamespace(time=np.array([0.0, 1e-4]), velocity=np.array([90.0, -0.2]))
    caption = view.Panel.caption(SimpleNamespace(record=record), 1e-4)
    assert caption == "100 µs after the strike, projectile at 0 m/s"


def test_the_signature_in_a_block_is_printed(capsys):
    record = SimpleNamespace(
        title="S-728", outcome="stopped", residual_velocity=0.0, pack=None, energy_error_max=1e-4, strike_energy=10.0,
        rigid_check="", backing=SimpleNamespace(back_face_signature=0.0114), energies={"backing_kinetic": [0.0, 5.4]},
        viscous_energy_fraction=0.02, absorbed_energy=4.0,
    )  # fmt: skip
    commands_impact._tell(record, Path("out"), None, None)
    said = "back-face signature 11.4 mm; the block still moves with 54 % of the strike energy"
    assert said in capsys.readouterr().out
