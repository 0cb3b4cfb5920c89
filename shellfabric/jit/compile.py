"""How kernels are compiled: those that other kernels call, and those that Python does.

numba makes two more functions beside each one that it compiles: one that takes Python's objects apart, and one with
the calling convention of C. A kernel with the state of a panel has over a hundred arrays, each a dozen instructions of
that, and only the few that a march begins with are ever called from Python: without the rest the kernels of a panel
are compiled in half the time.

    @kernel(...)    called by kernels
    @entry(...)     called by Python

A kernel that is called from Python all the same, as by its test, is compiled a second time for that.

What Python calls with many arrays is compiled in a process of its own (`compile_in_child`).

Kernels call each other across files: the cache of each file is emptied by a change in any file that it imports
(`kernel_cache`). The decorators put them there, so that a program imports the kernels that it uses and no others.
"""

from types import FunctionType

from numba import njit, types
from numba.core.caching import FunctionCache
from numba.core.registry import CPUDispatcher

from fabrics.base.kernel_cache import kernel_cache
from shellfabric.jit import inner_libraries
from shellfabric.jit.compile_in_child import ENTRY_SUFFIX, ChildCompileCache

inner_libraries.install()

_USUAL = {"cache": True, "error_model": "numpy", "no_cfunc_wrapper": True}


def entry(**options):
    """Decorator of a kernel that Python calls. options : of numba's njit, besides those of all kernels here."""

    def decorated(function):
        with kernel_cache(function.__code__.co_filename):
            found = njit(**_USUAL, **options)(function)
        if isinstance(getattr(found, "_cache", None), FunctionCache):
            found._cache.__class__ = ChildCompileCache
        return found

    return decorated


def kernel(**options):
    """Decorator of a kernel that other kernels call."""

    def decorated(function):
        with kernel_cache(function.__code__.co_filename):
            inner = njit(no_cpython_wrapper=True, **_USUAL, **options)(function)
        inner.__class__ = _Inner
        inner.entry_options = options
        return inner

    return decorated


class _Inner(CPUDispatcher):
    """A kernel that has no way in from Python, and makes itself one when Python calls it.

    A constant among its arguments does not make it a variant of its own, as it would in numba: where it is inlined LLVM
    sees the constant all the same.
    """

    def get_call_template(self, args, kws):
        plain = {name: types.unliteral(kind) for name, kind in kws.items()}
        return super().get_call_template(tuple(map(types.unliteral, args)), plain)

    def __call__(self, *arguments):
        return self._entry()(*arguments)

    def _entry(self):
        if not hasattr(self, "_twin"):
            inner = self.py_func
            twin = FunctionType(
                inner.__code__,
                inner.__globals__,
                inner.__name__,
                inner.__defaults__,
                inner.__closure__,
            )
            twin.__module__, twin.__qualname__ = (
                inner.__module__,
                inner.__qualname__ + ENTRY_SUFFIX,
            )  # names its file
            self._twin = entry(**self.entry_options)(twin)
        return self._twin
