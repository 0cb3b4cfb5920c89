"""Scenes: laws and surfaces, what need not be said, and a shot in words."""

import tomllib
from pathlib import Path

import pytest

import weavecell as wc
from fabrics.compression import CompressionLaw
from shellfabric.projectile import sdf_kernels
from shellfabric.projectile.shapes import SHAPES
from tests.scene_text import merged
from weavecell.scenes import build, words
from weavecell.scenes import impact as scenes_impact

TABLE = tomllib.loads("""
fabric.name = "S-720"
projectile = { mass = "3 g", diameter = "5.5 mm", edge_radius = "0.3 mm", strike_velocity = "92.5 m/s" }
panel.opening = "203 mm"
run.end_time = "250 us"
""")


def with_change(table, key, value):
    return TABLE | {table: TABLE[table] | {key: value}}


def test_unit_of_the_law():
    law = {"a": "45 um", "b": "5.8 mm uN^(1/3)"}  # 1 mm uN^(1/3) = 1e-5 m N^(1/3) (erratum E-03)
    got = build.build(
        scenes_impact.check(with_change("fabric", "law", law), "s.toml"), "s.toml", "s"
    )
    assert [(each.a, each.b) for each in got.laws] == 2 * [
        (pytest.approx(4.5e-5), pytest.approx(5.8e-5))
    ]


def test_law_file_is_found_beside_the_scene(tmp_path):
    CompressionLaw(4.45e-5, 6.47e-5).to_json(tmp_path / "law.json")
    path = tmp_path / "scene.toml"
    got = build.build(
        scenes_impact.check(with_change("fabric", "law", "law.json"), path), path, "s"
    )
    assert got.laws[0].b == pytest.approx(6.47e-5)
    assert "fitted" in got.law_name


def test_cell_from_a_surface():
    """A surface takes the place of the laws, in either form; the path is the scene's."""
    data = Path(__file__).parents[2] / "shellfabric" / "cell" / "data"
    for form in ("variational", "direct"):
        table = with_change("fabric", "surface", "S-720-coarse-9x9.h5")
        table["fabric"]["cell_formulation"] = form
        path = data / "scene.toml"
        panel = build.setup(build.build(scenes_impact.check(table, path), path, "s"), path).panel()
        assert panel.table.model.cell_formulation == form
        assert panel.table.model.region[0][1] == pytest.approx(1.0567, abs=1e-4)


def test_what_a_lay_up_and_a_limit_need_not_say():
    """[fabric] where every ply names its own, and [run]; in Python the same."""
    plies = [{"name": "S-728"}, {"name": "S-726", "angle": "90 deg"}]
    table = {"projectile": TABLE["projectile"], "panel": {"opening": "203 mm", "ply": plies}}
    written = build.setup(build.build(scenes_impact.check(table, "s"), "s", "s"), "s")
    given = wc.setup(None, "92.5 m/s", ply=plies)
    assert written.title == given.title == "1 x S-728 + 1 x S-726 at 90 deg"
    assert written.end_time == given.end_time == 800e-6


SAID = tomllib.loads("""
[[shot]]
projectile = { shape = "chisel", flat_width = "2.5 mm", flat_angle = "35 deg", obliquity = "30 deg", friction = 0.2 }
said = "a chisel-nosed fragment simulator of 3 g and 5.5 mm, 30° off the normal, with friction 0.2"
[[shot]]
projectile.body = "elastic_bar"
said = "a cylinder of 3 g and 5.5 mm, elastic-plastic along its axis"
[[shot]]
panel.opening = ["203 mm", "100 mm"]
panel.boundary.warp = ["clamped", { clamp_force = "20 N" }]
panel.boundary.weft = { pull_in = "5 mm", start = "200 us", end = "650 us" }
said = "clamped / clamped with 20 N a yarn and weft ends slipping by 5 mm"
[[shot]]
panel.weave_angle = "45 deg"
said = "203 mm square, its weave turned by 45° and clamped"
""")["shot"]


@pytest.mark.parametrize("shot", SAID, ids=[shot["said"] for shot in SAID])
def test_a_shot_in_words(shot):
    said = shot["said"]
    table = merged(TABLE, {key: part for key, part in shot.items() if key != "said"})
    asked = scenes_impact.check(merged(table, {"panel": {"symmetry": "whole"}}), "s")
    told = words.panel_in_words(asked.panel), words.shot_in_words(asked.projectile)
    assert told["projectile" in shot].endswith(said)


def test_shapes_have_the_order_of_their_numbers():
    assert [getattr(sdf_kernels, name.upper()) for name in SHAPES] == list(range(len(SHAPES)))
