"""Spin barrier for threads in compiled kernels, and the number of threads of a run.

Each thread runs a kernel of its own over the same steps; between the parts of a step all wait at
the barrier, an atomic counter in shared memory. A waiting thread spins on it, and after a while
yields the processor in between.
"""

import os

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from shellfabric.jit.compile import kernel

# elements below which the threads would wait for each other longer than they save
MIN_ELEMENTS_THREADED = 10_000
# slots of the shared array: far from each other, in cache lines of their own
COUNTER = 0
STOP = 16
SLOTS = 32
ABORTED = 2  # of slot STOP: a thread has raised an exception, and nobody waits any more
_SPINS = 2000  # at the counter before others get the processor
_WORD = ir.IntType(64)


def threads_for(given, elements):
    """Choose the number of threads of a run: as given, or all that the process may use if the panel
    is large enough."""
    if given is not None:
        return given
    if hasattr(os, "sched_getaffinity"):
        allowed = len(os.sched_getaffinity(0))
    else:
        allowed = os.cpu_count() or 1
    if elements >= MIN_ELEMENTS_THREADED:
        return allowed
    return 1


def _slot(context, builder, signature, arguments):
    data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
    return builder.gep(data, [arguments[1]])


@intrinsic
def _fetch_add(typing, shared, slot):
    """Atomic fetch-and-add of one to a slot, with acquire and release order."""

    def codegen(context, builder, signature, arguments):
        place = _slot(context, builder, signature, arguments)
        return builder.atomic_rmw("add", place, ir.Constant(_WORD, 1), "acq_rel")

    return types.int64(shared, slot), codegen


@intrinsic
def _load_acquire(typing, shared, slot):
    """Atomic load of a slot, with acquire order."""

    def codegen(context, builder, signature, arguments):
        place = _slot(context, builder, signature, arguments)
        return builder.load_atomic(place, "acquire", 8)

    return types.int64(shared, slot), codegen


@intrinsic
def _sched_yield(typing):
    """Yield the processor to other threads (sched_yield)."""

    def codegen(context, builder, signature, arguments):
        function = ir.FunctionType(ir.IntType(32), [])
        builder.call(cgutils.get_or_insert_function(builder.module, function, "sched_yield"), [])
        return context.get_dummy_value()

    return types.void(), codegen


@kernel()
def barrier_wait(shared, count):
    """Wait until all `count` threads have arrived: a barrier.

    shared : (SLOTS,) int64, zero at first
    """
    if count == 1:
        return
    goal = (_fetch_add(shared, COUNTER) // count + 1) * count
    looks = 0
    while _load_acquire(shared, COUNTER) < goal and _load_acquire(shared, STOP) != ABORTED:
        looks += 1
        if looks > _SPINS:
            _sched_yield()
