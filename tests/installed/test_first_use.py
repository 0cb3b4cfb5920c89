"""What a new user does first, in a new folder, with an editable installation and with a wheel.

The fabrics are those of tests/weavecell/own_fabrics: numbers of data sheets and nothing else.
"""

import re
import shutil
import sys
from pathlib import Path

import pytest

from tests.installed.conftest import runner
from tests.installed.packages import PACKAGES, ROOT
from tests.scene_text import impact_scene

OWN_FABRICS = sorted((ROOT / "tests" / "weavecell" / "own_fabrics").glob("*.toml"))
IMPORTS = f"import weavecell as wc, {', '.join(PACKAGES)}\nprint(wc.fabric('S-720').name, fabrics.__file__)\n"
OWN = 'file = "own.toml"\nlaw = "law/law.json"'
SHOT = (
    impact_scene("150 m/s", "100 mm", "800 us")
    .replace('name = "S-720"', OWN)
    .replace('"3 g"', '"1.1 g"')
)


def test_folders_of_our_names_hide_no_package(user, tmp_path):
    """In the folder of a script as in the folder that it is started in."""
    for place in (tmp_path, tmp_path / "scripts"):
        for name in PACKAGES:
            (place / name).mkdir(parents=True)
    (tmp_path / "scripts" / "script.py").write_text(IMPORTS)
    for arguments in (["-c", IMPORTS], ["scripts/script.py"]):
        done = user("python", *arguments, at=tmp_path)
        assert done.returncode == 0, done.stderr
        assert done.stdout.startswith("S-720 ")
        assert not Path(done.stdout.split()[1]).is_relative_to(tmp_path)


@pytest.mark.parametrize("name", ["fabrics/__init__.py", "meshing.py"])
def test_a_module_that_hides_a_package_is_named(user, tmp_path, name):
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text("")
    done = user("python", "-c", "import weavecell", at=tmp_path)
    assert done.returncode == 1
    last = done.stderr.splitlines()[-1]
    assert last.startswith(f"ImportError: {tmp_path / name} hides the package")
    assert last.endswith("rename it, or run from another folder")


# one on the mesh of users, the others on the least, in half of the time; [CPU s] of each
ON_MESH_OF_USERS = "aramid-3300"
EACH_DAY = "twaron-930"
SECONDS = {ON_MESH_OF_USERS: 130, "uhmwpe-1760": 90, "e-glass-300": 75, EACH_DAY: 65}


def marked(file):
    """A sheet as a case: the cheapest runs with the long tests, the others nightly."""
    mesh = "2,2,2"
    if file.stem == ON_MESH_OF_USERS:
        mesh = "coarse"
    marks = [pytest.mark.slow(SECONDS[file.stem])]
    if file.stem != EACH_DAY:
        marks.append(pytest.mark.nightly)
    return pytest.param(file, mesh, marks=marks, id=file.stem)


@pytest.mark.parametrize("file, mesh", [marked(file) for file in OWN_FABRICS])
def test_a_fabric_of_data_sheets_is_calibrated_and_shot_at(file, mesh, tmp_path):
    pytest.importorskip("dolfinx")
    shutil.copy(file, tmp_path / "own.toml")
    (tmp_path / "shot.toml").write_text(SHOT)
    run = runner(Path(sys.executable).parent)
    for line in (
        "show own.toml",
        f"calibrate own.toml --mesh {mesh} --jobs 1 --out law",
        "impact shot.toml",
    ):
        done = run("weavecell", *line.split(), at=tmp_path)
        assert done.returncode == 0, f"{line}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
        if line.startswith(("fabrics", "calibrate")):
            assert "assumed" in done.stdout
    assert re.search(r"answer +(stops|perforates)", done.stdout), done.stdout
