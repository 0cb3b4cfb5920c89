"""Changes that a user of the code makes, as patches: each still applies, touches few files, and runs.

A patch of this folder is what CONTRIBUTING says under "How to add"; the program beside it runs the change in a
copy of the packages and asserts what it does. A change of the code that a patch no longer fits makes the patch
again: apply it by hand, and `git diff > tests/changes/NAME.patch`.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
PACKAGES = ("fabrics", "meshing", "unitcell3d", "shellfabric", "validation", "weavecell")
# files of the packages that each may touch
MOST_FILES = {
    "nose-shape": 2,
    "nose-with-number": 2,
    "failure-criterion": 2,
    "failure-strain": 2,
    "part-from-file": 4,
    "force": 1,
    "key": 1,
    "report-column": 1,
    "command": 3,
}


def patched_files(name):
    """Files of the packages that a patch changes or adds."""
    text = (HERE / f"{name}.patch").read_text("utf-8")
    return set(re.findall(r"^\+\+\+ b/(\S+)", text, re.MULTILINE))


def apply(name, folder, *options):
    """Apply a patch to the packages in a folder, whether or not this is a checkout."""
    subprocess.run(
        ["git", "apply", *options, HERE / f"{name}.patch"],
        cwd=folder,
        env=os.environ | {"GIT_CEILING_DIRECTORIES": str(folder.parent)},
        check=True,
    )


def test_each_change_has_its_program():
    assert {path.stem for path in HERE.glob("*.patch")} == set(MOST_FILES)
    programs = {path.stem.removeprefix("run_") for path in HERE.glob("run_*.py")}
    assert programs == {name.replace("-", "_") for name in MOST_FILES}


@pytest.mark.parametrize("name", MOST_FILES)
def test_a_change_touches_few_files(name):
    assert len(patched_files(name)) <= MOST_FILES[name]


@pytest.fixture
def copy(tmp_path):
    """A copy of the packages, with the kernels that are compiled already."""
    for package in PACKAGES:
        shutil.copytree(
            ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__")
        )
        for kernels in (ROOT / package / "__pycache__").glob("kernels-*"):
            shutil.copytree(kernels, tmp_path / package / "__pycache__" / kernels.name)
    return tmp_path


@pytest.mark.parametrize("name", ["key", "report-column", "command"])
def test_a_change_without_kernels_runs(name, copy):
    run_change(name, copy)


@pytest.mark.parametrize("name", MOST_FILES)
def test_a_change_applies(name, copy):
    apply(name, copy, "--check")


@pytest.mark.slow(40)
@pytest.mark.parametrize(
    "name",
    [
        "nose-with-number",
        "force",
        *(
            pytest.param(name, marks=pytest.mark.nightly)
            for name in ("nose-shape", "failure-criterion", "failure-strain", "part-from-file")
        ),
    ],
)
def test_a_change_with_kernels_runs(name, copy):
    run_change(name, copy)


def run_change(name, copy):
    """Apply a change to a copy of the packages and run its program there."""
    apply(name, copy)
    program = HERE / f"run_{name.replace('-', '_')}.py"
    environment = os.environ | {"PYTHONPATH": str(copy), "PYTHONSAFEPATH": "1"}
    found = subprocess.run(
        [sys.executable, program], cwd=copy, env=environment, capture_output=True, text=True
    )
    assert found.returncode == 0, found.stderr
