"""What docs/from-other-codes.md says is not here is not here: its list is docs/not_here.toml."""

import json
import tomllib
from functools import cache
from pathlib import Path

import pytest

from fabrics.fabric_tables import FabricFile
from weavecell.scenes.coupon import CouponScene
from weavecell.scenes.impact import Scene

ROOT = Path(__file__).parents[1]
ENTRIES = tomllib.loads((ROOT / "docs" / "not_here.toml").read_text("utf-8"))["entry"]


@cache
def searched(place):
    """All text, in small letters, in which the words of an entry would stand."""
    if place == "inputs":
        schemas = [kind.model_json_schema() for kind in (Scene, CouponScene)]
        keys = [(key, field.title) for key, field in FabricFile.model_fields.items()]
        names = [path.stem for path in (ROOT / "fabrics").rglob("*.toml")]
        return json.dumps([schemas, keys, names]).lower()
    folders = ("weavecell/decks",)
    if place == "code":
        folders = ("fabrics", "meshing", "shellfabric", "unitcell3d", "weavecell")
    files = [path for folder in folders for path in (ROOT / folder).rglob("*.py")]
    return "\n".join(path.read_text("utf-8") for path in files).lower()


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry["text"][:20])
def test_what_is_said_not_to_be_here_is_not_here(entry):
    text = searched(entry["in"])
    assert [word for word in entry["absent"] if word in text] == []


@pytest.mark.parametrize(
    "place, word", [("inputs", "mushroom"), ("decks", "*mat_fabric"), ("code", "import numba")]
)
def test_what_is_searched_has_what_is_here(place, word):
    if word == "mushroom":
        word = '"metal"'
    assert word in searched(place)
