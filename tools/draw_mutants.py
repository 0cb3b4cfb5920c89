"""Draw defects from the arithmetic of the product: where and which is decided by a seed, not by hand.

    python tools/mutants.py --draw 40 --seed 1 --out results/drawn.csv [--of meshing unitcell3d ...]

A sum becomes a difference and the other way round, a product a quotient, a comparison takes its limit in or
leaves it out, an index 0 becomes 1, a number of warp is taken from the weft, a minimum becomes a maximum, a
weight its double, a term of a sum is dropped. Which of them change nothing has to be judged by reading.
"""

from __future__ import annotations

import ast
import random
import re
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
PACKAGES = ("fabrics", "meshing", "shellfabric", "unitcell3d", "weavecell")
OPERATORS = {ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*")}
COMPARISONS = {
    ast.Lt: ("<", "<="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", ">="),
    ast.GtE: (">=", ">"),
}
# names that have a partner, by their end or as a whole
PARTNERS = (("warp", "weft"), ("1", "2"))
EXTREMES = {"min": "max", "max": "min", "minimum": "maximum", "maximum": "minimum"}
MOST_FILES = 4  # of tests, that name the file of a defect


class Change(NamedTuple):
    """A place in a text, [start, end), and what stands there instead."""

    start: int
    end: int
    replacement: str
    defect: str


def find_changes(text: str) -> Iterator[Change]:
    """Find all changes that can be made in the text of a module."""
    tree = ast.parse(text)
    words = set(re.findall(r"\w+", text))
    lines = text.splitlines(keepends=True)
    rows = [0]
    for line in lines:
        rows.append(rows[-1] + len(line))

    def place(row: int, column: int) -> int:
        # columns of the tree are counted in bytes
        return rows[row - 1] + len(lines[row - 1].encode()[:column].decode())

    for node in ast.walk(tree):
        if not hasattr(node, "end_col_offset"):
            continue
        end = place(node.end_lineno, node.end_col_offset)
        if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
            # a path is joined by a slash, and a text by a plus
            if _is_text(node.left) or _is_text(node.right):
                continue
            sign, other = OPERATORS[type(node.op)]
            left = place(node.left.end_lineno, node.left.end_col_offset)
            right = place(node.right.lineno, node.right.col_offset)
            at = text.find(sign, left, right)
            if at < 0:
                continue
            yield Change(at, at + 1, other, f"{sign} became {other}")
            if isinstance(node.op, (ast.Add, ast.Sub)):
                yield Change(at, end, "", "the last term of a sum is dropped")
        elif isinstance(node, ast.Compare) and type(node.ops[0]) in COMPARISONS:
            sign, other = COMPARISONS[type(node.ops[0])]
            left = place(node.left.end_lineno, node.left.end_col_offset)
            right = place(node.comparators[0].lineno, node.comparators[0].col_offset)
            at = text.find(sign, left, right)
            yield Change(at, at + len(sign), other, f"{sign} became {other}")
        elif isinstance(node, ast.Subscript) and _number(node.slice) and node.slice.value in (0, 1):
            at = place(node.slice.lineno, node.slice.col_offset)
            other = str(1 - node.slice.value)
            yield Change(at, at + 1, other, f"index {node.slice.value} became {other}")
        elif isinstance(node, ast.Constant) and type(node.value) is float and node.value:
            at = place(node.lineno, node.col_offset)
            yield Change(at, end, f"(2 * {text[at:end]})", f"{text[at:end]} became its double")
        elif isinstance(node, (ast.Name, ast.Attribute)) and isinstance(node.ctx, ast.Load):
            name = getattr(node, "id", None) or node.attr
            if other := EXTREMES.get(name):
                yield Change(end - len(name), end, other, f"{name} became {other}")
            for pair in PARTNERS:
                for one, other in (pair, pair[::-1]):
                    partner = re.sub(f"{one}$", other, name)
                    # only a partner that the module knows
                    if partner != name and partner in words:
                        yield Change(end - len(name), end, partner, f"{name} became {partner}")


def _number(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and type(node.value) in (int, float)


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, (ast.Constant, ast.JoinedStr)) and not _number(node)


def draw(count: int, seed: int, folders: Sequence[str] = PACKAGES) -> list[dict]:
    """Draw defects, as `mutants.toml` has them; each place is as likely as any other.

    Parameters
    ----------
    count : of defects
    seed : of the random numbers; the same seed draws the same of the same code
    folders : of the files, such as "shellfabric/cell"
    """
    drawn = random.Random(seed).sample(_find_places(tuple(folders)), count)
    found = []
    for number, (file, change) in enumerate(drawn, 1):
        text = (ROOT / file).read_text("utf-8")
        first, last = enclose(text, change)
        changed = text[first : change.start] + change.replacement + text[change.end : last]
        found.append(
            {
                "id": f"drawn-{seed}-{number}",
                "file": str(file),
                "text": text[first:last],
                "replacement": changed,
                "tests": nearest_tests(file),
                "defect": change.defect,
            }
        )
    return found


@cache
def _find_places(folders: tuple[str, ...]) -> list[tuple[Path, Change]]:
    """Find all changes of the files of some folders, each with its file."""
    places = []
    for folder in folders:
        for file in sorted((ROOT / folder).rglob("*.py")):
            changes = sorted(set(find_changes(file.read_text("utf-8"))))
            places += [(file.relative_to(ROOT), change) for change in changes]
    return places


def enclose(text: str, change: Change) -> tuple[int, int]:
    """Find whole lines about a change that stand once in the text: (start, end) of them."""
    first = text.rfind("\n", 0, change.start) + 1
    last = text.find("\n", change.end)
    while text.count(text[first:last]) > 1 and first > 0:
        first = text.rfind("\n", 0, first - 1) + 1
    return first, last


@cache
def _texts_of_tests() -> dict[Path, str]:
    """Read all files of tests."""
    files = sorted((ROOT / "tests").rglob("test_*.py"))
    return {file.relative_to(ROOT): file.read_text("utf-8") for file in files}


@cache
def nearest_tests(file: Path) -> list[str]:
    """List the files of tests that reach a module, the nearest first, and the folder of its package."""
    module = ".".join(file.with_suffix("").parts)
    parent, stem = module.rsplit(".", 1)
    named = re.compile(
        rf"\b{re.escape(module)}\b|from {re.escape(parent)} import [^\n]*\b{re.escape(stem)}\b"
    )
    found = []
    for test, text in _texts_of_tests().items():
        if named.search(text):
            found.append(test)
    own = Path("tests", *file.parts[:-1])
    found.sort(key=lambda test: (not test.is_relative_to(own), str(test)))
    names = [str(test) for test in found[:MOST_FILES]]
    while not (ROOT / own).exists():
        own = own.parent
    return [*names, str(own)]
