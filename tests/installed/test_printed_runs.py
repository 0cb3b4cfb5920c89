"""Every command, file and piece of Python that the guide and README print is run, in their order, as a reader would."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests import printed_commands
from tests.printed_commands import PAGES, ROOT

FIRST = "README.md"  # the others are those of `make printed`
SHOWN = {page: printed_commands.of(page) for page in PAGES}
OTHERS = [
    page
    for page in PAGES
    if page != FIRST and {part.kind for part in SHOWN[page]} & {"command", "python"}
]


@pytest.mark.slow(600)
@pytest.mark.parametrize(
    "page", [FIRST, *(pytest.param(page, marks=pytest.mark.printed) for page in OTHERS)]
)
def test_what_a_page_prints_runs(page, tmp_path):
    """In a folder with a copy of examples/; the Python of a page is one script, run after its commands."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = os.environ | {
        "PATH": path,
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
        "MPLBACKEND": "Agg",
    }

    def run(argv):
        done = subprocess.run(
            argv, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=3000
        )
        assert done.returncode == 0, f"{argv}\n{done.stdout[-2000:]}\n{done.stderr[-3000:]}"
        return done.stdout + done.stderr

    script = ""
    printed = ""
    # what stood last before an output
    of_python = False
    for kind, text, name in SHOWN[page]:
        if kind == "file" and not name.startswith("."):
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_text(text, "utf-8")
        elif kind == "python":
            script += text + "\n"
        elif kind == "command":
            printed += run(printed_commands.words(text))
        elif kind == "output":
            if of_python:
                (tmp_path / "page.py").write_text(script, "utf-8")
                printed += run(["python", "page.py"])
            # a page shows some of the lines, and breaks long ones
            flat = " ".join(printed.split())
            for line in text.splitlines():
                assert " ".join(line.split()) in flat
        of_python = kind == "python"
    (tmp_path / "page.py").write_text(script, "utf-8")
    run(["python", "page.py"])
