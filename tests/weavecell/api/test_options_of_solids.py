"""Each option of the commands on one crossover is refused or changes the plan; the options are found from the
commands themselves."""

import inspect
import re

import pytest

import weavecell as wc
from tests.commands import without_effect
from weavecell.cli import app, from_signature

# the least that a command takes beside the fabric
BESIDE = {
    "calibrate": {},
    "surface": {},
    "biaxial": {},
    "mesh": {"patch": "3x4"},
    "crossover yarn": {},
    "crossover platens": {},
    "crossover biaxial": {"end_displacement": "0.02 mm"},
    "crossover shear": {},
}
# of what is no truth value and no choice of words
VALUES = {
    "mesh": ["coarse", "medium"],
    "compare_3d": ["coarse", "medium"],
    "friction": [0.1, 0.2],
    "pressure": ["10 MPa", "20 MPa"],
    "plies": [2, 3],
    "bars": [8, 12],
    "end_displacement": ["0.01 mm", "0.02 mm"],
    "shear_angle": ["20 deg", "30 deg"],
    "points": [9, 11],
    "tolerance": [1e-5, 1e-6],
    "d1": ["0 mm .. 0.02 mm", "0 mm .. 0.03 mm"],
    "d2": ["0 mm .. 0.02 mm", "0 mm .. 0.03 mm"],
    "ratio": [["1:1"], ["2:1"]],
    "patch": ["3x4", "4x5"],
    "format": ["msh", "vtu"],
    "yarn_gap": ["1 um", "2 um"],
    "gap": ["1 um", "2 um"],
}
# how it is computed and where it is written
OF_EXECUTION = ("check", "out", "jobs", "executor", "resume")


def list_options(function):
    """{option: values} of a command that can be tried without a file."""
    meanings = {}
    named = [
        one
        for one in inspect.signature(function).parameters.values()
        if one.kind is one.KEYWORD_ONLY
    ]
    found = {}
    for one in (*named, *from_signature.unpack_keywords(function, meanings)):
        words = str(one.annotation)
        choices = re.search(r"Literal\[(.*?)\]", words)
        if one.name in OF_EXECUTION:
            continue
        if words == "bool":
            found[one.name] = [True, False]
        elif choices:
            found[one.name] = re.findall(r"\w+", choices[1])
        elif one.name in VALUES:
            found[one.name] = VALUES[one.name]
    return found


@pytest.mark.parametrize("words", BESIDE)
def test_each_option_is_refused_or_changes_the_plan(words):
    function = app.find_function(app.COMMANDS[words][0])
    options = list_options(function)
    assert len(options) >= 2
    given = BESIDE[words]
    assert without_effect(function, [wc.fabric("S-720")], given, options) == []
