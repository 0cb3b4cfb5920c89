"""A disk that is full while a command writes: one line, exit code 2, and what was written before is kept.

The limit of this process on the size of its files stands for the disk. What a library writes that says nothing of
it (gmsh, VTK, Pillow) is found out by `fabrics.base.files.replace_whole`, which all of them go through.
"""

import os
import resource
from contextlib import contextmanager

import pytest

from tests.scene_text import impact_scene
from tests.weavecell.written import names

# no test here looks at what a picture shows
pytestmark = pytest.mark.usefixtures("drawn_once")

SCENE = impact_scene(opening="40 mm", end_time="40 us", run='outputs = ["paraview", "report"]')
BIGGER = os.strerror(27)
# command: (its words, most bytes of a file, the file that is larger, what is there in the end)
WRITERS = {
    "impact, HDF5": (
        "impact scene.toml --out r",
        90_000,
        "r/histories.h5",
        ["scene.toml"],
    ),
    "impact, report": (
        "impact scene.toml --out r",
        700_000,
        "r/report.html",
        ["histories.h5", "panel", "panel.pvd", "scene.toml", "summary.json"],
    ),
    "view": ("view whole --html page.html", 80_000, "page.html", []),
    "movie": ("view whole --movie film.gif", 80_000, "film.gif", []),
    "mesh": ("mesh S-720 --mesh coarse --format msh --out r", 80_000, "r/crossover.msh", []),
    "deck": ("export scene.toml --to lsdyna --out r", 80_000, "r/scene.k", []),
}


@contextmanager
def largest_file(size):
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.parametrize("writer", WRITERS)
def test_a_full_disk_is_one_line(command, succeed, tmp_path, writer):
    words, size, file, kept = WRITERS[writer]
    if writer == "mesh":
        pytest.importorskip("gmsh")
    (tmp_path / "scene.toml").write_text(SCENE)
    if writer in ("view", "movie"):
        succeed("impact", "scene.toml", "--out", "whole")
    with largest_file(size):
        code, _, err = command(*words.split())
    assert code == 2
    assert err.splitlines()[-1] == f"error: {file}: {BIGGER}"
    assert err.count("error") == 1
    left = []
    if (tmp_path / "r").exists():
        left = names(tmp_path / "r").split()
    assert [name for name in left if name != "checkpoint.h5"] == kept
    assert not list(tmp_path.rglob(".[!w]*"))  # temporary files
