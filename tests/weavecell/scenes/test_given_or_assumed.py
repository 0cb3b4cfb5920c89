"""A key that is given alone takes away the assumption that it stands for, and no other; what would change nothing, or a
run in which nothing happens, is refused."""

from dataclasses import replace

import pytest

import weavecell as wc
from fabrics import assumed, data_sheet
from fabrics.base.assumed_number import is_assumed
from fabrics.base.errors import InputError
from tests.scene_text import merged
from tests.weavecell.scenes.test_keys_reach import ENTRIES, ROOT, SHOT, row, with_value
from weavecell.scenes import build
from weavecell.scenes.impact import check
from weavecell.studies import inputs, unknown

STRENGTHS = {"strength after weaving", "strength of the file"}
# {key: what is no longer drawn with it}
GIVES = {
    "projectile.friction": {"friction on the nose"},
    "projectile.name": {"friction on the nose"},
    "fabric.weaving_damage.strength": {"strength after weaving"},
    # tensions of a surface are those of yarns as they are
    "fabric.surface": STRENGTHS | {"modulus", "crimp of the warp", "crimp of the weft"},
    "panel.yarn_failure": STRENGTHS | {"failure length", "strength of yarns"},
}
# a table whose keys need another to be a table at all
BESIDE = {"fabric.weaving_damage": {"fabric": {"weaving_damage": {"source": "made up"}}}}
# a ply is no table of its own in the standard shot
KEYS = [key for key in ENTRIES if not key.startswith("panel.ply.")]


def assumed_of(scene):
    made = build.setup(build.build(check(scene, None, "shot"), None, "s"), None)
    return set(unknown.find_drawn(made, inputs.read_scatter()))


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


NOSES = ["FSP 1.10 g", "sphere 12 mm", "9 mm FMJ 8.0 g", None]
# frictions on the nose and between plies of a fabric of the catalogue, an own one of its fibre, and an own one of a
# fibre with frictions of its own
FABRICS = {
    "S-731": (0.1, 0.2),
    "glass-balanced": (0.1, 0.2),
    "mine": (0.1, 0.2),
    "carbon": (0.2, 0.25),
}


@pytest.fixture(scope="module")
def fabrics():
    """Load them; what has no law takes that of another, which no set-up reads here."""
    mine = wc.fabric(ROOT / "examples/fabrics/mine.toml")
    law = wc.fabric("S-720").laws
    own = {"mine": mine, "carbon": mine.with_yarns(E=230e9, fibre_density=1760.0)}
    loaded = {name: own.get(name) or wc.fabric(name) for name in FABRICS}
    return {name: replace(own, laws=own.laws or law) for name, own in loaded.items()}


@pytest.mark.parametrize("nose", NOSES)
@pytest.mark.parametrize("fabric", FABRICS)
@pytest.mark.parametrize("plies", [1, 3])
def test_no_nose_is_without_friction_unless_it_is_given(nose, fabric, plies, fabrics):
    """And each says what is assumed: the assumptions of the report, the lines of `--check` and of a result."""
    options = {"plies": plies, "opening": "60 mm"}
    if nose is not None:
        options["projectile"] = nose
    made = wc.setup(fabrics[fabric], 210.0, **options)
    friction = made.projectile.friction
    low, high = friction.span
    assert friction == FABRICS[fabric][0]
    assert low == 0 < friction < high
    assert made.projectile.assumptions[-1] == (
        f"Friction on the fabric {friction:g}, assumed 0 to {high:g}."
    )
    told = f"assumed: friction of the projectile {friction:g} (0.0 .. "
    assert [line for line in assumed.lines(made.fabric) if line.startswith(told)]
    given = wc.setup(fabrics[fabric], 210.0, **options | {"projectile": of_given(nose, 0.0)})
    assert given.projectile.friction == 0.0
    assert not is_assumed(given.projectile.friction)
    assert not any("friction of the projectile" in line for line in assumed.lines(given.fabric))


@pytest.mark.parametrize("fabric", FABRICS)
def test_no_plies_are_without_friction_unless_it_is_given(fabric, fabrics):
    """And one ply assumes none."""
    made = wc.setup(fabrics[fabric], 210.0, plies=3, opening="60 mm")
    low, high = made.ply_friction.span
    assert made.ply_friction == FABRICS[fabric][1]
    assert low < made.ply_friction < high
    told = f"assumed: friction between plies {made.ply_friction:g} ("
    assert [line for line in assumed.lines(made.fabric) if line.startswith(told)]
    given = wc.setup(fabrics[fabric], 210.0, plies=3, opening="60 mm", ply_friction=0.0)
    single = wc.setup(fabrics[fabric], 210.0, opening="60 mm")
    assert not is_assumed(given.ply_friction)
    for other in (given, single):
        assert not any("friction between plies" in line for line in assumed.lines(other.fabric))


def of_given(nose, friction):
    """Return a projectile, by its name or the standard one, with a friction that is given."""
    if nose is None:
        return {"mass": "3 g", "diameter": "5.5 mm", "edge_radius": "0.3 mm", "friction": friction}
    return {"name": nose, "friction": friction}


def test_a_hybrid_pack_assumes_the_friction_of_what_is_struck_in_the_range_of_all(fabrics):
    """0.1 of aramid, which is struck, up to 0.4 of carbon behind it."""
    shot = check(SHOT, None, "shot").projectile
    first = build.make_projectile(shot, fabrics["mine"], fabrics["carbon"])
    other = build.make_projectile(shot, fabrics["carbon"], fabrics["mine"])
    assert (first.friction, *first.friction.span) == (0.1, 0.0, 0.4)
    assert (other.friction, *other.friction.span) == (0.2, 0.0, 0.4)


def test_plies_of_a_hybrid_pack_assume_the_friction_of_the_first_in_the_range_of_all(tmp_path):
    """0.2 of aramid, or 0.25 of carbon: the order makes neither range narrower."""
    aramid = ROOT / "examples/fabrics/mine.toml"
    carbon = tmp_path / "carbon.toml"
    sheet = aramid.read_text("utf-8")
    for old, new in (("90 GPa", "230 GPa"), ("1.44 g", "1.76 g"), ("3.3 %", "1.58 %")):
        sheet = sheet.replace(old, new)
    carbon.write_text(sheet, "utf-8")
    for first, other, friction in ((aramid, carbon, 0.2), (carbon, aramid, 0.25)):
        law = {"a": "0.04 mm", "b": "0.05 mm N^(1/3)"}
        plies = [{"count": 2}, {"file": str(other), "law": law, "count": 3}]
        made = wc.setup(str(first), 210.0, law=law, opening="60 mm", ply=plies)
        assert (made.ply_friction, *made.ply_friction.span) == (friction, 0.1, 0.5)


def test_a_fabric_of_another_shot_is_marked_by_the_shot_that_it_is_in(fabrics):
    """Given, and then not given, and given again: a fabric is taken from one set-up to the next."""
    given = {"projectile": of_given(None, 0.17)}
    first = wc.setup(fabrics["S-731"], 90.0, **given)
    second = wc.setup(first.fabric, 90.0)
    third = wc.setup(second.fabric, 90.0, **given)
    name = data_sheet.FRICTION_OF_PROJECTILE
    assert [name in each.fabric.assumed for each in (first, second, third)] == [False, True, False]
    assert [float(each.projectile.friction) for each in (first, second, third)] == [0.17, 0.1, 0.17]
