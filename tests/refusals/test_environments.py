"""Odd environments and odd values of Python: a result or a line, never a traceback."""

import datetime
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pandas as pd
import pytest

import weavecell as wc
from fabrics.base import kernel_cache, values
from fabrics.base.errors import InputError
from tests.scene_text import impact_scene

ROOT = Path(wc.__file__).parents[1]
NOSE = {"mass": "3 g", "diameter": "5 mm", "edge_radius": "1 mm"}
ENVIRONMENTS = [
    "MPLBACKEND=nonsense",
    "MPLBACKEND=",
    "MPLBACKEND=module://nowhere",
    "NUMBA_DISABLE_JIT=0",
    "NUMBA_NUM_THREADS=x",
    "OMP_NUM_THREADS=x",
    "OMP_NUM_THREADS=0",
    "MPLCONFIGDIR=/nonexistent",
    "TMPDIR=/nonexistent",
    "XDG_CACHE_HOME=/dev/null",
    "WEAVECELL_CACHE_DIR=/dev/null",
    "WEAVECELL_CACHE_DIR=",
    "LC_ALL=C",
    "LANG=nonsense",
    "PYTHONIOENCODING=ascii",
    "TERM=dumb",
    "COLUMNS=1",
    "COLUMNS=x",
    "NO_COLOR=1",
    "HOME=/nonexistent",
    "NUMBA_CACHE_DIR=/proc/none",
    "NUMBA_CACHE_DIR=/dev/null",
    "DISPLAY=nonsense",
    "TZ=nonsense",
    "PYTHONOPTIMIZE=2",
    "PYTHONWARNINGS=error",
    "PYTHONUTF8=0",
    "PYTHONHASHSEED=0",
]


def run(*words, env=(), program=("-m", "weavecell"), before=()):
    """(exit code, standard error) of a command in an environment that differs in some variables."""
    there = os.environ | {"PYTHONPATH": str(ROOT)} | dict(entry.split("=", 1) for entry in env)
    done = subprocess.run(
        [*before, sys.executable, *program, *words],
        env=there,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("entry", ENVIRONMENTS)
def test_an_odd_environment_changes_nothing(tmp_path, entry):
    code, err = run("show", "S-720", "--out", tmp_path / "s", env=[entry])
    assert code == 0, err
    assert "Traceback (most" not in err.replace("parse failed with exception:\nTraceback (most", "")


@pytest.mark.parametrize(
    "entry",
    ["NUMBA_DISABLE_JIT=1", "NUMBA_DISABLE_JIT= 02", "NUMBA_NUM_THREADS=0", "NUMBA_NUM_THREADS=-3"],
)
def test_an_environment_in_which_no_kernel_runs_is_named(entry):
    code, err = run("impact", "S-720", env=[entry])
    assert code == 2
    name, value = entry.split("=")
    assert err.startswith(f"error: {name} = {value!r}: must be unset, or ")
    assert err.count("\n") == 1


@pytest.mark.parametrize("value", ["nonsense", "module//x", "agg "])
def test_a_backend_that_is_none_decides_nothing(value):
    words = "import weavecell.report; from matplotlib.figure import Figure; Figure().savefig('/dev/null', format='png')"
    code, err = run(words, env=[f"MPLBACKEND={value}"], program=("-c",))
    assert code == 0, err
    assert f"MPLBACKEND = {value!r} is no backend of matplotlib: left out" in err


def test_kernels_that_cannot_be_kept_are_compiled_all_the_same(monkeypatch, caplog, tmp_path):
    """As for a user without a home, of an installation of root's."""
    monkeypatch.setattr(kernel_cache.KernelFolder, "from_function", classmethod(lambda *_: None))
    monkeypatch.setattr(kernel_cache.UserFolder, "from_function", classmethod(lambda *_: None))
    monkeypatch.setattr(kernel_cache, "_unkept", [])
    monkeypatch.setattr(kernel_cache, "_announced", set())
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "none"))
    monkeypatch.setattr(
        kernel_cache.ReadFolder,
        "from_function",
        classmethod(kernel_cache.ReadFolder.from_function.__func__),
    )

    @kernel_cache.kernel()
    def twice(x):
        return 2 * x

    assert twice(4.0) == 8.0
    assert not (tmp_path / "none").exists()
    kernel_cache.compiling("shellfabric.cell.any")
    kernel_cache.compiling("shellfabric.cell.any", done=True)
    assert f"in each run, as {tmp_path / 'none'} cannot be written" in caplog.text


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("setpriv") or os.name != "posix", reason="needs setpriv")
@pytest.mark.parametrize("home", [["-u", "HOME"], ["HOME=/nonexistent"]])
def test_a_user_without_a_home_is_served(tmp_path, home):
    """As with docker run --user."""
    if os.getuid() != 0:
        pytest.skip("needs root")
    path = tmp_path / "scene.toml"
    path.write_text(impact_scene())
    for folder in (path, *path.parents[:-2]):
        folder.chmod(0o755)
    tmp_path.chmod(0o777)
    user = ["setpriv", "--reuid", "65534", "--regid", "65534", "--clear-groups"]
    before = ["env", "-u", "NUMBA_CACHE_DIR", "-u", "WEAVECELL_CACHE_DIR", *home, *user]
    code, err = run("impact", path, "--check", "--out", tmp_path / "o", before=before)
    assert code == 0, err
    assert "Traceback" not in err


class Odd:
    """An object that cannot be compared, or written."""

    __hash__ = object.__hash__

    def __eq__(self, other):
        raise RuntimeError("compared")

    def __repr__(self):
        raise RuntimeError("written")


ITSELF: list = []
ITSELF.append(ITSELF)
WRONG = {
    "NA": pd.NA,
    "NaT": pd.NaT,
    "nan": np.nan,
    "masked": np.ma.masked,
    "no time": np.datetime64("NaT"),
    "list": [pd.NA],
    "dict": {"a": pd.NA},
    "frame": pd.DataFrame({"a": [1, 2]}),
    "odd": Odd(),
    "itself": ITSELF,
    "complex": 1j,
    "duration": datetime.timedelta(1),
    "class": int,
    "set": {1},
    "bytes": b"1 m/s",
}
DOORS = {
    "velocity": lambda value: wc.impact("S-720", value, check=True),
    "opening": lambda value: wc.impact("S-720", 150, opening=value, check=True),
    "plies": lambda value: wc.impact("S-720", 150, plies=value, check=True),
    "symmetry": lambda value: wc.impact("S-720", 150, symmetry=value, check=True),
    "mass": lambda value: wc.impact("S-720", 150, projectile=NOSE | {"mass": value}, check=True),
    "ply": lambda value: wc.impact("S-720", 150, ply=value, check=True),
    "backing": lambda value: wc.impact("S-720", 150, backing=value, check=True),
    "shear angle": lambda value: wc.coupon("S-720", "picture_frame", shear_angle=value, check=True),
    "shots": lambda value: wc.v50("S-720", shots=value, check=True),
    "ratio": lambda value: wc.biaxial("S-720", ratio=value, check=True),
    "fabric": wc.fabric,
    "load": wc.load,
    "cite": wc.cite,
}


@pytest.mark.parametrize("door", DOORS)
def test_a_value_that_is_missing_or_odd_is_refused_in_words(door):
    for name, value in WRONG.items():
        with pytest.raises(InputError) as refused:
            DOORS[door](value)
        assert str(refused.value), name


def test_what_cannot_be_compared_is_not_the_same():
    assert values.is_same([1, "a"], [1, "a"])
    for value in (pd.NA, np.arange(3), pd.DataFrame({"a": [1, 2]}), Odd()):
        assert not values.is_same(1, value)


def test_a_script_is_not_asked_for_values(tmp_path):
    with pytest.raises(InputError, match="values: is missing; must be a CSV file of values"):
        wc.new_fabric(tmp_path / "mine.toml")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("text", [impact_scene(), '[fabric]\nname = "S-720"\n'])
def test_an_input_file_in_place_of_a_fabric_is_told(tmp_path, text):
    (tmp_path / "s.toml").write_text(text)
    with pytest.raises(InputError, match=r"s.toml: is an input file of a run; must be a fabric"):
        wc.setup(tmp_path / "s.toml", 150)
