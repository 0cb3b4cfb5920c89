"""Where independent runs are made: one of these names, or any `concurrent.futures.Executor` given
from Python.

    local   processes of this machine
    mpi     mpi4py.futures: the ranks of `mpiexec -n RANKS python -m mpi4py.futures -m weavecell
            ...`
    dask    the workers of the Dask scheduler at the address in the environment variable
            DASK_SCHEDULER_ADDRESS

Workers have one thread each: another number of BLAS threads is another last bit. Of the workers of
these names one process a node compiles kernels, and the others load them. Tasks are functions of
importable modules. Nothing here imports numpy: a worker sets its number of threads before it does.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from functools import cache
from multiprocessing import active_children, current_process, get_context
from typing import Any

from fabrics.base.door import option
from fabrics.base.errors import InputError, WeavecellError
from fabrics.base.extras import explain_missing

BROKEN = (
    "a process that was started for this ended before its task, for example for want of memory; "
    'a script that starts processes does so below the line `if __name__ == "__main__":`'
)
# a new process, since neither MPI nor PETSc survives a fork
CONTEXT = get_context("spawn")
EXECUTORS = ("local", "mpi", "dask")
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS")


class InProcess(Executor):
    """Runs each task in this process, when it is submitted."""

    def submit(self, function: Callable, /, *arguments: Any, **keywords: Any) -> Future:
        """Run the function at once and return a finished future with its result or exception."""
        future: Future = Future()
        try:
            future.set_result(function(*arguments, **keywords))
        except Exception as problem:
            future.set_exception(problem)
        return future


@contextmanager
def one_thread_each() -> Iterator[None]:
    """Give processes that are started in this block one thread each."""
    before = {name: os.environ[name] for name in THREADS if name in os.environ}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    finally:
        for name in THREADS:
            del os.environ[name]
        os.environ.update(before)


def start_worker(initializer: Callable | None = None, *arguments: Any) -> None:
    """Prepare a process for tasks: one thread, one compiler a node, and what its `initializer`
    does."""
    os.environ.update(dict.fromkeys(THREADS, "1"))
    from fabrics.base.kernel_cache import one_compiler_a_node

    one_compiler_a_node()
    if initializer is not None:
        initializer(*arguments)


@contextmanager
def open_executor(
    executor: str | Executor = "local", jobs: int = 1, *, fresh: bool = False, first: tuple = ()
) -> Iterator[Executor]:
    """Open the executor of a name and close it at the end; use one that is given as an object as it
    is, and leave it open.

    `jobs` is the number of local processes, where a single one is this process unless it is to be
    `fresh`; `first` is (function, its arguments) that a local process calls first. InputError: no
    such executor, or no workers of it.
    """
    if jobs < 1:
        raise InputError(key="jobs", value=jobs, allowed="at least 1")
    if not isinstance(executor, str):
        yield executor
    # one process more would start the interpreter and load the kernels for nothing
    elif executor == "local" and jobs == 1 and not fresh:
        yield InProcess()
    elif executor == "local":
        others = active_children()
        if getattr(current_process(), "_inheriting", False):
            # a process that was just started is reading the script that started it
            raise SystemExit(1)
        # numpy reads the number of threads when it is imported, so it is set before the processes
        # start
        with one_thread_each(), ProcessPoolExecutor(jobs, CONTEXT, start_worker, first) as pool:
            try:
                yield pool
            except BrokenProcessPool:
                raise WeavecellError(BROKEN) from None
            except KeyboardInterrupt:
                # the program is to end now, not after the tasks that still run
                for worker in set(active_children()).difference(others):
                    worker.terminate()
                raise
    elif executor == "mpi":
        yield _ranks()
    elif executor == "dask":
        with _client() as client:
            # workers were started by somebody else, perhaps with many threads
            client.run(start_worker)
            # dask would give equal calls one result; here each task is run
            yield client.get_executor(pure=False)
    else:
        allowed = f"one of {', '.join(EXECUTORS)}"
        raise InputError(key=option("executor", ""), value=executor, allowed=allowed)


@cache
def _ranks():
    """The one pool of a program: mpi4py initialises ranks once, and closes them when the program
    ends."""
    from mpi4py import MPI, futures

    if (
        MPI.COMM_WORLD.size < 2 or "mpi4py.run" not in sys.modules
    ):  # which -m mpi4py.futures imports
        message = "needs the command mpiexec -n RANKS python -m mpi4py.futures -m weavecell ... with 2 ranks or more"
        raise InputError(message, key=option("executor", ""), value="mpi")
    return futures.MPIPoolExecutor(initializer=start_worker)


@explain_missing()
def _client():
    from distributed import Client

    address = os.environ.get("DASK_SCHEDULER_ADDRESS", "")
    with suppress(OSError, ValueError):
        if address:
            return Client(address)
    message = f"DASK_SCHEDULER_ADDRESS = {address!r} is the address of no Dask scheduler"
    raise InputError(message, key=option("executor", ""), value="dask")


def as_done(
    executor: Executor, function: Callable, arguments: Sequence[tuple]
) -> Iterator[tuple[int, Any]]:
    """Yield (index, result) of function(*row) for each row of `arguments`, as they end, until the
    first exception."""
    # submitting all of them at once would run all of them before the first result is handed on
    if isinstance(executor, InProcess):
        yield from ((index, function(*row)) for index, row in enumerate(arguments))
        return
    futures = {executor.submit(function, *row): index for index, row in enumerate(arguments)}
    try:
        yield from ((futures[future], future.result()) for future in as_completed(futures))
    finally:
        # after an exception or an interrupt the tasks that wait are not begun
        for future in futures:
            cancel(future)


def cancel(future: Future) -> None:
    """Cancel a task that has not begun, if the executor can."""
    with suppress(NotImplementedError):
        future.cancel()
