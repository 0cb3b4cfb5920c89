"""Calls whose last bits depend on the processor: made by `fabrics.base.sums`, or listed with a reason."""

import csv
from pathlib import Path

import pytest

KEPT = Path(__file__).parents[1] / "tools/processor_places.csv"


def listed():
    """{(file, function): calls} of the list; each line says what it decides, and why that does no harm."""
    found = {}
    with open(KEPT, encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            assert all(row.values()), row
            found[row["file"], row["function"]] = set(row["calls"].split(", "))
    return found


def test_the_list_has_what_there_is(tool):
    assert listed() == tool("processor_places").places()


@pytest.mark.parametrize(
    "line, call",
    [
        ("    return a @ b", "@"),
        ("    a @= b", "@"),
        ("    return np.linalg.norm(a)", "linalg.norm"),
        ("    return np.linalg.norm(a, axis=1)", None),
        ("    return a.dot(b)", "dot"),
        ("    return np.polyfit(a, b, 1)", "polyfit"),
        ("    return sums.dot(a, b)", None),
        ("    return np.einsum('i,i', a, b)", None),
        ("    return np.einsum('i,i', a, b, optimize=True)", "einsum"),
        ("    from scipy.sparse.linalg import splu as lu\n    return lu(a)", "lu"),
        ("    from scipy import linalg\n    return linalg.solve(a, b)", "linalg"),
        ("    from scipy.optimize import brentq\n    return brentq(a, b)", None),
    ],
)
def test_a_new_call_is_found_by_its_function(line, call, tool):
    source = f"import numpy as np\n\n\nclass Body:\n  def force(a, b):\n{line}\n"
    expected = {}
    if call:
        expected = {"Body.force": {call}}
    assert tool("processor_places").places_of(source) == expected
