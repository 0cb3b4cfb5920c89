"""The scripts of examples/ run as they stand, as tests of the public interface; `make docs` runs them too."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
SCRIPTS = sorted({*(ROOT / "examples").glob("*.py")} - {ROOT / "examples" / "demo.py"})  # of test_demo.py
NUMBER = r"\d+(\.\d+)?"
EXPECTED = {
    "areal_density": rf"4 x S-728, {NUMBER} g/m2: limit {NUMBER} to {NUMBER} m/s",
    "clay_backing": rf"back-face signature {NUMBER} mm, dent {NUMBER} cm3",
    "coupon": rf"complete\nshear stress {NUMBER} MPa",
    "crossover_calibration": rf"a = {NUMBER} mm, b = {NUMBER} mm N\^\(1/3\)\nShotResult\(S-720",
    "export_deck": r"LS-DYNA \*MAT_FABRIC {'rms': ",
    "first_shot": r"ShotResult\(S-720, 92.5 m/s: stopped(.*\n)+250 m/s: perforated",
    "hybrid_pack": rf"S-720 in front: (stopped|perforated), residual velocity {NUMBER} m/s",
    "oblique_fragment": rf"45 degrees: (stopped|perforated), {NUMBER} m/s",
    "own_fabric": r"assumed: \[shear\] of para-aramid yarns(.*\n)+.*over the assumed range of the trellis law",
    "pack_v50": rf"V50 {NUMBER} m/s, 95 % interval {NUMBER} to {NUMBER} m/s",
    "uncertainty": rf"30 panels: {NUMBER} m/s(.*\n)+3 x 3 elements per crossover: {NUMBER} m/s",
}
WRITES = {"first_shot": "first-shot/panel.pvd", "export_deck": "deck/S-728.k"}
IN_EXAMPLES = {"first_shot", "own_fabric"}  # run in their own folder, the others in another one


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_the_script_runs(script, tmp_path):
    """As a user runs it, beside the folders of examples/, without a path to the packages."""
    if script.stem == "crossover_calibration":
        pytest.importorskip("dolfinx")
    shutil.copytree(script.parent, tmp_path / "examples", ignore=shutil.ignore_patterns("__pycache__"))
    place = tmp_path / ("examples" if script.stem in IN_EXAMPLES else "elsewhere")
    place.mkdir(exist_ok=True)
    given = script.name if script.stem in IN_EXAMPLES else tmp_path / "examples" / script.name
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(
        [sys.executable, given], cwd=place, env=environment | {"MPLBACKEND": "Agg"},
        capture_output=True, text=True, timeout=900,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert re.search(EXPECTED[script.stem], done.stdout), done.stdout
    assert (place / WRITES.get(script.stem, "")).exists()
    assert (place / f"{script.stem.replace('_', '-')}.png").stat().st_size > 10_000
