"""A folder of results that came from anyone: each entry a link, each name of its lists one that leads out; no command
touches anything outside of the folder that it writes to."""

import hashlib
import json
import os
import shlex
import shutil
from pathlib import Path

import pytest

from fabrics import catalogue
from fabrics.base import files, run_cache
from fabrics.base.errors import InputError
from tests.scene_text import impact_scene
from tests.weavecell.session_runs import SCENES, toml
from weavecell.results import file_list, out_folder, vtk
from weavecell.scenes import kept_files

TESTS = "velocity [m/s], outcome\n80, PP\n120, CP\n"
FLIGHT = "time [us], displacement [mm]\n" + "".join(
    f"{time}, {0.15 * time - 2e-4 * time**2}\n" for time in range(0, 300, 5)
)
PLY = "force [N], displacement [mm]\n" + "".join(
    f"{force}, {0.02 * force / (force + 40)}\n" for force in range(20, 1000, 20)
)
# commands that compute little, one of each way of writing: with copies of inputs, runs, pictures, folders in folders
WORDS = {
    "impact": "impact own.toml",
    "sweep": "sweep own.toml --over panel.plies=1 --jobs 1",
    "tests": "reduce tests tests.csv",
    "flight": "reduce shot flight.csv --mass '3 g'",
    "compression": "reduce compression ply.csv --platen-area '361 mm^2'",
    "export": "export own.toml --to lsdyna",
    "biaxial": "biaxial S-731 --ratio 1:1",
    "coupon": "coupon coupon.toml",
}
RESUMED = ("impact", "sweep", "coupon")
# names that lead out of the folder, or to another of its files, of which `OUTSIDE` is the victim
HOSTILE = (
    "../outside/victim",
    "inputs/../../victim",
    "panel/../../panel-1.vtu",
    "inputs/../../outside/victim",
    "inputs/2/../../../outside/victim",
    "pictures/../../outside/victim",
    "panel/panel-../../../outside/victim",
    "./../outside/victim",
    "inputs//../../outside/victim",
    "linked/victim",
    "inputs/linked/victim",
    "runs/linked/victim",
    "{outside}/victim",
    "..",
)


@pytest.fixture
def inputs(command, tmp_path):
    """The files that `WORDS` read, in this folder."""
    text = impact_scene(end_time="3 us", run='outputs = ["paraview", "report"]').replace(
        'name = "S-720"', 'file = "mine/own.toml"'
    )
    (tmp_path / "mine").mkdir()
    shutil.copy(Path(catalogue.__file__).parent / "S-720.toml", tmp_path / "mine/own.toml")
    (tmp_path / "own.toml").write_text(text)
    (tmp_path / "tests.csv").write_text(TESTS)
    (tmp_path / "flight.csv").write_text(FLIGHT)
    (tmp_path / "ply.csv").write_text(PLY)
    coupon = SCENES["frame"] | {"run": {"steps": 1, "outputs": []}}
    (tmp_path / "coupon.toml").write_text(toml(coupon))


def state(folder):
    """{path: content, and instant of the last change} of all that a folder holds."""
    found = {folder: folder.stat().st_mtime_ns}
    for path in folder.rglob("*"):
        stat = path.lstat()
        content = path.read_bytes() if path.is_file() else None
        found[path] = (content, stat.st_mtime_ns, stat.st_ino)
    return found


def entries(folder):
    """The names of the files and folders in a folder, the outermost first; in an inner folder one of each kind."""
    names = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        kind = (path.parent, path.suffix) if "/" in name else name
        names.setdefault(kind, name)
    return list(names.values())


@pytest.mark.parametrize("name", WORDS)
def test_no_link_of_a_folder_is_written_or_removed_through(
    command, inputs, drawn_once, tmp_path, name
):
    words = shlex.split(WORDS[name])
    code, _, err = command(*words, "--out", "whole")
    assert code == 0, err
    whole = tmp_path / "whole"
    names = entries(whole)
    assert file_list.NAME in names
    names += [out_folder.LOCK, "pictures", *out_folder.OF_RUNS, "inputs"]
    names += ["runs/linked"]
    # the outside has files of the same names, which the list says are weavecell's
    outside = tmp_path / "outside"
    shutil.copytree(whole, outside)
    (outside / f"{'0' * 32}.npz").write_bytes(b"mine")
    (outside / f"{files.UNFINISHED}shots-abcd1234.csv").write_text("mine")
    before = state(outside)
    own = (file_list.NAME, out_folder.LOCK)
    tried = [([name], []) for name in dict.fromkeys(names)]
    if name in RESUMED:
        tried.append(([name for name in names if name not in own], ["--resume"]))
    for links, resume in tried:
        out = tmp_path / "out"
        shutil.copytree(whole, out)
        for entry in links:
            path = out / entry
            # of folders in folders the outer one is the link
            if path.parent.resolve().is_relative_to(outside):
                continue
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path)
            path.unlink(missing_ok=True)
            path.parent.mkdir(exist_ok=True)
            path.symlink_to(outside / entry if (outside / entry).exists() else outside)
        code, _, err = command(*words, "--out", "out", *resume)
        assert state(outside) == before, links
        assert code in (0, 2), err
        shutil.rmtree(out)


@pytest.mark.parametrize("name", WORDS)
def test_no_name_of_a_list_leads_out_of_its_folder(command, inputs, drawn_once, tmp_path, name):
    words = shlex.split(WORDS[name])
    outside = tmp_path / "outside"
    outside.mkdir()
    for victim in (outside / "victim", tmp_path / "victim", tmp_path / "panel-1.vtu"):
        victim.write_text("mine")
    digest = hashlib.sha256(b"mine").hexdigest()
    assert command(*words, "--out", "out")[0] == 0
    out = tmp_path / "out"
    listed = file_list.FileList.read(out)
    for hostile in HOSTILE:
        listed.digests[hostile.format(outside=outside)] = [digest]
    listed.write(out)
    before = state(outside)
    for links in ((), ("linked", "inputs/linked")):
        for link in links:
            (out / link).parent.mkdir(exist_ok=True)
            (out / link).symlink_to(outside)
        code, _, err = command(*words, "--out", "out")
        assert state(outside) == before
        assert (tmp_path / "victim").exists()
        assert (tmp_path / "panel-1.vtu").exists()
        assert code in (0, 2), err


def test_a_list_that_is_another_file_is_not_written(command, inputs, tmp_path):
    """Of a link, or of another name of the same file."""
    victim = tmp_path / "victim"
    for name in (file_list.NAME, out_folder.LOCK):
        for make in (os.link, os.symlink):
            victim.write_text("mine")
            out = tmp_path / "out"
            out.mkdir()
            make(victim, out / name)
            code, _, err = command("reduce tests tests.csv --out out")
            assert code == 2
            assert "is no file that can be written to" in err
            assert victim.read_text() == "mine"
            assert os.path.lexists(out / name)
            shutil.rmtree(out)


@pytest.mark.parametrize("hostile", HOSTILE)
def test_names_of_other_lists_lead_nowhere(tmp_path, hostile):
    outside = tmp_path / "outside"
    folder = tmp_path / "folder"
    (folder / "inputs").mkdir(parents=True)
    outside.mkdir()
    (outside / "victim").write_text("mine")
    (tmp_path / "victim").write_text("mine")
    for place in ("linked", "inputs/linked"):
        (folder / place).symlink_to(outside)
    name = hostile.format(outside=outside)
    if not name.startswith("inputs/linked") or "runs" in name:
        (folder / "runs").mkdir()
        (folder / "runs/linked").symlink_to(outside)
    assert files.find_inside(folder, name) is None
    (folder / "panel.pvd").write_text(
        f'<VTKFile><Collection><DataSet timestep="0" file="{name}"/></Collection></VTKFile>'
    )
    with pytest.raises(InputError, match="which is not beside it"):
        vtk.read_series(folder / "panel.pvd")
    within = name.removeprefix("inputs/")
    (folder / kept_files.NAMED).write_text(
        json.dumps({"format": kept_files.FORMAT, "files": {"mine.toml": within}})
    )
    if within in ("linked/victim", "runs/linked/victim"):
        (folder / "inputs/runs").mkdir()
        (folder / "inputs/runs/linked").symlink_to(outside)
    with pytest.raises(InputError, match="must be a file in inputs"):
        kept_files.read_named(folder)


def test_plain_names_are_inside(tmp_path):
    (tmp_path / "panel").mkdir()
    for name in ("panel", "panel/panel-0001.vtu", "a b.csv", "ä.toml", "..a", "a..", "inputs/2/x"):
        assert files.find_inside(tmp_path, name) == tmp_path / name
    # the folder itself may be a link of the user's
    (tmp_path / "link").symlink_to(tmp_path)
    assert files.find_inside(tmp_path / "link", "panel") == tmp_path / "link/panel"


class Runs:
    """What a file would call if its pickle were loaded."""

    def __reduce__(self):
        return os.mkdir, ("run",)


def test_nothing_of_a_file_is_run(command, inputs, drawn_once, tmp_path):
    """A pickle in place of any file of a folder, which is resumed, opened and cited."""
    import pickle

    import numpy as np

    words = shlex.split(WORDS["sweep"])
    assert command(*words, "--out", "whole")[0] == 0
    kept = run_cache.RunCache(tmp_path / "whole/runs").files()
    assert kept
    code = pickle.dumps(Runs())
    with open(tmp_path / "arrays.npz", "wb") as file:
        np.savez(file, content=np.array([Runs()], object))
    names = [*entries(tmp_path / "whole"), f"runs/{kept[0].stem}.pickle"]
    for content in (code, (tmp_path / "arrays.npz").read_bytes()):
        shutil.copytree(tmp_path / "whole", tmp_path / "out")
        for name in names:
            if not (tmp_path / "out" / name).is_dir():
                (tmp_path / "out" / name).write_bytes(content)
        for line in (
            [*words, "--out", "out", "--resume"],
            ["cite", "out"],
            ["view", "out", "--html", "a.html"],
        ):
            assert command(*line)[0] in (0, 2), line
        assert not (tmp_path / "run").exists()
        shutil.rmtree(tmp_path / "out")
    pickle.loads(code)
    assert (tmp_path / "run").exists()
