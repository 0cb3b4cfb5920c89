"""What a scene's runs in several models say of them, and of the model that the like scene advises."""

import numpy as np
import pytest

from validation.cases import models
from weavecell.studies.model_choice import Advice, KnownScene, SceneNumbers

NUMBERS = SceneNumbers("nose", 4.0, 0.6, 2.0, 0.2)
NAMES = ("membrane, 1 element", "membrane, 3 elements", "resolved yarns")
# of each model: energy [J] and way [m], standard error [J], CPU time [s]
FOUND = {
    "membrane, 1 element": (np.array([40.0, 0.0106]), 0.0, 0.3),
    "membrane, 3 elements": (np.array([41.0, 0.0103]), 0.3, 0.9),
    "resolved yarns": (np.array([42.0, 0.0100]), 0.4, 2.7),
}


@pytest.fixture
def compare(monkeypatch):
    """Judge the runs of FOUND beside the advice of a like scene in which a model was enough; None: no scene is like."""

    def judged(advised):
        like = KnownScene("the like one", NUMBERS, "resolved yarns", {}, {})
        advice = advised and Advice(advised, like, None, 2)
        monkeypatch.setattr(models, "_fire", lambda name, *scene: FOUND[name])
        monkeypatch.setattr(models, "_describe", lambda *scene: NUMBERS)
        monkeypatch.setattr(models.model_choice, "find_advice", lambda numbers: advice)
        return models.compare(models=NAMES, velocities=[90.0, 95.0], at="60 us", fabric="S-728")

    return judged


def test_the_cheapest_model_is_near_in_energy_and_way_with_their_error(compare):
    found = compare(None)
    # the way decides of one element, and the energy would have let it pass
    assert found["off"]["membrane, 1 element"] == pytest.approx(6.0)
    assert found["off"]["membrane, 3 elements"] == pytest.approx(3.0)
    # sqrt(.3^2 + .4^2) = .5 of 42 J
    assert found["known"] == pytest.approx(100 * 0.5 / 42)
    assert found["cheapest"] == "membrane, 3 elements"
    assert found["cost_over_richest"] == pytest.approx(1 / 3)
    assert (found["nose"], found["plies"]) == (4.0, 2.0)


@pytest.mark.parametrize(
    ("advised", "verdict", "off", "cost"),
    [
        ("membrane, 1 element", "miss", 6.0, 1 / 3),
        ("membrane, 3 elements", "hit", 3.0, 1.0),
        ("resolved yarns", "dearer", 0.0, 3.0),
    ],
)
def test_advice_is_judged_by_what_the_runs_show(compare, advised, verdict, off, cost):
    found = compare(advised)
    assert (found["like"], found["advised"]) == ("the like one", advised)
    assert found["verdict"] == verdict
    assert found["off_of_advised"] == pytest.approx(off)
    assert found["cost_of_advised"] == pytest.approx(cost)


def test_a_scene_that_is_like_none_has_no_advice(compare):
    found = compare(None)
    assert (found["like"], found["advised"], found["verdict"]) == ("", "", "none is like it")
    assert np.isnan(found["off_of_advised"])
