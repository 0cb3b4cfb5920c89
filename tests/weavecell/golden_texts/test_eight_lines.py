"""What a command prints of its result fits a screen: eight lines of 120 characters, 110 words; the rest is on the
page, and printed by --verbose."""

import re

import pytest

from tests import commands
from tests.weavecell.golden_texts import cases
from weavecell.cli.app import COMMANDS
from weavecell.results.finding import LABEL, WIDTH, Answer, Mover

# what prints a text or a table that is asked for, or makes a picture
DOCUMENTS = tuple(name for name in COMMANDS if not commands.answers(name))
# commands whose golden text is that of another of the same words
ALIKE = {f"crossover {name}" for name in ("biaxial", "path", "shear", "pull-out")}


def printed():
    """(command line, lines that it prints of its result) of the golden texts."""
    for name in cases.CASES:
        text = (cases.HERE / "texts" / f"{name}.txt").read_text("utf-8")
        for block in re.split(r"^\$ weavecell ", text, flags=re.MULTILINE)[1:]:
            line, *lines = block.partition("[exit code")[0].splitlines()
            # what is odd about an input is told before it is computed
            of_result = [one for one in lines if not one.startswith(("! ", "note: "))]
            document = line.startswith(DOCUMENTS) or "--check" in line
            if of_result and not document:
                yield line, of_result


PRINTED = dict(printed())


@pytest.mark.parametrize("line", PRINTED)
def test_a_result_is_eight_lines(line):
    lines = PRINTED[line]
    assert len(lines) <= 8
    assert max(map(len, lines)) <= WIDTH
    assert sum(len(one.split()) for one in lines) <= 110


def test_every_command_is_among_them():
    asked = set(COMMANDS) - set(DOCUMENTS)
    found = {name for name in asked if any(line.startswith(f"{name} ") for line in PRINTED)}
    assert asked - found - ALIKE == set()


@pytest.mark.parametrize("count", [1, 3, 40])
def test_an_answer_of_many_parts_keeps_to_its_lines(count):
    parts = tuple(f"part {number} of what is doubtful" for number in range(count))
    movers = [
        Mover(f"mover {number}", f"settle {number} so", 10.0 + number) for number in range(count)
    ]
    left = [Mover(f"left out {number}", "--uncertainty") for number in range(count)]
    over = ", ".join(f"friction {number} of 0.1 to 0.3" for number in range(count))
    answer = Answer("of what", "110 m/s", parts, over=over, movers=(*movers, *left), advice=parts)
    lines = answer.lines()
    assert len(lines) == 7
    assert max(map(len, lines)) <= WIDTH
    for label, words in answer.rows:
        named = re.search(r"(\d+) more$", words)
        shown = words.count(", " if label in ("over", "moved by") else "; ") + (not named)
        assert label in ("answer", "next") or shown + (int(named[1]) if named else 0) == count
        assert lines[0] == "of what"
        assert len(label) <= LABEL
