"""Where independent runs are made: any `concurrent.futures.Executor`, chosen by name.

    local             processes of this machine
    mpi               mpi4py.futures: the ranks of `mpiexec -n RANKS python -m mpi4py.futures -m weavecell ...`
    parsl             parsl.concurrent.ParslPoolExecutor with workers on this machine
    dask              distributed.Client.get_executor(): the workers of the scheduler that DASK_SCHEDULER_ADDRESS names,
                      or some of this machine where it names none
    MODULE:FUNCTION   what the function returns, such as a ParslPoolExecutor whose configuration is that of a cluster

Workers have one thread each: another number of BLAS threads is another last bit. Tasks are functions of importable
modules. On each node one process at a time compiles kernels, and the others load what it has compiled
(`kernel_cache.one_compiler_a_node`). Nothing here imports numpy: a worker sets its number of threads before it does.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor, as_completed
from contextlib import AbstractContextManager, contextmanager, suppress
from functools import cache
from importlib import import_module
from math import ceil
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from fabrics.errors import InputError

CONTEXT = get_context("spawn")  # MPI and PETSc do not survive a fork
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS")
_TASKS_A_WORKER = 8  # at least, where runs are many: else the last worker keeps the others waiting
_LARGEST_BATCH = 8  # runs; what an interruption loses of each worker
_OPTION = "--executor"


class InProcess(Executor):
    """Runs each task in this process, when it is submitted."""

    def submit(self, function: Callable, /, *arguments: Any, **keywords: Any) -> Future:
        future: Future = Future()
        try:
            future.set_result(function(*arguments, **keywords))
        except Exception as problem:
            future.set_exception(problem)
        return future


class _Pool(Executor):
    """An executor whose workers compile kernels one at a time."""

    def __init__(self, inner):
        self._inner = inner

    def submit(self, function: Callable, /, *arguments: Any, **keywords: Any) -> Future:
        return self._inner.submit(run_task, function, *arguments, **keywords)

    def map(self, function, /, *iterables, **options):
        rows = list(zip(*iterables))
        # the inner one's own: Parsl's futures cannot be cancelled, as the default executor does
        return self._inner.map(run_task, [function] * len(rows), *zip(*rows), **options)


@contextmanager
def _environment(**values):
    """Processes that are started meanwhile have these environment variables."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def one_thread_each() -> AbstractContextManager[None]:
    """Processes that are started meanwhile have one thread."""
    return _environment(**dict.fromkeys(THREADS, "1"))


def set_one_thread() -> None:
    """One thread for libraries that are loaded after this."""
    os.environ.update(dict.fromkeys(THREADS, "1"))


def run_task(function: Callable, /, *arguments: Any, **keywords: Any) -> Any:
    """function(*arguments, **keywords), in a worker."""
    from fabrics.kernel_cache import one_compiler_a_node

    one_compiler_a_node()
    return function(*arguments, **keywords)


@contextmanager
def open_executor(
    executor: str | Executor = "local", jobs: int = 1, *, fresh: bool = False, **options: Any
) -> Iterator[Executor]:
    """The executor of a name, closed at the end; one that is given as an object is used as it is, and left open.

    Parameters
    ----------
    executor : Executor, or a name as above
    jobs : workers; of mpi, and of what a function returns, there are as many as it has
    fresh : whether a single local worker is a process too, rather than this one
    options : of the ProcessPoolExecutor of "local"; not used by others

    Raises
    ------
    InputError : no such executor, or its library is not installed
    """
    if jobs < 1:
        raise InputError(key="jobs", value=jobs, allowed="at least 1")
    if not isinstance(executor, str):
        yield executor
    elif executor == "local" and jobs == 1 and not fresh:
        yield InProcess()
    elif executor == "local":
        with one_thread_each(), ProcessPoolExecutor(jobs, mp_context=CONTEXT, **options) as pool:
            yield _Pool(pool)
    elif executor in _NAMED:
        package, opened = _NAMED[executor]
        try:
            import_module(package)
        except ModuleNotFoundError:
            raise InputError(
                f"needs the Python package {package.split('.')[0]}, which is not installed", key=_OPTION, value=executor
            ) from None
        with one_thread_each(), opened(jobs) as pool:
            yield _Pool(pool)
    else:
        with one_thread_each(), _returned(executor) as pool:
            yield _Pool(pool)


def _returned(name):
    """The executor that the function MODULE:FUNCTION of the user returns."""
    module, _, function = name.partition(":")
    if not (module and function):
        raise InputError(key=_OPTION, value=name, allowed="local, mpi, parsl, dask or MODULE:FUNCTION")
    sys.path.insert(0, os.getcwd())  # as python -m has it
    try:
        found = getattr(import_module(module), function)
    except (ImportError, AttributeError) as problem:
        raise InputError(f"cannot be imported ({problem})", key=_OPTION, value=name) from None
    pool = found() if callable(found) else None
    if not isinstance(pool, Executor):
        raise InputError(key=_OPTION, value=name, allowed="a function that returns a concurrent.futures.Executor")
    return pool


@contextmanager
def _mpi(jobs):
    from mpi4py import MPI

    if MPI.COMM_WORLD.size < 2 or "mpi4py.run" not in sys.modules:  # which -m mpi4py.futures imports
        raise InputError(
            "goes with mpiexec -n RANKS python -m mpi4py.futures -m weavecell ..., 2 ranks or more",
            key=_OPTION, value="mpi",
        )  # fmt: skip
    yield _ranks()


@cache
def _ranks():
    """The one pool of a program: mpi4py initialises ranks once, and closes them when the program ends."""
    from mpi4py.futures import MPIPoolExecutor

    return MPIPoolExecutor(initializer=set_one_thread)


@contextmanager
def _parsl(jobs):
    from parsl import Config, DataFlowKernel
    from parsl.concurrent import ParslPoolExecutor
    from parsl.executors import HighThroughputExecutor
    from parsl.providers import LocalProvider

    folder = tempfile.mkdtemp(prefix="weavecell-parsl-")
    workers = HighThroughputExecutor(
        label="weavecell", address="127.0.0.1", max_workers_per_node=jobs, cores_per_worker=1e-3,
        provider=LocalProvider(init_blocks=1, max_blocks=1),
    )  # fmt: skip
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}"  # where Parsl's own programs are
    try:
        with _environment(PATH=path):
            config = Config(executors=[workers], run_dir=folder, initialize_logging=False, strategy="none")
            kernel = DataFlowKernel(config)
            try:
                yield ParslPoolExecutor(dfk=kernel)
            finally:
                kernel.cleanup()  # at once: tasks of a run that has failed are not waited for
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@contextmanager
def _dask(jobs):
    import dask
    from distributed import Client

    own = {"n_workers": jobs, "threads_per_worker": 1, "processes": True, "dashboard_address": None}
    with Client(**({} if dask.config.get("scheduler-address", None) else own)) as client:
        yield client.get_executor(pure=False)


_NAMED = {
    "mpi": ("mpi4py.futures", _mpi), "parsl": ("parsl.concurrent", _parsl), "dask": ("distributed", _dask),
}  # fmt: skip


def as_done(
    executor: Executor, function: Callable, arguments: Sequence[tuple], *, jobs: int | None = None
) -> Iterator[tuple[int, Any]]:
    """(index, result) of function(*one) for each one of `arguments`, as they end.

    Parameters
    ----------
    executor : Executor
    function : of a module
    arguments : list of tuples
    jobs : workers; where there are many more runs than workers, several are submitted as one task. None: one each

    Raises
    ------
    The first exception of a run, once the results before it in its task have been given; what has not begun is
    cancelled.
    """
    if isinstance(executor, InProcess):
        yield from ((index, function(*one)) for index, one in enumerate(arguments))
        return
    size = 1 if jobs is None else min(_LARGEST_BATCH, ceil(len(arguments) / (_TASKS_A_WORKER * jobs)))
    starts = range(0, len(arguments), max(size, 1))
    futures = {executor.submit(_batch, function, arguments[start : start + size]): start for start in starts}
    try:
        for future in as_completed(futures):
            found, problem = future.result()
            yield from enumerate(found, futures[future])
            if problem is not None:
                raise problem
    finally:
        for future in futures:
            cancel(future)


def cancel(future: Future) -> None:
    """Cancel a task that has not begun, where the executor can; Parsl cannot."""
    with suppress(NotImplementedError):
        future.cancel()


def _batch(function, arguments):
    """(results of runs one after the other, the exception of the one after them or None)."""
    found = []
    for one in arguments:
        try:
            found.append(function(*one))
        except Exception as problem:
            return found, problem
    return found, None
