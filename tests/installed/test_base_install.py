"""Without any extra, weavecell fires, saves and loads; what needs an extra says in one line which.

Where `WHEEL_PYTHON` names a Python (tools/package.sh base) the program runs in an environment of the wheel and of what
pip brings with it; else here, with the packages of the extras kept from being imported.
"""

import os
import re
import subprocess
import sys

import pytest

from tests import printed_commands
from tests.installed.conftest import run_in
from tests.installed.packages import ROOT, SETTINGS

EXTRAS = {
    re.match(r"\w+", entry)[0]
    for name in ("app", "xarray", "dask")
    for entry in SETTINGS["project"]["optional-dependencies"][name]
}
BLOCKED = f"import sys\nsys.modules |= dict.fromkeys({sorted(EXTRAS | {'vtkmodules'})})\n"
PROGRAM = """
from pathlib import Path
import weavecell as wc
from fabrics.base.extras import MissingPackage

if __name__ == "__main__":
    short = {"opening": "20 mm", "end_time": "10 us"}
    print("setup", wc.setup("S-720", "150 m/s", **short).strike_velocity)
    shot = wc.impact("S-720", "150 m/s", **short, out="shot")
    print("impact", shot.outcome)
    shot.save("again")
    print("save", *sorted(path.name for path in Path("again").iterdir()))
    print("load", wc.load("again").residual_velocity == shot.residual_velocity)
    quick = {"scan": False, "residual_shots": 0, "opening": "50 mm", "tolerance": "20 m/s"}
    limit = wc.critical_velocity("S-720", out="limit", **quick)
    print("limit", *sorted(path.name for path in Path("limit").iterdir()))
    print("load", wc.load("limit").summary()["fabric"])
    print("biaxial", *wc.biaxial("S-720", out="biaxial").paths)
    doors = (shot.plot, shot.plot_panel, shot.view, lambda: shot.to_vtk("vtk"), limit.plot)
    for door in (*doors, shot.to_xarray, lambda: wc.view("shot"), lambda: wc.overlay(shot)):
        try:
            door()
            print("no refusal")
        except MissingPackage as problem:
            print("refused", problem)
"""
EXPECTED = """\
setup 150.0
impact in flight
save .weavecell-files histories.h5 scene.toml summary.json
load True
limit .weavecell-files critical-velocity.json runs scene.toml shots.csv
load S-720
biaxial 1:1 1:0 0:1
"""


@pytest.fixture(scope="module")
def bare(request, tmp_path_factory):
    """run(text of a program, at=folder) without extras; command(*words, at=folder) of the program `weavecell`."""
    folder = tmp_path_factory.mktemp("bare")
    program = folder / "program.py"
    wanted = os.environ.get("WHEEL_PYTHON")
    first = BLOCKED
    python = [sys.executable]
    if wanted:
        [wheel] = request.getfixturevalue("built").glob("*.whl")
        subprocess.run([wanted, "-m", "venv", str(folder / "venv")], check=True)
        python = [str(folder / "venv/bin/python")]
        done = run_in(folder, *python, "-m", "pip", "install", "--quiet", str(wheel))
        assert done.returncode == 0, done.stderr
        first = ""

    def run(text, at):
        program.write_text(first + text)
        environment = os.environ | {"OMP_NUM_THREADS": "1"}
        if wanted:
            environment.pop("PYTHONPATH", None)
        else:
            environment |= {"PYTHONPATH": str(ROOT)}
        command = [*python, str(program)]
        return subprocess.run(command, cwd=at, env=environment, capture_output=True, text=True)

    return run


def test_shots_limits_and_paths_are_computed_saved_and_loaded(bare, tmp_path):
    done = bare(PROGRAM, at=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(EXPECTED)
    refused = done.stdout.removeprefix(EXPECTED).splitlines()
    assert len(refused) == 8
    for line in refused:
        assert re.fullmatch(r"refused this needs the Python package \w+, .*pip install \S+", line)
    assert '"weavecell[xarray]"' in refused[5]
    assert '"weavecell[app]"' in refused[0]
    told = [line for line in done.stderr.splitlines() if line.startswith("numbers alone are")]
    assert len(told) == 1
    assert told[0].endswith('pip install "weavecell[app]"')


@pytest.mark.slow(20)
def test_the_first_lines_of_readme_run(bare, tmp_path):
    """Whoever has installed the wheel copies them, and reads what is printed below them."""
    lines, output = [part.text for part in printed_commands.of("README.md")][:2]
    done = bare(lines, at=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == output.split()


def test_the_program_says_in_one_line_what_it_needs(bare, tmp_path):
    done = bare("from weavecell import __main__\n__main__.main()\n", at=tmp_path)
    line = 'error: this needs the Python package typer, which is not installed; pip install "weavecell[app]"\n'
    assert (done.returncode, done.stdout, done.stderr) == (1, "", line)


def test_a_package_that_no_extra_brings_is_named_alone():
    from fabrics.base.extras import MissingPackage, find_missing, how_to_install

    assert "pip" not in str(MissingPackage("a_package_of_others"))
    assert how_to_install("vtkmodules.vtkCommonCore") == how_to_install("vtk")
    assert how_to_install("gmsh").startswith("the 3D part needs: apt install")
    assert find_missing("json", "a_package_of_others", "csv") == "a_package_of_others"
    assert find_missing("json", "csv") is None
