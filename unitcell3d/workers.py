"""Processes that solve crossovers beside each other."""

from __future__ import annotations

import os
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context

# MPI and PETSc do not survive a fork: start afresh
CONTEXT = get_context("spawn")


@contextmanager
def one_thread_each():
    """Start processes with one BLAS thread: they share the cores among themselves."""
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")
    before = {name: os.environ.get(name) for name in names}
    os.environ.update(dict.fromkeys(names, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@contextmanager
def workers(executor, processes, **options):
    """The executor, or `processes` of our own with one thread each, started with `options`.

    Of our own even where there is one alone: another number of BLAS threads is another last bit.
    """
    if executor is not None:
        yield executor
        return
    with one_thread_each(), ProcessPoolExecutor(processes, mp_context=CONTEXT, **options) as pool:
        yield pool
