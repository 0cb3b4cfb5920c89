"""A faulty scene is refused in the same words by `impact`, by its `--check` and by Python, with the code 2: what
each of the three does beside the others would show here."""

import random
import re
import tomllib

import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from fabrics.base.schema import unit_of
from tests.scene_text import merged, table_of, toml
from tests.weavecell.scenes.test_keys_reach import ENTRIES
from tests.weavecell.session_runs import SCENES

PLIES = {"panel": {"plies": 2}}
YARNS = {"panel": {"crossovers": "yarns", "symmetry": "whole"}}
BLOCK = {"backing": {"material": "clay", "size": ["60 mm", "60 mm", "30 mm"]}}
HISTORY = {"history": {"interval": "1 us", "warp": ["0 mm"]}}
# what each table needs to be read at all
BESIDE = {"fabric": {}, "projectile": {}, "panel": {}, "run": {}, "numerics": {}}
BESIDE |= {"backing": BLOCK, "history": HISTORY}
# faults that a reader of keys cannot see: of two keys, of the set-up, of the panel that is made of it
TOGETHER = tomllib.loads("""
"law of two forms" = { fabric = { law = { a = "0.04 mm", b = "0.05 mm N^(1/3)" }, surface = "none.npz" } }
"law without b" = { fabric = { law = { a = "0.04 mm" } } }
"law thicker than its fabric" = { fabric = { law = { a = "4 mm", b = "0.05 mm N^(1/3)" } } }
"no fabric of this name" = { fabric = { name = "S-7200" } }
"nose wider than the opening" = { panel = { opening = "3 mm" } }
"grading that ends" = { panel = { grading = [[8, 1], [12, 2]], opening = "60 mm" } }
"aim beyond the edge" = { panel = { symmetry = "whole", impact_point = ["40 mm", "0 mm"] } }
"aim off a quarter" = { panel = { symmetry = "quarter", impact_point = ["4 mm", "0 mm"] } }
"edge wider than the nose" = { projectile = { edge_radius = "4 mm" } }
"bar of a light projectile" = { projectile = { body = "elastic_bar", mass = "0.1 g" } }
"lean before a block" = { projectile = { obliquity = "30 deg" }, backing = { material = "clay" } }
"plies of no fabric" = { panel = { ply = [{ fabric = "S-7200" }, { fabric = "S-728" }] } }
"gap of one ply" = { panel = { ply_gap = "0.05 mm" } }
"friction below none" = { panel = { plies = 2, ply_friction = -0.1 } }
"block without a material" = { backing = { standoff = "2 mm" } }
"block of two lengths" = { backing = { material = "clay", size = ["60 mm", "60 mm"] } }
"gap of yarns that are resolved" = { fabric = { crossover_gap = "0.01 mm" }, panel = { crossovers = "yarns" } }
"zone of pinned yarns" = { panel = { crossovers = "pinned", zone = "10 mm" } }
"zone smaller than the nose" = { panel = { crossovers = "yarns", zone = "0.1 mm" } }
"history of a third ply" = { history = { interval = "1 us", plies = [3] }, panel = { plies = 2 } }
"history beyond the edge" = { history = { interval = "1 us", warp = ["500 mm"] } }
"samples closer than steps" = { history = { interval = "0.1 ns", warp = ["0 mm"] } }
"end before contact" = { run = { end_time = "40 ns" } }
""")
DRAWN = 2  # keys of each table


def spoil(key, random):
    """A value of a key that is none, whatever else the scene says."""
    unit = unit_of(ENTRIES[key])
    wrong = ["3 parsec^5", {"a": 1}]
    if unit:
        wrong += [7.25, "12,5 mm"]
    return random.choice(wrong)


def draw():
    """{name: change} of keys of each table, drawn, with values that are none, and of keys that are none."""
    drawn = random.Random(91)
    found = {}
    for table, beside in BESIDE.items():
        keys = sorted(key for key in ENTRIES if key.rpartition(".")[0] == table)
        for key in drawn.sample(keys, DRAWN):
            found[key] = merged(beside, table_of(key, spoil(key, drawn)))
        key = drawn.choice(keys) + drawn.choice("qxz")
        found[key] = merged(beside, table_of(key, "1 mm"))
    return found


FAULTS = TOGETHER | draw()


class Computed(Exception):
    """Something is computed."""


@pytest.fixture
def not_computed(monkeypatch):
    def computed(*_, **__):
        raise Computed

    monkeypatch.setattr("shellfabric.impact.run._run_recorded", computed)
    monkeypatch.setattr("shellfabric.impact.run._make_solver", computed)


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_told_once(name, not_computed, command, tmp_path):
    (tmp_path / "scene.toml").write_text(toml(merged(SCENES["small"], FAULTS[name])))
    code, _, told = command("impact", "scene.toml", "--out", "r")
    assert code == 2
    assert re.match(r"error: scene\.toml:(\d+:)? ", told)
    foreseen = command("impact", "scene.toml", "--check")
    assert (foreseen[0], foreseen[2]) == (code, told)
    for options in ({"check": True}, {}):
        with pytest.raises(InputError) as refused:
            wc.impact("scene.toml", **options)
        lines = [f"error: {line}" for line in str(refused.value).splitlines()]
        assert lines == told.splitlines()
    assert [path.name for path in tmp_path.iterdir()] == ["scene.toml"]
