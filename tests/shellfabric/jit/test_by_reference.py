"""Named tuples that kernels take as one pointer, and what an unknown numba gets instead."""

import subprocess
import sys
from collections import namedtuple

import numpy as np
import pytest
from numba import typeof

from shellfabric.jit.borrowed_list import Items, borrowed_item
from shellfabric.jit.by_reference import Reference, by_reference
from shellfabric.jit.compile import entry, kernel

Inner = namedtuple("Inner", "c d")
Mixed = namedtuple("Mixed", "flag numbers inner pair count")
by_reference(Mixed)
ITEM = Mixed(True, np.arange(3.0), Inner(2.5, np.ones(2)), (np.zeros(2), np.full(2, 7.0)), 4)
UNKNOWN = """
import numba
numba.version_info = numba.version_info._replace(minor=999)
from collections import namedtuple
from numba import typeof
from numba.core import codegen, types
before = codegen.CPUCodeLibrary._optimize_final_module
from shellfabric.jit.by_reference import by_reference
from shellfabric.jit import compile
Two = namedtuple("Two", "a b")
by_reference(Two)
assert isinstance(typeof(Two(1.0, 2)), types.NamedTuple)
assert codegen.CPUCodeLibrary._optimize_final_module is before
"""


@kernel()
def total(item):
    item.pair[0][:] += 1.0
    size = 100.0 if item.flag else 0.0
    return size + item.numbers[2] + item.inner.c + item.inner.d[0] + item.pair[1][0] + item.count


@entry()
def totals(item, items):
    return total(item), total(borrowed_item(items, 0))


def test_members_are_read_and_arrays_written_through_the_pointer():
    assert isinstance(typeof(ITEM), Reference)
    expected = 100.0 + 2.0 + 2.5 + 1.0 + 7.0 + 4.0
    assert totals(ITEM, Items([ITEM])) == (expected, expected)
    assert ITEM.pair[0].tolist() == [2.0, 2.0]


@pytest.mark.slow
def test_an_unknown_numba_takes_tuples_by_value_and_keeps_its_libraries():
    subprocess.run([sys.executable, "-c", UNKNOWN], check=True)
