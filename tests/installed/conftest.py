"""The wheel, and an environment in which it alone is installed: made once, and shared by the processes of a session."""

import os
import shutil
import site
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from tests.installed.packages import FILES, ROOT

META = ("pyproject.toml", "README.md", "LICENSE")
BUILD = "from setuptools.build_meta import build_sdist, build_wheel; build_wheel({0!r}); build_sdist({0!r})"


@pytest.fixture(scope="session")
def built(shared):
    """Folder with wheel and source distribution, built from a copy of the files, so that no earlier build gets in,
    and of the kernels that are compiled."""

    def make(folder):
        for path in [*FILES, *map(Path, META)]:
            (folder / "source" / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / path, folder / "source" / path)
        for kernels in ROOT.glob("*/__pycache__/kernels-*"):
            shutil.copytree(kernels, folder / "source" / kernels.relative_to(ROOT))
        # in a checkout without any it stands for them
        planted = folder / "source" / "shellfabric" / "__pycache__" / "kernels-planted"
        planted.mkdir(parents=True)
        (planted / "planted.nbi").touch()
        done = run_in(folder / "source", sys.executable, "-c", BUILD.format(str(folder)))
        assert done.returncode == 0, done.stdout + done.stderr

    return shared("built", make)


@pytest.fixture(scope="session")
def installed(built, shared):
    """run(program, *arguments, at=folder) of a new environment without the checkout, whose `packages` are a folder.

    What weavecell needs is seen by a .pth file that names the folders of this environment. Python does not read the
    .pth files in there, so that an editable installation of the checkout is not seen. Where `WHEEL_PYTHON` names a
    Python, the environment is one of that Python and of packages of PyPI alone.
    """

    def make(folder):
        if python := os.environ.get("WHEEL_PYTHON"):
            subprocess.run([python, "-m", "venv", str(folder)], check=True)
            [wheel] = built.glob("*.whl")
            pip = (str(folder / "bin" / "pip"), "install", "--quiet")
            done = run_in(folder, *pip, f"{wheel}[app]")
            assert done.returncode == 0, done.stderr
            if newest := os.environ.get("WHEEL_UPGRADE", "").split():
                # pip tells that this is beyond the bounds, and does it
                done = run_in(folder, *pip, "--upgrade", *newest)
                assert done.returncode == 0, done.stderr
            return
        subprocess.run(
            [sys.executable, "-m", "venv", "--system-site-packages", str(folder)], check=True
        )
        pip = ["-m", "pip", "install", "--quiet", "--no-deps", "--no-index"]
        python = str(folder / "bin" / "python")
        done = run_in(folder, python, *pip, *map(str, built.glob("*.whl")))
        assert done.returncode == 0, done.stderr
        [packages] = folder.glob("lib/python*/site-packages")
        (packages / "test-environment.pth").write_text("\n".join(site.getsitepackages()) + "\n")

    folder = shared("environment", make)
    [packages] = folder.glob("lib/python*/site-packages")
    return SimpleNamespace(run=runner(folder / "bin"), packages=packages)


@pytest.fixture(params=["editable", "wheel"])
def user(request):
    """run(program, *arguments, at=folder) of either installation."""
    return (
        request.getfixturevalue("installed").run
        if request.param == "wheel"
        else runner(Path(sys.executable).parent)
    )


def runner(binaries):
    """run(program, *arguments, at=folder) of the programs in the folder `binaries`."""
    return lambda program, *arguments, at: run_in(at, str(binaries / program), *map(str, arguments))


def run_in(folder, *command):
    """A program that has run in a folder, with one thread and without the paths of this process."""
    dropped = ("PYTHONPATH", "PYTHONHOME", "NUMBA_CACHE_DIR", "VIRTUAL_ENV")
    environment = {name: value for name, value in os.environ.items() if name not in dropped}
    environment |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=3000
    )
