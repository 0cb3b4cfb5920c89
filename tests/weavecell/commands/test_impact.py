"""`weavecell impact`: energies of its record, resuming to the bit, instability with what was computed, nothing
half-written; and `weavecell view` of what it wrote."""

import re
import shutil
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import pyvista
from PIL import Image

from shellfabric.loop import checkpoint
from tests.scene_text import datasets, every, impact_scene
from tests.weavecell.written import names, page_of, table_of
from weavecell.report.shot import view
from weavecell.results import vtk
from weavecell.results.result_folder import read_record

EXAMPLES = sorted((Path(__file__).parents[3] / "examples").glob("*.toml"))
# [s] of CPU time
LONG = {"body-armour": 400, "hybrid-pack": 39, "own-fabric": 39, "S-720-perforates": 5}
NIGHTLY = 30  # [CPU s] from which an example runs nightly


def marks_of_long(name):
    """Those of an example; `--check` reads and plans each of them in the quick run."""
    seconds = LONG.get(name, 10)
    if seconds < NIGHTLY:
        return pytest.mark.slow(seconds)
    return pytest.mark.slow(seconds), pytest.mark.nightly


UNSTABLE = "\n[numerics]\ncontact_damping = 30.0\n"


@pytest.fixture
def scene(tmp_path):
    def write(name="scene.toml", outputs="[]", extra=""):
        path = tmp_path / name
        path.write_text(small_scene(outputs, extra))
        return path

    return write


@pytest.fixture
def copied(results, tmp_path):
    """The results of the impact on one ply, as a folder "results" that may be changed."""
    return Path(shutil.copytree(results("impact").folder, tmp_path / "results"))


def small_scene(outputs, extra=""):
    run = every("20 us", "10 us") + f"outputs = {outputs}\n"
    return impact_scene(head='title = "a small panel"', run=run, extra=extra)


@pytest.mark.parametrize("name", ["impact", pytest.param("pack", marks=pytest.mark.slow(6))])
def test_a_resumed_run_is_the_uninterrupted_one(
    command, succeed, results, drawn_once, interrupted, tmp_path, name
):
    whole = results(name).folder
    again = tmp_path / "again"
    with interrupted(0.45):
        code, _, err = command(f"impact {whole}/scene.toml --out again")
    assert code == 130
    assert err == "error: interrupted; --resume goes on from its last checkpoint\n"
    assert names(again) == "checkpoint.h5"
    succeed(f"impact {whole}/scene.toml --out again --resume")
    assert names(again) == names(whole)
    assert datasets(again / "histories.h5") == datasets(whole / "histories.h5")
    for file in ("panel.pvd", *(f"panel/{name}" for name in names(whole / "panel").split())):
        assert (again / file).read_bytes() == (whole / file).read_bytes()


def test_a_run_of_seconds_leaves_no_checkpoint(command, scene, interrupted, tmp_path):
    with interrupted(0.95, least_wall=checkpoint.LEAST_WALL):
        assert command(f"impact {scene()} --out results")[::2] == (130, "error: interrupted\n")
    assert not (tmp_path / "results").exists()


def test_resume_leaves_a_finished_run_and_a_shorter_one_leaves_nothing_of_it(
    command, succeed, scene, copied
):
    written = (copied / "summary.json").read_text()
    before = names(copied / "panel")
    out = succeed(f"impact {copied}/scene.toml --out results --resume")
    assert out.endswith("results/report.html\ndone before with the same input and code\n")
    assert (copied / "summary.json").read_text() == written
    short = scene("other.toml", outputs='["paraview"]')
    short.write_text(short.read_text().replace('"60 us"', '"20 us"'))
    assert "replaces the results of " in command(f"impact {short} --out results")[1]
    assert len(names(copied / "panel")) < len(before)


@pytest.fixture
def unstable(command, scene, tmp_path):
    """(exit code, standard output, the line of the error, folder) of a run that becomes unstable."""
    path = scene(outputs='["paraview", "pictures", "report"]', extra=UNSTABLE)
    code, out, err = command(f"impact {path} --out results")
    line = next(line for line in err.splitlines() if line.startswith("error: "))
    return code, out, line, tmp_path / "results"


def test_an_unstable_run_says_where_and_when(unstable):
    code, out, line, _ = unstable
    assert code == 3
    assert re.search(r"at node .* us \(step ", line)
    assert "UNSTABLE, and no result: " in out


def test_an_unstable_run_keeps_what_it_computed(unstable):
    *_, line, folder = unstable
    files = "histories.h5 panel panel.pvd pictures report.html scene.toml summary.json"
    assert names(folder) == files
    record = read_record(folder / "histories.h5")
    assert record.outcome == "unstable"
    assert line == f"error: {record.failure_message}"
    assert len(record.time) >= 2
    assert np.isfinite(record.velocity).all()
    page = page_of(folder)
    assert 'class="answer unstable"' in page
    assert record.failure_message in page


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_examples_can_be_run(succeed, example):
    assert f"weavecell impact examples/{example.name}" in example.read_text()
    assert "CPU time" in succeed(f"impact {example} --check")


@pytest.mark.parametrize(
    "example",
    [pytest.param(path, marks=marks_of_long(path.stem)) for path in EXAMPLES],
    ids=lambda path: path.stem,
)
def test_examples_run(succeed, tmp_path, example):
    succeed(f"impact {example} --out results")
    told = table_of(tmp_path / "results")
    assert told["outcome"] in ("stopped", "perforated")
    assert told["energy_error_max"] < 0.01


def test_a_view_has_the_whole_panel_and_the_projectile(results):
    folder = results("impact").folder
    file = view.find(folder)
    panel = view.read_shot(folder, file)
    # half of it is computed: the place that is struck is on one yarn
    assert panel.mirrors == (False, True)
    assert view.read_shot(folder / "panel.pvd", file).series == panel.series
    last, t = panel.series[-1]
    assert last == file
    assert [time for _, time in panel.series] == sorted(time for _, time in panel.series)
    assert t == pytest.approx(panel.record.time[-1], rel=1e-8)
    grid = pyvista.read(file)
    body = panel.body(grid, t)
    assert body[..., 2].max() == pytest.approx(panel.record.final[-1].nose_position)
    image = panel.image(grid, t)
    quarters = [
        np.any(half < 240, axis=2).sum()
        for rows in np.array_split(image, 2)
        for half in np.array_split(rows, 2, 1)
    ]
    assert min(quarters) > 0.15 * sum(quarters)  # fabric on all four sides of the impact point
    steel = np.ptp(image.astype(int), axis=2) < 25
    assert np.any(steel & (image.mean(axis=2) < 180))


def test_a_view_is_written_as_a_picture(command, copied, tmp_path):
    assert command("view results --screenshot panel.png")[:2] == (0, "written to panel.png\n")
    with Image.open(tmp_path / "panel.png") as picture:
        assert np.ptp(np.asarray(picture.convert("L"))) > 100


def test_a_view_is_written_as_a_movie_and_a_page(command, copied, tmp_path):
    written = "written to shot.gif\nwritten to shot.html\n"
    assert command("view results --movie shot.gif --html shot.html")[:2] == (0, written)
    assert "20 \\u00b5s after the strike" in (tmp_path / "shot.html").read_text("utf-8")
    with Image.open(tmp_path / "shot.gif") as movie:
        assert movie.n_frames == len(vtk.read_series(copied / "panel.pvd"))


def test_a_view_without_a_display_names_what_needs_none(command, copied, monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    line = "error: there is no display for a window: give --html FILE.html, --screenshot FILE.png or --movie FILE.gif\n"
    assert command("view results") == (2, "", line)


def test_a_movie_without_its_package_names_the_package(command, copied, monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio.v2", None)
    assert "imageio" in command("view results --movie shot.mp4")[2]


def test_a_view_without_histories_names_the_file(command, copied):
    (copied / "histories.h5").unlink()
    assert "histories.h5" in command("view results --movie shot.gif")[2]
    # a folder of another program has no list of files
    (copied / ".weavecell-files").unlink()
    assert view.read_shot(copied, view.find(copied)) is None


def test_failed_yarns_keep_their_colour_in_a_movie(tmp_path):
    """Five pixels of a picture that has far more colours than a GIF."""
    image = np.random.default_rng(1).integers(90, 255, (60, 80, 1)) * np.array([0.7, 0.9, 1.0])
    image[30, 40:45] = 213, 94, 0
    (tmp_path / "a.gif").write_bytes(view.gif([image.astype(np.uint8)] * 3))
    with Image.open(tmp_path / "a.gif") as movie:
        seen = np.asarray(movie.convert("RGB"))[30, 40:45].astype(int)
    assert abs(seen - (213, 94, 0)).max() < 6


def test_a_projectile_at_rest_has_no_sign():
    record = SimpleNamespace(
        time=np.array([0.0, 1e-4]), velocity=np.array([90.0, -0.2]), time_of_pack=float
    )
    caption = view.ViewedShot.caption(SimpleNamespace(record=record), 1e-4)
    assert caption == "100 µs after the strike, projectile at 0 m/s"
