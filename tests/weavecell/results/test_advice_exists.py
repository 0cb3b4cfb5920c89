"""Advice names what to do next: each command, option and key in it exists, wherever the advice comes from."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

from fabrics.base import schema
from fabrics.base.door import name_options, open_terminal
from fabrics.fabric_tables import FabricFile
from shellfabric.impact.proposals import PROPOSALS
from tests.weavecell.golden_texts.test_eight_lines import PRINTED
from weavecell.cli import from_signature
from weavecell.cli.app import COMMANDS, find_function
from weavecell.scenes.coupon import CouponScene
from weavecell.scenes.impact import Scene
from weavecell.studies import unknown

ROOT = Path(__file__).parents[3]
GOLDEN = ROOT / "tests/weavecell/golden_texts/texts"
# what a text says that can be tried: a command, an option of one, a table or key of a file
WAY = re.compile(
    r"weavecell (?P<command>[a-z0-9]+(?:[ -][a-z0-9]+)*)|--(?P<option>[a-z][a-z-]*)|\[(?P<table>[a-z_]+)\]"
    r"|\b(?P<key>[a-z_]+(?:\.(?!toml|json|csv)[a-z_A-Z0-9]+)+)|\b(?P<given>[a-z_]+) = "
)
# call : name and place of the argument that is advice
ARGUMENTS = {
    "Mover": ("settle", 1),
    "LeftOut": ("settle", 3),
    "Unknown": ("advice", 2),
    "Check": ("advice", 3),
    "_find_answer": ("advice", 3),
}
# advice that is not written where it is given: what it is made of is, or is printed in a golden text
MADE = {
    ("ply_counts.py", "advice"),
    ("ply_counts.py", "unknown.ADVICE.get(name, '')"),
    ("v50.py", "tuple(first.values())"),
    ("v50.py", "settles[name]"),
    ("shot.py", "advice"),
    ("calibration.py", "advice"),
    ("biaxial_fit.py", "advice"),
    ("comparison.py", "advice"),
    ("pull_out_friction.py", "advice"),
    ("pull_out_friction.py", "settle"),
    ("result.py", "part.settle"),
    ("left_out.py", "way"),
    ("left_out.py", "words"),
    ("left_out.py", "'--uncertainty' if one_shot else ''"),
}


@cache
def options_of(command):
    """Options of a command, as they are written."""
    function, *rest = COMMANDS[command]
    made, _ = from_signature.command(find_function(function), command, *rest)
    return {name.replace("_", "-") for name in made.__signature__.parameters}


@cache
def keys():
    """Keys and tables of all files that a user writes."""
    found = {"law", "weaving_damage"}
    for model in (Scene, CouponScene, FabricFile):
        found |= {*schema.entries(model), *schema.tables(model)}
    return found


def find_command(line):
    """The command that a line calls, without `weavecell`; "" of none."""
    return max(
        (name for name in COMMANDS if f"{line} ".startswith(f"{name} ")), key=len, default=""
    )


def wrong(text, command=""):
    """Ways of a text that do not exist; None of a text that has none. `command` is that whose advice it is."""
    ways = 0
    bad = []
    for part in text.split("; "):
        ways += part.partition(":")[0] in COMMANDS
    for found in WAY.finditer(text):
        ways += 1
        kind, word = found.lastgroup, found[found.lastgroup]
        if kind == "command":
            command = find_command(word)
            known = bool(command)
        elif kind == "option":
            of = [command] if command else COMMANDS
            known = any(word in options_of(name) for name in of)
        elif kind == "given":
            known = any(key.rpartition(".")[2] == word for key in keys())
        else:
            ends = [word, word.removeprefix("fabric.")]
            known = any(end in keys() for end in ends)
        if not known:
            bad.append(found[0])
    return bad if ways else None


@cache
def calls():
    """{name: (file, call) of each call of it in the code}, of those with advice."""
    found = {name: [] for name in ARGUMENTS}
    for folder in ("weavecell", "shellfabric", "unitcell3d"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            text = path.read_text("utf-8")
            if not any(f"{name}(" in text for name in ARGUMENTS):
                continue
            for node in ast.walk(ast.parse(text)):
                if isinstance(node, ast.Call):
                    name = getattr(node.func, "id", getattr(node.func, "attr", ""))
                    found.get(name, []).append((path.name, node))
    return found


def literals(name):
    """(file, text) of all advice that is written in the code as an argument of calls of a name."""
    keyword, place = ARGUMENTS[name]
    for file, node in calls()[name]:
        given = [one.value for one in node.keywords if one.arg == keyword]
        for value in given or node.args[place : place + 1]:
            if isinstance(value, ast.Constant):
                yield file, value.value
            elif not (file == "unknown.py" and value.id in vars(unknown)):
                yield file, value


def test_all_advice_of_the_code_is_walked():
    """A text that is made elsewhere is one that is known here, so that no new one goes unread."""
    made = {
        (file, ast.unparse(text))
        for name in ARGUMENTS
        for file, text in literals(name)
        if not isinstance(text, str)
    }
    assert made == MADE


@pytest.mark.parametrize("name", ARGUMENTS)
def test_what_the_code_advises_exists(name):
    texts = {text for _, text in literals(name) if isinstance(text, str)}
    if name == "Unknown":
        texts |= set(unknown.ADVICE.values())
    for text in texts - {""}:
        taken = {key: one.words for key, one in PROPOSALS.items()}
        found = wrong(text.format(**taken) if "{" in text else text)
        # a check may ask to state what it says
        assert found == [] or (found is None and name == "Check"), text


def printed():
    """(command, advice) of the texts that users read, and of the pages."""
    for line, lines in PRINTED.items():
        command = find_command(line)
        labels = ("first ", "second ", "third ", "fourth ") if command == "next" else ("next ",)
        for row in lines:
            if row.startswith(labels):
                yield command, row.partition(" ")[2].strip()
    for path in (*sorted((ROOT / "docs").glob("*.md")), ROOT / "README.md"):
        text = path.read_text("utf-8")
        for row in re.finditer(r"^(?:next|first|second) {2,}(.+)$", text, re.M):
            # whose output it is stands above it
            *_, called = re.findall(r"weavecell ([a-z0-9 -]+)", text[: row.start()])
            yield find_command(called), row[1]


def test_what_is_printed_exists():
    """Of its own command, in the terminal and on the pages."""
    rows = {*printed()}
    assert len(rows) > 8
    for command, row in rows:
        own = "" if command == "next" else command
        assert wrong(row, own) == [], (command, row)


def test_written_advice_exists():
    """What JSON files say, of which a line may show a part alone."""
    texts = set()
    for path in GOLDEN.glob("*.txt"):
        text = path.read_text("utf-8")
        texts |= set(re.findall(r'"settle": "((?:[^"\\]|\\.)+)"', text))
        for block in re.findall(r'"advice": \[([^\]]+)\]', text):
            texts |= set(re.findall(r'"((?:[^"\\]|\\.)+)"', block))
    assert len(texts) > 8
    for text in texts:
        assert wrong(text) == [], text


@pytest.mark.parametrize(
    "text, command, found",
    [
        ("measure friction (`weavecell reduce pullout`)", "", ["weavecell reduce pullout"]),
        ("--assumed-range", "impact", ["--assumed-range"]),
        ("--scan", "impact", ["--scan"]),
        ("--scan", "critical-velocity", []),
        ("give panel.ply_frictions", "", ["panel.ply_frictions"]),
        ("leave [numeric] out", "", ["[numeric]"]),
        ('crossover = "yarns"', "", ["crossover = "]),
        ("`weavecell plies --tested '5 plies: V50'`", "", ["--tested"]),
        ("think about it", "", None),
    ],
)
def test_advice_that_does_not_exist_is_found(text, command, found):
    assert wrong(text, command) == found


def test_options_are_named_as_each_door_has_them():
    text = "`weavecell plies --test 'S-728, 5 plies: V50'`; --draws 16; --scan"
    with open_terminal():
        assert name_options(text) == text
    there = "`weavecell plies test='S-728, 5 plies: V50'`; draws=16; scan=True"
    assert name_options(text) == there
