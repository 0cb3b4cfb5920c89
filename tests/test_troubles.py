"""troubles.csv names the test of each trouble that a user had: the tests are there."""

import ast
import csv
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
ROWS = list(csv.DictReader((Path(__file__).parent / "troubles.csv").open(encoding="utf-8")))


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row["trouble"][:50])
def test_the_test_of_a_trouble_is_there(row):
    path, _, name = row["test"].partition("::")
    assert (ROOT / path).is_file()
    if name:
        tree = ast.parse((ROOT / path).read_text("utf-8"))
        assert name in {part.name for part in tree.body if isinstance(part, ast.FunctionDef)}
