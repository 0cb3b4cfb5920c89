"""How kernels are compiled: what other kernels call has no way in from Python until it is asked for one."""

import numpy as np
import pytest
from numba import config, typeof, types

from shellfabric.cell import yarn_kernels
from shellfabric.cloth import boundary_kernels
from shellfabric.jit import compile_in_child
from shellfabric.jit.compile import entry, kernel


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


@pytest.fixture
def large(small, tmp_path, monkeypatch):
    """(a kernel of a panel with an empty cache, what numba calls its arguments)."""
    found, panel = boundary_kernels.update_slip_nodes, small()
    kinds = typeof(panel.state(1.0)), typeof(panel.constants()), types.float64
    with monkeypatch.context() as patch:
        patch.setattr(config, "CACHE_DIR", str(tmp_path))
        function = entry()(found.py_func)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))  # for the other process; here it would undo the line above
    return function, kinds


def test_a_large_kernel_is_compiled_in_another_process(large):
    """This one finds it in the cache, and its compiler has made nothing that it would keep."""
    function, kinds = large
    assert compile_in_child.members(kinds) > compile_in_child.MIN_MEMBERS
    function.compile(kinds)
    assert not function.stats.cache_misses
    assert sum(function.stats.cache_hits.values()) == 1


def test_where_no_other_process_can_a_large_kernel_is_compiled_in_this_one(large, monkeypatch):
    function, kinds = large
    monkeypatch.setattr(compile_in_child, "_CHILD_CODE", "raise SystemExit(1)")
    function.compile(kinds)
    assert sum(function.stats.cache_misses.values()) == 1
    assert function.overloads[kinds].library.get_pointer_to_function(function.overloads[kinds].fndesc.mangled_name)


def test_members_are_counted_in_tuples_and_lists():
    panel = types.Tuple([types.float64, types.UniTuple(types.float64[:], 3)])
    assert compile_in_child.members((panel, types.ListType(panel), types.int64)) == 4 + 4 + 1
