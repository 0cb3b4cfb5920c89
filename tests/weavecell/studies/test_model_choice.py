"""Which model a scene needs: of the scenes like it that were run in all models."""

import csv
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
# each is two steps away, in another direction, and like none of the others
MOVED = {
    "wide": {"nose": 16.5},
    "fast": {"velocity": 1.4},
    "thick": {"plies": 19.0},
    "rough": {"friction": 0.51},
    "bullet": {"kind": "bullet"},
}


COARSE, FINE, RICH = "membrane, 1 element", "membrane, 3 elements", "resolved yarns"
CPU = {COARSE: 0.31, FINE: 1.1, RICH: 2.9, "body of metal": 7.0}


def known(name, numbers, coarse, fine):
    """A scene in which the two membranes are some per cent off."""
    richest = model_choice.RICHEST[numbers.kind]
    return KnownScene(name, numbers, richest, {COARSE: coarse, FINE: fine, richest: 0.0}, CPU)


@pytest.fixture
def give(monkeypatch):
    """Give scenes that were run."""

    def given(*scenes):
        monkeypatch.setattr(model_choice, "known_scenes", lambda: scenes)

    return given


@pytest.fixture
def advise(monkeypatch):
    def advised(numbers):
        monkeypatch.setattr(model_choice, "describe", lambda setup, target: numbers)
        return model_choice.advise(None, None)

    return advised


@pytest.mark.parametrize("name", [*MOVED, "same"])
def test_the_like_scene_is_the_nearest_in_each_number(give, advise, name):
    moved = [known(one, replace(HERE, **change), 9.0, 8.0) for one, change in MOVED.items()]
    give(known("same", HERE, 1.25, 0.8), *moved)
    told = advise(replace(HERE, **MOVED.get(name, {})))
    if name == "same":
        assert told.startswith(f"model: {COARSE}, 1.2 % off {RICH} at 0.11 of the CPU time")
    else:
        assert told.endswith(f": no cheaper model is within 5 % in the like shot {name}")


def test_a_model_has_to_be_enough_in_each_like_scene(give, advise):
    """It was enough in the nearest by less than another differs from it."""
    beside = replace(HERE, velocity=0.66)
    alone = known("same", HERE, 4.75, 3.1)
    give(alone)
    cost = "0.11 of the CPU time in the like shot same"
    assert advise(HERE) == f"model: {COARSE}, 4.8 % off {RICH} at {cost}"
    give(alone, known("beside", beside, 4.9, 4.0))
    assert advise(HERE) == f"model: {COARSE}, 4.8 % off {RICH} at {cost}, and within 5 % in 1 other"
    give(alone, known("beside", beside, 6.4, 4.0))
    words = f"{COARSE}, enough in the like shot same, is 6.4 % off in another, beside"
    assert advise(HERE) == f"model: {FINE}: {words}"
    give(
        alone,
        known("beside", beside, 6.4, 5.1),
        known("worse", replace(HERE, plies=2.5), 17.3, 8.0),
    )
    words = f"{COARSE}, enough in the like shot same, is 17.3 % off in another, worse"
    assert advise(HERE) == f"model: {RICH}: {words}"
    # far away it says nothing
    give(alone, known("worse", replace(HERE, plies=20.0), 17.3, 8.0))
    assert advise(HERE) == f"model: {COARSE}, 4.8 % off {RICH} at {cost}"


def test_a_model_that_was_enough_and_dearer_than_the_richest_is_not_advised(give, advise):
    dear = {COARSE: 0.31, FINE: 3.3, RICH: 2.9}
    give(KnownScene("same", HERE, RICH, {COARSE: 7.5, FINE: 2.0, RICH: 0.0}, dear))
    assert advise(HERE) == f"model: {RICH}: no cheaper model is within 5 % in the like shot same"


def test_a_scene_that_is_like_none_is_told(give, advise):
    give(known("same", HERE, 1.0, 0.5), known("wide", replace(HERE, nose=9.0), 2.0, 1.0))
    assert advise(replace(HERE, nose=40.0)).startswith("model: none of the 2 scenes")


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
    with DATA.open(encoding="utf-8") as file:
        next(file)
        rows = list(csv.DictReader(file))
    for scene, row in zip(known, rows, strict=True):
        assert row["richest"] in scene.cpu
        assert scene.off.keys() <= scene.cpu.keys() <= {*scene.off, row["richest"]}
        if row["off, 3 elements [%]"]:
            off = float(row["off, 3 elements [%]"]) + float(row["known to [%]"])
            assert scene.off["membrane, 3 elements"] == pytest.approx(off)
        assert row["cheapest within 5 %"] in scene.enough
