"""A key that is given alone takes away the assumption that it stands for, and no other; what would change nothing, or a
run in which nothing happens, is refused."""

import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from tests.scene_text import merged
from tests.weavecell.scenes.test_keys_reach import ENTRIES, ROOT, SHOT, row, with_value
from weavecell.scenes import build
from weavecell.scenes.impact import check
from weavecell.studies import assumed_range

# {key: what is no longer assumed with it}
GIVES = {
    "projectile.friction": {"friction of the projectile"},
    "projectile.name": {"friction of the projectile"},
    "fabric.weaving_damage.strength": {"strength after weaving"},
    # tensions of a surface are those of yarns as they are
    "fabric.surface": {"strength after weaving"},
    "panel.yarn_failure": {"failure length", "strength after weaving"},
}
# a table whose keys need another to be a table at all
BESIDE = {"fabric.weaving_damage": {"fabric": {"weaving_damage": {"source": "made up"}}}}
# a ply is no table of its own in the standard shot
KEYS = [key for key in ENTRIES if not key.startswith("panel.ply.")]


def assumed_of(scene):
    made = build.setup(build.build(check(scene, None, "shot"), None, "s"), None)
    return set(assumed_range.changes(made))


@pytest.fixture(scope="module")
def usual():
    return assumed_of(SHOT)


@pytest.mark.parametrize("key", KEYS)
def test_a_key_given_alone_keeps_all_other_assumptions(key, usual, monkeypatch):
    monkeypatch.chdir(ROOT)
    table = key.rpartition(".")[0]
    try:
        # the key alone: not with the context in which other tests give it
        found = assumed_of(with_value(merged(SHOT, BESIDE.get(table, {})), key, row(key)[1]))
    except InputError:
        return
    assert usual - found <= GIVES.get(key, set())


def test_what_keys_give_is_assumed_without_them(usual):
    assert set().union(*GIVES.values()) - usual == set()


@pytest.mark.parametrize(
    "given, modulus, strength",
    [({}, 1.0, 0.94), ({"modulus": 0.97}, 0.97, 0.94), ({"strength": 0.97}, 1.0, 0.97)],
)
def test_a_share_after_weaving_that_is_not_given_stays_as_it_is(given, modulus, strength):
    fabric = wc.fabric(ROOT / "examples/fabrics/mine.toml")
    options = {}
    if given:
        options["weaving_damage"] = {"source": "made up", **given}
    law = {"a": "0.04 mm", "b": "0.05 mm N^(1/3)"}
    made = wc.setup(fabric, 150.0, law=law, **options).fabric.weave.warp
    plain = fabric.weave.warp
    assert (made.E / plain.E, made.strength / plain.strength) == pytest.approx((modulus, strength))


def test_a_slip_of_the_modulus_is_said_of_the_modulus():
    """It had made the yarns those of no family, and the line asked for [shear]."""
    fabric = wc.fabric(ROOT / "examples/fabrics/mine.toml")
    damage = {"modulus": 0.094, "strength": 0.94, "source": "made up"}
    law = {"a": "0.04 mm", "b": "0.05 mm N^(1/3)"}
    notes = wc.setup(fabric, 150.0, law=law, weaving_damage=damage).notes
    assert any("weaving_damage.modulus: share" in note and "is 0.094" in note for note in notes)


@pytest.mark.parametrize(
    "options, message",
    [
        ({"weaving_damage": {"source": "made up"}}, "weaving_damage.modulus: is missing; must be given, or strength"),
        ({"backing": {"standoff": "2 mm"}}, "backing.material: is missing; must be the name of a backing"),
        ({"end_time": "40 ns"}, "end_time = '0.04 us': must be at least 0.46 us, in which the nose moves a tenth of a"),
        ({"history": {"interval": "1 ns"}}, "interval = '0.001 us': must be from a time step, "),
        ({"history": {"interval": "70 us"}}, "to the end of the run, 60 us"),
        ({"snapshot_interval": "2 ns"}, "snapshot_interval = '0.002 us': must be at least a time step, "),
    ],
)  # fmt: skip
def test_what_would_do_nothing_is_refused(options, message):
    with pytest.raises(InputError) as refused:
        wc.impact("S-720", 150.0, check=True, opening="50 mm", **{"end_time": "60 us"} | options)
    assert message in str(refused.value)


def test_positions_beyond_the_edge_are_refused():
    scene = merged(SHOT, {"history": {"report_positions": ["5 mm", "140 mm"]}})
    with pytest.raises(
        InputError,
        match=r"history.report_positions = '?140 mm'?: must be within panel.opening .50 mm., at",
    ):
        build.setup(build.build(check(scene, None, "shot"), None, "s"), None)


@pytest.mark.parametrize(
    "times, told",
    [(0.98, "run.end_time: latest end"), (1.02, ""), (980, ""), (1020, "run.end_time: latest end")],
)
def test_an_end_before_or_long_after_the_wave_is_at_the_edge_is_told_and_run(times, told):
    """The nearest edge counts: 9 mm along the warp, 15 mm along the weft, from an aim off the middle."""
    weave = wc.fabric("S-731").weave
    counts = weave.warp_count, weave.weft_count
    speeds = [
        (yarn.E * yarn.A_s * n / weave.areal_density) ** 0.5 for yarn, n in zip(weave.yarns, counts)
    ]
    reached = min(0.009 / speeds[0], 0.015 / speeds[1])
    made = wc.setup(
        "S-731",
        150.0,
        opening=("26 mm", "32 mm"),
        impact_point=("4 mm", "1 mm"),
        symmetry="whole",
        end_time=times * reached,
    )
    notes = [note for note in made.notes if "run.end_time" in note]
    assert bool(notes) == bool(told)
    assert all(told in note for note in notes)
