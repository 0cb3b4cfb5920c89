"""Where independent runs are made: one of these names, or any `concurrent.futures.Executor` given from Python.

    local   processes of this machine
    mpi     mpi4py.futures: the ranks of `mpiexec -n RANKS python -m mpi4py.futures -m weavecell ...`
    dask    the workers of the Dask scheduler at the address in the environment variable DASK_SCHEDULER_ADDRESS

Workers have one thread each: another number of BLAS threads is another last bit. Tasks are functions of importable
modules. Of the workers of these names, one process at a time compiles kernels on each node, and the others load what it
has compiled (`kernel_cache.one_compiler_a_node`). Nothing here imports numpy: a worker sets its number of threads
before it does.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor, as_completed
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from multiprocessing import get_context
from typing import Any

from fabrics.errors import InputError

CONTEXT = get_context("spawn")  # MPI and PETSc do not survive a fork
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS")
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


@contextmanager
def one_thread_each() -> Iterator[None]:
    """Processes that are started meanwhile have one thread."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def start_worker(initializer: Callable | None = None, *arguments: Any) -> None:
    """Prepare a process for tasks: one thread, one compiler a node, and what else its `initializer` does."""
    os.environ.update(dict.fromkeys(THREADS, "1"))
    from fabrics.kernel_cache import one_compiler_a_node

    one_compiler_a_node()
    if initializer is not None:
        initializer(*arguments)


@contextmanager
def open_executor(
    executor: str | Executor = "local", jobs: int = 1, *, fresh: bool = False, first: tuple = ()
) -> Iterator[Executor]:
    """The executor of a name, closed at the end; one that is given as an object is used as it is, and left open.

    Parameters
    ----------
    executor : Executor, or a name as above
    jobs : processes of "local"; of mpi and dask there are as many workers as these have
    fresh : whether a single local worker is a process too, rather than this one
    first : (function, its arguments) that a local process calls first; not used by others

    Raises
    ------
    InputError : no such executor, its library is not installed, or its workers cannot be reached
    """
    if jobs < 1:
        raise InputError(key="jobs", value=jobs, allowed="at least 1")
    if not isinstance(executor, str):
        yield executor
    elif executor == "local" and jobs == 1 and not fresh:
        yield InProcess()
    elif executor == "local":
        with one_thread_each(), ProcessPoolExecutor(jobs, CONTEXT, start_worker, first) as pool:
            yield pool
    elif executor in _NAMED:
        with ExitStack() as stack:
            try:
                pool = stack.enter_context(_NAMED[executor]())
            except ModuleNotFoundError as problem:
                message = f"needs the Python package {problem.name}, which is not installed"
                raise InputError(message, key=_OPTION, value=executor) from None
            yield pool
    else:
        raise InputError(key=_OPTION, value=executor, allowed="local, mpi or dask")


@contextmanager
def _mpi():
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

    return MPIPoolExecutor(initializer=start_worker)


@contextmanager
def _dask():
    from distributed import Client

    address = os.environ.get("DASK_SCHEDULER_ADDRESS", "")
    try:
        if not address:
            raise ValueError("it is not set")
        client = Client(address)
    except (OSError, ValueError) as problem:
        message = f"DASK_SCHEDULER_ADDRESS = {address!r} is the address of no Dask scheduler ({problem})"
        raise InputError(message, key=_OPTION, value="dask") from None
    with client:
        client.run(start_worker)
        yield client.get_executor(pure=False)


_NAMED = {"mpi": _mpi, "dask": _dask}


def as_done(executor: Executor, function: Callable, arguments: Sequence[tuple]) -> Iterator[tuple[int, Any]]:
    """(index, result) of function(*one) for each one of `arguments`, as they end; `function` is that of a module.

    Raises
    ------
    The first exception of a run; what has not begun is cancelled.
    """
    if isinstance(executor, InProcess):
        yield from ((index, function(*one)) for index, one in enumerate(arguments))
        return
    futures = {executor.submit(function, *one): index for index, one in enumerate(arguments)}
    try:
        yield from ((futures[future], future.result()) for future in as_completed(futures))
    finally:
        for future in futures:
            cancel(future)


def cancel(future: Future) -> None:
    """Cancel a task that has not begun, where the executor can."""
    with suppress(NotImplementedError):
        future.cancel()
