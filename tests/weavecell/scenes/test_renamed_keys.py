"""Old names of scene keys are read with a warning that names the new one; the table that says so is true."""

import copy
import tomllib
from pathlib import Path

import pytest
from test_supported import SHOT, merged

from fabrics.errors import InputError
from weavecell.scenes import coupon as scenes_coupon
from weavecell.scenes import impact as scenes_impact
from weavecell.scenes import renamed_keys, supported

EXAMPLES = Path(__file__).parents[3] / "examples"
OLD = {  # a scene in the old names -> the same in the new ones
    "fabric": (
        {"fabric": {"cell_form": "equilibrium", "gap": "0.01 mm", "yarn_toe": "0.1 %"}},
        {"fabric": {"cell_formulation": "equilibrium", "crossover_gap": "0.01 mm", "fibre_slack": "0.1 %"}},
    ),
    "bar": (
        {"projectile": {"body": "bar", "bore": "4.5 mm"}},
        {"projectile": {"body": "elastic_bar", "bore_diameter": "4.5 mm"}},
    ),
    "panel": (
        {"panel": {"plies": 2, "gap": "0.1 mm", "yarns_fail": False}},
        {"panel": {"plies": 2, "ply_gap": "0.1 mm", "yarn_failure": False}},
    ),
    "sides": (
        {"panel": {"boundary": {"warp": {"grip": "20 N"}, "weft": ["clamped", {"grip": "30 N"}]}}},
        {"panel": {"boundary": {"warp": {"clamp_force": "20 N"}, "weft": ["clamped", {"clamp_force": "30 N"}]}}},
    ),
    "history": ({"measure": {"places": ["5 mm"]}}, {"history": {"report_positions": ["5 mm"]}}),
    "numerics": ({"numerics": {"safety": 0.5}}, {"numerics": {"cfl": 0.5}}),
    "backing": (
        {"backing": {"room": "1 mm", "far": "free", "finest": "2 mm", "fine": "9 mm"}},
        {"backing": {"standoff": "1 mm", "outer_boundary": "free", "min_size": "2 mm", "refined_depth": "9 mm"}},
    ),
}  # fmt: skip
OLD_COUPONS = {
    "picture_frame": ({"shear": "20 deg"}, {"shear_angle": "20 deg"}),
    "biaxial": ({"strain": ["1 %", "1 %"], "drawn": False}, {"strain": ["1 %", "1 %"], "cross_yarns_removed": False}),
}


@pytest.mark.parametrize("name", OLD)
def test_old_keys_of_an_impact_are_read_with_a_warning(name, capsys):
    old, new = OLD[name]
    assert scenes_impact.check(merged(SHOT, old), "s.toml") == scenes_impact.check(merged(SHOT, new), "s.toml")
    lines = capsys.readouterr().err.splitlines()
    assert all(line.startswith("warning: s.toml: ") for line in lines)
    told = {tuple(line.split(": ")[2].split(";")[0].split(" is now called ")) for line in lines}
    assert told <= {*renamed_keys.SCENE_KEYS.items(), ('projectile.body = "bar"', '"elastic_bar"')}
    assert len(told) == len(lines) > 0


@pytest.mark.parametrize("test", OLD_COUPONS)
def test_old_keys_of_a_coupon_are_read_with_a_warning(test, capsys):
    old, new = OLD_COUPONS[test]
    run = {"most_iterations": 100}
    base = {"fabric": SHOT["fabric"]}
    found = scenes_coupon.check(base | {test: old, "run": run}, "s.toml")
    assert len(capsys.readouterr().err.splitlines()) == 2
    assert found == scenes_coupon.check(base | {test: new, "run": {"max_iterations": 100}}, "s.toml")


def test_every_old_key_is_tested_and_none_is_a_key_of_today():
    tried = set()
    for old, _ in (*OLD.values(), *(({test: pair[0]}, None) for test, pair in OLD_COUPONS.items())):
        tried |= set(_paths(old))
    assert set(renamed_keys.SCENE_KEYS) <= tried | {"run.most_iterations"}
    today = {*supported.keys(scenes_impact.Scene), *supported.keys(scenes_coupon.CouponScene)}
    tables = {key.rpartition(".")[0] for key in today}
    assert not set(renamed_keys.SCENE_KEYS) & (today | tables)
    assert set(renamed_keys.SCENE_KEYS.values()) <= today | tables


def _paths(value, path=""):
    for part in value if isinstance(value, list) else [value]:
        if isinstance(part, dict):
            for name, inner in part.items():
                key = f"{path}.{name}" if path else name
                yield key
                yield from _paths(inner, key)


def test_old_and_new_key_together_are_an_error():
    table = merged(SHOT, {"numerics": {"safety": 0.5, "cfl": 0.5}})
    with pytest.raises(InputError, match=r"^s: numerics.safety: is the old name of numerics.cfl, which is given too$"):
        scenes_impact.check(table, "s")
    with pytest.raises(InputError, match=r"^s: measure: is the old name of history, which is given too$"):
        scenes_impact.check(merged(SHOT, {"measure": {}, "history": {}}), "s")


def test_a_scene_of_format_2_has_new_names_only(capsys):
    table = merged(SHOT, {"format": 2, "panel": {"yarns_fail": False}})
    with pytest.raises(InputError, match=r"panel.yarns_fail: is called panel.yarn_failure in a scene of format 2"):
        scenes_impact.check(table, "s")
    scenes_impact.check(merged(SHOT, {"format": 2}), "s")
    for other in (3, "2", True, [2]):
        with pytest.raises(InputError, match=r"s: format = .*: must be 1 or 2"):
            scenes_impact.check(merged(SHOT, {"format": other}), "s")
    assert capsys.readouterr().err == ""


def test_an_old_key_is_one_line_on_the_command_line(command, tmp_path):
    text = (EXAMPLES / "S-728-pack.toml").read_text().replace("ply_gap", "gap").replace('"0.12 mm"', '"-1 mm"')
    (tmp_path / "old.toml").write_text(text)
    code, out, err = command("impact", "old.toml")
    assert (code, out) == (2, "")
    assert err.splitlines() == [
        "warning: old.toml: panel.gap is now called panel.ply_gap; the old name is read until the next release",
        """error: old.toml: panel.ply_gap = '-1 mm': must be a length of at least 0, such as "0.12 mm\"""",
    ]


@pytest.mark.parametrize("path", sorted([*EXAMPLES.glob("*.toml"), *EXAMPLES.glob("coupons/*.toml")]), ids=str)
def test_examples_have_no_old_key(path, capsys):
    table = tomllib.loads(path.read_text(encoding="utf-8"))
    assert renamed_keys.upgraded(copy.deepcopy(table), path) == table
    assert capsys.readouterr().err == ""
