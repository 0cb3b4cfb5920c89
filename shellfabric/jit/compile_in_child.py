"""Compile large kernels in a process of their own, which gives back the memory that the compiler keeps.

LLVM holds on to everything it has made of a kernel until its process ends: hundreds of megabytes for one that works on
the state of a panel, of which the machine code is a hundredth. A process that compiles several variants of them, as
the tests do, grows to gigabytes. So a kernel with many arrays that is not in the cache is compiled by a child process,
which writes it there, and is then loaded like any other that is. Where that does not work (no cache can be written, the
kernel is not one of an importable module, the compiler objects) this process compiles it after all, with the same
outcome or the same error.

Kernels that will be called soon can be compiled by several such processes beside each other (`start`), and those that
call them by others after these. Who wants one of them waits for the child that has it; before any other kernel is
compiled all children are waited for, since it may call what they compile.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import threading
from pkgutil import resolve_name
from typing import Any

from numba import typeof, types
from numba.core.caching import FunctionCache

from fabrics.base.kernel_cache import compiling

# numba types of arguments that are no tuples
INDEX, NUMBER, VECTOR, HISTORY, COUNTERS = (
    types.int64,
    types.float64,
    types.float64[::1],
    types.float64[:, ::1],
    types.int64[::1],
)
# scalars and arrays among the arguments; one array takes a dozen instructions wherever it is passed on
MIN_MEMBERS = 50
MODULES = (
    "shellfabric.",
    "validation.models.",
)  # that a child can import; a kernel of a test it could not
ENTRY_SUFFIX = "_from_python"  # ending of the name of a kernel's way in from Python (`compile`)
_CHILD_CODE = "from shellfabric.jit.compile_in_child import child; child()"


_pending: list[
    tuple[threading.Event, list]
] = []  # children that `start` has planned: set at their end, what for


class ChildCompileCache(FunctionCache):
    """numba's cache of one function, which has what is missing compiled by a child process."""

    def load_overload(self, sig, target_context):
        found = super().load_overload(sig, target_context)
        if found is not None:
            return found
        compiling(self._py_func.__module__)
        if members(sig) < MIN_MEMBERS:
            return None
        if await_children(self._py_func, sig):
            found = super().load_overload(sig, target_context)
        if found is None and compiled_in_child(self._py_func, sig):
            found = super().load_overload(sig, target_context)
        compiling(self._py_func.__module__, done=True)
        return found

    def save_overload(self, sig, data):
        super().save_overload(sig, data)
        compiling(self._py_func.__module__, done=True)


def start(*stages):
    """Begin to compile kernels: each part of a stage, [(kernel, numba types of its arguments), ...], in a child process
    of its own, the children of a stage beside each other, and each stage when the one before has ended.

    What is in the cache is left out. Returns without waiting.
    """
    planned = []
    for parts in stages:
        found = [
            [(kernel.py_func, kinds) for kernel, kinds in part if not kept(kernel, kinds)]
            for part in parts
        ]
        planned.append([(threading.Event(), missing) for missing in found if missing])
    for done, missing in (part for stage in planned for part in stage):
        _pending.append((done, [(function.__qualname__, kinds) for function, kinds in missing]))
    if any(planned):
        compiling(next(missing for stage in planned for _, missing in stage)[0][0].__module__)
        threading.Thread(target=_compile_stages, args=(planned,), daemon=True).start()


def _compile_stages(planned):
    """The children of each stage, one stage after the other."""
    for stage in planned:
        children = [(done, _child([_named(*one) for one in missing])) for done, missing in stage]
        for done, process in children:
            if process is not None:
                process.wait()
            done.set()


def await_children(function, kinds):
    """Wait for the child that compiles a kernel, or for all where none does; whether one did."""
    found = [child for child in _pending if (function.__qualname__, kinds) in child[1]]
    for child in found or list(_pending):
        child[0].wait()
        _pending.remove(child)
    return bool(found)


def type_of(value: Any) -> Any:
    """numba type of a value."""
    return typeof(value)


def kept(kernel, kinds):
    """Whether the machine code of a kernel is in its cache, or it has none."""
    try:
        return (
            kernel._cache._index_key(kinds, kernel.targetctx.codegen())
            in kernel._cache._cache_file._load_index()
        )
    except (OSError, AttributeError):
        return True


def is_cold(kernel):
    """Whether no machine code of a kernel is in its cache, for whatever arguments."""
    try:
        return not kernel._cache._cache_file._load_index()
    except (OSError, AttributeError):
        return False


def members(kinds):
    """How many scalars and arrays there are in numba types: tuples and lists count what they hold."""
    kinds = getattr(
        kinds, "kind", getattr(kinds, "inner", kinds)
    )  # of `Items`; of a reference to a named tuple
    return sum(map(members, kinds)) if isinstance(kinds, (tuple, types.BaseTuple)) else 1


def compiled_in_child(function, kinds):
    """Whether a child process has compiled a kernel, the plain function here, for arguments of these numba types."""
    if not function.__module__.startswith(MODULES) or not sys.executable:
        return False
    process = _child([_named(function, kinds)])
    return process is not None and process.wait() == 0


def _named(function, kinds):
    return function.__module__, function.__qualname__, kinds


def _child(wanted):
    """The process that compiles [(module, name, numba types of the arguments)]; None where there can be none."""
    paths = os.pathsep.join(path or os.getcwd() for path in sys.path)
    try:
        given = pickle.dumps(wanted)
        # -P: the folder that the user is in is not among the paths, if it is not here
        process = subprocess.Popen(
            [sys.executable, "-P", "-c", _CHILD_CODE],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            env=os.environ | {"PYTHONPATH": paths},
        )
        with process.stdin as pipe:
            pipe.write(given)
    except (OSError, pickle.PicklingError, TypeError, AttributeError):
        return None
    return process


def child():
    """Compile the kernels named on the standard input, and write them to the cache; the work of the child process."""
    for module, name, kinds in pickle.load(sys.stdin.buffer):
        kernel = resolve_name(f"{module}:{name.removesuffix(ENTRY_SUFFIX)}")
        if name.endswith(ENTRY_SUFFIX):
            kernel = kernel._entry()
        kernel._cache.__class__ = FunctionCache  # here and now
        kernel.compile(kinds)
