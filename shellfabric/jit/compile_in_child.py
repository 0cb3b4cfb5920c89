"""Compile large kernels in a process of their own, which gives back the memory that the compiler keeps.

LLVM holds on to everything it has made of a kernel until its process ends: hundreds of megabytes for one that works on
the state of a panel, of which the machine code is a hundredth. A process that compiles several variants of them, as
the tests do, grows to gigabytes. So a kernel with many arrays that is not in the cache is compiled by a child process,
which writes it there, and is then loaded like any other that is. Where that does not work (no cache can be written, the
kernel is not one of an importable module, the compiler objects) this process compiles it after all, with the same
outcome or the same error.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from pkgutil import resolve_name

from numba import types
from numba.core.caching import FunctionCache

# scalars and arrays among the arguments; one array takes a dozen instructions wherever it is passed on
MIN_MEMBERS = 50
ENTRY_SUFFIX = "_from_python"  # ending of the name of a kernel's way in from Python (`compile`)
_CHILD_CODE = "from shellfabric.jit.compile_in_child import child; child()"


class ChildCompileCache(FunctionCache):
    """numba's cache of one function, which has what is missing compiled by a child process."""

    def load_overload(self, sig, target_context):
        found = super().load_overload(sig, target_context)
        if found is None and members(sig) >= MIN_MEMBERS and compiled_in_child(self._py_func, sig):
            found = super().load_overload(sig, target_context)
        return found


def members(kinds):
    """How many scalars and arrays there are in numba types: tuples and lists count what they hold."""
    if isinstance(kinds, (tuple, types.BaseTuple)):
        return sum(map(members, kinds))
    return members(kinds.dtype) if isinstance(kinds, (types.List, types.ListType)) else 1


def compiled_in_child(function, kinds):
    """Whether a child process has compiled a kernel, the plain function here, for arguments of these numba types."""
    if not function.__module__.startswith("shellfabric.") or not sys.executable:
        return False
    paths = os.pathsep.join(path or os.getcwd() for path in sys.path)
    try:
        wanted = pickle.dumps((function.__module__, function.__qualname__, kinds))
        # -P: the folder that the user is in is not among the paths, if it is not here
        done = subprocess.run(
            [sys.executable, "-P", "-c", _CHILD_CODE],
            input=wanted, env=os.environ | {"PYTHONPATH": paths}, capture_output=True,
        )  # fmt: skip
    except (OSError, pickle.PicklingError, TypeError, AttributeError):
        return False
    return done.returncode == 0


def child():
    """Compile the kernel named on the standard input, and write it to the cache; the work of the child process."""
    module, name, kinds = pickle.load(sys.stdin.buffer)
    kernel = resolve_name(f"{module}:{name.removesuffix(ENTRY_SUFFIX)}")
    if name.endswith(ENTRY_SUFFIX):
        kernel = kernel._entry()
    kernel._cache.__class__ = FunctionCache  # here and now
    kernel.compile(kinds)
