"""The answer over what nobody knows: which places and frictions are run, what decides, and its words."""

from dataclasses import replace

import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from shellfabric.impact.setup import Ply
from tests.scene_text import sphere_scene
from weavecell.studies import interval, places
from weavecell.studies.interval import Interval, Run
from weavecell.studies.places import CROSSOVER, GAP, ON_WARP, ON_WEFT, Places

SPHERE = {"shape": "sphere", "mass": "0.69 g", "diameter": "5.5 mm"}
YARNS, NOSE, PLIES = interval.FRICTIONS
TWO = {YARNS: (0.1, 0.3), NOSE: (0.0, 0.2)}
WIDE = {"shape": "sphere", "mass": "9 g", "diameter": "14 mm"}


def resolved(fabric="S-728", velocity=130.0, **keywords):
    keywords = {"opening": "60 mm", "projectile": SPHERE} | keywords
    return places.resolve(wc.setup(fabric, velocity, **keywords))


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize(
    ("keywords", "listed", "why"),
    [
        ({}, (CROSSOVER, GAP), ""),
        ({"projectile": "FSP 1.10 g"}, (ON_WARP, ON_WEFT), ""),
        ({"projectile": None}, (CROSSOVER, GAP), ""),
        ({"fabric": "S-726", "projectile": None}, (CROSSOVER,), "the flat nose is 6 yarns wide"),
        ({"projectile": WIDE}, (CROSSOVER,), "the nose is 9 yarns wide"),
        ({"projectile": "FSP 1.10 g", "plies": 2}, (CROSSOVER,), "2 plies are shifted"),
        ({"plies": 4}, (CROSSOVER, GAP), ""),
        ({"plies": 5}, (CROSSOVER,), "5 plies are shifted"),
        (
            {"crossovers": "yarns", "crossover_friction": 0.6},
            (CROSSOVER,),
            "a friction of 0.6 holds the yarns at 130 m/s",
        ),
        ({"crossovers": "yarns", "crossover_friction": 0.2}, (CROSSOVER, GAP), ""),
        # less is enough under a nose that is known to be rough; one that may have no friction asks for more
        ({"crossovers": "yarns", "crossover_friction": 0.22}, (CROSSOVER, GAP), ""),
        (
            {
                "crossovers": "yarns",
                "crossover_friction": 0.22,
                "projectile": SPHERE | {"friction": 0.1},
            },
            (CROSSOVER,),
            "a friction of 0.22 holds the yarns at 130 m/s",
        ),
    ],
)
def test_the_places_follow_from_nose_fabric_plies_and_friction(keywords, listed, why):
    found = places.choose_places(resolved(**keywords), 130.0)
    assert found.listed == listed
    assert why in found.why
    assert bool(found.why) == (len(listed) == 1)


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_place_is_struck_as_the_smallest_part_of_the_panel():
    """Of a fabric whose spacings of warp and weft differ."""
    sphere = resolved("S-726", opening="50 mm")
    w = sphere.fabric.weave.w
    assert w[0] != w[1]
    cases = [
        (CROSSOVER, (0.0, 0.0), "quarter"),
        (ON_WARP, (w[0], 0.0), "other half"),
        (ON_WEFT, (0.0, w[1]), "half"),
        (GAP, (w[0], w[1]), "whole"),
    ]
    for place, point, part in cases:
        struck = places.strike_at(sphere, place)
        assert struck.impact_point == pytest.approx(point)
        assert struck.symmetry == part
    # a ply at another angle than a right one mirrors itself nowhere
    fabric = sphere.fabric
    lay_up = (Ply(fabric), Ply(fabric, angle=0.4))
    pack = replace(sphere, plies=2, lay_up=lay_up)
    assert places.strike_at(pack, CROSSOVER).symmetry == "whole"
    # a nose that leans in the plane of the warp, edges that differ, a chisel that is rolled
    leaning = replace(sphere, projectile=replace(sphere.projectile, obliquity=0.3))
    assert places.strike_at(leaning, CROSSOVER).symmetry == "other half"
    unlike = replace(sphere, boundary=(("clamped", "free"), "clamped"), symmetry="whole")
    assert places.strike_at(unlike, CROSSOVER).symmetry == "whole"


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_only_frictions_that_nobody_gave_are_varied():
    assert interval.find_unknown(resolved()) == TWO
    nose = SPHERE | {"friction": 0.0}
    assert [*interval.find_unknown(resolved(projectile=nose))] == [YARNS]
    given = {"crossovers": "yarns", "crossover_friction": 0.2}
    assert [*interval.find_unknown(resolved(**given))] == [NOSE]
    assert [*interval.find_unknown(resolved(plies=2))] == [YARNS, NOSE, PLIES]
    assert [*interval.find_unknown(resolved(plies=2, ply_friction=0.22))] == [YARNS, NOSE]


def plan(unknown, struck):
    setup = resolved(opening="40 mm")
    first = interval.plan_first(setup, struck, unknown)
    more = interval.plan_more(setup, struck.listed[-1], unknown, first)
    for run in [*first, *more]:
        held = run.setup.crossovers.friction, run.setup.projectile.friction
        for name, value in zip((YARNS, NOSE), held):
            assert value == run.frictions.get(name, value)
    return [[(run.place, *run.frictions.values()) for run in runs] for runs in (first, more)]


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_each_place_is_struck_at_low_frictions_and_the_first_at_high_ones():
    both = Places((CROSSOVER, GAP))
    assert plan(TWO, both) == [
        [(CROSSOVER, 0.1, 0.0), (GAP, 0.1, 0.0), (CROSSOVER, 0.3, 0.2)],
        [(GAP, 0.3, 0.0), (GAP, 0.1, 0.2)],
    ]
    # where one friction is varied at one place, the first runs have both its ends
    one = {NOSE: (0.0, 0.2)}
    assert plan(one, Places((CROSSOVER,))) == [[(CROSSOVER, 0.0), (CROSSOVER, 0.2)], []]
    assert plan({}, both) == [[(CROSSOVER,), (GAP,)], []]


def shots(*rows, unknown=TWO, struck=(CROSSOVER, GAP), why=""):
    """An Interval of shots at 150 m/s: (place, friction between yarns, on the nose, what is left [m/s])."""
    runs = []
    for place, yarns, nose, left in rows:
        outcome = "perforated" if left > 0 else "stopped"
        frictions = dict(zip((YARNS, NOSE), (yarns, nose)))
        frictions = {name: value for name, value in frictions.items() if name in unknown}
        row = {"outcome": outcome, "residual_velocity_m_s": left, "checks": "ok"}
        runs.append(Run(place, frictions, row | {"strike_velocity_m_s": 150.0}))
    return Interval("shot", Places(struck, why), unknown, tuple(runs))


def test_runs_that_agree_are_the_answer():
    low = (CROSSOVER, 0.1, 0.0, -0.4), (GAP, 0.1, 0.0, -0.2)
    stopped = shots(*low, (CROSSOVER, 0.3, 0.2, 0.0))
    assert (stopped.agrees, stopped.outcome, stopped.decides) == (True, "stopped", ())
    varied = "friction between yarns 0.1 to 0.3, friction on the nose 0 to 0.2"
    assert stopped.words() == f"stopped wherever it strikes, {varied}"
    low = (CROSSOVER, 0.1, 0.0, 71.2), (GAP, 0.1, 0.0, 80.4)
    through = shots(*low, (CROSSOVER, 0.3, 0.2, 66.0))
    words = f"perforated wherever it strikes, 66.0 to 80.4 m/s left, {varied}"
    assert through.words() == words
    # 15.1 m/s are more than a tenth of 150 m/s
    assert not shots(*low, (CROSSOVER, 0.3, 0.2, 65.2)).agrees
    # a residual velocity of 3 m/s is near 0, and another outcome
    assert not shots((CROSSOVER, 0.1, 0.0, 3.0), (CROSSOVER, 0.3, 0.2, 0.0)).agrees


def test_what_moves_the_answer_by_half_of_the_interval_decides():
    low = (CROSSOVER, 0.1, 0.0, 0.0), (GAP, 0.1, 0.0, 61.0), (CROSSOVER, 0.3, 0.2, 0.0)
    place = shots(*low, (GAP, 0.3, 0.0, 52.0), (GAP, 0.1, 0.2, 44.0))
    assert place.effects == {"the place": 61.0, "friction on the nose": 17.0} | {
        "friction between yarns": 9.0
    }
    assert place.words() == (
        "stopped on a crossover, perforated in a gap with 44.0 to 61.0 m/s left: the place decides; "
        "`v50` gives the share"
    )
    assert (place.weakest, place.outcome) == (GAP, "depends")
    friction = shots(
        (CROSSOVER, 0.1, 0.0, 70.0),
        (GAP, 0.1, 0.0, 90.0),
        (CROSSOVER, 0.3, 0.2, 0.0),
        (GAP, 0.3, 0.0, 0.0),
        (GAP, 0.1, 0.2, 82.0),
    )
    assert friction.words() == (
        "stopped to perforated with 90.0 m/s left: friction between yarns decides; measure friction "
        "between yarns by a pull-out"
    )
    # nothing alone moves it by half: all that moves it, the most first
    together = shots(
        (CROSSOVER, 0.1, 0.0, 60.0),
        (GAP, 0.1, 0.0, 90.0),
        (CROSSOVER, 0.3, 0.2, 10.0),
        (GAP, 0.3, 0.0, 70.0),
        (GAP, 0.1, 0.2, 65.0),
    )
    assert together.decides == ("the place", "friction on the nose", "friction between yarns")
    assert together.words().startswith("perforated wherever it strikes, 10.0 to 90.0 m/s left: ")


def limits(*rows):
    """An Interval of limits: (place, friction between yarns, low, high [m/s] of the bracket)."""
    runs = []
    for place, yarns, low, high in rows:
        row = {"outcome": "no limit"}
        if low:
            row = {"outcome": "single limit", "lower_m_s": low, "upper_m_s": high}
        runs.append(Run(place, {YARNS: yarns}, row))
    return Interval("critical-velocity", Places((ON_WARP, ON_WEFT)), {YARNS: (0.1, 0.3)}, (*runs,))


def test_limits_that_differ_are_an_interval_with_what_decides():
    low = (ON_WARP, 0.1, 40.0, 43.0), (ON_WEFT, 0.1, 20.0, 23.0), (ON_WARP, 0.3, 124.0, 127.0)
    found = limits(*low, (ON_WEFT, 0.3, 120.0, 123.0))
    assert found.weakest == ON_WEFT
    assert found.words() == (
        "21.5 to 125.5 m/s: friction between yarns decides; measure friction between yarns by a pull-out"
    )
    alike = limits((ON_WARP, 0.1, 120.0, 123.0), (ON_WEFT, 0.1, 124.0, 126.0))
    words = "121.5 to 125.0 m/s wherever it strikes, friction between yarns 0.1 to 0.3"
    assert alike.words() == words
    lost = limits(*low, (ON_WEFT, 0.3, 0.0, 0.0))
    assert lost.words().endswith("; 1 of 4 runs: no limit")
    assert not limits((ON_WARP, 0.1, 0.0, 0.0)).agrees
    assert limits((ON_WARP, 0.1, 0.0, 0.0)).words() == "no run has a value: no limit"


RESOLVED = 'crossovers = "yarns"\nzone = "9 mm"'


@pytest.mark.filterwarnings("ignore::UserWarning", "ignore::weavecell.DoubtfulResult")
def test_the_answer_of_a_shot_is_written_told_and_resumed(tmp_path, monkeypatch, drawn_once):
    scene = tmp_path / "scene.toml"
    scene.write_text(sphere_scene("30 mm", "24 us", RESOLVED))
    size = wc.impact(scene, interval=True, check=True)
    assert (size.beside.shots, size.beside.more.shots) == (2, 2)
    assert "answer over what nobody knows: about 2 shots more; " in str(size)
    first = "on a crossover, friction between yarns 0.1, friction on the nose 0"
    assert f"described here is the first run: {first}" in str(size)
    assert "if these do not agree, about 2 shots more; " in str(size)
    found = wc.impact(scene, interval=True, out=tmp_path / "r")
    table = found.interval.to_dataframe()
    assert [*table["place"][:3]] == ["on a crossover", "in a gap", "on a crossover"]
    assert [*table["friction_between_yarns"][:3]] == [0.1, 0.1, 0.3]
    assert [*table["friction_on_nose"][:3]] == [0.0, 0.0, 0.2]
    assert [*table["modelled_part"][:3]] == ["quarter", "whole", "quarter"]
    assert table["residual_velocity_m_s"].nunique() == len(table)
    # the first run is the shot that is shown
    assert table["residual_velocity_m_s"][0] == found.residual_velocity
    assert table["max_deflection_m"][0] == found.max_deflection
    assert found.target.setup.symmetry == "quarter"
    # what the runs do not vary is named, without an option that an interval refuses
    (data,) = [part.text for part in found.left_out if part.kind == "assumed data"]
    assert "friction" not in data.replace("frictions are varied", "")
    assert "assumed-range" not in data.replace("_", "-")
    # each run alone is the shot that its row says
    run = wc.impact.plan(scene, interval=True).interval.first[2]
    alone = wc.impact(run.setup)
    assert alone.residual_velocity == pytest.approx(table["residual_velocity_m_s"][2], rel=1e-9)
    monkeypatch.setattr("weavecell.studies.sweep.shot", None)
    again = wc.impact(scene, interval=True, out=tmp_path / "r", resume=True)
    assert again.answer == found.answer
    assert again.read_from == tmp_path / "r"


@pytest.mark.parametrize(
    ("yarns", "options", "words"),
    [
        (
            'crossovers = "pinned"',
            {},
            "panel.crossovers = .pinned.: must be yarns, auto, or left out",
        ),
        (RESOLVED, {"uncertainty": True}, "left out of an interval"),
        (RESOLVED, {"interval": "close"}, "must be True, False or 'open'"),
        ('crossovers = "yarns"\nzone = "3 mm"', {}, "zone"),
    ],
)
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_what_an_interval_does_not_read_is_refused(tmp_path, yarns, options, words):
    scene = tmp_path / "scene.toml"
    scene.write_text(sphere_scene("30 mm", "24 us", yarns))
    with pytest.raises(InputError, match=words):
        wc.impact(scene, **{"interval": True, "check": True} | options)


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_point_that_is_given_is_the_only_place(tmp_path):
    scene = tmp_path / "scene.toml"
    point = RESOLVED + '\nimpact_point = ["0.3 mm", "0.5 mm"]'
    scene.write_text(sphere_scene("30 mm", "24 us", point))
    made = wc.impact.plan(scene, interval=True)
    assert [run.place.name for run in made.interval.first] == 2 * ["at the given point"]
    assert made.target.setup.impact_point == pytest.approx((0.3e-3, 0.5e-3))


def test_a_shot_says_where_it_strikes_in_spacings_along_warp_and_weft():
    """10.24 warp yarns and 10.63 weft yarns a cm: along the warp a spacing is 1/10.63 cm."""
    aimed = {"impact_point": ["0.3 mm", "0.6 mm"], "symmetry": "whole", "opening": "50 mm"}
    size = wc.impact("S-726", "80 m/s", crossovers="yarns", check=True, **aimed)
    said = "0.319 and 0.614 spacings beside the crossover in the middle, along warp and weft"
    assert any(said in line for line in size.lines())
