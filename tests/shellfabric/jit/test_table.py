"""Rows of a table: what does not fit its line is refused where the row is made, and says so."""

import pickle

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from shellfabric.jit.compile import entry
from shellfabric.jit.table import (
    Row,
    Rows,
    array,
    flag,
    integer,
    number,
    numbers,
    per_slot,
    row,
    row_of,
    tally,
    total,
)


class Inner(Row):
    """A row in another."""

    factor = number("-", "of all")


class Sheet(Row):
    """A table of every kind of line."""

    count = integer("-", "how many")
    active = flag("whether it acts")
    step = number("s", "time step")
    limits = numbers(2, "-", "two numbers")
    u = array("2 x slots", "m", "displacements", kept=True)
    marks = array("slots uint8", "-", "marks")
    grid = array("rows, 3", "m", "places")
    stiffness = per_slot("N/m", "of the slots")
    inner = row(Inner, "another")
    taken = total("J", "work", kept=True)
    steps = tally("-", "made", kept=True)


def values(**changes):
    """What makes a row of Sheet."""
    found = {"count": 2, "active": True, "step": 0.5, "limits": (1.0, 2.0), "stiffness": 3.0}
    found |= Sheet.zeros(slots=4, rows=2)
    found["inner"] = Inner(factor=7.0)
    return found | changes


WIDE = np.zeros((4, 2))
FIXED = np.zeros(4, np.uint8)
FIXED.flags.writeable = False


@pytest.mark.parametrize(
    "name, value, said",
    [
        ("marks", np.zeros(8, np.uint8)[::2], "strides (2,)"),
        ("marks", np.zeros(4), "an array of float64"),
        ("marks", FIXED, "writable"),
        ("marks", None, "not None"),
        ("marks", np.zeros((4, 1), np.uint8), "1 dimensions"),
        ("grid", WIDE.T, "strides (8, 16)"),
        ("grid", np.zeros(6), "2 dimensions"),
        ("u", (np.zeros(4), None), "not None"),
        ("u", (np.zeros(4),) * 3, "2 values"),
        ("u", tuple(WIDE.T), "strides (16,)"),
        ("marks", np.zeros(3, np.uint8), ": 3 instead of 4 of slots"),
        ("grid", np.zeros((2, 4)), ": 4 instead of 3 of 3"),
        ("count", 2.5, "must be of int64, not 2.5"),
        ("count", None, "must be of int64, not None"),
        ("active", 1, "must be of bool, not 1"),
        ("step", None, "must be of float64, not None"),
        ("step", np.zeros(1), "must be of float64"),
        ("limits", (1.0,), "2 values"),
        ("stiffness", None, "must be of float64, not None"),
        ("stiffness", np.zeros(8)[::2], "strides (16,)"),
        ("inner", None, "must be a row of Inner"),
        ("inner", np.zeros(1), "must be a row of Inner"),
        ("taken", np.zeros(1), "without dimensions"),
        ("steps", np.zeros(()), "an array of int64 without dimensions"),
    ],
)
def test_a_row_of_wrong_values_is_refused_by_name(name, value, said):
    with pytest.raises(TypeError) as problem:
        Sheet(**values(**{name: value}))
    assert f"Sheet.{name}" in str(problem.value)
    assert said in str(problem.value)


def test_missing_and_unknown_names_are_refused():
    given = values(other=1.0)
    del given["grid"]
    with pytest.raises(TypeError, match="Sheet: missing or unknown: grid, other"):
        Sheet(**given)


def test_a_list_holds_rows_of_one_type():
    uniform = Sheet(**values())
    graded = Sheet(**values(stiffness=np.ones(4)))
    with pytest.raises(TypeError, match=r"2 types in one list: Sheet_\w+, Sheet_graded_"):
        Rows([uniform, graded])


def test_a_row_does_not_change():
    sheet = Sheet(**values())
    with pytest.raises(AttributeError, match=r"Sheet\.step cannot be set"):
        sheet.step = 1.0
    changed = sheet._replace(step=1.0)
    assert sheet.step == 0.5
    assert changed.step == 1.0
    assert changed.u[0] is sheet.u[0]


@entry(_nrt=False)
def read(sheets, place, found):
    """Everything that a row holds."""
    sheet = row_of(sheets, place)
    found[0] = sheet.count
    found[1] = sheet.step if sheet.active else 0.0
    found[2] = sheet.limits[0]
    found[3] = sheet.limits[1]
    found[4] = sheet.u[0][1]
    found[5] = sheet.u[1][2]
    found[6] = sheet.marks[3]
    found[7] = sheet.grid[1, 2]
    found[8] = sheet.inner.factor
    found[9] = sheet.grid.shape[0] + len(sheets)
    sheet.u[1][0] = 9.0


def test_a_kernel_reads_what_python_has_put_there():
    """Also of a copy that has gone through another process, whose arrays are its own."""
    sheet = Sheet(**values())
    sheet.u[0][1] = 3.0
    sheet.u[1][2] = 4.0
    sheet.marks[3] = 5
    sheet.grid[1, 2] = 6.0
    copy = pickle.loads(pickle.dumps(sheet))
    for sheets, place in ((Rows([sheet]), 0), (Rows([sheet, copy]), 1)):
        found = np.zeros(10)
        read(sheets, place, found)
        assert_array_equal(found, [2, 0.5, 1, 2, 3, 4, 5, 6, 7, 2 + place + 1])
        assert sheets.values[place].u[1][0] == 9.0
    assert sheet.u[1][0] == copy.u[1][0] == 9.0


def test_kept_is_what_a_checkpoint_has():
    assert Sheet.kept() == ["u", "taken", "steps"]


@entry(_nrt=False)
def first_of_a(pair):
    return pair.a[0]


def test_machine_code_of_other_places_is_not_taken():
    """Kernels in the cache are found by the types of their arguments: two lines of a table that have changed places
    make another type, although both hold an array of doubles."""
    lines = {"a": array("n", "m", "one"), "b": array("n", "m", "another")}
    before, after = (
        type("Pair", (Row,), dict(order)) for order in (lines.items(), reversed(lines.items()))
    )
    assert str(before.types[0]) != str(after.types[0])
    for table in (before, after):
        assert first_of_a(table(a=np.array([1.0]), b=np.array([2.0]))) == 1.0


@entry(_nrt=False)
def work_on(sheet):
    """Add to the numbers of a row by their names."""
    sheet.taken += 0.25 * sheet.steps
    sheet.steps += 2
    return sheet.taken


def test_kernels_and_python_read_and_set_a_number_by_its_name():
    sheet = Sheet(**values())
    sheet.steps = 3
    sheet.steps += 2
    sheet.taken = 0.5
    before = sheet.taken
    assert work_on(sheet) == 1.75
    assert before == 0.5  # a number, which does not follow what the kernel does
    assert sheet.taken == 1.75
    assert sheet.steps == 7


def test_rows_may_share_a_number():
    """A number of a row may be a place in an array of another, and goes with what a checkpoint keeps."""
    of_all = np.array([4, 5, 6])
    sheet = Sheet(**values(steps=of_all[1, ...]))
    work_on(sheet)
    assert of_all.tolist() == [4, 7, 6]
    again = pickle.loads(pickle.dumps(sheet))
    work_on(again)
    assert (sheet.steps, again.steps) == (7, 9)
