"""Processes that work beside each other, with one thread each.

They start afresh (MPI and PETSc do not survive a fork), and share the cores among themselves: so many processes, so
many threads in all.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from typing import Any

CONTEXT = get_context("spawn")
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS")


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


@contextmanager
def workers(executor: Executor | None, processes: int, **options: Any) -> Iterator[Executor]:
    """The executor, or `processes` of our own with one thread each, started with `options`.

    Of our own even where there is one alone: another number of threads is another last bit.
    """
    if executor is not None:
        yield executor
        return
    with one_thread_each(), ProcessPoolExecutor(processes, mp_context=CONTEXT, **options) as pool:
        yield pool
