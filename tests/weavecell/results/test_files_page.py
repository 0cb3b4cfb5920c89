"""docs/reference/files.md holds what readers accept and writers write."""

import json
from pathlib import Path

import h5py
import numpy as np
import pytest

from fabrics import catalogue
from fabrics.compression import CompressionLaw
from fabrics.surface import ResponseSurface
from meshing.formats import export

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "reference" / "files.md").read_text("utf-8")


@pytest.fixture
def made(tool):
    return tool("file_formats")


def between(made, name):
    begin, end = made.marks(name)
    return PAGE.partition(begin)[2].partition(end)[0].strip()


@pytest.mark.parametrize("name", ["outputs", "fabric", "surface"])
def test_the_tables_are_up_to_date(made, name):
    command = "python tools/file_formats.py"
    assert between(made, name) == made.markdown(made.TABLES[name]()).strip(), f"to renew it: {command}"


def test_the_columns_of_cases_are_up_to_date(made):
    pytest.importorskip("dolfinx")
    assert between(made, "case") == made.markdown(made.case_file()).strip()


def test_every_key_of_every_catalogue_file_is_on_the_page(made):
    rows = [row[1] for row in made.fabric_file()[1:]]
    for name in catalogue.list_names():
        for key in catalogue.load(name).sources:
            last = key.rpartition(".")[2]
            assert f"`{last}`" in rows or f"`{last}`" in PAGE, key


def test_every_key_of_a_law_is_on_the_page(tmp_path):
    CompressionLaw(4e-5, 5e-5, assumed_range=((5e-5, 4e-5), (3e-5, 5e-5))).to_json(tmp_path / "law.json")
    content = json.loads((tmp_path / "law.json").read_text())
    part = PAGE[PAGE.index("## Compression law") :].split("\n## ")[0]
    assert content["format"] in part
    assert [key for key in (*content, *content["fit"]) if f"`{key}`" not in part] == []


def test_every_dataset_of_a_surface_is_on_the_page(made, tmp_path):
    axis, values = np.array([0.0, 1.0]), np.zeros((2, 2))
    ResponseSurface(axis, axis, *[values] * 5).write(tmp_path / "surface.h5")
    with h5py.File(tmp_path / "surface.h5") as file:
        assert {f"`{name}`" for name in file} == {row[0] for row in made.surface_file()[1:]}


def test_every_format_of_a_mesh_is_on_the_page():
    assert [suffix for suffix in export.WRITERS if f"`{suffix}`" not in PAGE.replace("_0000.rad", ".rad")] == []
