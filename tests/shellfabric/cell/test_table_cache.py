"""Kept tables are the filled ones to the last bit, for the cell that they were kept for, and no others."""

import os
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from fabrics import catalogue
from fabrics.base.assumed_number import Assumed
from shellfabric.cell import table_cache
from shellfabric.cell.model import CellModel, CellTable

MODEL = CellModel(catalogue.load("S-720").with_effective_density())


@pytest.fixture
def fills(tmp_path, monkeypatch):
    """The models that tables have been filled for, with an empty cache."""
    seen = []
    fill = CellTable.fill.__func__
    monkeypatch.setattr(
        CellTable, "fill", classmethod(lambda cls, m, *a: seen.append(m) or fill(cls, m, *a))
    )
    monkeypatch.setenv("WEAVECELL_CACHE_DIR", str(tmp_path))
    return seen


def assert_equal(one, two):
    assert one.values.keys() == two.values.keys()
    for name, array in one.values.items():
        assert_array_equal(array, two.values[name])
    for name in ("stretch1", "stretch2", "tension1", "tension2", "spline"):
        assert_array_equal(getattr(one, name), getattr(two, name))


def test_a_kept_table_is_the_filled_one_and_that_of_no_other_cell(fills):
    filled = table_cache.table(MODEL, 21)
    assert_equal(table_cache.table(MODEL, 21), filled)
    assert len(fills) == 1
    assert_equal(MODEL.table(21), filled)
    for model, size in (
        (MODEL, 23),
        (replace(MODEL, crossover_gap=1e-6), 21),
        (replace(MODEL, cell_formulation="equilibrium"), 21),
    ):
        table_cache.table(model, size)
    assert len(fills) == 5


def test_tables_in_memory_are_those_of_the_cell_and_the_last_few(fills, monkeypatch):
    """A number that is assumed is another than the same number given: a report tells them apart."""
    monkeypatch.setattr(table_cache, "_IN_MEMORY", {})
    given = replace(MODEL, crossover_gap=1e-6)
    assumed = replace(MODEL, crossover_gap=Assumed(1e-6))
    sizes = [21, 21, 23, 21]
    cells = [MODEL, given, MODEL, assumed]
    made = [table_cache.share(cell, n) for cell, n in zip(cells, sizes)]
    assert len(fills) == 4
    assert [one.model for one in made] == cells
    assert table_cache.share(replace(given), 21) is made[1]
    assert_equal(made[1], given.table(21))
    # a fifth takes the place of the one that was used longest ago, which is the first
    table_cache.share(replace(MODEL, crossover_gap=2e-6), 21)
    assert table_cache.share(given, 21) is made[1]
    assert table_cache.share(MODEL, 21) is not made[0]


@pytest.mark.parametrize("content", [b"", b"broken", None])
def test_a_broken_file_is_filled_again(fills, content):
    first = table_cache.table(MODEL, 21)
    [file] = table_cache.folder().glob("*.npz")
    if content is None:
        with open(file, "wb") as out:
            np.savez(out, np.zeros((3, 3)))
    else:
        file.write_bytes(content)
    assert_equal(table_cache.table(MODEL, 21), first)
    assert len(fills) == 2


@pytest.mark.parametrize("folder", ["", "file"])
def test_nothing_is_kept_without_a_folder(fills, tmp_path, monkeypatch, folder):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("WEAVECELL_CACHE_DIR", folder and str(tmp_path / folder))
    assert_equal(table_cache.table(MODEL, 21), table_cache.table(MODEL, 21))
    assert len(fills) == 2


def test_the_least_recently_used_are_removed(tmp_path):
    for age, name in enumerate("abcd"):
        file = tmp_path / f"{32 * name}.npz"
        file.write_bytes(b"x" * 100)
        os.utime(file, (1000 - age, 1000 - age))
    table_cache.trim(tmp_path, 250)
    assert sorted(file.stem[0] for file in tmp_path.glob("*.npz")) == ["a", "b"]
