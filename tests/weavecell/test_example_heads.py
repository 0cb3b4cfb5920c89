"""What the head of an example says was computed is what its run computes."""

import json
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
GOLDEN = ROOT / "tests" / "golden"
ENDS = {"perforated": r"\bperforat", "stopped": r"\bstop"}
# examples whose run is kept, by its name there
KEPT = {path.stem.removeprefix("impact-"): path for path in GOLDEN.glob("impact-*.json")}
NAMES = sorted(path.stem for path in EXAMPLES.glob("*.toml") if path.stem in KEPT)


def head(name):
    """Return the comment that an example begins with, in one line."""
    lines = (EXAMPLES / f"{name}.toml").read_text("utf-8").splitlines()
    first = next(k for k, line in enumerate(lines) if not line.startswith("#"))
    return " ".join(line.lstrip("# ") for line in lines[:first])


@pytest.mark.parametrize("name", NAMES)
def test_the_head_says_how_the_kept_run_ends(name):
    """A head that says how a shot ends says the end that the run has, and its numbers."""
    kept = json.loads(KEPT[name].read_text())["numbers"]
    said = [end for end, word in ENDS.items() if re.search(word, head(name))]
    if said:
        assert kept["outcome"] in said
    for number in re.findall(r"(\d+(?:\.\d+)?) m/s left", head(name)):
        decimals = len(number.partition(".")[2])
        assert round(kept["residual_velocity"], decimals) == float(number)
    for number in re.findall(r"(\d+\.\d+) mm shorter", head(name)):
        assert round(1e3 * kept["bar.shortening"], 2) == float(number)


def test_some_heads_say_it():
    assert "S-720-bar" in NAMES
    assert sum(bool(re.search("|".join(ENDS.values()), head(name))) for name in NAMES) >= 3
