"""Readers and validators of panel decks that share no code with the writers: what the manuals say of columns and ids.

Each reader takes a deck apart and asserts on the way that titles are there and short, that fields lie in their
columns and are numbers, that ids are unique and whatever is referred to is defined. It returns the curves of the
material cards.
"""

import re
from collections import defaultdict
from itertools import pairwise

import numpy as np

TITLE = 70


def columns(line, widths):
    """Numbers (or blanks, as None) in fixed columns; nothing beyond them, nothing across their bounds."""
    ends = np.cumsum([0, *widths])
    assert len(line) <= ends[-1], line
    found = [line[a:b].strip() for a, b in pairwise(ends) if a < len(line)]
    assert all(" " not in each for each in found), line
    return [float(each) if each else None for each in found]


def title(line):
    assert line.isascii()
    assert 0 < len(line.strip()) <= TITLE, line
    return line.strip()


def unique(numbers):
    numbers = [int(each) for each in numbers]
    assert len(set(numbers)) == len(numbers)
    assert min(numbers) > 0
    return set(numbers)


# --- LS-DYNA --------------------------------------------------------------------------------------------------------

DYNA = {"*NODE": (8, 16, 16, 16), "*ELEMENT_SHELL": (8,) * 6}


def dyna(text):
    """{material: (warp, weft, shear)}, each (n, 2), with (DATTYP of warp)."""
    blocks, lines = [], [line for line in text.splitlines() if not line.startswith("$")]
    assert lines[0] == "*KEYWORD"
    assert lines[-1] == "*END"
    assert all(len(line) <= 80 for line in text.splitlines())
    for line in lines[1:-1]:
        if line.startswith("*"):
            blocks.append((line, []))
        else:
            blocks[-1][1].append(line)
    ids, cards = defaultdict(list), defaultdict(list)
    for word, body in blocks:
        if word.endswith("_TITLE") or word in ("*TITLE", "*PART", "*PART_INERTIA"):
            title(body.pop(0))
        word = word.removesuffix("_TITLE")
        if word == "*DEFINE_CURVE":
            head, points = columns(body[0], (10,) * 8), [columns(line, (20, 20)) for line in body[1:]]
            cards["curves"].append((head, np.array(points)))
            ids[word].append(head[0])
        elif word in DYNA:
            cards[word] = np.array([columns(line, DYNA[word]) for line in body])
            ids[word] = list(cards[word][:, 0])
        else:
            rows = [columns(line, (10,) * 8) for line in body]
            cards[word].append(rows)
            kind = word.replace("_LIST", "").replace("_INERTIA", "")
            if kind.startswith(("*SET", "*PART", "*SECTION")) and rows:
                ids[kind].append(rows[0][0])
            elif word.startswith("*MAT"):
                ids["*MAT"].append(rows[0][0])
    defined = {kind: unique(numbers) for kind, numbers in ids.items() if kind != "*TITLE"}
    _dyna_references(cards, defined)
    curves = {int(head[0]): (points, head[6]) for head, points in cards["curves"]}
    return {int(rows[0][0]): tuple(curves[int(n)] for n in rows[5][:3]) for rows in cards["*MAT_FABRIC"]}


def _dyna_references(cards, defined):
    nodes, parts = defined["*NODE"], defined["*PART"]
    assert set(cards["*ELEMENT_SHELL"][:, 1]) == parts
    assert set(cards["*ELEMENT_SHELL"][:, 2:].ravel()) <= nodes
    for rows in [*cards["*PART"], *cards["*PART_INERTIA"]]:
        assert rows[0][1] in defined["*SECTION_SHELL"]
        assert rows[0][2] in defined["*MAT"]
    assert cards["*PART_INERTIA"][0][1][5] in nodes
    for rows in cards["*SET_NODE_LIST"]:
        assert {n for row in rows[1:] for n in row} <= nodes
    assert {rows[0][0] for rows in cards["*BOUNDARY_SPC_SET"]} == defined["*SET_NODE"]
    assert {n for row in cards["*SET_PART_LIST"][0][1:] for n in row} <= parts
    for rows in cards["*MAT_FABRIC"]:
        assert [len(row) for row in rows] == [7, 8, 8, 8, 8, 7]
        assert rows[2][5] == 14
        assert set(rows[5][:3]) <= defined["*DEFINE_CURVE"]
    contact = cards["*CONTACT_AUTOMATIC_SURFACE_TO_SURFACE"][0][0]
    assert contact[0] in defined["*SET_PART"]
    assert contact[1] in parts
    assert contact[2:4] == [2, 3]


# --- OpenRadioss ----------------------------------------------------------------------------------------------------

REAL5 = (20,) * 5
RADIOSS = {  # cards below the title, the last one repeated
    "MAT/LAW58": ((20, 20), REAL5, (20, 20, 20, 20, 10, 10), REAL5, (10, 10, 20, 20, 20, 20), (10, 10, 20)),
    "MAT/LAW1": ((20, 20), (20, 20)),
    "PROP/TYPE16": ((10,) * 3, REAL5, (10, 10, 20, 20, 10, 10), (20, 20, 20, 10, 10, 10, 10), (20, 20, 20, 20, 10)),
    "PROP/TYPE1": ((10,) * 5, REAL5, (10, 10, 20, 20, 10, 10, 10)),
    "PART": ((10, 10),), "FUNCT": ((20, 20),), "GRNOD/NODE": ((10,) * 10,), "GRNOD/PART": ((10,) * 10,),
    "SURF/PART": ((10,) * 10,), "INIVEL/TRA": ((20, 20, 20, 10, 10),),
    "RBODY": ((10, 10, 10, 10, 20, 10, 10, 10, 10), (20,) * 3, (20,) * 3, (10,)),
    "INTER/TYPE7": (
        (10,) * 10, (20, 20, 20, 20, 10), (20, 20, 20, 20, 10, 10), REAL5, (7, 1, 1, 1, 20, 10, 20, 20, 20),
        (10, 10, 20, 10, 10, 10, 20, 10),
    ),
}  # fmt: skip
UNTITLED = {
    "NODE": ((10, 20, 20, 20),), "SHELL": ((10,) * 5,),
    "FAIL/FABRIC": ((20, 20, 20, 20, 10, 10), (20,)),
}  # fmt: skip


def radioss(text):
    """{material: (rows of its card, (n, 2) shear function)}."""
    lines = text.splitlines()
    assert lines[0] == "#RADIOSS STARTER"
    assert lines[-1] == "/END"
    assert all(len(line.removeprefix("#")) <= 100 for line in lines)
    blocks, kinds = [], defaultdict(list)
    for line in lines[:-1]:
        if line.startswith("/"):
            blocks.append((line[1:], []))
        elif not line.startswith("#"):
            blocks[-1][1].append(line)
    ids, rows_of = defaultdict(list), defaultdict(dict)
    for head, body in blocks:
        word, _, number = head.rpartition("/")
        if head == "NODE":
            word, number = head, ""
        layout = RADIOSS.get(word) or UNTITLED.get(word)
        if word == "BCS":
            assert re.fullmatch(r"   [01]{3} [01]{3} {9}0[ \d]{10}", body[1]), body
            kinds["BCS"].append(int(body[1][20:30]))
        if layout is None:
            assert head.split("/")[0] in ("BEGIN", "TITLE", "BCS", "TH"), head
            continue
        if word in RADIOSS:
            title(body.pop(0))
        rows = [columns(line, layout[min(n, len(layout) - 1)]) for n, line in enumerate(body)]
        assert len(rows) >= len(layout), head
        name = word.split("/")[0]
        if name not in ("SHELL", "NODE", "FAIL"):
            ids[name].append(number)
        rows_of[word][number] = rows
    defined = {name: unique(numbers) for name, numbers in ids.items()}
    _radioss_references(rows_of, defined, kinds["BCS"])
    functions = rows_of["FUNCT"]
    cards = rows_of["MAT/LAW58"].items()
    return {int(number): (rows, np.array(functions[str(int(rows[7][0]))])) for number, rows in cards}


def _radioss_references(rows_of, defined, of_boundary):
    nodes = unique(row[0] for row in rows_of["NODE"][""])
    elements = [row for rows in rows_of["SHELL"].values() for row in rows]
    unique(row[0] for row in elements)
    assert {n for row in elements for n in row[1:]} <= nodes
    assert {int(n) for n in rows_of["SHELL"]} == defined["PART"]
    for ((prop, material),) in rows_of["PART"].values():
        assert prop in defined["PROP"]
        assert material in defined["MAT"]
    groups, surfaces = defined["GRNOD"], defined["SURF"]
    assert set(of_boundary) <= groups
    for rows in rows_of["GRNOD/NODE"].values():
        assert {n for row in rows for n in row} <= nodes
    for word in ("GRNOD/PART", "SURF/PART"):
        assert {n for rows in rows_of[word].values() for row in rows for n in row} <= defined["PART"]
    for rows in rows_of["INTER/TYPE7"].values():
        assert rows[0][0] in groups
        assert rows[0][1] in surfaces
        assert rows[3][2] > 0
    for rows in rows_of["INIVEL/TRA"].values():
        assert rows[0][3] in groups
    body = rows_of["RBODY"]["1"][0]
    assert body[0] in nodes
    assert body[5] in groups
    assert body[7] == 4
    assert body[4] > 0
    assert {int(n) for n in rows_of["FAIL/FABRIC"]} <= defined["MAT"]
