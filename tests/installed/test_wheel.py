"""The wheel holds every file that the packages need, and every command that needs no PETSc runs from it alone."""

import re
import tarfile
import zipfile
from pathlib import Path

import pytest

from fabrics.base.kernel_cache import kernel_folder
from tests import commands
from tests.installed.conftest import META
from tests.installed.packages import FILES, PACKAGES, ROOT
from tests.scene_text import impact_scene
from weavecell.cli.app import COMMANDS


def test_wheel_and_source_distribution_hold_every_file(built):
    """Data files that no package-data names, and folders without __init__.py, would be left out."""
    import fabrics

    [wheel] = built.glob(f"weavecell-{fabrics.__version__}-py3-*.whl")
    [source] = built.glob("*.tar.gz")
    expected = {path.as_posix() for path in FILES}
    found = {name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in name}
    assert {name for name in found if "/__pycache__/kernels-" not in name} == expected
    with tarfile.open(source) as archive:
        assert expected | set(META) <= {name.partition("/")[2] for name in archive.getnames()}


def test_the_wheel_is_without_validation(built, installed, tmp_path):
    """It is run from a checkout; a package of users may bear its name."""
    [wheel] = built.glob("*.whl")
    tops = {name.partition("/")[0] for name in zipfile.ZipFile(wheel).namelist()}
    assert {top for top in tops if not top.endswith(".dist-info")} == set(PACKAGES)
    assert "validation" not in PACKAGES
    assert not [name for name in tops if "validation" in name]
    code = "import importlib.util; print(importlib.util.find_spec('validation'))"
    assert installed.run("python", "-c", code, at=tmp_path).stdout == "None\n"


def test_the_checkout_does_not_leak_into_the_environment(installed, tmp_path):
    code = f"import sys, {', '.join(PACKAGES)}; files = [sys.modules[name].__file__ for name in {PACKAGES}]"
    code += "; print(*files, *sys.path, sep='\\n')"
    done = installed.run("python", "-c", code, at=tmp_path)
    assert done.returncode == 0, done.stderr
    files = done.stdout.splitlines()[: len(PACKAGES)]
    paths = done.stdout.splitlines()[len(PACKAGES) :]
    assert all(Path(file).is_relative_to(installed.packages) for file in files)
    assert str(ROOT) not in paths


def test_kernels_of_the_wheel_are_those_that_its_source_looks_for(built, installed, tmp_path):
    """Whatever the place of the files; what the checkout had compiled is installed with them."""
    code = (
        "from fabrics.base.kernel_cache import ROOT, kernel_folder\n"
        "for file in (ROOT / 'shellfabric').rglob('*.py'): print(kernel_folder(file, ROOT))"
    )
    looked_for = set(installed.run("python", "-c", code, at=tmp_path).stdout.split())
    assert looked_for == {kernel_folder(file) for file in (ROOT / "shellfabric").rglob("*.py")}
    # the tests beside this one compile more in the checkout
    kernels = "*/__pycache__/kernels-*/*.nbi"
    compiled, there = (
        {path.relative_to(folder).as_posix() for path in folder.glob(kernels)}
        for folder in (built / "source", installed.packages)
    )
    assert any(name.startswith("shellfabric/") for name in compiled)
    assert {name for name in compiled if name.split("/")[0] in ("fabrics", "shellfabric")} <= there


PLY = impact_scene("60 m/s", "20 mm", "10 us", run='snapshot_interval = "5 us"').replace(
    '"3 g"', '"0.5 g"'
)
LOADS = [10 * 1.2**n for n in range(36)]  # [N] of a record of compression, of 50 um of free height
TIMES = range(0, 200, 2)  # [us] of a projectile that is stopped slowly
RECORDS = {
    "one.csv": "force [N], displacement [mm]\n"
    + "".join(f"{F:.6g}, {0.05 * (1 - (10 / F) ** (1 / 3)):.6g}\n" for F in LOADS),
    "peaks.csv": "crossings, peak load [N]\n10, 1.3\n10, 1.2\n20, 6.4\n20, 6.1\n",
    "flight.csv": "time [us], displacement [mm]\n"
    + "".join(f"{t}, {0.1 * t - 1e-4 * t**2:.6g}\n" for t in TIMES),
}
SCENES = RECORDS | {
    "ply.toml": PLY,
    "pack.toml": PLY.replace('"20 mm"\n', '"20 mm"\nplies = 2\n'),
    "coupon.toml": '[fabric]\nname = "glass-balanced"\n\n[biaxial]\nstrain = ["0.4 %", "0.2 %"]\ncentre = 4\narm = 3\n'
    "\n[run]\nsteps = 2\n",
    "tests.csv": "velocity [m/s], outcome\n60, PP\n200, CP\n",
}
# every command that needs no PETSc, on the smallest scenes; each group is a process, for gmsh and VTK share none
GROUPS = {
    "panels": (
        "fabrics list --out list.csv",
        "show S-728 --out own",
        f"fabrics new new.toml --from {ROOT}/examples/fabrics/mine.csv",
        "new shot.toml",
        "projectiles list",
        "metals list",
        "backings list",
        "impact ply.toml --out ply",
        "cite ply --out ply.bib",
        "impact pack.toml --out pack",
        "coupon coupon.toml --out coupon",
        "biaxial S-720 --out biaxial",
        "critical-velocity ply.toml --tolerance 20m/s --residual-shots 0 --jobs 1 --out limit",
        "reduce tests tests.csv --out tests",
        "compare S-720 S-728 --shots 4 --opening 30.6mm --jobs 1 --seed 2 --out compare",
        "plies S-720 --stop 'FSP 1.10 g' --at 150m/s --opening 30.6mm --shots 4 --jobs 1 --out plies",
        "v50 S-720 --shots 8 --batch 4 --jobs 1 --opening 30.6mm --seed 2 --out v50",
        "next v50",
        "sweep ply.toml --over projectile.strike_velocity=80m/s,90m/s --jobs 1 --out sweep",
        "export ply.toml --to lsdyna --out export",
        "reduce compression one.csv --platen-area 361mm^2 --cell-of S-728 --out compression",
        "reduce pull-out S-728 peaks.csv --tension 2N --out pull-out",
        "reduce shot flight.csv --mass 3g --bandwidth 20kHz --out flight",
    ),
    "meshes": ("mesh S-720 --mesh coarse --format msh,geo,vtu,k,inp,rad --out mesh",),
    "views": (
        "impact ply.toml --out ply",
        "view ply --screenshot ply.png",
    ),
}
NEED_PETSC = {"calibrate", "surface", "crossover"}
NAMED = {line.split()[0] for lines in GROUPS.values() for line in lines} | NEED_PETSC
# a command without a line above is run by its example
OTHERS = [commands.example_line(words) for words in COMMANDS if words.split()[0] not in NAMED]
# runs the lines of a file one after the other, as the program `weavecell` does, and stops at the first that fails
DRIVER = """
import shlex
import sys
from weavecell.cli import app

if __name__ == "__main__":
    for line in open("commands.txt"):
        try:
            app.main(shlex.split(line))
        except SystemExit as end:
            if end.code:
                sys.exit(f"{line} ended with {end.code}")
"""


@pytest.mark.slow(300)
@pytest.mark.parametrize("group", GROUPS)
def test_commands_run_from_the_wheel(installed, tmp_path, group):
    if (
        group == "meshes"
        and installed.run("python", "-c", "import gmsh, meshio", at=tmp_path).returncode
    ):
        pytest.skip("the environment has no gmsh")
    for name, text in SCENES.items():
        (tmp_path / name).write_text(text)
    others = OTHERS if group == "panels" else ()
    (tmp_path / "commands.txt").write_text("\n".join((*GROUPS[group], *others)))
    (tmp_path / "driver.py").write_text(DRIVER)
    done = installed.run("python", "driver.py", at=tmp_path)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-3000:]
    assert "Traceback" not in done.stderr
    pages = ("ply/report.html", "pack/report.html", "v50/report.html") if group == "panels" else ()
    assert [page for page in pages if not (tmp_path / page).is_file()] == []


def test_the_program_has_the_version_of_the_code(user, tmp_path):
    import fabrics

    assert re.search(
        rf"\b{re.escape(fabrics.__version__)}\b", user("weavecell", "--version", at=tmp_path).stdout
    )
