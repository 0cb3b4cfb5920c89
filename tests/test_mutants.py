"""The table of planted defects follows the code: each text stands once, and its tests are there."""

import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MUTANTS = tomllib.loads((ROOT / "tools" / "mutants.toml").read_text("utf-8"))["mutant"]


@pytest.mark.slow
@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: mutant["id"])
def test_a_defect_can_be_planted(mutant):
    code = (ROOT / mutant["file"]).read_text("utf-8")
    assert code.count(mutant["text"]) == 1
    assert mutant["replacement"] != mutant["text"]
    assert all((ROOT / path).exists() for path in mutant["tests"])


def test_no_two_defects_have_one_name():
    assert len({mutant["id"] for mutant in MUTANTS}) == len(MUTANTS)
