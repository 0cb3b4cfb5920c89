"""The folder of --out: probed before anything is computed, kept from other runs, and what it replaces is named."""

import os
import shlex
import subprocess
import sys

import pytest

from fabrics.base.errors import InputError
from tests.scene_text import impact_scene
from tests.weavecell.session_runs import RUNS, write_inputs
from weavecell.results import out_folder

HOLD = (
    "import sys; from pathlib import Path; from weavecell.results import out_folder; "
    "out_folder.claim(Path(sys.argv[1]), []); print('held', flush=True); input()"
)
OTHERS = {"biaxial": "biaxial S-720", "reduce tests": "reduce tests shots.csv"}


@pytest.fixture(autouse=True)
def released():
    yield
    out_folder.release()


@pytest.mark.parametrize("name", [*RUNS, *OTHERS])
def test_a_folder_that_cannot_be_made_is_refused_before_the_run(
    command, tmp_path, monkeypatch, name
):
    def computed(*_, **__):
        raise AssertionError("something is computed")

    if name in RUNS and RUNS[name].get("solid"):
        pytest.importorskip("dolfinx")
    monkeypatch.setattr("shellfabric.cell.model.CellTable.fill", computed)
    monkeypatch.setattr("meshing.crossover.build", computed)
    (tmp_path / "shots.csv").write_text("velocity [m/s], outcome\n80, PP\n120, CP\n")
    if name in RUNS:
        write_inputs(name)
    (tmp_path / "file").write_text("")
    words = OTHERS[name] if name in OTHERS else RUNS[name]["words"]
    code, _, err = command(*shlex.split(words), "--out", "file/out")
    assert (
        err
        == "error: --out = 'file/out': must be a folder that can be written to (Not a directory)\n"
    )
    assert code == 2


def test_a_run_is_kept_from_the_folder_of_another_until_that_ends(tmp_path):
    folder = tmp_path / "made" / "out"
    other = subprocess.Popen([sys.executable, "-c", HOLD, folder], stdin=-1, stdout=-1, text=True)
    assert other.stdout.readline() == "held\n"
    with pytest.raises(
        InputError, match="must be another folder: another run is writing to this one"
    ):
        out_folder.claim(folder, [])
    other.kill()  # the system frees the lock
    other.communicate()
    out_folder.claim(folder, [])
    out_folder.claim(folder, [])
    assert os.listdir(folder) == [out_folder.LOCK]
    out_folder.release()
    assert os.listdir(folder) == []


def test_a_folder_that_was_made_and_is_empty_goes(tmp_path):
    out_folder.claim(tmp_path / "made" / "out", [], inputs=[1.0])
    out_folder.release()
    assert os.listdir(tmp_path) == []


def test_what_is_replaced_is_named(command):
    words = "biaxial", "S-731", "--ratio", "1:1", "--out", "b"
    assert command(*words)[1].startswith("S-731, biaxial response")
    first = command(*words)[1].splitlines()[0]
    assert first.startswith("replaces the results of S-731 of 20")
    assert first.endswith(" UTC in b")


def test_to_resume_is_refused_in_a_folder_of_another_input(command, tmp_path, monkeypatch):
    """Comments, the title and the path of the file make no other input."""

    def interrupted(*_, **__):
        (tmp_path / "r" / "kept.json").write_text('{"date": "today", "title": "S-720, 155 m/s"}')
        raise KeyboardInterrupt

    def times():
        return {path: path.stat().st_mtime_ns for path in (tmp_path / "r").iterdir()}

    monkeypatch.setattr("weavecell.api.sweeps.run_cache.results", interrupted)
    over = "--over 'run.end_time=10 us,20 us'"
    one = impact_scene().replace(
        "[projectile]", 'law = { a = "45 um", b = "58 um * N**(1/3)" }\n[projectile]'
    )
    for name, text in (
        ("one", one),
        ("same", f'title = "a" # b\n{one}'),
        ("other", one.replace("50 mm", "60 mm")),
    ):
        (tmp_path / f"{name}.toml").write_text(text)
    assert command(f"sweep one.toml {over} --out r")[0] == 130
    assert command(f"sweep same.toml {over} --out r --resume")[0] == 130
    before = times()
    code, _, err = command(f"sweep other.toml {over} --out r --resume")
    line = "error: --out = 'r': must be another folder: this one has S-720, 155 m/s of today, of other input or "
    assert code == 2
    assert err == f"{line}options; without --resume it is replaced\n"
    assert times() == before


KILLED = (
    "import os, sys; from pathlib import Path; from fabrics.base import files\n"
    "with files.replace_whole(Path(sys.argv[1])): os._exit(9)"
)


def test_what_a_killed_run_left_unfinished_goes(tmp_path):
    """In the folder and in those of its names; hidden files of others stay, as does what is not of these folders."""
    for name in ("shots.csv", "pictures/curve.svg", "mine/shots.csv"):
        subprocess.run([sys.executable, "-c", KILLED, tmp_path / name], check=False)
    kept = [
        ".shots-abcd1234.csv",
        ".weavecell-notes.txt",
        ".weavecell-shots-ABCD1234.csv",
        "mine/.curve-abcd1234.svg",
    ]
    for name in kept:
        (tmp_path / name).write_text("mine")
    assert sum(path.is_file() for path in tmp_path.rglob("*")) == 3 + len(kept)
    out_folder.claim(tmp_path, ["shots.csv", "pictures/*.svg", "panel/*"])
    out_folder.release()
    left = [p.relative_to(tmp_path).as_posix() for p in tmp_path.rglob("*") if p.is_file()]
    (unfinished,) = [name for name in left if name not in kept]
    assert unfinished.startswith("mine/.weavecell-shots-")
    assert set(kept) < set(left)
