"""`--executor`: the same runs, to the bit, wherever they are made, and one line for one that there is none of."""

import os
import shutil
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path

import pytest

from fabrics.executors import one_thread_each

ROOT = Path(__file__).parents[2]
WORDS = ("v50", "S-720", "--shots", "4", "--batch", "4", "--opening", "30.6 mm", "--seed", "2")


def table(folder):
    """{file: bytes} of a study's runs, and its table."""
    runs = {path.name: path.read_bytes() for path in (folder / "runs").iterdir()}
    assert len(runs) == 5  # four shots, and the bracket without scatter
    return runs | {"shots.csv": (folder / "shots.csv").read_bytes()}


@pytest.fixture(scope="module")
def here(tmp_path_factory):
    """The table of one process, this one."""
    from weavecell.cli import app

    folder = tmp_path_factory.mktemp("here")
    with pytest.raises(SystemExit):
        app.main([*WORDS, "--jobs", "1", "--out", str(folder)])
    return table(folder)


@pytest.mark.parametrize("executor", ["local", "dask"])
def test_the_table_is_the_same_to_the_bit(executor, here, command, tmp_path, monkeypatch):
    with ExitStack() as stack:
        if executor == "dask":
            distributed = pytest.importorskip("distributed")
            with one_thread_each():
                own = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
                cluster = stack.enter_context(distributed.LocalCluster(**own))
            monkeypatch.setenv("DASK_SCHEDULER_ADDRESS", cluster.scheduler_address)
        code, _, err = command(*WORDS, "--jobs", "2", "--executor", executor, "--out", "out")
    assert code == 0, err
    assert table(tmp_path / "out") == here


def test_the_table_of_ranks_of_mpi_is_the_same_to_the_bit(here, tmp_path):
    """In the test program without dolfinx: beside its processes mpiexec has ended with code 1 and no message."""
    pytest.importorskip("mpi4py.futures")
    if shutil.which("mpiexec") is None:
        pytest.skip("no mpiexec")
    start = ["mpiexec", "-n", "3", "--allow-run-as-root", "--oversubscribe", sys.executable, "-m", "mpi4py.futures"]
    done = subprocess.run(
        [*start, "-m", "weavecell", *WORDS, "--executor", "mpi", "--out", "out"], cwd=tmp_path, text=True,
        env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("written to") == 1  # one rank is the command, the others run tasks
    assert table(tmp_path / "out") == here


@pytest.mark.parametrize(
    ("executor", "told"),
    [
        ("dask", "DASK_SCHEDULER_ADDRESS = '' is the address of no Dask scheduler"),
        ("no dask", "needs the Python package distributed, which is not installed"),
    ],
)
def test_an_executor_that_there_is_none_of_is_one_line(executor, told, command, tmp_path, monkeypatch):
    monkeypatch.delenv("DASK_SCHEDULER_ADDRESS", raising=False)
    if executor == "no dask":
        monkeypatch.setitem(sys.modules, "distributed", None)
    executor = executor.removeprefix("no ")
    code, _, err = command(*WORDS, "--jobs", "2", "--executor", executor, "--out", "out")
    assert code == 2
    [line] = err.strip().splitlines()
    assert line.startswith(f"error: --executor = '{executor}':")
    assert told in line
    assert not (tmp_path / "out").exists()
