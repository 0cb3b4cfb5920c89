"""Where kernels are compiled: large ones in another process, if there can be one."""

import math

import pytest
from numba import config, typeof, types

from fabrics.base import kernel_cache
from shellfabric.jit import compile_in_child
from shellfabric.jit.compile import entry
from shellfabric.panel import quality_kernels


@pytest.fixture
def large(small, tmp_path, monkeypatch):
    """(a kernel of a panel with an empty cache, what numba calls its arguments)."""
    found, panel = quality_kernels.sample, small()
    numbers = types.int64, types.int64, types.float64, types.float64, types.float64[::1]
    kinds = typeof(panel.state(1.0)), typeof(panel.constants()), *numbers
    with monkeypatch.context() as patch:
        patch.setattr(config, "CACHE_DIR", str(tmp_path))
        function = entry()(found.py_func)
    monkeypatch.setenv(
        "NUMBA_CACHE_DIR", str(tmp_path)
    )  # for the other process; here it would undo the line above
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
        assert [
            record.message for record in caplog.records if record.name == "weavecell"
        ] == announced
        with monkeypatch.context() as patch:
            patch.setattr(config, "CACHE_DIR", str(tmp_path))
            function = entry()(function.py_func)


def test_where_no_other_process_can_a_large_kernel_is_compiled_in_this_one(large, monkeypatch):
    function, kinds = large
    monkeypatch.setattr(compile_in_child, "_CHILD_CODE", "raise SystemExit(1)")
    function.compile(kinds)
    assert sum(function.stats.cache_misses.values()) == 1
    assert function.overloads[kinds].library.get_pointer_to_function(
        function.overloads[kinds].fndesc.mangled_name
    )
