"""The page "One step, as data" names every file that a step calls, and arrays that exist."""

import re
from pathlib import Path

import pytest

from shellfabric.block.state import BlockPoints, BlockRow
from shellfabric.metal.state import BodyRow
from shellfabric.plies.state import Guard, NeighbourLists, PackContact, Pressure
from shellfabric.projectile.state import BarRow
from shellfabric.state import Constants, Profile, Stack, State, Work
from shellfabric.yarns.state import Zone

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "developers" / "one-step.md"
ROWS = {
    "state": State,
    "const": Constants,
    "work": Work,
    "stack": Stack,
    "contact": PackContact,
    "lists": NeighbourLists,
    "pressure": Pressure,
    "guard": Guard,
    "own": BarRow,
    "body": BodyRow,
    "profile": Profile,
    "zone": Zone,
    "block": BlockRow,
    "points": BlockPoints,
}
# the loop, and what it calls by address
STARTS = (
    "shellfabric/loop/loop.py",
    "shellfabric/yarns/coupling_kernels.py",
    "shellfabric/projectile/bar_kernels.py",
    "shellfabric/metal/motion_kernels.py",
    "shellfabric/block/coupling.py",
    "shellfabric/block/block_kernels.py",
)


def unknown_arrays(text):
    """List the names `row.field` of a text that no table has."""
    names = re.findall(r"`([a-z]+)\.(\w+)`", text)
    return [f"{row}.{field}" for row, field in names if field not in known_fields(row)]


def known_fields(row):
    """Return the fields of the table that kernels call `row`."""
    return ROWS[row].fields if row in ROWS else ()


def arrays_of_other_files(text):
    """List the arrays of each section that no file named in the section reads or writes."""
    found = []
    for section in re.split(r"^### ", text, flags=re.MULTILINE)[1:]:
        files = re.findall(r"`(shellfabric/[\w/]+\.py)`", section)
        code = "".join((ROOT / name).read_text("utf-8") for name in files)
        for row, field in re.findall(r"`([a-z]+)\.(\w+)`", section):
            if not re.search(rf"\.{field}\b", code):
                found.append(f"{row}.{field}")
    return found


@pytest.mark.parametrize("start", STARTS)
def test_every_kernel_file_of_a_step_is_on_the_page(tool, start):
    text = PAGE.read_text("utf-8")
    files = tool("architecture").kernels(start)
    assert files
    assert [name for name in files if f"`{name}`" not in text] == []


def test_arrays_on_the_page_exist():
    assert unknown_arrays(PAGE.read_text("utf-8")) == []


def test_arrays_stand_with_files_that_use_them():
    assert arrays_of_other_files(PAGE.read_text("utf-8")) == []


def test_an_array_that_stands_with_another_file_is_found():
    section = (
        "### 8. Edges\n\n`shellfabric/membrane/boundary_kernels.py` writes `state.u`, `state.{}`\n"
    )
    assert arrays_of_other_files(section.format("slip_force")) == []
    assert arrays_of_other_files(section.format("trellis_turn")) == ["state.trellis_turn"]


@pytest.mark.parametrize("name", ["state.force", "nose.u", "contact.u", "guard.f_int"])
def test_arrays_that_are_gone_are_found(name):
    assert unknown_arrays(f"reads `state.u` and `{name}`") == [name]
