"""Executors: one thread each, the first exception, kernels that one process of a node compiles, the same to the bit."""

import operator
import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from unittest.mock import Mock

import pytest

from fabrics.base.executors import THREADS, as_done, one_thread_each, open_executor

ROOT = Path(__file__).parents[2]
LINE = "v50 S-720 --shots 4 --batch 4 --opening 30.6mm --seed 2 --out"


class Uncancelled(ThreadPoolExecutor):
    """Cancels nothing, like Parsl's."""

    def submit(self, *task):
        future = super().submit(*task)
        future.cancel = Mock(side_effect=NotImplementedError)
        return future


def test_processes_have_one_thread_each(monkeypatch):
    monkeypatch.setenv(THREADS[0], "7")
    monkeypatch.delenv(THREADS[-1], raising=False)
    before = dict(os.environ)
    with open_executor("local", 1, fresh=True) as pool:
        assert {pool.submit(os.getenv, name).result() for name in THREADS} == {"1"}
        assert pool.submit(os.getpid).result() != os.getpid()
    assert dict(os.environ) == before


def test_results_come_as_they_end_until_the_first_exception_and_a_given_executor_is_left_open():
    with Uncancelled(1) as given:
        for executor in ("local", given):
            with open_executor(executor, 1) as pool:
                assert dict(as_done(pool, pow, [(k, 2) for k in range(100)])) == {
                    k: k**2 for k in range(100)
                }
                with pytest.raises(ZeroDivisionError):
                    dict(as_done(pool, operator.truediv, [(1, 2), (3, 4), (1, 0)]))
        assert given.submit(int, "3").result() == 3


KERNEL = """
import sys, time
from pathlib import Path
from fabrics.base.executors import start_worker

start_worker()
from numba import njit

@njit(cache=True)
def slow(x):
    return x**2 + 1

both = Path(sys.argv[2])
(both / sys.argv[1]).touch()
while len(list(both.glob("*"))) < 2:
    time.sleep(0.01)
slow(1.0)
print(sum(slow.stats.cache_misses.values()))
"""


def test_of_two_processes_one_compiles_a_kernel_and_the_other_loads_it(tmp_path):
    (script := tmp_path / "kernel.py").write_text(KERNEL)
    (tmp_path / "both").mkdir()
    own = {
        "PYTHONPATH": str(ROOT),
        "NUMBA_CACHE_DIR": str(tmp_path / "cache"),
        "TMPDIR": str(tmp_path),
    }
    words = [[sys.executable, str(script), me, str(tmp_path / "both")] for me in "ab"]
    begun = [subprocess.Popen(line, stdout=subprocess.PIPE, env=os.environ | own) for line in words]
    assert sorted(process.communicate()[0].strip() for process in begun) == [b"0", b"1"]


def table(folder):
    """{file: bytes} of a study: four shots, the bracket without scatter, and their table."""
    files = {
        path.name: path.read_bytes() for path in [*folder.glob("runs/*"), folder / "shots.csv"]
    }
    assert len(files) == 6
    return files


@pytest.mark.slow(30)
def test_a_v50_is_the_same_to_the_bit_with_every_executor(succeed, tmp_path, monkeypatch):
    """In the test program without dolfinx: beside its processes mpiexec has ended with code 1 and no message."""
    distributed = pytest.importorskip("distributed")
    mpiexec = shutil.which("mpiexec")
    if mpiexec is None:
        pytest.skip("no mpiexec")
    # a machine that does other things too answers late
    for name in ("connect", "tcp"):
        monkeypatch.setitem(distributed.config["distributed"]["comm"]["timeouts"], name, "3000 s")
    succeed(f"{LINE} here --jobs 1")
    succeed(f"{LINE} local --jobs 2")
    with one_thread_each():
        cluster = distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None
        )
    with cluster:
        monkeypatch.setenv("DASK_SCHEDULER_ADDRESS", cluster.scheduler_address)
        succeed(f"{LINE} dask --executor dask")
    start = f"{mpiexec} -n 3 --allow-run-as-root --oversubscribe {sys.executable} -m mpi4py.futures"
    words = f"{start} -m weavecell {LINE} mpi --executor mpi".split()
    done = subprocess.run(
        words, env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("\nfiles  ") == 1  # one rank is the command, the others run tasks
    tables = [table(tmp_path / name) for name in ("here", "local", "dask", "mpi")]
    assert tables == [tables[0]] * 4
