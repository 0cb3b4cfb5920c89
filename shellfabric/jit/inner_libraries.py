"""No machine code of kernels that only other kernels call.

numba optimises each function that it compiles with all that it calls, and makes machine code of it, although a kernel
without a way in from Python can only ever run as a part of its callers, in which LLVM optimises it again. Here such a
kernel is only made ready for inlining; its cache file has the intermediate code alone.
"""

import ctypes

from numba.core import codegen

from shellfabric.jit.numba_internals import KNOWN

_PREFIX, _ENTRY = "_ZN11shellfabric", "_ZN7cpython"
if KNOWN:
    _full, _finish = (
        codegen.CPUCodeLibrary._optimize_final_module,
        codegen.CPUCodeLibrary._finalize_final_module,
    )
    _object_code = codegen.JITCodeLibrary.serialize_using_object_code


def _inner(library):
    """Whether a library has kernels of this package and none that Python calls."""
    if not hasattr(library, "_is_inner"):
        names = [
            function.name
            for function in library._final_module.functions
            if not function.is_declaration
        ]
        library._is_inner = any(name.startswith(_PREFIX) for name in names) and not any(
            name.startswith(_ENTRY) for name in names
        )
    return library._is_inner


def _optimize_final_module(self):
    if not _inner(self):
        return _full(self)
    generator = self._codegen
    manager, builder = generator._module_pass_manager(
        loop_vectorize=generator._loopvect,
        slp_vectorize=False,
        opt=generator._opt_level,
        cost="cheap",
    )
    return manager.run(self._final_module, builder)


def _finalize_final_module(self):
    if not _inner(self):
        return _finish(self)
    self._finalize_dynamic_globals()
    self._finalized = True
    return None


def _serialize(self):
    return self.serialize_using_bitcode() if _inner(self) else _object_code(self)


def _set_env(self, name, env):
    place = self._engine.get_global_value_address(name)
    if place:  # what has no machine code has no environment
        (ctypes.c_void_p * 1).from_address(place)[0] = ctypes.c_void_p(id(env))


def install():
    """From now on in this process, with a numba that is known."""
    if not KNOWN:
        return
    codegen.CPUCodeLibrary._optimize_final_module = _optimize_final_module
    codegen.CPUCodeLibrary._finalize_final_module = _finalize_final_module
    codegen.JITCodeLibrary.serialize_using_object_code = _serialize
    codegen.JITCPUCodegen.set_env = _set_env
