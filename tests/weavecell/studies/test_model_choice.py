"""Which model a scene needs: of the nearest scene that was run in all models."""

from dataclasses import replace
from pathlib import Path

import pytest

import weavecell as wc
from fabrics import catalogue
from weavecell.studies import model_choice
from weavecell.studies.ballistic_limit import first_guess
from weavecell.studies.model_choice import KnownScene, SceneNumbers

DATA = Path(__file__).parents[3] / "docs" / "reports" / "data" / "models-of-scenes.csv"
HERE = SceneNumbers("nose", 4.0, 0.6, 2.0, 0.2)
# each is one step away, in another direction
MOVED = {
    "wide": {"nose": 9.0},
    "fast": {"velocity": 1.1},
    "thick": {"plies": 8.0},
    "slippery": {"friction": 0.01},
    "bullet": {"kind": "bullet"},
}


@pytest.fixture
def scenes(monkeypatch):
    known = [KnownScene("same", HERE, "cheap", "rich", 1.25, 0.0431)]
    for name, change in MOVED.items():
        known.append(KnownScene(name, replace(HERE, **change), "dear", "dear", 0.0, 1.0))
    monkeypatch.setattr(model_choice, "known_scenes", lambda: tuple(known))
    return known


@pytest.mark.parametrize("name", [*MOVED, "same"])
def test_the_like_scene_is_the_nearest_in_each_number(scenes, monkeypatch, name):
    numbers = replace(HERE, **MOVED.get(name, {}))
    monkeypatch.setattr(model_choice, "describe", lambda setup, target: numbers)
    told = model_choice.advise(None, None)
    if name == "same":
        assert told == "model: cheap, 1.2 % off rich at 0.043 of the CPU time in the like shot same"
    else:
        assert told == f"model: dear: no cheaper model is within 5 % in the like shot {name}"


def test_a_scene_that_is_like_none_is_told(scenes, monkeypatch):
    numbers = replace(HERE, nose=40.0)
    monkeypatch.setattr(model_choice, "describe", lambda setup, target: numbers)
    assert model_choice.advise(None, None).startswith("model: none of the 6 scenes")


def test_numbers_of_a_scene():
    projectile = {"shape": "sphere", "mass": "0.5 g", "diameter": "4 mm"}
    setup = wc.setup("S-726", "150 m/s", plies=3, projectile=projectile, opening="30 mm")
    target = setup.target(setup.plain_table())
    numbers = model_choice.describe(setup, target)
    weave = catalogue.load("S-726").weave
    assert numbers.nose == pytest.approx(4e-3 * max(weave.warp_count, weave.weft_count))
    assert numbers.velocity == pytest.approx(150 / first_guess(target))
    assert (numbers.kind, numbers.plies, numbers.friction) == ("nose", 3.0, 0.2)
    slippery = wc.setup(
        "S-726", "150 m/s", crossovers="yarns", crossover_friction=0.07, opening="30 mm"
    )
    assert model_choice.describe(slippery, target).friction == 0.07
    bullet = wc.setup("S-745", "190 m/s", projectile="9 mm FMJ 8.0 g", opening="60 mm")
    assert model_choice.describe(bullet, target).kind == "bullet"


def test_the_scenes_are_those_of_the_study():
    """Else: python tools/pages.py"""
    copy = Path(model_choice.__file__).parent / model_choice.FILE
    assert copy.read_bytes() == DATA.read_bytes()
    known = model_choice.known_scenes()
    assert len(known) == 10
    for scene in known:
        assert scene.off <= 5.0
        assert scene.cost <= 1.0 or scene.cheapest != scene.richest
