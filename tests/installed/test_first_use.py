"""What a new user does first, in a new folder, with an editable installation and with a wheel.

The fabrics are those of tests/weavecell/own_fabrics: numbers of data sheets and nothing else.
"""

import re
import shutil
import sys
from pathlib import Path

import pytest
from test_wheel import PACKAGES, ROOT, installed, runner, wheel  # noqa: F401  two of them are fixtures

SCRIPTS = sorted((ROOT / "examples").glob("*.py"))
OWN_FABRICS = sorted((ROOT / "tests" / "weavecell" / "own_fabrics").glob("*.toml"))
IMPORTS = f"import weavecell as wc, {', '.join(PACKAGES)}\nprint(wc.fabric('S-720').name, fabrics.__file__)\n"
SHOT = """
[fabric]
file = "own.toml"
law = "law/law.json"

[projectile]
mass = "1.1 g"
diameter = "5.5 mm"
edge_radius = "0.3 mm"
strike_velocity = "150 m/s"

[panel]
opening = "100 mm"

[run]
end_time = "800 us"
"""
WRONG = """
thickness = "0.3"
areal_density = "205 kg"

[warp]
linear_density = "930 detx"
fibre_density = "1.44 g/cm^3"
modulus = "95 GPa"
failure_strain = "-3 %"
count = "11 / cm"

[weft]
linear_density = "930 dtex"
fibre_densty = "1.44 g/cm^3"
modulus = "95 GPa"
failure_strain = "3.3 %"
"""
WRONG_KEYS = (
    "thickness", "areal_density", "warp.linear_density", "warp.failure_strain", "weft.fibre_densty", "weft.count",
)  # fmt: skip


@pytest.fixture(params=["editable", "wheel"])
def user(request, tmp_path):
    """A function that runs a program of an installation in a new folder, its attribute `folder`."""
    binaries = (
        request.getfixturevalue("installed").binaries if request.param == "wheel" else Path(sys.executable).parent
    )
    run = runner(binaries, tmp_path)
    run.folder = tmp_path
    return run


def test_folders_of_our_names_hide_no_package(user):
    """In the folder of a script as in the folder that it is started in."""
    for place in (user.folder, user.folder / "scripts"):
        for name in PACKAGES:
            (place / name).mkdir(parents=True)
    (user.folder / "scripts" / "script.py").write_text(IMPORTS)
    for arguments in (["-c", IMPORTS], ["scripts/script.py"]):
        done = user("python", *arguments)
        assert done.returncode == 0, done.stderr
        assert done.stdout.startswith("S-720 ")
        assert not Path(done.stdout.split()[1]).is_relative_to(user.folder)


@pytest.mark.parametrize("name", ["validation/__init__.py", "meshing.py", "fabrics.py"])
def test_a_module_that_hides_a_package_is_named(user, name):
    (user.folder / name).parent.mkdir(exist_ok=True)
    (user.folder / name).write_text("")
    done = user("python", "-c", "import weavecell")
    assert done.returncode == 1
    last = done.stderr.splitlines()[-1]
    assert last.startswith(f"ImportError: {user.folder / name} hides the package")
    assert last.endswith("rename it, or run from another folder")


def test_all_wrong_keys_of_a_fabric_are_listed_at_once(user):
    (user.folder / "wrong.toml").write_text(WRONG)
    done = user("weavecell", "fabrics", "show", "wrong.toml")
    assert done.returncode == 2, done.stdout + done.stderr
    assert [key for key in WRONG_KEYS if key not in done.stderr] == []
    assert "Traceback" not in done.stderr


@pytest.mark.slow(300)
@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_runs_from_the_wheel(installed, script, tmp_path):  # noqa: F811
    """tests/weavecell/api/test_examples.py runs them from the editable installation."""
    shutil.copytree(script.parent, tmp_path / "examples")
    done = installed("python", script.name, at=tmp_path / "examples")
    assert done.returncode == 0, done.stderr


@pytest.mark.slow(150)
@pytest.mark.parametrize("file", OWN_FABRICS, ids=lambda path: path.stem)
def test_a_fabric_of_data_sheets_is_calibrated_and_shot_at(file, tmp_path):
    pytest.importorskip("dolfinx")
    run = runner(Path(sys.executable).parent, tmp_path)
    shutil.copy(file, tmp_path / "own.toml")
    (tmp_path / "shot.toml").write_text(SHOT)
    for line in ("fabrics show own.toml", "calibrate own.toml --mesh coarse --jobs 1 --out law", "impact shot.toml"):
        done = run("weavecell", *line.split())
        assert done.returncode == 0, f"{line}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
        if line.startswith(("fabrics", "calibrate")):
            assert "assumed" in done.stdout
    assert re.search(r"150 m/s: (stopped|perforated)", done.stdout), done.stdout
