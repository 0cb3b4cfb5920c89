"""Independent runs on any executor of concurrent.futures; each is on disk as soon as it is done.

A run is kept under the key of its function, its arguments and the code of both (`fabrics.run_cache`), so that an
interrupted study goes on where it was, and a run of other code is never taken for one of this. Nothing depends on
how many runs are under way, or in which order they end.
"""

from __future__ import annotations

from concurrent.futures import as_completed
from contextlib import contextmanager

from fabrics import run_cache
from fabrics import workers as processes
from fabrics.errors import InputError

POOLS = ("processes", "mpi")


@contextmanager
def executor(kind="processes", jobs=1):
    """An executor: fresh processes with one thread each, or the ranks of mpi4py.futures; None for one process, this.

    Under MPI the program is started as `mpiexec -n RANKS python -m mpi4py.futures -m weavecell ...`.
    """
    if kind not in POOLS:
        raise InputError(key="pool", value=kind, allowed=" or ".join(POOLS))
    if kind == "mpi":
        try:
            from mpi4py.futures import MPIPoolExecutor
        except ImportError:
            raise InputError(key="pool", value=kind, allowed="processes, since mpi4py is not installed") from None
        with MPIPoolExecutor() as pool:
            yield pool
    elif jobs == 1:
        yield None
    else:
        with processes.workers(None, jobs) as pool:
            yield pool


def results(function, arguments, *, folder, workers=None, report=None):
    """function(*one) for each one of `arguments`, in their order.

    Parameters
    ----------
    function : of a module, to be found again in another process
    arguments : list of tuples of plain numbers, texts and frozen dataclasses
    folder : Path where results are kept, and taken from
    workers : executor, or None
    report : called as report(number done, number of all)

    Raises
    ------
    WeavecellError : as the function; what had ended has been kept
    """
    names = [run_cache.key((function.__qualname__, one), function.__module__) for one in arguments]
    kept = run_cache.RunCache(folder)
    missing = [k for k, name in enumerate(names) if name not in kept]
    report = report or (lambda done, total: None)
    report(len(names) - len(missing), len(names))
    for done, (k, content) in enumerate(_each(function, [(k, arguments[k]) for k in missing], workers), 1):
        kept[names[k]] = content
        report(len(names) - len(missing) + done, len(names))
    return [kept[name] for name in names]


def _each(function, jobs, workers):
    """(key, result) of each job, as they end."""
    if workers is None:
        for key, one in jobs:
            yield key, function(*one)
        return
    futures = {workers.submit(function, *one): key for key, one in jobs}
    try:
        for future in as_completed(futures):
            yield futures[future], future.result()
    finally:
        for future in futures:
            future.cancel()
