"""The runner of the solid patch, as written in its help; in a process of its own, since it draws."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("gmsh")
pytest.importorskip("pyvista")
h5py = pytest.importorskip("h5py")

SMALL = ["--count", "10", "--size", "2", "2", "1", "--threads", "1"]


def run(*arguments):
    command = [sys.executable, "-m", "validation.published.solid_patch", *SMALL, *arguments]
    return subprocess.run(command, capture_output=True, text=True, cwd=Path(__file__).parents[3], check=False)


def test_runner_writes_its_files_and_goes_on(tmp_path):
    first = run("--out", str(tmp_path / "a"), "--end-time", "0.5")
    assert first.returncode == 0, first.stderr
    for name in ("solid_patch.h5", "summary.txt", "histories.png", "patch.png", "end.vtu", "checkpoint.h5"):
        assert (tmp_path / "a" / name).stat().st_size > 0
    assert "3200, " in first.stdout
    resumed = run("--out", str(tmp_path / "a"), "--end-time", "1", "--resume")
    assert resumed.returncode == 0, resumed.stderr
    whole = run("--out", str(tmp_path / "b"), "--end-time", "1")
    assert whole.returncode == 0, whole.stderr
    with h5py.File(tmp_path / "a/solid_patch.h5") as one, h5py.File(tmp_path / "b/solid_patch.h5") as other:
        assert np.array_equal(one["end/places"][()], other["end/places"][()])
        assert one["histories/warp_nose"].attrs["unit"] == "N"
        assert len(one["histories/t"]) == 4


def test_a_patch_too_small_for_the_shot_is_told_before_it_runs(tmp_path):
    found = run("--count", "5", "--out", str(tmp_path))
    assert found.returncode == 2
    assert "even" in found.stderr
    assert not list(tmp_path.iterdir())
