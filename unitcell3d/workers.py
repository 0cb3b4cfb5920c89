"""Processes that solve crossovers beside each other."""

from __future__ import annotations

import os
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
