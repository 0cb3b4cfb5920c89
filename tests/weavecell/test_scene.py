"""Scenes: units as text become SI, defaults, relative paths, and what the examples say."""

import dataclasses
import tomllib
from pathlib import Path

import pytest

from fabrics.compression import CompressionLaw
from weavecell import case, scene, toml_text

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.toml"))
TABLE = {
    "fabric": {"name": "S-720"},
    "projectile": {"mass": "3 g", "diameter": "5.5 mm", "edge_radius": "0.3 mm", "strike_velocity": "92.5 m/s"},
    "panel": {"opening": "203 mm"},
    "run": {"end_time": "250 us"},
}


def with_change(table, key, value):
    return TABLE | {table: TABLE[table] | {key: value}}


def test_units_become_si():
    got = scene.check(TABLE, "scene.toml")
    assert got.projectile.mass == pytest.approx(3e-3, rel=1e-15)
    assert got.projectile.diameter == pytest.approx(5.5e-3, rel=1e-15)
    assert got.projectile.strike_velocity == 92.5
    assert got.panel.opening == pytest.approx(0.203, rel=1e-15)
    assert got.run.end_time == pytest.approx(2.5e-4, rel=1e-15)


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
    got = scene.check(with_change(table, key, text), "scene.toml")
    assert getattr(getattr(got, table), key) == pytest.approx(expected, rel=1e-12)


def test_unit_of_the_law():
    law = {"a": "45 um", "b": "58 um N^(1/3)"}
    got = case.build(scene.check(with_change("fabric", "law", law), "s.toml"), "s.toml", "s")
    assert got.laws[0].a == pytest.approx(4.5e-5)
    assert got.laws[1].b == pytest.approx(5.8e-5)
    micro = scene.check(with_change("fabric", "law", {"a": "45 um", "b": "5.8 mm uN^(1/3)"}), "s.toml")
    assert micro.fabric.law.b == pytest.approx(5.8e-5)  # 1 mm uN^(1/3) = 1e-5 m N^(1/3) (erratum E-03)


def test_law_file_is_found_beside_the_scene(tmp_path):
    CompressionLaw(4.45e-5, 6.47e-5).to_json(tmp_path / "law.json")
    path = tmp_path / "scene.toml"
    got = case.build(scene.check(with_change("fabric", "law", "law.json"), path), path, "s")
    assert got.laws[0].b == pytest.approx(6.47e-5)
    assert "fitted" in got.law_name


def test_linear_density_is_a_choice():
    nominal = case.build(scene.check(with_change("fabric", "linear_density", "nominal"), "s"), "s", "s")
    effective = case.build(scene.check(TABLE, "s"), "s", "s")
    ratio = effective.fabric.weave.warp.linear_density / nominal.fabric.weave.warp.linear_density
    assert ratio == pytest.approx(1433 / 1420, rel=1e-12)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_are_good_scenes(path):
    got, text = scene.load(path)
    case.build(got, path, path.stem)
    assert "weavecell impact examples/" + path.name in text


def test_scene_as_text_reads_back():
    table = {"title": 'a "quoted" µ', **TABLE}
    table["run"] = TABLE["run"] | {"outputs": ["report"], "elements_per_crossover": 2}
    assert tomllib.loads(toml_text.dumps(table)) == table


def test_numerical_knobs_are_those_of_the_shell():
    from shellfabric.panel import Numerics

    known = {entry.name for entry in dataclasses.fields(Numerics)}
    assert set(scene.NumericsTable.model_fields) <= known
    knobs = {"penalty": 0.02, "safety": 0.5}
    asked = scene.check(TABLE | {"numerics": knobs}, "s")
    numerics = case.setup(case.build(asked, "s", "s"), "s").numerics
    assert (numerics.penalty, numerics.safety) == (0.02, 0.5)
    assert numerics.stretch_viscosity == Numerics().stretch_viscosity


def test_setup_is_what_the_scene_says():
    asked = scene.check(with_change("panel", "symmetry", "whole"), "s")
    setup = case.setup(case.build(asked, "s", "s"), "s")
    assert setup.symmetry == "whole"
    assert setup.projectile.radius == pytest.approx(2.75e-3)
    assert setup.opening == pytest.approx(0.203)
    assert setup.snapshot_interval == pytest.approx(1e-5)
