"""Scenes: units as text become SI, defaults, relative paths, and what the examples say."""

import dataclasses
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import weavecell as wc
from fabrics.compression import CompressionLaw
from weavecell.report.shot import chapters_shot
from weavecell.results import provenance
from weavecell.scenes import build, of_commands, words
from weavecell.scenes import impact as scenes_impact

EXAMPLES = sorted((Path(__file__).parents[3] / "examples").glob("*.toml"))
TABLE = {
    "fabric": {"name": "S-720"},
    "projectile": {"mass": "3 g", "diameter": "5.5 mm", "edge_radius": "0.3 mm", "strike_velocity": "92.5 m/s"},
    "panel": {"opening": "203 mm"},
    "run": {"end_time": "250 us"},
}


def with_change(table, key, value):
    return TABLE | {table: TABLE[table] | {key: value}}


@pytest.mark.parametrize(
    ("table", "key", "text", "expected"),
    [
        ("projectile", "strike_velocity", "333 km/h", 92.5),
        ("projectile", "strike_velocity", "303.4776902887139 ft/s", 92.5),
        ("projectile", "mass", "0.003 kg", 3e-3),
        ("panel", "opening", "8 inch", 0.2032),
        ("run", "end_time", "0.25 ms", 2.5e-4),
        ("run", "end_time", "250 µs", 2.5e-4),
    ],
)
def test_any_unit_of_the_right_dimension(table, key, text, expected):
    got = scenes_impact.check(with_change(table, key, text), "scene.toml")
    assert getattr(getattr(got, table), key) == pytest.approx(expected, rel=1e-12)


def test_unit_of_the_law():
    law = {"a": "45 um", "b": "58 um N^(1/3)"}
    got = build.build(scenes_impact.check(with_change("fabric", "law", law), "s.toml"), "s.toml", "s")
    assert got.laws[0].a == pytest.approx(4.5e-5)
    assert got.laws[1].b == pytest.approx(5.8e-5)
    micro = scenes_impact.check(with_change("fabric", "law", {"a": "45 um", "b": "5.8 mm uN^(1/3)"}), "s.toml")
    assert micro.fabric.law.b == pytest.approx(5.8e-5)  # 1 mm uN^(1/3) = 1e-5 m N^(1/3) (erratum E-03)


def test_law_file_is_found_beside_the_scene(tmp_path):
    CompressionLaw(4.45e-5, 6.47e-5).to_json(tmp_path / "law.json")
    path = tmp_path / "scene.toml"
    got = build.build(scenes_impact.check(with_change("fabric", "law", "law.json"), path), path, "s")
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
        assert panel.table.model.form == form
        assert panel.table.model.region[0][1] == pytest.approx(1.0567, abs=1e-4)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_are_good_scenes(path):
    got, text = scenes_impact.load(path)
    build.build(got, path, path.stem)
    assert "weavecell impact examples/" + path.name in text


def test_what_a_lay_up_and_a_limit_need_not_say():
    """[fabric] where every ply names its own, and [run]; in Python the same."""
    plies = [{"name": "S-728"}, {"name": "S-726", "angle": "90 deg"}]
    table = {"projectile": TABLE["projectile"], "panel": {"opening": "203 mm", "ply": plies}}
    written = build.setup(build.build(scenes_impact.check(table, "s"), "s", "s"), "s")
    given = wc.setup(None, "92.5 m/s", ply=plies)
    assert written.title == given.title == "1 x S-728 + 1 x S-726 at 90 deg"
    assert written.end_time == given.end_time == 800e-6


def test_an_elastic_projectile_and_a_block_are_what_the_scene_says():
    changed = with_change("projectile", "body", "elastic_bar") | {
        "backing": {"modulus": "50 MPa", "standoff": "1 mm", "outer_boundary": "free"}
    }
    changed["projectile"]["bore_diameter"] = "4.8 mm"
    changed["panel"] = changed["panel"] | {"yarn_failure": False}
    setup = build.setup(build.build(scenes_impact.check(changed, "s"), "s", "s"), "s")
    assert setup.projectile.bar.mass == pytest.approx(3e-3)
    assert setup.projectile.bar.sections[1][1] == pytest.approx(np.pi / 4 * (5.5e-3**2 - 4.8e-3**2))
    assert (setup.backing.material.modulus, setup.backing.standoff, setup.backing.outer_boundary) == (5e7, 1e-3, "free")
    assert setup.backing.material.density == pytest.approx(3000)  # of Table 6-1, as all that is left out
    assert not setup.failure
    plain = build.setup(build.build(scenes_impact.check(TABLE, "s"), "s", "s"), "s")
    assert plain.projectile.bar is None
    assert plain.backing is None
    assert plain.failure


def setup_of(changes):
    table = {name: TABLE[name] | changes.get(name, {}) for name in TABLE}
    asked = scenes_impact.check(table, "s")
    return build.setup(build.build(asked, "s", "s"), "s"), asked


ASIDE, ON, PART, WINDOW = "weft off a crossover", "on a crossover", "symmetry can decide", "window possible"


@pytest.mark.parametrize(
    ("panel", "symmetry", "spacings", "notes"),
    [
        ({}, "whole", 0.25, [ASIDE]),
        ({"symmetry": "quarter"}, "quarter", 0.0, [PART, ON]),
        ({"symmetry": "half"}, "half", 0.0, [PART, ON]),
        ({"impact_point": ["0 mm", "0 mm"]}, "whole", 0.0, [ON]),
        ({"impact_point": ["1.27 mm", "-6.35 mm"]}, "whole", None, [ON]),  # crossovers of S-720 are 1.27 mm apart
        ({"crossover_friction": 0.14}, "whole", 0.25, [ASIDE, WINDOW]),
        ({"crossover_friction": 0.15}, "whole", 0.25, [ASIDE]),
        ({"plies": 2, "crossover_friction": 0.1}, "quarter", 0.0, [PART]),
        ({"crossovers": "pinned"}, "quarter", 0.0, []),
    ],
)
@pytest.mark.parametrize("support", [of_commands.IMPACT, of_commands.LIMITS], ids=["impact", "limits"])
def test_part_and_impact_point_of_sliding_plies(capsys, panel, symmetry, spacings, notes, support):
    """By default one sliding ply is computed whole and struck off a crossover; what is doubtful is said everywhere."""
    table = TABLE | {"panel": {"opening": "50 mm", "crossovers": "sliding"} | panel}
    setup = build.setup(build.build(scenes_impact.check(table, "s", support), "s", "s"), "s")
    assert setup.symmetry == symmetry
    drawn = scenes_impact.check(table, "s", of_commands.DRAWS).panel  # which draws compute whole anyway
    assert drawn.symmetry == ("whole" if drawn.crossovers == "sliding" and drawn.plies == 1 else symmetry)
    struck = replace(setup, table_size=11).target().plies[0].impact_point
    if spacings is not None:
        assert struck == pytest.approx([spacings * 2 * w for w in setup.fabric.weave.w])
    assert len(setup.notes) == len(notes)
    assert all(words in note for words, note in zip(notes, setup.notes))
    printed = [line for line in capsys.readouterr().out.splitlines() if "note" in line]
    assert printed == [f"note: {note}" for note in setup.notes]
    assert provenance.stamp(setup=setup).get("notes", "") == "; ".join(setup.notes)
    assert all(note[1:] in chapters_shot.assumptions(setup, ()).tables[0].rows[0][1] for note in setup.notes)


def test_shape_and_attitude_of_the_shot():
    chisel = {"shape": "chisel", "flat_width": "2.5 mm", "flat_angle": "35 deg", "length": "6.3 mm", "friction": 0.2}
    attitude = {"obliquity": "30 deg", "azimuth": "90 deg", "yaw": "-5 deg", "roll": "10 deg"}
    setup, asked = setup_of({"projectile": chisel | attitude, "panel": {"symmetry": "whole"}})
    shot = setup.projectile
    assert (shot.shape, shot.friction) == ("chisel", 0.2)
    assert (shot.radius, shot.flat_width, shot.length) == pytest.approx((2.75e-3, 2.5e-3, 6.3e-3))
    assert (shot.flat_angle, shot.obliquity, shot.azimuth, shot.yaw, shot.roll) == pytest.approx(
        tuple(math.radians(angle) for angle in (35, 30, 90, -5, 10))
    )
    told = words.shot_in_words(asked.projectile)
    assert told == "a chisel-nosed fragment simulator of 3 g and 5.5 mm, 30° off the normal, with friction 0.2"


def test_an_elastic_projectile_in_words():
    setup, asked = setup_of({"projectile": {"body": "elastic_bar"}})
    assert setup.projectile.bar is not None
    assert words.shot_in_words(asked.projectile).endswith("elastic-plastic along its axis")


def test_every_shape_of_the_solver_is_a_shape_of_scenes():
    from shellfabric.projectile.projectile import SHAPES

    assert list(scenes_impact.SHAPES) == list(SHAPES)


def test_a_sphere_has_no_edge():
    ball = {key: value for key, value in TABLE["projectile"].items() if key != "edge_radius"} | {
        "shape": "sphere",
        "mass": "1 g",
    }
    asked = scenes_impact.check(TABLE | {"projectile": ball}, "s")
    assert build.setup(build.build(asked, "s", "s"), "s").projectile.shape == "sphere"


def test_sides_and_weave_of_the_panel():
    from shellfabric.panel.boundary import Grip, PullIn

    pull = {"pull_in": "5 mm", "start": "200 us", "end": "650 us"}
    boundary = {"warp": ["clamped", {"clamp_force": "20 N"}], "weft": pull}
    setup, asked = setup_of({"panel": {"opening": ["203 mm", "100 mm"], "boundary": boundary, "symmetry": "whole"}})
    assert setup.opening == pytest.approx((0.203, 0.1))
    (low, high), weft = setup.edge
    assert (low, high) == ("clamped", Grip(20.0))
    assert isinstance(weft, PullIn)
    assert dataclasses.astuple(weft) == pytest.approx((5e-3, 200e-6, 650e-6, 60e-3))  # zone of the source
    told = words.panel_in_words(asked.panel)
    assert told == "203 mm by 100 mm, warp ends clamped / clamped with 20 N a yarn and weft ends slipping by 5 mm"
    for side, grip in (({"clamp_force": "5 N"}, Grip(5.0)), (pull, weft)):
        setup, asked = setup_of({"panel": {"boundary": side}})
        assert setup.edge == (grip, grip), "one side holds for all four"
    assert words.panel_in_words(asked.panel).endswith("warp ends slipping by 5 mm and weft ends slipping by 5 mm")
    setup, asked = setup_of({"panel": {"weave_angle": "45 deg", "symmetry": "whole"}})
    assert setup.weave_angle == pytest.approx(math.pi / 4)
    assert words.panel_in_words(asked.panel) == "203 mm square, its weave turned by 45° and clamped"
