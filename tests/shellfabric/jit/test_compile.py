"""Units: kernels that are compiled by themselves, when they are first called, and called through cells."""

import numpy as np
import pytest

from shellfabric.jit.compile import UNITS, entry, units
from shellfabric.jit.table import GRADED, UNIFORM, Row, array, per_slot


class Line(Row):
    """Weights of a sum."""

    weight = array("n", "-", "of each value")
    scale = per_slot("-", "of the sum")


unit = units({"line": Line})


@unit("number", values="n")
def weighted(line, values):
    """Sum of values times weights."""
    total = 0.0
    for k in range(values.size):
        total += values[k] * line.weight[k]
    return total


@unit("integer")
def half(count):
    """A half, which is no integer."""
    return count / 2


@entry()
def call_weighted(line, values):
    return weighted(line, values)


@entry()
def call_half(count):
    return half(count)


@pytest.fixture(autouse=True)
def of_runs():
    """The units of this file are none of a run."""
    yield
    UNITS[:] = [each for each in UNITS if each.py_func.__module__.startswith("shellfabric.")]


def test_a_unit_is_compiled_when_it_is_called_and_its_caller_is_not_compiled_again():
    values = np.array([1.0, 2.0])
    uniform = Line(weight=np.array([3.0, 4.0]), scale=1.0)
    assert not weighted.cell(UNIFORM).full
    assert call_weighted(uniform, values) == 11.0
    assert weighted.cell(UNIFORM).full
    assert not weighted.cell(GRADED).full
    graded = Line(weight=np.array([5.0, 6.0]), scale=np.ones(2))
    assert call_weighted(graded, values) == 17.0
    assert weighted(uniform, values) == 11.0


def test_what_python_raises_for_machine_code_comes_out():
    with pytest.raises(TypeError, match="half returns float64, not int64"):
        half(4)


def test_a_unit_refuses_arguments_of_other_types():
    with pytest.raises(Exception, match="weighted is not compiled for"):
        call_weighted(np.zeros(2), np.zeros(2))


LITTLE = """
from shellfabric.jit.compile import units

unit = units({})
"""
LITTLE_UNIT = """
@unit("number", x="number")
def times_{0}(x):
    return {0} * x
"""
COUNT = 4
RUN = """
import sys
import little
from shellfabric.loop import compile_ahead
from shellfabric.jit.table import GRADED

little_alone = "compile_ahead.OF_A_PLY = ('little',)"
exec(little_alone)
if sys.argv[1] == "no child":
    compile_ahead._CHILD = "raise SystemExit(1)"
else:
    head = f"import little; from shellfabric.loop import compile_ahead; {little_alone}; "
    compile_ahead._CHILD = head + compile_ahead._CHILD
compile_ahead.fill(GRADED, False)
wanted = compile_ahead.cells(GRADED, False)
print(*[int(cell.kinds in cell.unit.dispatcher.stats.cache_misses) for cell in wanted])
"""


@pytest.fixture
def compiled(tmp_path, fresh):
    """A function: whether each of a few units was compiled by a process that has a child, or none, beside it."""
    numbers = range(1, COUNT + 1)
    (tmp_path / "little.py").write_text(LITTLE + "".join(map(LITTLE_UNIT.format, numbers)))

    def run(child, cache):
        done = fresh.run(RUN, child, folder=tmp_path, cache=tmp_path / cache)
        assert done.code == 0, done.err
        return [int(word) for word in done.out.split()]

    return run


def test_units_of_a_cold_start_are_compiled_with_or_without_a_child(compiled):
    """Where no child can help, this process compiles them all; what is in the cache is compiled by none."""
    assert compiled("no child", "one") == [1] * COUNT
    assert compiled("child", "one") == [0] * COUNT
    # the child takes from the end what it can: the first is always left to this process
    assert compiled("child", "other")[0] == 1
    assert compiled("no child", "other") == [0] * COUNT
