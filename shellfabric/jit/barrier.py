"""Threads that march together: a barrier for compiled kernels that hold no lock, and how many threads a run uses.

Each thread runs a kernel of its own over the same steps; between the parts of a step all wait for each other at a
barrier. It is a counter in memory that every thread adds one to, and that nobody passes before the last has come. Who
waits looks at it again and again, and after a while lets others have the processor in between: shots of `limit`, or
other programs.
"""

import os

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from shellfabric.jit.compile import kernel

CHEAP = 10_000  # elements below which the threads would wait for each other longer than they save
COUNTER, STOP, ROOM = 0, 16, 32  # slots of the shared array: far from each other, in cache lines of their own
_LOOKS = 2000  # at the counter before others get the processor
_WORD = ir.IntType(64)


def threads_for(asked, elements):
    """Threads that march a panel: as many as asked, or all that the process may use where it pays."""
    if asked is not None:
        return asked
    allowed = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return allowed if elements >= CHEAP else 1


def _slot(context, builder, signature, arguments):
    data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
    return builder.gep(data, [arguments[1]])


@intrinsic
def _arrive(typing, shared, slot):
    """Add one to a slot, all that was written before being seen by who reads it; returns what it was."""

    def codegen(context, builder, signature, arguments):
        place = _slot(context, builder, signature, arguments)
        return builder.atomic_rmw("add", place, ir.Constant(_WORD, 1), "acq_rel")

    return types.int64(shared, slot), codegen


@intrinsic
def _look(typing, shared, slot):
    """Read a slot, with all that was written before."""

    def codegen(context, builder, signature, arguments):
        place = _slot(context, builder, signature, arguments)
        more = {"typ": _WORD} if "typ" in ir.IRBuilder.load_atomic.__code__.co_varnames else {}
        return builder.load_atomic(place, "acquire", 8, **more)

    return types.int64(shared, slot), codegen


@intrinsic
def _let_others(typing):
    """Give the processor to who else wants it."""

    def codegen(context, builder, signature, arguments):
        function = ir.FunctionType(ir.IntType(32), [])
        builder.call(cgutils.get_or_insert_function(builder.module, function, "sched_yield"), [])
        return context.get_dummy_value()

    return types.void(), codegen


@kernel()
def meet(shared, count):
    """Wait until all `count` threads are here. shared : (ROOM,) int64, zero at first."""
    if count == 1:
        return
    goal = (_arrive(shared, COUNTER) // count + 1) * count
    looks = 0
    while _look(shared, COUNTER) < goal:
        looks += 1
        if looks > _LOOKS:
            _let_others()
