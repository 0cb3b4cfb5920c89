"""The scripts of examples/ run as they stand, each in a process and a folder of its own."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
SCRIPTS = sorted((ROOT / "examples").glob("*.py"))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_the_script_runs(script, tmp_path):
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, script], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=600
    )
    assert done.returncode == 0, done.stderr
    assert "ShotResult(" in done.stdout
    if script.stem == "own_fabric":
        assert "over the assumed range of the trellis law" in done.stdout
        assert "assumed: [shear] of para-aramid yarns" in done.stdout
    elif script.stem == "pack_limit":
        assert "2 plies of S-728: ballistic limit " in done.stdout
    else:
        assert (tmp_path / "first-shot" / "panel.pvd").exists()
        assert done.stdout.count("m/s: ") == 4


def test_they_are_short():
    assert len(SCRIPTS) >= 3
    assert all(len([line for line in path.read_text().splitlines() if line]) < 20 for path in SCRIPTS)
