"""The wheel holds every file that the packages need, and every command that needs no PETSc runs from it alone."""

import os
import shutil
import site
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from fnmatch import fnmatch
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SETTINGS = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
PACKAGES = [pattern.rstrip("*") for pattern in SETTINGS["tool"]["setuptools"]["packages"]["find"]["include"]]


def files():
    """Files of our packages: those that git tracks, or all but caches where this is no checkout."""
    command = ["git", "-C", str(ROOT), "ls-files", "--cached", "--others", "--exclude-standard", "--", *PACKAGES]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode == 0 and done.stdout:
        return sorted(Path(line) for line in done.stdout.splitlines() if (ROOT / line).is_file())
    found = [path for package in PACKAGES for path in (ROOT / package).rglob("*") if path.is_file()]
    return sorted(path.relative_to(ROOT) for path in found if "__pycache__" not in path.parts)


FILES = files()
DATA = [path for path in FILES if path.suffix != ".py"]


def shipped(path, table):
    """Whether package-data matches a file: patterns are relative to their package, and * does not cross folders."""
    for package, patterns in table.items():
        folder = Path(*package.split("."))
        if folder not in path.parents:
            continue
        parts = path.relative_to(folder).parts
        for pattern in patterns:
            wanted = Path(pattern).parts
            if len(wanted) == len(parts) and all(map(fnmatch, parts, wanted)):
                return True
    return False


@pytest.mark.parametrize("path", DATA, ids=str)
def test_package_data_holds_every_data_file(path):
    assert shipped(path, SETTINGS["tool"]["setuptools"]["package-data"]), f"{path} is in no package-data"


def test_a_data_file_that_is_left_out_is_seen():
    table = {"a.b": ["*.toml", "measured/*.csv"]}
    assert shipped(Path("a/b/x.toml"), table)
    assert shipped(Path("a/b/measured/x.csv"), table)
    for name in ("a/b/x.json", "a/x.toml", "a/b/c/x.toml", "a/b/measured/deep/x.csv"):
        assert not shipped(Path(name), table), name


def test_every_folder_with_modules_is_a_package():
    """A folder without __init__.py is left out of the wheel by `packages.find`."""
    for path in FILES:
        if path.suffix == ".py":
            assert path.parent / "__init__.py" in FILES, path


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """The wheel, built from a copy of the files, so that nothing of an earlier build gets into it."""
    source, out = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("wheel")
    for path in [*FILES, *map(Path, ("pyproject.toml", "README.md", "LICENSE"))]:
        (source / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / path, source / path)
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "--no-index"]
    done = subprocess.run([*command, "--wheel-dir", str(out), str(source)], cwd=out, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    [found] = out.glob("*.whl")
    return found


def test_the_wheel_holds_every_file(wheel):
    held = {name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in name}
    assert held == {path.as_posix() for path in FILES}


def test_the_wheel_has_the_version_of_the_code(wheel):
    import fabrics

    assert wheel.name.startswith(f"weavecell-{fabrics.__version__}-py3-")


def test_the_source_distribution_holds_every_file(tmp_path):
    for path in [*FILES, *map(Path, ("pyproject.toml", "README.md", "LICENSE"))]:
        (tmp_path / "source" / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / path, tmp_path / "source" / path)
    code = f"from setuptools.build_meta import build_sdist; build_sdist({str(tmp_path)!r})"
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path / "source", capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    [found] = tmp_path.glob("*.tar.gz")
    with tarfile.open(found) as archive:
        held = {name.partition("/")[2] for name in archive.getnames()}
    assert {path.as_posix() for path in FILES} | {"pyproject.toml", "README.md", "LICENSE"} <= held


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory):
    """A function that runs a program of a new environment, in an empty folder and without the checkout.

    What weavecell needs is seen by a .pth file that names the folders of this environment. Python does not read the
    .pth files in there, so that an editable installation of the checkout is not seen.
    """
    folder, work = tmp_path_factory.mktemp("environment"), tmp_path_factory.mktemp("work")
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", str(folder)], check=True)
    python = folder / "bin" / "python"
    install = [str(python), "-m", "pip", "install", "--quiet", "--no-deps", "--no-index", str(wheel)]
    subprocess.run(install, check=True, cwd=work)
    [packages] = folder.glob("lib/python*/site-packages")
    (packages / "test-environment.pth").write_text("\n".join(site.getsitepackages()) + "\n")
    run = runner(folder / "bin", work)
    run.packages, run.folder, run.binaries = packages, work, folder / "bin"
    return run


def runner(binaries, work):
    """A function that runs a program of the folder `binaries` in the folder `work`, or in `at`."""
    dropped = ("PYTHONPATH", "PYTHONHOME", "NUMBA_CACHE_DIR", "VIRTUAL_ENV")
    environment = {name: value for name, value in os.environ.items() if name not in dropped}
    environment |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}

    def run(program, *arguments, at=work):
        command = [str(binaries / program), *map(str, arguments)]
        return subprocess.run(command, cwd=at, env=environment, capture_output=True, text=True, timeout=1500)

    return run


def test_the_checkout_does_not_leak_into_the_environment(installed):
    code = f"import {', '.join(PACKAGES)}; print(*(m.__file__ for m in ({', '.join(PACKAGES)})), sep='\\n')"
    done = installed("python", "-c", code)
    assert done.returncode == 0, done.stderr
    for line in done.stdout.splitlines():
        assert Path(line).is_relative_to(installed.packages), line
    where = installed("python", "-c", "import sys; print(*sys.path, sep='\\n')").stdout.splitlines()
    assert str(ROOT) not in where


PLY = """
[fabric]
name = "S-720"
linear_density = "effective"

[projectile]
mass = "0.5 g"
diameter = "5.5 mm"
edge_radius = "0.3 mm"
strike_velocity = "60 m/s"

[panel]
opening = "20 mm"

[run]
end_time = "10 us"
snapshot_interval = "5 us"
"""
SCENES = {
    "ply.toml": PLY,
    "pack.toml": PLY.replace('"20 mm"\n', '"20 mm"\nplies = 2\n'),
    "accuracy.toml": PLY + '\n[accuracy]\ndeflection = "10 %"\n',
    "coupon.toml": '[fabric]\nname = "glass-balanced"\n\n[biaxial]\nstrain = ["0.4 %", "0.2 %"]\ncentre = 4\narm = 3\n'
    "\n[run]\nsteps = 2\n",
    "tests.csv": "velocity [m/s], outcome\n60, PP\n200, CP\n",
}
# every command that needs no PETSc, on the smallest scenes
COMMANDS = (
    "--version",
    "fabrics list --out list.csv",
    "fabrics show S-728 --out own",
    f"fabrics new new.toml --from {ROOT}/examples/fabrics/mine.csv",
    "projectiles list",
    "backings list",
    "impact ply.toml --out ply",
    "impact pack.toml --out pack",
    "impact accuracy.toml --out accuracy",
    "view ply --screenshot ply.png",
    "coupon coupon.toml --out coupon",
    "biaxial S-720 --out biaxial",
    "critical-velocity ply.toml --tolerance 20m/s --residual-shots 0 --jobs 1 --out limit",
    "compare tests.csv ply.toml --tolerance 20m/s --jobs 1 --out compare",
    "v50 S-720 --shots 8 --batch 4 --jobs 1 --opening 30.6mm --seed 2 --out v50",
    "sweep ply.toml --over projectile.strike_velocity=80m/s,90m/s --jobs 1 --out sweep",
    "sensitivity S-720 --velocity 60m/s --samples 2 --jobs 1 --opening 20mm --out sobol",
    "export ply.toml --to lsdyna --out export",
    "mesh S-720 --mesh coarse --format msh,vtu,k,inp,rad --out mesh",
    "view mesh --screenshot mesh.png",
)
VIEWED = {
    "view ply": "impact ply.toml --out ply",
    "view mesh": "mesh S-720 --mesh coarse --format vtu --out mesh",
}
NEED_PETSC = {"calibrate", "surface", "crossover"}


def test_every_command_is_run_here():
    """The list above is complete: a new command goes into it, or needs PETSc."""
    from typer.main import get_command

    from weavecell.cli.app import program

    assert set(get_command(program()).commands) == {line.split()[0] for line in COMMANDS[1:]} | NEED_PETSC


@pytest.mark.slow
@pytest.mark.parametrize("line", COMMANDS)
def test_a_command_runs_from_the_wheel(installed, line):
    for name, text in SCENES.items():
        (installed.folder / name).write_text(text)
    if line.startswith(("mesh", "view mesh")):
        pytest.importorskip("gmsh")
    viewed = " ".join(line.split()[:2])
    if viewed in VIEWED and not (installed.folder / line.split()[1]).exists():  # another process has written it
        installed("weavecell", *VIEWED[viewed].split())
    done = installed("weavecell", *line.split())
    assert done.returncode == 0, f"{line}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
    assert "Traceback" not in done.stderr
