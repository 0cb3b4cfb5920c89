"""Presets: what one line puts into the tables of a scene, and what it leaves to the user."""

import pytest

import weavecell as wc
from fabrics import backings
from fabrics.base.errors import InputError
from tests.scene_text import merged
from weavecell.scenes import presets
from weavecell.scenes.impact import check

SHOT = {
    "fabric": {"name": "S-745"},
    "projectile": {"name": "sphere 5.5 mm", "strike_velocity": "200 m/s"},
    "panel": {"preset": "body armour", "plies": 15},
}


def test_body_armour_is_a_free_pack_before_a_deep_wide_block_that_comes_to_rest():
    """The same by one line of a file and by one keyword of Python, with the opening that Python always has."""
    scene = check(SHOT, None)
    panel, block = scene.panel, scene.backing
    assert (panel.boundary, panel.opening, panel.plies) == ("free", 0.2, 15)
    assert all(given >= least for given, least in zip(block.size, (0.4, 0.4, 0.14)))
    assert (block.refined_depth, block.after_stop) == (0.04, 3e-3)
    assert block.yield_stress == backings.load("Roma Plastilina No. 1").yield_stress
    assert scene.run.end_time >= 3e-3 + 1e-3
    setup = wc.setup("S-745", "200 m/s", preset="body armour", plies=15, projectile="sphere 5.5 mm")
    assert setup.boundary == "free"
    assert setup.opening == 0.203
    assert setup.backing.refined_depth == 0.04
    assert setup.backing.name == block.material
    assert setup.end_time == scene.run.end_time


def test_what_is_given_stands_before_the_preset():
    given = {
        "panel": {"boundary": "clamped"},
        "backing": {"after_stop": "1 ms", "material": "gelatine 20 %"},
        "run": {"elements_per_crossover": 2},
    }
    scene = check(merged(SHOT, given), None)
    assert scene.panel.boundary == "clamped"
    assert scene.backing.after_stop == 1e-3
    assert scene.backing.material == "gelatine 20 %"
    assert scene.backing.size[2] >= 0.14
    assert scene.run.elements_per_crossover == 2
    assert scene.run.end_time == 5e-3


def test_a_preset_that_there_is_not_is_refused_with_those_that_there_are():
    with pytest.raises(InputError, match=r"body armor.*body armour") as refused:
        check(merged(SHOT, {"panel": {"preset": "body armor"}}), "shot.toml")
    assert "shot.toml: panel.preset" in str(refused.value)
    assert presets.fill({"panel": {"opening": "50 mm"}}) == {"panel": {"opening": "50 mm"}}
    assert presets.fill({"panel": "body armour"}) == {"panel": "body armour"}
