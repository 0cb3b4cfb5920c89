"""The scripts of examples/ run as they stand, from their folder and from another one; `make docs` runs them too."""

import ast
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
SCRIPTS = sorted((ROOT / "examples").glob("*.py"))
EXPECTED = {
    "first_shot": r"ShotResult\(S-720, 92.5 m/s: stopped(.*\n)+250 m/s: perforated",
    "own_fabric": r"assumed: \[shear\] of para-aramid yarns(.*\n)+.*over the assumed range of the trellis law",
    "pack_limit": r"2 plies of S-728: ballistic limit \d+ to \d+ m/s",
    "bias_coupon": r"MPa at 20 degrees\ncomplete",
    "sliding_crossovers": r"pinned: stopped.*\nmu = 0.2: .*\nmu = 0.1: perforated",
}


@pytest.mark.parametrize("place", ["examples", "elsewhere"])
@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_the_script_runs(script, place, tmp_path):
    """As a user runs it, beside the folders of examples/, without a path to the packages."""
    shutil.copytree(script.parent, tmp_path / "examples")
    (tmp_path / "elsewhere").mkdir()
    given = script.name if place == "examples" else tmp_path / "examples" / script.name
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(
        [sys.executable, given], cwd=tmp_path / place, env=environment, capture_output=True, text=True, timeout=600
    )
    assert done.returncode == 0, done.stderr
    assert re.search(EXPECTED[script.stem], done.stdout), done.stdout
    if script.stem == "first_shot":
        assert (tmp_path / place / "first-shot" / "panel.pvd").exists()


def code(path):
    """Lines of code of a script, without its text."""
    lines = path.read_text("utf-8").splitlines()
    return [line for line in lines[ast.parse("\n".join(lines)).body[0].end_lineno :] if re.match(r"\s*[^#\s]", line)]


def test_they_are_short_and_make_a_page_of_the_gallery():
    assert len(SCRIPTS) >= 5
    for path in SCRIPTS:
        text = ast.get_docstring(ast.parse(path.read_text("utf-8")))
        title, line = text.splitlines()[:2]
        assert line == "=" * len(title), f"{path.name}: title of its page"
        assert f"examples/{path.name}" in text
        assert "figure = " in path.read_text("utf-8"), f"{path.name}: a figure for its page"
        assert len(code(path)) <= 15, path.name
