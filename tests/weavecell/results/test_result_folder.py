"""A folder of results is read wherever it is, with the files that its scene names, and only as it was written."""

import json
import os
import shutil
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import weavecell as wc
from fabrics import catalogue
from fabrics.base import files
from fabrics.base.errors import InputError
from fabrics.compression import CompressionLaw
from tests.scene_text import FRAME, merged, toml
from weavecell.results import file_list, json_file, keys, out_folder
from weavecell.results.result_folder import KINDS, open_folder

CUBE = Path(__file__).parents[3] / "examples" / "cube.stl"
OWN = {
    "fabric": {"file": "data/mine.toml", "law": "law.json"},
    "projectile": {
        "shape": "stl",
        "stl": "data/body.stl",
        "stl_unit": "mm",
        "mass": "1.1 g",
        "edge_radius": "0.4 mm",
        "strike_velocity": "150 m/s",
    },
    "panel": {
        "opening": "20 mm",
        "ply_contact": "record.csv",
        # another file of the same name, with its own law
        "ply": [{}, {"file": "other/mine.toml", "law": "other/law.json"}],
    },
    "run": {"end_time": "4 us", "snapshot_interval": "2 us", "outputs": ["paraview"]},
}


# a fabric file names its contact law beside it
CURVE = '\n[ply_contact]\nfile = "curve.csv"\n'


@pytest.fixture(scope="module")
def own(tmp_path_factory):
    """A folder with the folders of shot, coupon and sweep, whose fabrics, laws, body and record were there and are
    gone."""
    place = tmp_path_factory.mktemp("own")
    before = place / "before"
    (before / "data").mkdir(parents=True)
    (before / "other").mkdir()
    text = (Path(catalogue.__file__).parent / "S-720.toml").read_text("utf-8")
    (before / "data/mine.toml").write_text(text.replace('"S-720"', '"mine"', 1))
    (before / "other/mine.toml").write_text(text.replace('"S-720"', '"other"', 1) + CURVE)
    CompressionLaw(4.45e-5, 6.47e-5).to_json(before / "law.json")
    CompressionLaw(4.75e-5, 6.17e-5).to_json(before / "other/law.json")
    (before / "data/body.stl").write_bytes(CUBE.read_bytes())
    for number, name in enumerate(("record.csv", "other/curve.csv")):
        rows = [f"{(1 + 0.1 * number) * n}, {2 * n**2}" for n in range(9)]
        (before / name).write_text("\n".join(["closure [um], pressure [kPa]", *rows]))
    (before / "shot.toml").write_text(toml(OWN))
    (before / "frame.toml").write_text(
        FRAME.replace('name = "S-720"', 'file = "data/mine.toml"\nlaw = "law.json"')
    )
    at = Path.cwd()
    os.chdir(before)
    try:
        shot = wc.impact("shot.toml", out="shot")
        wc.coupon("frame.toml", out="coupon")
        one = merged(OWN, {"panel": {}}) | {"panel": {"opening": "20 mm"}}
        Path("ply.toml").write_text(toml(one))
        wc.sweep("ply.toml", over={"panel.opening": ["20 mm", "24 mm"]}, out="sweep")
    finally:
        os.chdir(at)
    for name in ("shot", "coupon", "sweep"):
        shutil.move(before / name, place / name)
    shutil.rmtree(before)
    return place, shot


@pytest.fixture
def folder(own, tmp_path):
    """A copy of the folder of the shot."""
    return Path(shutil.copytree(own[0] / "shot", tmp_path / "moved" / "shot"))


def test_the_folder_has_every_file_that_its_scene_names(own):
    place, _ = own
    assert sorted(path.name for path in (place / "shot/inputs").iterdir()) == [
        "2",
        "body.stl",
        "law.json",
        "mine.toml",
        "named.json",
        "record.csv",
    ]
    named = json.loads((place / "shot/inputs/named.json").read_text())["files"]
    assert named["other/mine.toml"] == "2/mine.toml"
    beside = {path.name for path in (place / "shot/inputs/2").iterdir()}
    assert beside == {"mine.toml", "curve.csv", "law.json"}
    assert (place / "shot/inputs/body.stl").read_bytes() == CUBE.read_bytes()
    assert (place / "shot/scene.toml").read_text() == toml(OWN)
    assert sorted(path.name for path in (place / "coupon/inputs").iterdir()) == [
        "law.json",
        "mine.toml",
        "named.json",
    ]
    assert (place / "sweep/inputs/body.stl").is_file()


def test_a_moved_shot_is_loaded_with_its_own_fabrics_laws_body_and_record(own, folder):
    _, shot = own
    again = wc.load(folder)
    first, *others = again.details().splitlines()
    assert others.pop(0) == f"read from {folder}"
    assert [first, *others] == shot.details().splitlines()
    assert str(again).splitlines()[:-1] == str(shot).splitlines()[:-1]
    assert [each.name for each in again.target.setup.fabrics] == ["mine", "other"]
    wanted = [[law.a for law in ply.laws] for ply in shot.target.setup.lay_up]
    assert [[law.a for law in ply.laws] for ply in again.target.setup.lay_up] == wanted
    assert wanted[0] != wanted[1]
    solids = again.target.setup.projectile.solid, shot.target.setup.projectile.solid
    assert solids[0].digest == solids[1].digest
    np.testing.assert_array_equal(again.velocity, shot.velocity)


def test_a_moved_shot_is_viewed_cited_compared_and_saved_again(folder, tmp_path):
    assert "mine" in str(wc.cite(folder))
    again = wc.load(folder)
    assert len(wc.overlay(again, again).axes) == 3
    wc.view(folder, html=tmp_path / "page.html")
    assert (tmp_path / "page.html").is_file()
    again.save(tmp_path / "saved")
    assert wc.load(tmp_path / "saved").outcome == again.outcome


def test_a_moved_shot_is_fired_again_from_its_scene_and_resumed(own, folder):
    _, shot = own
    # the folder holds this very run, and says so
    assert wc.impact(folder / "scene.toml", out=folder, resume=True).read_from == folder
    fired = wc.impact(folder / "scene.toml")
    np.testing.assert_array_equal(fired.velocity, shot.velocity)


def test_a_file_that_lies_where_the_scene_says_is_read_before_its_copy(folder):
    """Else a run beside its own results would go on with what its files once were."""
    (folder / "data").mkdir()
    text = (folder / "inputs/mine.toml").read_text()
    (folder / "data/mine.toml").write_text(text.replace('"mine"', '"edited"', 1))
    assert wc.impact(folder / "scene.toml").target.setup.fabric.name == "edited"
    assert wc.load(folder).target.setup.fabric.name == "mine"


@pytest.mark.parametrize("name", ["coupon", "sweep"])
def test_other_moved_results_are_loaded_and_cited(own, name):
    found = wc.load(own[0] / name)
    assert found.summary()
    assert "mine" in str(wc.cite(own[0] / name))


@pytest.mark.parametrize(
    "name", ["histories.h5", "summary.json", "scene.toml", "inputs/mine.toml", "inputs/named.json"]
)
@pytest.mark.parametrize("damage", ["cut", "edited", "missing"])
def test_a_damaged_file_is_named_by_all_that_read_the_folder(folder, name, damage):
    harm(folder / name, damage)
    for read in (wc.load, wc.cite, lambda place: wc.view(place, html=folder / "page.html")):
        with pytest.raises(InputError) as refused:
            read(folder)
        assert refused.value.file == folder / name
        assert "load(folder, changed=True)" in str(refused.value)
    assert not (folder / "page.html").exists()


def test_a_changed_file_is_taken_if_the_user_says_so_and_told(folder, caplog):
    text = (folder / "scene.toml").read_text().replace("20 mm", "24 mm")
    (folder / "scene.toml").write_text(text)
    found = wc.load(folder, changed=True)
    assert found.target.text == text
    assert [line for line in caplog.messages if line.endswith("is not as weavecell wrote it")] == [
        f"{folder / 'scene.toml'} is not as weavecell wrote it"
    ]
    harm(folder / "histories.h5", "cut")
    with pytest.raises(InputError, match=r"histories.h5: is not a readable HDF5 file"):
        wc.load(folder, changed=True)


def test_pictures_and_pages_are_for_the_reader(folder):
    for path in (folder / "panel").iterdir():
        path.unlink()
    assert wc.load(folder).outcome == "in flight"
    with pytest.raises(InputError, match=r"panel-0000.vtu: is missing"):
        wc.view(folder, html=folder / "page.html")


def harm(path, damage):
    """Cut a file in half, change one byte of it, or remove it."""
    content = path.read_bytes()
    path.unlink()
    half = len(content) // 2
    if damage == "cut":
        path.write_bytes(content[:half])
    elif damage == "edited":
        path.write_bytes(content[:half] + bytes([content[half] ^ 1]) + content[half + 1 :])


TABLE = "strike velocity [m/s],residual velocity [m/s]\n90,0\n130,60.5\n"


def written(folder, name):
    """Write a result of a kind to a folder: its numbers, its table and a picture."""
    names = [name, "scene.toml", "picture.svg"]
    if KINDS[name].csv:
        names.append(KINDS[name].csv)
    with out_folder.hold(folder, names):
        json_file.write(folder / name, {"format": keys.SUMMARY_FORMAT, "speed_m_s": 97.5})
        files.write(folder / "scene.toml", FRAME)
        files.write(folder / "picture.svg", "<svg/>")
        if KINDS[name].csv:
            files.write(folder / KINDS[name].csv, TABLE)


@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(st.data())
def test_any_kind_with_any_damage_is_as_it_was_or_named(tmp_path_factory, data):
    name = data.draw(st.sampled_from(sorted(KINDS)))
    folder = tmp_path_factory.mktemp("kind") / "r"
    written(folder, name)
    moved = folder.rename(folder.with_name("renamed"))
    assert wc.load(moved).summary()["speed_m_s"] == 97.5
    chosen = data.draw(st.sampled_from(sorted(path.name for path in moved.iterdir())))
    damage = data.draw(st.sampled_from(["cut", "edited", "missing"]))
    if chosen == file_list.NAME:
        return
    harm(moved / chosen, damage)
    if chosen == "picture.svg":
        assert wc.load(moved).summary()["speed_m_s"] == 97.5
        return
    with pytest.raises(InputError) as refused:
        wc.load(moved)
    assert refused.value.file == moved / chosen


def test_a_kind_that_weavecell_did_not_write_there_is_named(tmp_path):
    written(tmp_path / "r", "v50.json")
    (tmp_path / "r" / "difference.json").write_text('{"format": "x"}')
    with pytest.raises(InputError, match=r"difference.json: is not as weavecell wrote it"):
        wc.load(tmp_path / "r")


def test_a_folder_without_its_list_is_read_and_told(tmp_path, caplog):
    written(tmp_path / "r", "v50.json")
    (tmp_path / "r" / file_list.NAME).unlink()
    assert wc.load(tmp_path / "r").summary()["speed_m_s"] == 97.5
    assert any("whether its files were changed cannot be told" in line for line in caplog.messages)


def test_a_table_that_is_none_is_named(tmp_path):
    written(tmp_path / "r", "v50.json")
    (tmp_path / "r" / "shots.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match=r"shots.csv: is not a readable table"):
        open_folder(tmp_path / "r", changed=True).read_tables()
