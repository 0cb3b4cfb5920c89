"""What a user reads of each command is as it was: a change that is meant is written anew (`python -m
tests.weavecell.golden_texts`), and its difference is read."""

import difflib

import pytest

from tests.weavecell.golden_texts import cases

SOLID = [name for name, case in cases.CASES.items() if case.get("solid")]
OTHERS = [name for name in cases.CASES if name not in SOLID]


def compare(name):
    kept = (cases.HERE / "texts" / f"{name}.txt").read_text("utf-8").splitlines()
    found = cases.text_of(name).splitlines()
    changed = "\n".join(difflib.unified_diff(kept, found, "kept", "found", lineterm="", n=1))
    assert not changed, changed


@pytest.mark.parametrize("name", OTHERS)
def test_texts_are_as_they_were(name, tmp_path, monkeypatch):
    if name == "mesh":
        pytest.importorskip("gmsh")
    monkeypatch.chdir(tmp_path)
    compare(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", SOLID)
def test_texts_of_the_3d_crossover_are_as_they_were(name, tmp_path, monkeypatch):
    pytest.importorskip("dolfinx")
    monkeypatch.chdir(tmp_path)
    compare(name)
