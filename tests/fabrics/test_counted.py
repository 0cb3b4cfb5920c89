"""A count agrees with its noun, and every count that a user reads is said by `counted`."""

import re
from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from fabrics.base.counted import counted, plural

ROOT = Path(__file__).parents[2]
NOUNS = {
    "shot": "shots",
    "ply": "plies",
    "mesh": "meshes",
    "search": "searches",
    "hexahedron": "hexahedra",
    "equilibrium": "equilibria",
    "load step": "load steps",
    "fitted test": "fitted tests",
    "row": "rows",
    "array": "arrays",
    "law": "laws",
    "yarn": "yarns",
    "element": "elements",
    "perforation": "perforations",
}


@given(st.integers(0, 10**7), st.sampled_from(sorted(NOUNS)))
def test_one_is_singular_and_all_others_are_plural(number, noun):
    said, _, words = counted(number, noun).partition(" ")
    assert int(said.replace(",", "")) == number
    assert words == (noun if number == 1 else NOUNS[noun])


# a number in braces before a noun in the plural; numbers with decimals, and constants, are never 1
BY_HAND = re.compile(
    r"\{(?![A-Z_]+\b|paired\.MOST)[^{}]*?(?<![.:\d][efg%])\} (?:(?:more|load|time|computed|fitted) )?"
    rf"(?:{'|'.join(map(plural, NOUNS))})\b"
)
# texts that are joined, not counted
TEXTS = re.compile(r"join\(|cell_model|MOST_|bool\}")


def test_no_count_is_written_by_hand():
    found = []
    for path in sorted((ROOT / "weavecell").rglob("*.py")):
        for part in BY_HAND.findall(path.read_text("utf-8")):
            if not TEXTS.search(part):
                found.append(f"{path.relative_to(ROOT)}: {part}")
    assert found == []
    assert BY_HAND.search('f"{len(shots)} shots"')
    assert BY_HAND.search('f"about {self.count:,} more shots"')


def test_no_golden_text_has_one_of_several_or_no_memory():
    texts = sorted((ROOT / "tests/weavecell/golden_texts/texts").glob("*.txt"))
    assert len(texts) > 14
    wrong = re.compile(rf"(?<![\d.,:x-])(?<!\d )\b1 (?:{'|'.join(map(plural, NOUNS))})\b|\b0 MB\b")
    found = []
    for path in texts:
        lines = path.read_text("utf-8").splitlines()
        # a table of one row is counted by the test
        found += [line for line in lines if wrong.search(line) and not line.startswith("table: ")]
    assert found == []
