"""Threads that march together: the same bits with any number of them, and how many there are."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from numba import njit
from numpy.testing import assert_array_equal

from fabrics.base.errors import InputError
from shellfabric.jit import barrier
from shellfabric.membrane.numerics import Numerics


@njit(nogil=True)
def _meetings(shared, written, me, count):
    sums = np.empty(written.shape[0])
    for m in range(written.shape[0]):
        written[m, me] = me + 1.0
        barrier.barrier_wait(shared, count)
        sums[m] = written[m].sum()
    return sums


def test_how_many(monkeypatch):
    """A large panel takes the processors that the process is allowed to use, not those of the machine."""
    monkeypatch.setattr("os.cpu_count", lambda: 64)
    monkeypatch.setattr("os.sched_getaffinity", lambda process: {0, 3, 5, 6, 9}, raising=False)
    assert barrier.threads_for(3, 10) == barrier.threads_for(3, barrier.MIN_ELEMENTS_THREADED) == 3
    assert barrier.threads_for(None, barrier.MIN_ELEMENTS_THREADED - 1) == 1
    assert barrier.threads_for(None, barrier.MIN_ELEMENTS_THREADED) == 5
    monkeypatch.delattr("os.sched_getaffinity")  # a system without it
    assert barrier.threads_for(None, barrier.MIN_ELEMENTS_THREADED) == 64
    monkeypatch.setattr("os.cpu_count", lambda: None)
    assert barrier.threads_for(None, barrier.MIN_ELEMENTS_THREADED) == 1
    with pytest.raises(InputError, match="threads"):
        Numerics(threads=0)


def test_nobody_passes_the_barrier_alone():
    """Sums of what each thread has written before it came are complete behind the barrier, a thousand times over."""
    count = 3
    shared = np.zeros(barrier.SLOTS, np.int64)
    written = np.zeros((1000, 3))
    _meetings(shared, written, 0, 1)  # compiled
    written[:] = 0.0
    with ThreadPoolExecutor(count) as pool:
        seen = [pool.submit(_meetings, shared, written, me, count) for me in range(count)]
        for sums in seen:
            assert_array_equal(sums.result(), np.full(1000, 6.0))
