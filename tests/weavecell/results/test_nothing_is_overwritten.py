"""What weavecell did not write, and what a run reads, is neither overwritten nor removed: each command, each file."""

import os
import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

import weavecell as wc
from fabrics import catalogue
from fabrics.base.errors import InputError
from tests import commands
from tests.scene_text import impact_scene, toml
from tests.weavecell.session_runs import RUNS, SCENES, write_inputs
from weavecell.cli import app
from weavecell.results import file_list

ROOT = Path(wc.__file__).parents[1]

TESTS = "velocity [m/s], outcome\n80, PP\n120, CP\n"
FLIGHT = "time [us], displacement [mm]\n" + "".join(
    f"{time}, {0.15 * time - 2e-4 * time**2}\n" for time in range(0, 300, 5)
)
PLY = "force [N], displacement [mm]\n" + "".join(
    f"{force}, {0.02 * force / (force + 40)}\n" for force in range(20, 1000, 20)
)
# command: (words, files that it leaves) of those that no session run has
OTHERS = {
    "reduce tests": ("reduce tests tests.csv", "tests.json shots.csv tests.svg"),
    "plies": (
        "plies S-728 --stop 'FSP 1.10 g' --at '120 m/s'",
        "plies.json plies.csv plies.svg shots.csv scene.toml report.html",
    ),
    "a or b": ("compare S-720 S-728", "difference.json difference.svg a/v50.json report.html"),
    "mesh": ("mesh S-720 --format k,rad", "crossover.k crossover_0000.rad quality.png mesh.json"),
    "patch": ("mesh S-720 --patch 2x2 --format inp", "patch.inp patch.png"),
    "reduce shot": ("reduce shot flight.csv --mass '3 g'", "shot.json motion.csv motion.svg"),
    "reduce compression": (
        "reduce compression ply.csv --platen-area '361 mm^2'",
        "compression.json platen-curve.csv fabric-keys.toml compression.svg",
    ),
    "reduce pull-out": (
        "reduce pull-out S-728 peaks.csv",
        "pull-out.json pull-outs.csv friction-keys.toml pull-out.svg report.html",
    ),
    "radioss": ("export scene.toml --to radioss", "scene_0000.rad scene_0001.rad mapping.svg"),
}
# what stands in a folder of results, for the names of folders
INSIDE = {
    "panel": ["panel/panel-0001.vtu", "panel"],
    "pictures": ["pictures", "pictures/curve.svg"],
    "runs": [],
}


def left_by(name):
    """(words, names of the files that the command leaves)."""
    words, folder = OTHERS.get(name) or (RUNS[name]["words"], RUNS[name]["folder"])
    names = []
    for entry in folder.split():
        names += INSIDE.get(entry, [entry])
    if "pictures/curve.svg" in names and name in ("biaxial",):
        names[names.index("pictures/curve.svg")] = "pictures/cell.svg"
    return words, names


@pytest.fixture
def not_computed(monkeypatch):
    def computed(*_, **__):
        raise AssertionError("something is computed")

    for where in (
        "shellfabric.cell.model.CellTable.fill",
        "shellfabric.impact.run.run_impact",
        "weavecell.studies.ballistic_limit.shoot",
        "weavecell.studies.biaxial_path.to_strength",
        "weavecell.runs.laboratory_tests.reduce",
        "weavecell.studies.displacement_record.reduce",
        "weavecell.studies.pull_out_tests.reduce",
        "weavecell.studies.compression_records.laws_of",
        "weavecell.decks.model.build",
    ):
        monkeypatch.setattr(where, computed)


@pytest.mark.parametrize("name", [*RUNS, *OTHERS])
def test_a_file_that_is_not_weavecells_is_kept_and_named(command, tmp_path, not_computed, name):
    solid = name in RUNS and RUNS[name].get("solid")
    if solid or name in ("mesh", "patch"):
        pytest.importorskip("dolfinx" if solid else "gmsh")
    words, names = left_by(name)
    if name in RUNS:
        write_inputs(name)
    else:
        write_inputs("export")
    (tmp_path / "one-ply.toml").write_text(toml(SCENES["small"]))
    (tmp_path / "tests.csv").write_text(TESTS)
    (tmp_path / "flight.csv").write_text(FLIGHT)
    (tmp_path / "ply.csv").write_text(PLY)
    (tmp_path / "peaks.csv").write_text("crossings, peak load [N]\n10, 1.3\n20, 6.4\n")
    for number, file in enumerate(names):
        out = tmp_path / f"out-{number}"
        (out / file).parent.mkdir(parents=True)
        (out / file).write_text("mine")
        code, _, err = command(*shlex.split(words), "--out", out.name)
        assert code == 2, file
        assert err == (
            f"error: --out = '{out.name}': must be another folder: this one has {file}, which weavecell did "
            "not write; nothing was overwritten\n"
        )
        assert (out / file).read_text() == "mine"
        assert sum(path.is_file() for path in out.rglob("*")) == 1


def test_a_folder_whose_list_can_be_no_list_is_refused(command, tmp_path, not_computed):
    (tmp_path / "tests.csv").write_text(TESTS)
    for make in (Path.mkdir, os.mkfifo, lambda path: path.symlink_to(tmp_path / "nowhere")):
        out = tmp_path / f"out-{len(list(tmp_path.iterdir()))}"
        out.mkdir()
        make(out / file_list.NAME)
        code, _, err = command(f"reduce tests tests.csv --out {out.name}")
        assert code == 2
        assert err == (
            f"error: --out = '{out.name}': must be another folder: in this one .weavecell-files, the list of what "
            "weavecell wrote, is no file that can be written to\n"
        )
        assert [path.name for path in out.iterdir()] == [file_list.NAME]
    assert not (tmp_path / "nowhere").exists()


@pytest.mark.parametrize(
    "words",
    [
        "reduce tests shots.csv",
        "impact law.toml",
        "v50 law.toml",
        "biaxial S-720 --law biaxial.json",
        "fabrics new mine.toml --from mine.toml",
    ],
)
def test_what_a_run_reads_is_not_written(command, tmp_path, not_computed, words):
    write_inputs("export")
    for name in ("shots.csv", "tests.csv"):
        (tmp_path / name).write_text(TESTS)
    (tmp_path / "mine.toml").write_text("key,warp,weft,source,status\n")
    catalogue.load("S-720").laws[0].to_json(tmp_path / "summary.json")
    for name in ("v50.json", "biaxial.json"):
        shutil.copy(tmp_path / "summary.json", tmp_path / name)
    law = "summary.json" if "impact" in words else "v50.json"
    text = impact_scene().replace("[projectile]", f'law = "{law}"\n[projectile]', 1)
    (tmp_path / "law.toml").write_text(text)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    out = ["--out", "."]
    if words.startswith("fabrics"):
        out = []
    code, _, err = command(*words.split(), *out)
    assert code == 2
    assert "which this run reads" in err or "exists already" in err
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


@pytest.mark.parametrize(
    "words", ["impact scene.toml", "sweep scene.toml --over panel.plies=1 --jobs 1"]
)
def test_an_input_file_in_the_folder_stays_to_the_last_byte(command, drawn_once, tmp_path, words):
    write_inputs("sweep")
    text = (tmp_path / "scene.toml").read_text().replace("60 us", "5 us")
    content = b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode()
    (tmp_path / "scene.toml").write_bytes(content)
    for resume in ((), ("--resume",)):
        code, _, err = command(*words.split(), "--out", ".", *resume)
        assert code == 0, err
        assert (tmp_path / "scene.toml").read_bytes() == content
    # it is no result: another run does not replace it
    (tmp_path / "other.toml").write_text(text)
    code, _, err = command("impact other.toml --out .")
    assert code == 2
    assert "scene.toml, which weavecell did not write" in err
    assert (tmp_path / "scene.toml").read_bytes() == content


@pytest.mark.parametrize("way", [".", "./x/..", "x/../", "here", "{}", "y/../here/."])
def test_a_file_is_kept_whatever_way_leads_to_its_folder(command, tmp_path, way):
    (tmp_path / "tests.csv").write_text(TESTS)
    (tmp_path / "shots.csv").write_text("mine")
    (tmp_path / "here").symlink_to(tmp_path)
    code, _, err = command("reduce", "tests", "tests.csv", "--out", way.format(tmp_path))
    assert code == 2
    assert "shots.csv, which weavecell did not write" in err
    assert (tmp_path / "shots.csv").read_text() == "mine"


def test_results_that_a_run_reads_are_not_replaced_by_it(command, succeed, tmp_path):
    """Although weavecell wrote them, in Python too."""
    (tmp_path / "tests.csv").write_text(TESTS)
    succeed("reduce", "tests", "tests.csv", "--out", "o")
    (tmp_path / "o/shots.csv").rename(tmp_path / "o/kept.csv")
    (tmp_path / "o/shots.csv").write_text(TESTS)
    with pytest.raises(InputError, match=r"shots.csv, which this run reads"):
        wc.reduce_tests("o/shots.csv", out="o")
    assert (tmp_path / "o/shots.csv").read_text() == TESTS


def test_results_that_were_changed_are_kept_and_unchanged_ones_replaced(succeed, command, tmp_path):
    (tmp_path / "tests.csv").write_text(TESTS)
    succeed("reduce", "tests", "tests.csv", "--out", "o")
    (tmp_path / "o/notes.txt").write_text("mine")
    succeed("reduce", "tests", "tests.csv", "--out", "o")
    with open(tmp_path / "o/tests.json", "a") as file:
        file.write(" ")
    code, _, err = command("reduce", "tests", "tests.csv", "--out", "o")
    assert code == 2
    assert "tests.json, which was changed since weavecell wrote it" in err
    assert (tmp_path / "o/notes.txt").read_text() == "mine"


def test_a_result_that_is_saved_overwrites_nothing(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tests.csv").write_text(TESTS)
    (tmp_path / "shots.csv").write_text(TESTS)
    with pytest.raises(InputError, match=r"shots.csv, which weavecell did not write"):
        wc.reduce_tests("tests.csv").save(".")
    assert (tmp_path / "shots.csv").read_text() == TESTS


def test_a_folder_called_runs_keeps_what_is_in_it(command, drawn_once, tmp_path):
    write_inputs("sweep")
    (tmp_path / "runs").mkdir()
    (tmp_path / "runs/mine.txt").write_text("mine")
    (tmp_path / "panel").mkdir()
    (tmp_path / "panel/photo.png").write_text("mine")
    (tmp_path / "s.toml").write_text((tmp_path / "scene.toml").read_text().replace("60 us", "5 us"))
    (tmp_path / "scene.toml").unlink()
    for words in ("sweep s.toml --over panel.plies=1 --jobs 1", "impact s.toml"):
        code, _, err = command(*words.split(), "--out", ".")
        assert code == 0, err
        (tmp_path / "scene.toml").unlink()
        (tmp_path / "report.html").unlink()
    assert (tmp_path / "runs/mine.txt").read_text() == "mine"
    assert (tmp_path / "panel/photo.png").read_text() == "mine"


@pytest.mark.parametrize("kind", ["fabrics", "projectiles", "metals", "backings"])
def test_a_list_is_not_written_over_a_file(command, tmp_path, kind):
    (tmp_path / "mine.csv").write_text("mine")
    code, _, err = command(f"{kind} list --out mine.csv")
    assert (code, err) == (2, "error: mine.csv: exists already\n")
    assert (tmp_path / "mine.csv").read_text() == "mine"


@pytest.mark.parametrize(
    "option", ["html r.html", "screenshot a.png", "movie a.gif", "movie a.mp4"]
)
@pytest.mark.parametrize("kind", ["file", "folder", "link"])
def test_a_view_is_written_over_nothing(command, tmp_path, option, kind):
    path = tmp_path / option.split()[1]
    match kind:
        case "file":
            path.write_text("mine")
        case "folder":
            path.mkdir()
        case "link":
            path.symlink_to("nowhere")
    code, _, err = command(f"view results --{option}")
    assert (code, err) == (2, f"error: {path.name}: exists already\n")
    assert [*tmp_path.iterdir()] == [path]
    assert kind != "file" or path.read_text() == "mine"


# commands whose files the tests above put there: of a session run, of `OTHERS`, or a single file
SINGLE_FILES = {
    "show": "show S-720 --out .",
    "new": "new S-720.toml",
    "cite": "cite S-720 --out S-720.bib",
    "fabrics new": "fabrics new S-720.toml --from tests.csv",
    "view": "view results --html S-720.html",
    "fabrics list": "fabrics list --out S-720.csv",
    "projectiles list": "projectiles list --out S-720.csv",
    "metals list": "metals list --out S-720.csv",
    "backings list": "backings list --out S-720.csv",
}


def test_the_walk_has_every_command():
    """A new command that writes, or a new option that does, is added to one of the lists."""
    words = [RUNS[name]["words"] for name in RUNS] + [line for line, _ in OTHERS.values()]
    groups = {name.partition(" ")[0] for name in app.COMMANDS if " " in name}
    walked = set(SINGLE_FILES)
    for line in words:
        first, second = [*line.split(), ""][:2]
        walked.add(f"{first} {second}" if first in groups else first)
    # all cases of the crossover are written by one function
    missing = {name for name in app.COMMANDS if commands.writes(name) and name not in walked}
    assert {name for name in missing if not name.startswith("crossover ")} == set()


@pytest.mark.parametrize("words", SINGLE_FILES.values())
def test_a_single_file_is_written_over_nothing(command, tmp_path, words):
    (tmp_path / "tests.csv").write_text(TESTS)
    kept = [tmp_path / f"S-720.{ending}" for ending in ("toml", "csv", "html", "bib")]
    for path in kept:
        path.write_text("mine")
    code, _, err = command(words)
    assert code == 2
    assert err.endswith("exists already\n")
    assert {path.read_text() for path in kept} == {"mine"}


def test_every_file_is_written_by_one_function():
    """All go through `files.replace_whole`, whose watchers see them; no other call opens a file to write."""
    found = []
    for folder in ("fabrics", "meshing", "unitcell3d", "shellfabric", "weavecell"):
        for path in (ROOT / folder).rglob("*.py"):
            for line in path.read_text().splitlines():
                if re.search(r"\.write_(text|bytes)\(|\bopen\([^)]*[\"'][wax]b?\+?[\"']", line):
                    found.append(f"{path.relative_to(ROOT)}: {line.strip()}")
    outside = [line for line in found if "beside" not in line and ">>>" not in line]
    # a list of files that is appended to, and scripts for gmsh in a folder of their own
    assert sorted(line.partition(":")[0] for line in outside) == [
        "meshing/files.py",
        "meshing/generate.py",
        "meshing/mesh_file.py",
        "weavecell/results/file_list.py",
    ]


@pytest.mark.parametrize("name", RUNS)
def test_every_file_of_a_run_is_in_the_list_of_its_folder(results, name):
    if RUNS[name].get("solid"):
        pytest.importorskip("dolfinx")
    out = results(name).folder
    there = set()
    for path in out.rglob("*"):
        file = path.relative_to(out).as_posix()
        if path.is_file() and file != file_list.NAME and not file.startswith("runs/"):
            there.add(file)
    listed = file_list.FileList.read(out)
    assert set(listed.digests) == there
    assert listed.whole is not None
    assert listed.damaged(out, ["*", "*/*"]) == []
    subprocess.run(["sha256sum", "--quiet", "-c", file_list.NAME], cwd=out, check=True)
