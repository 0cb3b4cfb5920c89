"""Executors: one thread each, the first exception, and kernels that one process of a node compiles."""

import math
import operator
import os
import subprocess
import sys
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from pathlib import Path

import pytest

from fabrics.errors import InputError
from fabrics.executors import THREADS, InProcess, as_done, open_executor

ROOT = Path(__file__).parents[2]


class Uncancelled(Executor):
    """Does each task at once; cancels nothing, like Parsl's."""

    def submit(self, function, /, *arguments):
        future = InProcess().submit(function, *arguments)
        future.cancel = self.refuse
        return future

    def refuse(self):
        raise NotImplementedError


def test_processes_have_one_thread_each(monkeypatch):
    monkeypatch.setenv(THREADS[0], "7")
    monkeypatch.delenv(THREADS[-1], raising=False)
    before = dict(os.environ)
    with open_executor("local", 1, fresh=True) as pool:
        assert {pool.submit(os.getenv, name).result() for name in THREADS} == {"1"}
        assert list(pool.map(pow, [2, 3], [5, 2])) == [32, 9]
    assert dict(os.environ) == before


def test_one_local_worker_is_this_process_unless_asked_otherwise():
    with open_executor("local", 1) as pool:
        assert pool.submit(os.getpid).result() == os.getpid()
        failed = pool.submit(math.sqrt, -1)
    assert isinstance(failed, Future)
    with pytest.raises(ValueError):
        failed.result()


def test_a_given_executor_is_used_and_left_open():
    with ThreadPoolExecutor(1) as given:
        with open_executor(given, 5) as pool:
            assert pool is given
        assert given.submit(int, "3").result() == 3


@pytest.mark.parametrize("pool", [Uncancelled(), InProcess()])
def test_results_come_as_they_end_until_the_first_exception(pool):
    assert dict(as_done(pool, pow, [(k, 2) for k in range(100)])) == {k: k**2 for k in range(100)}
    with pytest.raises(ZeroDivisionError):
        dict(as_done(pool, operator.truediv, [(1, 2), (3, 4), (1, 0)]))


def test_no_workers_are_refused():
    with pytest.raises(InputError, match="jobs"), open_executor("local", 0):
        pass


KERNEL = """
import sys, time
from pathlib import Path

from fabrics.executors import start_worker


def compiled(me, both):
    from numba import njit

    @njit(cache=True)
    def slow(x):
        for i in range(3):
            x = x**2 + i
        return x

    (both / me).touch()
    while len(list(both.glob("*"))) < 2:
        time.sleep(0.01)
    slow(1.0)
    return sum(slow.stats.cache_misses.values())


start_worker()
print(compiled(sys.argv[1], Path(sys.argv[2])))
"""


def test_a_kernel_is_compiled_by_one_process_and_loaded_by_the_other(tmp_path):
    """Two processes that want it at the same time, and an empty cache."""
    (tmp_path / "one.py").write_text(KERNEL)
    (tmp_path / "both").mkdir()
    paths = {"PYTHONPATH": str(ROOT), "NUMBA_CACHE_DIR": str(tmp_path / "cache"), "TMPDIR": str(tmp_path)}
    begun = [
        subprocess.Popen(
            [sys.executable, str(tmp_path / "one.py"), me, str(tmp_path / "both")], stdout=subprocess.PIPE,
            env=os.environ | paths, text=True,
        )
        for me in ("a", "b")
    ]  # fmt: skip
    assert sorted(process.communicate()[0].strip() for process in begun) == ["0", "1"]
