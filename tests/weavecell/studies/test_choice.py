"""crossovers = "auto": pinned where the checks say that it is enough, else resolved, with the reason first."""

import json
from dataclasses import replace

import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from shellfabric.membrane import quality
from weavecell.studies import choice

SPHERE = {
    "projectile": {"shape": "sphere", "mass": "0.69 g", "diameter": "5.56 mm"},
    "opening": "40 mm",
    "crossovers": "auto",
    "zone": "8 mm",
}


def test_pinned_yarns_that_hold_are_enough():
    """60 m/s asks S-726 for a friction of 0.17; nothing else is run."""
    shot = wc.impact("S-726", "60 m/s", end_time="30 us", **SPHERE)
    assert shot.chosen == choice.PINNED_ENOUGH
    assert shot.target.setup.crossovers is shot.target.setup.instead is None
    assert choice.PINNED_ENOUGH in shot.headline()
    alone = wc.impact(
        "S-726", "60 m/s", end_time="30 us", **SPHERE | {"crossovers": "pinned", "zone": None}
    )
    assert shot.residual_velocity == alone.residual_velocity


@pytest.mark.filterwarnings("ignore::weavecell.DoubtfulResult")
def test_yarns_that_the_nose_parts_are_resolved_and_the_headline_says_why(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(
        """
[fabric]
name = "S-726"
[projectile]
shape = "sphere"
mass = "0.69 g"
diameter = "5.56 mm"
strike_velocity = "120 m/s"
[panel]
opening = "40 mm"
plies = 2
crossovers = "auto"
zone = "8 mm"
[run]
end_time = "16 us"
outputs = ["report"]
"""
    )
    shot = wc.impact(scene, out=tmp_path / "r")
    words = "yarns resolved: at 120 m/s a friction of 0.26 holds them, and theirs is 0.2 (pinned yarns: "
    assert words in shot.headline()
    assert shot.target.setup.crossovers.half_width == 8e-3
    assert shot.energies["crossover_friction"][-1] > 0
    assert json.loads((tmp_path / "r/summary.json").read_text())["chosen"] == shot.chosen
    assert words in (tmp_path / "r/report.html").read_text("utf-8")
    size = wc.size_of(scene)
    assert any("if the checks ask for resolved yarns, another" in line for line in size.assumed)


def test_yarns_that_unzip_are_resolved():
    setup = wc.setup(
        "S-720",
        "100 m/s",
        opening="60 mm",
        projectile={"mass": "15 g", "diameter": "13 mm", "edge_radius": "1 mm"},
        crossovers="auto",
    )
    unzip = replace(quality.indicator("unzipping", 3.0))
    assert choice.find_reason(setup, 100.0, [unzip]).startswith(
        "yarns resolved: pinned ones unzip, 3.00"
    )
    assert choice.find_reason(setup, 100.0, [quality.indicator("unzipping", 1.2)]) == ""
    resolved = choice.with_resolved(setup)
    assert (resolved.symmetry, resolved.crossovers) == ("whole", setup.instead)
    assert resolved.impact_point != (0.0, 0.0)


def test_what_cannot_choose_refuses_it():
    with pytest.raises(InputError) as caught:
        wc.setup("S-720", "100 m/s", opening="60 mm", crossovers="auto").target()
    assert (caught.value.key, caught.value.value) == ("crossovers", "auto")
    with pytest.raises(InputError):
        wc.v50("S-726", shots=4, batch=2, **SPHERE)
    with pytest.raises(InputError):
        wc.impact("S-726", "60 m/s", uncertainty=True, **SPHERE)
    with pytest.raises(InputError):
        wc.impact("S-726", "60 m/s", elements_per_crossover=2, **SPHERE)
