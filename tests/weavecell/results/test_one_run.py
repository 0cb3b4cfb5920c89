"""A single run says what it stands for that nobody gave, and which option answers over it, at what cost."""

from pathlib import Path

import pytest

import weavecell as wc
from weavecell.api import one_run
from weavecell.api.target import resolve_target

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning", "ignore::weavecell.DoubtfulResult")
EXAMPLES = sorted((Path(__file__).parents[3] / "examples").glob("*.toml"))
# of a body of metal no yarns are resolved
SILENT = {"body-armour.toml"}
# resolved yarns have a mesh of their own, an interval refines none
REFUSED = {
    "own-fabric.toml": "run.elements_per_crossover",
    "S-728-accuracy.toml": "accuracy",
}


def find(target, quantity="shot", **options):
    given = resolve_target(target, options, "shot", 120.0, function="impact", one_shot=True)
    return one_run.find_unknown(given, quantity)


def test_each_example_says_what_it_stands_for():
    assert len(EXAMPLES) > 12
    for path in EXAMPLES:
        target = resolve_target(str(path), {}, "shot", None, function="impact", one_shot=True)
        found = one_run.find_unknown(target, "shot")
        if path.name in SILENT:
            assert found is None
            continue
        assert "one run stands for unknown " in found.brief, path
        assert "friction between yarns (0.1 to 0.3)" in found.text
        if path.name in REFUSED:
            assert found.brief.endswith(f": interval=True refuses {REFUSED[path.name]}")
            continue
        assert ": interval=True answers over them, " in found.brief, path
        assert found.brief.endswith(" s of CPU time")


def test_what_is_given_is_not_unknown():
    sphere = {"shape": "sphere", "mass": "0.69 g", "diameter": "5.5 mm"}
    shot = {"opening": "60 mm", "projectile": sphere}
    found = find("S-728", **shot)
    assert "place (on a crossover or in a gap), friction between yarns (0.1 to 0.3)" in found.text
    assert "3 shots" in found.text
    yarns = shot | {"crossovers": "yarns"}
    known = yarns | {"crossover_friction": 0.2, "impact_point": ["0.1 mm", "0.4 mm"]}
    assert "unknown friction on the nose: " in find("S-728", **known).brief
    assert find("S-728", **known | {"projectile": sphere | {"friction": 0.1}}) is None
    # who asks for pinned yarns is not asked
    asked = resolve_target(
        "S-728", {**shot, "crossovers": "pinned"}, "shot", 120.0, function="impact"
    )
    assert asked.is_pinned
    assert one_run.find_unknown(asked, "shot") is None
    assert "16 shots" in find("S-720", "critical-velocity", opening="60 mm").brief


def test_headline_page_and_file_of_a_shot_and_of_a_limit_say_it():
    shot = wc.impact("S-720", "150 m/s", opening="44 mm", end_time="8 us")
    (words,) = [part.brief for part in shot.left_out if part.kind == one_run.KIND]
    assert shot.headline().endswith(words)
    assert words.startswith("one run stands for unknown friction between yarns")
    assert words in str(shot).splitlines()[0]
    limit = wc.critical_velocity(
        "S-720", tolerance="20 m/s", scan=False, residual_shots=0, opening="44 mm"
    )
    assert "one run stands for unknown friction between yarns" in limit.headline[1]
    assert one_run.KIND in {part.kind for part in limit.left_out}
