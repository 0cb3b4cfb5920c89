"""Scenes of packs: their folder, resuming to the bit, and one clear line for what does not go together."""

import json

import h5py
import numpy as np
import pytest
from scipy.integrate import trapezoid
from test_impact import datasets, interrupt_at, names

from fabrics import catalogue
from tests.scene_text import every, impact_scene
from weavecell.report.shot import view
from weavecell.results import progress
from weavecell.results.impact import ImpactRecord

EVERYTHING = ["histories.h5", "panel", "panel.pvd", "pictures", "report.html", "scene.toml", "summary.json"]


HALF = 22.5e-3 + 1e-9  # [m] of the opening


@pytest.fixture
def scene(tmp_path):
    def write(panel='stacking = "alternating"\nply_gap = "0.1 mm"', outputs="[]", extra=""):
        path = tmp_path / "scene.toml"
        run = every("8 us", "4 us") + f"outputs = {outputs}\n"
        path.write_text(
            impact_scene("200 m/s", "45 mm", "24 us", fabric="S-728", panel=f"plies = 3\n{panel}", run=run, extra=extra)
        )
        return path

    return write


def test_everything_asked_for_is_written(command, scene, tmp_path):
    path = scene(outputs='["paraview", "pictures", "report"]')
    code, out, _ = command("impact", path, "--out", "results")
    folder = tmp_path / "results"
    assert code == 0
    assert names(folder) == EVERYTHING
    assert "3 x S-728, 200 m/s: in flight" in out
    told = json.loads((folder / "summary.json").read_text())
    assert told["plies"] == 3
    assert told["stacking"] == "alternating"
    assert (told["ply_gap_m"], told["ply_gap_low_m"], told["ply_gap_source"]) == (1e-4, 1e-4, "given")
    assert "ply gap 0.1 mm, given" in out.splitlines()
    assert told["energy_error_max"] < 5e-3
    assert len(told["ply_failed_yarn_segments"]) == 3
    assert sum(told["ply_failed_yarn_segments"]) == told["failed_yarn_segments"]
    record = ImpactRecord.read(folder / "histories.h5")
    assert record.count == 3
    impulse = trapezoid(record.plies["push"].sum(axis=1), record.time)  # of the nose on all plies
    assert impulse == pytest.approx(record.mass * (record.velocity[0] - record.velocity[-1]), rel=0.05)
    assert len(record.cuts) == 3
    assert record.z_rest[1] == pytest.approx(record.thickness[0] + 0.1e-3)
    assert names(folder / "pictures") == [
        "cell.svg", "cuts.svg", "energies.svg", "histories.svg", "panel.png", "plies.svg", "pushes.svg",
        "reactions.svg",
    ]  # fmt: skip
    page = (folder / "report.html").read_text()
    assert "3 plies of S-728, alternating, " in page
    assert "At rest: ply gap 0.1 mm, given; contact of plies: " in page
    with h5py.File(folder / "histories.h5") as file:
        assert file["plies/histories/push"].attrs["unit"] == "N"
        assert file["plies/histories/push"].shape == (len(record.time), 3)
    import pyvista
    from PIL import Image

    last = sorted((folder / "panel").iterdir())[-1]
    grid = pyvista.read(last)
    assert set(np.unique(grid.cell_data["ply"])) == {1, 2, 3}
    assert command("view", "results", "--screenshot", "pack.png")[0] == 0
    assert view.find(folder) == last
    assert view.summary_of(last)["mirror_x"] is True
    panel = view.panel_of(folder, last)
    assert panel.strength(grid).shape == (len(grid.cell_data["ply"]), 2)
    assert panel.body(0.01, record.time[-1])[..., 2].max() == pytest.approx(0.01)  # its foremost point
    assert "m/s" in panel.caption(panel.series[-1][1])
    assert np.ptp(view.frame(panel, *panel.series[-1])) > 50  # not an empty picture
    assert command("view", "results", "--movie", "pack.gif")[0] == 0
    with Image.open(tmp_path / "pack.gif") as movie:
        assert movie.n_frames == len(panel.series)
    assert command("view", "results", "--cut", "--movie", "cut.gif", "--screenshot", "cut.png")[0] == 0
    with Image.open(tmp_path / "cut.gif") as movie:
        assert movie.n_frames == len(record.cuts)
        sizes = {movie.size}
        movie.seek(movie.n_frames - 1)
        assert {movie.size} == sizes
        assert np.ptp(np.asarray(movie.convert("L"))) > 150  # not an empty picture
    refused = "error: --cut: must be given with --screenshot or --movie, of a folder with panel.pvd and histories.h5\n"
    assert command("view", "results", "--cut")[::2] == (2, refused)
    assert command("view", last, "--cut")[::2] == (2, refused)
    whole = pyvista.merge(view.mirrored(grid, (True, True)))
    assert whole.bounds[:4] == pytest.approx([-grid.bounds[1], grid.bounds[1], -grid.bounds[3], grid.bounds[3]])


def test_a_hybrid_pack_says_what_it_is_made_of(command, scene, tmp_path):
    plies = '[[panel.ply]]\ncount = 2\n[[panel.ply]]\nname = "S-726"\nangle = "90 deg"\ngap = "0.2 mm"'
    path = scene(f'symmetry = "half"\n{plies}', outputs='["paraview", "pictures", "report"]')
    path.write_text(path.read_text().replace("plies = 3\n", ""))
    code, out, err = command("impact", path, "--out", "results")
    assert code == 0, err
    assert "2 x S-728 + 1 x S-726 at 90 deg, 200 m/s: in flight" in out
    told = json.loads((tmp_path / "results" / "summary.json").read_text())
    assert (told["plies"], told["stacking"]) == (3, "lay-up")
    assert told["ply_fabrics"] == ["S-728", "S-728", "S-726"]
    assert told["ply_angles_deg"] == [0.0, 0.0, 90.0]
    record = ImpactRecord.read(tmp_path / "results" / "histories.h5")
    cloths = [catalogue.load(name).with_effective_density() for name in ("S-728", "S-728", "S-726")]
    strengths = [[yarn.strength for yarn in cloth.weave.yarns] for cloth in cloths]
    assert record.strength == pytest.approx(np.array(strengths), rel=1e-12)
    page = (tmp_path / "results" / "report.html").read_text()
    assert "3 plies: 2 x S-728 + 1 x S-726 at 90 deg" in page
    assert "Data of the fabric S-726" in page
    assert command("view", "results", "--screenshot", "pack.png")[0] == 0


def test_a_pack_of_any_angles_is_reported_and_drawn(command, scene, tmp_path, monkeypatch):
    """Backing, histories, pictures and checkpoint of a hybrid pack at 0, 30 and -45 degrees before a block."""
    import pyvista

    plies = '[[panel.ply]]\n[[panel.ply]]\nname = "S-726"\nangle = "30 deg"\n[[panel.ply]]\nangle = "135 deg"'
    block = '[backing]\nsize = ["60 mm", "60 mm", "30 mm"]\nmin_size = "3 mm"\ngrowth = 1.5\n'
    extra = f'{block}[history]\ninterval = "2 us"\n'
    path = scene(f"ply_friction = 0.2\n{plies}", outputs='["paraview", "pictures", "report"]', extra=extra)
    text = path.read_text().replace("plies = 3\n", "").replace("24 us", "12 us")
    path.write_text(text.replace("[run]\n", "[run]\nelements_per_crossover = 1\n"))
    code, out, err = command("impact", path, "--out", "results")
    assert code == 0, err
    assert "1 x S-728 + 1 x S-726 at 30 deg + 1 x S-728 at -45 deg, 200 m/s" in out
    folder = tmp_path / "results"
    told = json.loads((folder / "summary.json").read_text())
    assert told["ply_angles_deg"] == [0.0, 30.0, -45.0]
    assert told["energy_error_max"] < 5e-3
    assert told["back_face_signature_mm"] > 0.1
    record = ImpactRecord.read(folder / "histories.h5")
    assert (record.mirror_x, record.mirror_y, record.backing.share) == (False, False, 1.0)
    for cut in record.cuts:  # of each ply, from edge to edge of the opening and through its deepest point
        for line in cut.lines:
            assert -HALF <= np.nanmin(line[:, 0]) < -20e-3
            assert HALF >= np.nanmax(line[:, 0]) > 20e-3
    deepest = [(np.nanmax(line[:, 1]), shape.nodes[:, 2].max()) for line, shape in zip(cut.lines, record.final)]
    assert all(drawn == pytest.approx(found, rel=0.05) for drawn, found in deepest)
    grid = pyvista.read(sorted((folder / "panel").glob("*.vtu"))[-1])
    for ply, angle in enumerate(told["ply_angles_deg"], 1):  # where its yarns lie in the frame of all
        cells = grid.extract_cells(grid.cell_data["ply"] == ply)
        assert np.abs(cells.points[:, :2]).max() <= HALF, "nothing is drawn beyond the opening"
        side = cells.extract_cells([cells.find_closest_cell((14e-3, 14e-3, 0.0))]).points
        along = np.degrees(np.arctan2(*(side[1] - side[0])[1::-1]))
        assert along == pytest.approx(angle, abs=0.5) or along == pytest.approx(angle + 90, abs=0.5)
    assert "at 30 deg" in (folder / "report.html").read_text()
    assert command("view", "results", "--screenshot", "pack.png")[0] == 0
    original = progress.bar
    interrupt_at(monkeypatch, 0.5)
    assert command("impact", path, "--out", "again")[0] == 130
    monkeypatch.setattr(progress, "bar", original)
    assert command("impact", path, "--out", "again", "--resume")[0] == 0
    assert datasets(folder / "histories.h5") == datasets(tmp_path / "again" / "histories.h5")


def test_histories_of_every_ply_are_written_and_drawn_of_the_first_and_the_last(command, scene, tmp_path):
    path = scene(outputs='["pictures"]', extra='[history]\ninterval = "2 us"\nwarp = ["0 mm", "5 mm"]\n')
    assert command("impact", path, "--out", "results")[0] == 0
    record = ImpactRecord.read(tmp_path / "results" / "histories.h5")
    assert len(record.measured) == 3
    for ply, found in enumerate(record.measured):
        assert [yarn.family for yarn in found.yarns] == ["warp", "warp", "weft"]
        assert found.yarns[0].strength == pytest.approx(record.strength[ply, 0])
        assert found.t[-1] == pytest.approx(record.time[-1])
    assert record.measured[0].yarns[0].deflection.max() > record.measured[2].yarns[0].deflection.max()
    drawn = names(tmp_path / "results" / "pictures")
    assert {f"{name}-ply-{ply}.svg" for name in ("tensions", "fronts", "profiles", "edges") for ply in (1, 3)} <= set(
        drawn
    )


def test_resuming_gives_the_same_bytes(command, scene, tmp_path, monkeypatch):
    path = scene()
    assert command("impact", path, "--out", "whole")[0] == 0
    original = progress.bar
    interrupt_at(monkeypatch, 0.5)
    code, _, err = command("impact", path, "--out", "again")
    assert code == 130
    assert "--resume" in err
    monkeypatch.setattr(progress, "bar", original)
    assert command("impact", path, "--out", "again", "--resume")[0] == 0
    assert datasets(tmp_path / "whole" / "histories.h5") == datasets(tmp_path / "again" / "histories.h5")
    assert names(tmp_path / "again") == ["histories.h5", "scene.toml", "summary.json"]


def test_the_gap_may_come_from_the_fabric(command, scene, tmp_path):
    assert command("impact", scene(""), "--out", "r")[0] == 0
    told = json.loads((tmp_path / "r" / "summary.json").read_text())
    assert told["ply_gap_m"] == told["ply_gap_high_m"] == pytest.approx(0.1185e-3, rel=1e-3)
    assert told["ply_gap_source"].startswith("of the fabric file (thesis Table 5-2), less the ")


def test_a_graded_pack_has_all_records(command, scene, tmp_path):
    """Shapes, cuts and histories of every ply, as without grading; fewer elements, and the shot is much the same."""
    records, history = [], '[history]\ninterval = "2 us"\nwarp = ["0 mm", "5 mm"]\n'
    for name, more in (("plain", "\ngrading = [[inf, 1]]"), ("graded", "\ngrading = [[10, 1], [inf, 2]]")):
        path = scene(panel='ply_gap = "0.1 mm"' + more, outputs='["paraview", "pictures", "report"]', extra=history)
        code, _, err = command("impact", path, "--out", name)
        assert code == 0, err
        records.append(ImpactRecord.read(tmp_path / name / "histories.h5"))
    plain, graded = records
    assert graded.elements < 0.8 * plain.elements
    assert names(tmp_path / "graded") == names(tmp_path / "plain") == EVERYTHING
    assert len(graded.measured) == len(plain.measured) == 3
    assert set(graded.plies) == set(plain.plies)
    np.testing.assert_allclose(graded.velocity[-1], plain.velocity[-1], rtol=0.01)
    np.testing.assert_allclose(graded.plies["push"].max(axis=0)[0], plain.plies["push"].max(axis=0)[0], rtol=0.05)


def test_a_pack_is_answered_as_well_as_its_scene_wants(command, scene, tmp_path):
    accuracy = '\n[accuracy]\nresidual_velocity = "10 %"\n'
    path = scene(outputs='["report"]', extra=accuracy)
    code, out, err = command("impact", path, "--out", "results")
    assert code == 0, err
    told = json.loads((tmp_path / "results/summary.json").read_text())
    assert told["plies"] == 3
    assert told["accuracy"]["targets"] == {"residual_velocity": 0.1}
    assert told["accuracy"]["confirmed"] is True
    assert told["accuracy"]["models_run"][-2:] == [told["accuracy"]["compared_with"], told["accuracy"]["model"]]
    assert f"accuracy confirmed: {told['accuracy']['model']}, quarter panel" in out
    assert "Meshes that were run" in (tmp_path / "results/report.html").read_text()
    assert not list((tmp_path / "results").glob("checkpoint*"))
