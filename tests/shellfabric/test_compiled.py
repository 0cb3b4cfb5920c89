"""How kernels are compiled: what other kernels call has no way in from Python until it is asked for one."""

import numpy as np
from numba import types

from shellfabric import yarn_kernels
from shellfabric.compiled import entry, kernel


@kernel()
def halved(x, y=1.0):
    return 0.5 * x / y


@entry()
def quartered(x):
    return halved(halved(x))


def has_way_in(function, *kinds):
    """Whether what is compiled of it for arguments of these kinds can be called from Python."""
    function.compile(kinds)
    found = function.overloads[kinds]
    return found.library.get_pointer_to_function(found.fndesc.llvm_cpython_wrapper_name) != 0


def test_only_entries_have_a_way_in():
    assert has_way_in(quartered, types.float64)
    assert not has_way_in(halved, types.float64, types.float64)


def test_a_kernel_that_python_calls_makes_itself_one():
    quartered(1.0)
    assert halved(3.0, 2.0) == 0.75
    assert halved(3.0) == 1.5
    # its defaults, its globals and the compiler's options are those of the kernel: no error at 1 / 0
    assert halved(1.0, 0.0) == np.inf
    assert quartered(2.0) == 0.5


def test_a_kernel_is_itself_for_other_kernels_after_python_has_called_it():
    energy = yarn_kernels.energy.py_func(1.1, 1.0, 50.0, 0.0, 5.0)
    assert yarn_kernels.energy(1.1, 1.0, 50.0, 0.0, 5.0) == energy


def test_what_python_calls_is_kept_with_the_kernels():
    """Anywhere else it would be found again after a change of what it calls."""
    called, inner = yarn_kernels.energy._entry(), yarn_kernels.energy
    assert called._cache.cache_path == inner._cache.cache_path
    assert "kernels-" in called._cache.cache_path
