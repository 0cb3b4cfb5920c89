"""How kernels are compiled: what other kernels call has no way in from Python until it is asked for one."""

import math

import numpy as np
import pytest
from numba import config, typeof, types

from fabrics import kernel_cache
from shellfabric.jit import compile_in_child
from shellfabric.jit.compile import entry, kernel
from shellfabric.panel import quality_kernels


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


@pytest.fixture
def large(small, tmp_path, monkeypatch):
    """(a kernel of a panel with an empty cache, what numba calls its arguments)."""
    found, panel = quality_kernels.sample, small()
    numbers = types.int64, types.int64, types.float64, types.float64, types.float64[::1]
    kinds = typeof(panel.state(1.0)), typeof(panel.constants()), *numbers
    with monkeypatch.context() as patch:
        patch.setattr(config, "CACHE_DIR", str(tmp_path))
        function = entry()(found.py_func)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))  # for the other process; here it would undo the line above
    return function, kinds


def test_a_large_kernel_is_compiled_in_another_process(large, tmp_path, caplog, monkeypatch):
    """This one finds it in the cache, and its compiler has made nothing that it would keep. The user is warned once."""
    function, kinds = large
    assert compile_in_child.members(kinds) > compile_in_child.MIN_MEMBERS
    for announced in (["compiling the kernels of a ply, once: about half a minute"], []):
        caplog.clear()
        monkeypatch.setattr(kernel_cache, "_last", -math.inf)
        function.compile(kinds)
        assert not function.stats.cache_misses
        assert sum(function.stats.cache_hits.values()) == 1
        assert [record.message for record in caplog.records if record.name == "weavecell"] == announced
        with monkeypatch.context() as patch:
            patch.setattr(config, "CACHE_DIR", str(tmp_path))
            function = entry()(function.py_func)


def test_where_no_other_process_can_a_large_kernel_is_compiled_in_this_one(large, monkeypatch):
    function, kinds = large
    monkeypatch.setattr(compile_in_child, "_CHILD_CODE", "raise SystemExit(1)")
    function.compile(kinds)
    assert sum(function.stats.cache_misses.values()) == 1
    assert function.overloads[kinds].library.get_pointer_to_function(function.overloads[kinds].fndesc.mangled_name)


def test_a_child_that_has_begun_a_kernel_is_waited_for(large):
    """Then the cache holds it, and no second child compiles it."""
    function, kinds = large
    assert not compile_in_child.kept(function, kinds)
    compile_in_child.start([[]], [[(function, kinds)]])  # a stage with nothing to compile holds up none
    assert len(compile_in_child._pending) == 1
    compile_in_child.start([[]])
    assert len(compile_in_child._pending) == 1
    assert compile_in_child.await_children(function.py_func, kinds)
    assert compile_in_child.kept(function, kinds)
    assert not compile_in_child._pending
    compile_in_child.start([[(function, kinds)]])
    assert not compile_in_child._pending


def test_a_constant_argument_makes_no_variant():
    @kernel()
    def shifted(x, n):
        return x + n

    @entry()
    def both(x, n):
        return shifted(x, 1) + shifted(x, 2) + shifted(x, n)

    assert both(0.5, 3) == 7.5
    assert shifted.signatures == [(types.float64, types.int64)]
