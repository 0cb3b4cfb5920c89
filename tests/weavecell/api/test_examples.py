"""The scripts of examples/ run as they stand, as tests of the public interface; `make docs` runs them too."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
# of test_demo.py
SCRIPTS = sorted({*(ROOT / "examples").glob("*.py")} - {ROOT / "examples" / "demo.py"})
# what each prints before its number, and the number, stored within 1 %, or one of the last digit printed
NUMBERS = {
    "areal_density": (r"4 x S-728, 925 g/m2: limit", 260),
    "clay_backing": (r"its dent has been", 3.1),
    "export_deck": (r"LAW58 {'rms': '", 3.4),
    "hybrid_pack": (r"S-720 in front: perforated, residual velocity", 191),
    "oblique_fragment": (r"30 degrees: perforated,", 138),
    "own_study": (r"of 8 shots pass: sphere", 8),
    "punch_test": (r"failure length 0.75 mm: limit", 45.4),
    "sobol_indices": (r"80 shots: mean", 121.8),
    "uncertainty": (r"3 x 3 elements per crossover:", 95.2),
}


@pytest.mark.slow(15)
@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_the_script_prints_its_number(script, tmp_path):
    """As a user runs it, beside the folders of examples/, without a path to the packages."""
    shutil.copytree(
        script.parent, tmp_path / "examples", ignore=shutil.ignore_patterns("__pycache__")
    )
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(
        [sys.executable, tmp_path / "examples" / script.name],
        cwd=tmp_path,
        env=environment | {"MPLBACKEND": "Agg"},
        capture_output=True,
        text=True,
        timeout=3000,
    )
    assert done.returncode == 0, done.stderr
    words, number = NUMBERS[script.stem]
    found = re.search(rf"{words} ?(\d+\.?\d*)", done.stdout)
    assert found, done.stdout
    last_digit = 10.0 ** -len(found[1].partition(".")[2])
    assert float(found[1]) == pytest.approx(number, rel=0.01, abs=last_digit)
    assert (tmp_path / f"{script.stem.replace('_', '-')}.png").exists()
