"""The table of planted defects follows the code: each text stands once, and its tests are there."""

import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MUTANTS = tomllib.loads((ROOT / "tools" / "mutants.toml").read_text("utf-8"))["mutant"]


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: mutant["id"])
def test_a_defect_can_be_planted(mutant):
    code = (ROOT / mutant["file"]).read_text("utf-8")
    assert code.count(mutant["text"]) == 1
    assert mutant["replacement"] != mutant["text"]
    assert all((ROOT / path).exists() for path in mutant["tests"])


def test_no_two_defects_have_one_name():
    assert len({mutant["id"] for mutant in MUTANTS}) == len(MUTANTS)


TEXT = '''
def area(warp, weft, count):
    """w1 + w2 of a text is no sum"""
    if warp > 2 * weft:
        return warp - weft / 3, "a" + "b"
    return count[0] * warp + 0.5 * min(weft, 1)
'''
CHANGED = {
    "if warp >= 2 * weft:",
    "if warp > 2 / weft:",
    "if weft > 2 * weft:",
    "if warp > 2 * warp:",
    'return warp + weft / 3, "a" + "b"',
    'return warp , "a" + "b"',
    'return warp - weft * 3, "a" + "b"',
    'return weft - weft / 3, "a" + "b"',
    'return warp - warp / 3, "a" + "b"',
    "return count[1] * warp + 0.5 * min(weft, 1)",
    "return count[0] / warp + 0.5 * min(weft, 1)",
    "return count[0] * weft + 0.5 * min(weft, 1)",
    "return count[0] * warp - 0.5 * min(weft, 1)",
    "return count[0] * warp",
    "return count[0] * warp + (2 * 0.5) * min(weft, 1)",
    "return count[0] * warp + 0.5 / min(weft, 1)",
    "return count[0] * warp + 0.5 * max(weft, 1)",
    "return count[0] * warp + 0.5 * min(warp, 1)",
}


def test_changes_are_those_of_the_arithmetic(tool):
    """All of a small module: operators, limits, indices, partners, extremes, weights, and a dropped term."""
    made = tool("draw_mutants")
    found = set()
    for change in made.find_changes(TEXT):
        changed = TEXT[: change.start] + change.replacement + TEXT[change.end :]
        compile(changed, "changed", "exec")
        pairs = zip(TEXT.splitlines(), changed.splitlines(), strict=True)
        (line,) = (after.strip() for before, after in pairs if before != after)
        found.add(line)
    assert found == CHANGED


def test_a_seed_draws_the_same_defects_and_each_can_be_planted(tool):
    made = tool("draw_mutants")
    folders = ("meshing", "shellfabric/cell")
    drawn = made.draw(20, 1, folders)
    assert drawn == made.draw(20, 1, folders) != made.draw(20, 2, folders)
    assert {mutant["file"].rpartition("/")[0] for mutant in drawn} == set(folders)
    for mutant in drawn:
        code = (ROOT / mutant["file"]).read_text("utf-8")
        assert code.count(mutant["text"]) == 1
        changed = code.replace(mutant["text"], mutant["replacement"])
        assert changed != code
        compile(changed, mutant["file"], "exec")
        assert all((ROOT / path).exists() for path in mutant["tests"])
