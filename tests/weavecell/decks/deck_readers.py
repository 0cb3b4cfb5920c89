"""Readers and validators of panel decks that share no code with the writers: what the manuals say of columns and ids.

Each reader takes a deck apart and asserts on the way that titles are there and short, that fields lie in their
columns and are numbers, that ids are unique and whatever is referred to is defined. It returns the curves of the
material cards.
"""

import re
import tomllib
from collections import defaultdict
from itertools import pairwise
from pathlib import Path

import numpy as np

TABLES = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
RADIOSS = TABLES["radioss"]
TEN = [10] * 8
CONTACT = "*CONTACT_AUTOMATIC_SURFACE_TO_SURFACE"


def columns(line, widths):
    """Numbers (or blanks, as None) in fixed columns; nothing beyond them, nothing across their bounds."""
    ends = np.cumsum([0, *widths])
    assert len(line) <= ends[-1], line
    found = [line[a:b].strip() for a, b in pairwise(ends) if a < len(line)]
    assert all(" " not in each for each in found), line
    return [float(each) if each else None for each in found]


def named(text):
    """{keyword without a number: {name: text}} of the last row of each first block, by the comment lines."""
    cards = {}
    names = []
    for line in text.splitlines():
        if line[0] in "*/":
            word = re.sub(r"/\d+$", "", line)
            card = {} if word in cards else cards.setdefault(word, {})
            names = []
        elif line.startswith(("$#", "# ")):
            names = [(name[0], name.end()) for name in re.finditer(r"(?<=[ #])[^ #]\S*", line)]
        elif names and line[0] not in "#$":
            starts = [0, *(end for _, end in names)]
            texts = {name: line[start:end].split() for start, (name, end) in zip(starts, names)}
            card.update({name: words[-1] for name, words in texts.items() if words})
    return cards


def blocks(lines, mark, comment):
    """[word, lines below it] of a deck."""
    found = []
    for line in lines:
        if line.startswith(mark):
            found.append((line, []))
        elif not line.startswith(comment):
            found[-1][1].append(line)
    return found


def rows_of(body, layout, titled):
    if titled:
        title = body.pop(0).strip()
        assert title.isascii()
        assert 0 < len(title) <= 70, title
    return [columns(line, layout[min(n, len(layout) - 1)]) for n, line in enumerate(body)]


def defined_in(cards, ids, words):
    """{kind: its ids}, each once and above 0, among which all are that the cards of a code refer to."""
    defined = {kind: {int(each) for each in numbers} for kind, numbers in ids.items()}
    for kind, numbers in ids.items():
        assert len(defined[kind]) == len(numbers), kind
        assert min(defined[kind]) > 0
    for reference in TABLES["reference"]:
        word = reference["word"]
        if word.startswith("*") == words.startswith("*"):
            rows = slice(*reference["cards"])
            fields = slice(*reference["fields"])
            named = {field for block in cards[word] for row in block[rows] for field in row[fields]}
            assert named, word
            assert named <= defined[reference["kind"]], word
    return defined


def dyna(text):
    """{material: (warp, weft, shear)}, each (n, 2), with (DATTYP of warp)."""
    lines = text.splitlines()
    cards = defaultdict(list)
    ids = defaultdict(list)
    assert all(len(line) <= 80 for line in lines)
    lines = [line for line in lines if not line.startswith("$")]
    assert lines[0] == "*KEYWORD"
    assert lines[-1] == "*END"
    for word, body in blocks(lines[1:-1], "*", "$"):
        titled = word.endswith("_TITLE") or word in ("*TITLE", "*PART", "*PART_INERTIA")
        word = word.removesuffix("_TITLE")
        rows = rows_of(body, TABLES["lsdyna"].get(word, [TEN]), titled)
        cards[word].append(rows)
        kind = re.match(r"\*(NODE|ELEMENT|PART|SECTION|MAT|DEFINE|SET_NODE|SET_PART)", word)
        if kind:
            ids[kind[1]] += [
                row[0] for row in (rows if kind[1] in ("NODE", "ELEMENT") else rows[:1])
            ]
    defined = defined_in(cards, ids, "*")
    assert {row[1] for rows in cards["*ELEMENT_SHELL"] for row in rows} == defined["PART"]
    assert {rows[0][0] for rows in cards["*BOUNDARY_SPC_SET"]} == defined["SET_NODE"]
    for rows in cards["*MAT_FABRIC"]:
        assert [len(row) for row in rows] == [7, 8, 8, 8, 8, 7]
        assert rows[2][5] == 14
    assert cards[CONTACT][0][0][2:4] == [2, 3]
    curves = {rows[0][0]: (np.array(rows[1:]), rows[0][6]) for rows in cards["*DEFINE_CURVE"]}
    return {
        int(rows[0][0]): tuple(curves[number] for number in rows[5][:3])
        for rows in cards["*MAT_FABRIC"]
    }


def radioss(text):
    """{material: (rows of its card, (n, 2) shear function)}."""
    lines = text.splitlines()
    cards = defaultdict(list)
    ids = defaultdict(list)
    numbered = {}
    assert lines[0] == "#RADIOSS STARTER"
    assert lines[-1] == "/END"
    assert all(len(line.removeprefix("#")) <= 100 for line in lines)
    for head, body in blocks(lines[:-1], "/", "#"):
        word, _, number = (head[1:] + "/" * (head == "/NODE")).rpartition("/")
        if word == "BCS":
            assert re.fullmatch(r"   [01]{3} [01]{3} {9}0[ \d]{10}", body[1]), body
            cards[word].append([[int(body[1][20:30])]])
        if word not in RADIOSS:
            assert head.split("/")[1] in ("BEGIN", "TITLE", "BCS", "TH"), head
            continue
        rows = rows_of(body, RADIOSS[word], word not in ("NODE", "SHELL", "FAIL/FABRIC"))
        assert len(rows) >= len(RADIOSS[word]), head
        cards[word].append(rows)
        numbered[word, number] = rows
        ids[word.split("/")[0]] += (
            [row[0] for row in rows] if word in ("NODE", "SHELL") else [number]
        )
    defined = defined_in(cards, ids, "/")
    parts = {int(number) for word, number in numbered if word == "SHELL"}
    assert parts == defined["PART"]
    assert {rows[0][0] for rows in cards["BCS"]} <= defined["GRNOD"]
    assert defined.get("FAIL", set()) <= defined["MAT"]
    assert all(rows[3][2] > 0 for rows in cards["INTER/TYPE7"])
    body = cards["RBODY"][0][0]
    assert body[7] == 4
    assert body[4] > 0
    laws = {number: rows for (word, number), rows in numbered.items() if word == "MAT/LAW58"}
    return {
        int(n): (rows, np.array(numbered["FUNCT", str(int(rows[7][0]))]))
        for n, rows in laws.items()
    }
