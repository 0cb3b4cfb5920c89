"""No key of a lay-up is passed over: one that is set is refused by its name, or a shot that perforates has other bits.
`[fabric]` has one rule for all its keys: a ply that names its fabric takes only how cells are computed."""

import pytest

from fabrics.base.errors import InputError
from tests.scene_text import merged, table_of
from tests.weavecell.scenes.test_keys_of_models import (
    KEYS,
    NAMED,
    OF_FILES,
    OTHERWISE,
    SHOT,
    answer,  # noqa: F401
    answers,  # noqa: F401
    fire,
)
from tests.weavecell.scenes.test_keys_reach import row, with_value
from weavecell.scenes import build
from weavecell.scenes.impact import check

# the shot of `test_keys_of_models`, fast enough to go through
FAST = merged(
    SHOT,
    {
        "projectile": {"strike_velocity": "700 m/s"},
        "panel": {"opening": "12 mm"},
        "run": {"end_time": "4 us"},
    },
)
LAY_UPS = {
    "one named": {"panel": {"ply": [{"angle": "0 deg"}, {"name": "S-728"}]}},
    "all named": {"panel": {"ply": [{"name": "S-726"}, {"name": "S-728"}]}},
}
# of the first ply: its tables, and values that differ
PLY = {
    "panel.ply.name": "S-731",
    "panel.ply.file": "fabrics/catalogue/S-731.toml",
    "panel.ply.law": {"a": "0.03 mm", "b": "0.05 mm N^(1/3)"},
    "panel.ply.law.a": "0.035 mm",
    "panel.ply.law.b": "0.06 mm N^(1/3)",
    "panel.ply.law.form": "printed",
    "panel.ply.angle": "90 deg",
    "panel.ply.gap": "0.2 mm",
    "panel.ply.count": 2,
    "panel.ply.linear_density": "nominal",
    "panel.ply.weaving_damage.modulus": 0.9,
    "panel.ply.weaving_damage.strength": 0.7,
}
BESIDE = {
    "panel.ply.law.": {"law": {"a": "0.04 mm", "b": "0.055 mm N^(1/3)"}},
    "panel.ply.weaving_damage.": {"weaving_damage": {"source": "drawn", "strength": 0.9}},
}
# tables of which a key alone says too little
WHOLE = {
    "fabric.law": {"a": "0.03 mm", "b": "0.05 mm N^(1/3)"},
    "fabric.weaving_damage": {"source": "drawn", "strength": 0.8, "modulus": 0.9},
}
# a ply has one fabric, and a second key takes the place of the first
REPLACES = {"panel.ply.file": "name"}
PASSED = (
    "projectile.stl",
    "backing.",
    "panel.crossovers",
    "panel.boundary.",
    "panel.ply.weaving_damage.s",
)
CASES = [
    (lay_up, key)
    for lay_up in LAY_UPS
    for key in [*KEYS, *PLY]
    if key == "panel.ply.weaving_damage.strength" or not key.startswith((*PASSED, *OF_FILES))
]


def marks(lay_up, key):
    """What is computed by the same code, and the keys of which `test_keys_of_models` has a cheaper walk."""
    if not key.startswith(("panel.ply.", "fabric.")):
        return [pytest.mark.slow, pytest.mark.nightly]
    if lay_up == "all named" and key.startswith("panel.ply."):
        return [pytest.mark.slow]
    return []


WALK = [pytest.param(*case, marks=marks(*case)) for case in dict.fromkeys(CASES)]


def scenes(lay_up, key):
    """(Scene without a key, with it) of a lay-up."""
    base = merged(FAST, LAY_UPS[lay_up])
    if lay_up == "all named":
        del base["fabric"]["name"]
    if key.startswith("panel.ply."):
        first, last = base["panel"]["ply"]
        for head, beside in BESIDE.items():
            if key.startswith(head):
                first = merged(first, beside)
        if key in REPLACES:
            first = {}
        base = merged(base, {"panel": {"ply": [first, last]}})
        changed = with_value(base, key, PLY[key])
        if "law" in changed["panel"]["ply"][0] and key == "panel.ply.law":
            changed["panel"]["ply"][0]["law"] = PLY[key]
        if key in REPLACES and lay_up == "all named":
            base = merged(FAST, LAY_UPS[lay_up])
            del base["fabric"]["name"]
        return base, changed
    context, value = OTHERWISE.get(key) or row(key)[:2]
    # beside a lay-up there is no number of plies
    context = merged({}, context)
    for name in ("ply", "plies"):
        context.get("panel", {}).pop(name, None)
    context = {
        name: table for name, table in context.items() if name != "panel" or "ply" not in table
    }
    for table in WHOLE:
        if lay_up == "all named" and key.startswith(f"{table}."):
            return base, merged(base, table_of(table, WHOLE[table]))
    base = merged(base, context)
    return base, with_value(base, key, value)


@pytest.mark.parametrize("lay_up, key", WALK)
def test_a_key_is_refused_or_changes_the_shot(lay_up, key, answer):  # noqa: F811
    """With the second ply of another fabric; of a lay-up whose plies all name theirs too."""
    base, changed = scenes(lay_up, key)
    without = answer(fire, base)
    if isinstance(without, InputError):
        return
    found = answer(fire, changed)
    assert found != without
    if isinstance(found, InputError):
        wanted = [*key.split("."), NAMED.get(("pack", key))]
        # where all plies then name a fabric
        wanted += ["name"] if key == "panel.ply.file" else []
        # of which the plies follow
        wanted += ["ply"] if key == "panel.areal_density" else []
        assert (found.key or "").rpartition(".")[2] in wanted, found


# key of [fabric] = its value, which no ply takes where all name a fabric
OF_NONE = {
    "name": "S-728",
    "file": "fabrics/catalogue/S-731.toml",
    "linear_density": "effective",
    "law": "published",
    "weaving_damage": {"source": "drawn", "strength": 0.8},
    "bending": "1e-6 N m^2",
}


def test_a_law_that_no_ply_takes_is_refused():
    """The first ply has one of its own, the second another fabric."""
    plies = [{"law": "published"}, {"name": "S-728"}]
    law = {"a": "0.03 mm", "b": "0.05 mm N^(1/3)"}
    with pytest.raises(InputError, match=r"fabric\.law: must be left out"):
        check(merged(FAST, {"fabric": {"law": law}, "panel": {"ply": plies}}), None, "shot")
    check(merged(FAST, {"fabric": {"law": law}, "panel": {"ply": [{}, *plies]}}), None, "shot")


@pytest.mark.parametrize("key", OF_NONE)
def test_a_key_that_no_ply_takes_is_refused_at_its_default_too(key):
    scene = merged(FAST, LAY_UPS["all named"] | {"fabric": {key: OF_NONE[key]}})
    if key != "name":
        del scene["fabric"]["name"]
    with pytest.raises(InputError, match="names its fabric") as caught:
        check(scene, None, "shot")
    assert caught.value.key == f"fabric.{key}"


def test_a_ply_takes_its_own_data_and_that_of_fabric_alike():
    """Damage of a named ply is its own; a ply of [fabric] has that of [fabric], or its own in place of it."""
    damage = {"source": "drawn", "strength": 0.5}
    plies = [{"name": "S-728"}, {}, {"weaving_damage": {"source": "own", "strength": 0.7}}]
    scene = merged(FAST, {"fabric": {"weaving_damage": damage}, "panel": {"ply": plies}})
    lay_up = build.build(check(scene, None, "shot"), None, "s").lay_up
    plain = build.build(
        check(merged(FAST, {"panel": {"ply": plies[:1] * 2}}) | {"fabric": {}}, None, "shot"),
        None,
        "s",
    ).lay_up
    named, of_fabric, own = (ply.fabric.weave.warp.failure_strain for ply in lay_up)
    assert named == plain[0].fabric.weave.warp.failure_strain
    assert own / of_fabric == pytest.approx(0.7 / 0.5, rel=1e-12)
