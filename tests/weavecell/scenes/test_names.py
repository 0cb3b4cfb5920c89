"""Projectiles and backings by name: data that agree with each other, and stand for what is not given."""

from dataclasses import fields
from math import pi

import numpy as np
import pytest
from test_keys_reach import SHOT

import weavecell as wc
from fabrics import backings, projectiles
from fabrics.base.units import si
from fabrics.materials import load
from weavecell.scenes import build, impact

NAMES = projectiles.list_names()
GRAIN = 64.79891e-6  # [kg]
SHAPES = {"FSP": "chisel", "RCC": "flat", "sphere": "sphere"}
BULLETS = [name for name in NAMES if name.partition(" ")[0] not in SHAPES]
OF_STEEL = [name for name in NAMES if name not in BULLETS]


def scene(**keys):
    return impact.check(SHOT | {"projectile": {"strike_velocity": "90 m/s"} | keys}, "s.toml")


def made(**keys):
    return build.setup(build.build(scene(**keys), "s.toml", "s"), "s.toml").projectile


def volume(projectile):
    """[m3] of the closed surface that is drawn of it, from its facets by the divergence theorem."""
    rings = projectile.surface()
    a = rings[:-1, :-1]
    b = rings[1:, :-1]
    c = rings[1:, 1:]
    d = rings[:-1, 1:]
    return (
        sum(
            abs(np.einsum("ijk,ijk->ij", p, np.cross(q, r)).sum())
            for p, q, r in ((a, b, c), (a, c, d))
        )
        / 6
    )


def of_kind(kind):
    """Return the names of projectiles of a kind."""
    return [name for name in NAMES if name.startswith(f"{kind} ")]


@pytest.mark.parametrize("name", NAMES)
def test_a_projectile_has_the_shape_of_its_name(name):
    shape, _ = projectiles.entry(name)
    assert shape == made(name=name).shape == SHAPES.get(name.partition(" ")[0], "ogive")


@pytest.mark.parametrize("name", BULLETS)
def test_a_bullet_has_the_mass_of_its_name_and_of_its_drawing(name):
    """The drawing is assumed so that it does, within 1 %; as a rigid nose it has the same shape."""
    body = made(name=name)
    assert body.body == "metal"
    assert body.mass == pytest.approx(si(" ".join(name.split()[-2:]), "kg"), rel=0.005)
    assert body.drawing.density_factor == pytest.approx(1.0, abs=0.01)
    rigid = made(name=name, body="rigid")
    assert rigid.core is None
    assert (rigid.shape, rigid.length, rigid.mass) == (body.shape, body.length, body.mass)


@pytest.mark.parametrize("name", OF_STEEL)
def test_a_projectile_is_of_steel(name):
    """Within 1 %: facets have up to 0.3 % less volume, rounded edges up to 0.7 %, lengths three digits."""
    body = made(name=name)
    assert projectiles.density() == pytest.approx(7850)
    assert body.mass / volume(body) == pytest.approx(projectiles.density(), rel=0.01)


@pytest.mark.parametrize("name", of_kind("FSP"))
def test_a_fragment_simulator_has_mass_flat_and_tolerance_of_the_standard(name):
    body = made(name=name)
    _, data = projectiles.entry(name)
    assert body.mass == pytest.approx(si(name.partition(" ")[2], "kg"))
    assert body.flat_width / (2 * body.radius) == pytest.approx(0.47, abs=0.003)
    tolerance = si(data["mass_tolerance"]["value"], "kg")
    assert tolerance == pytest.approx(0.03 / 1.1 * body.mass, rel=0.03)


@pytest.mark.parametrize("name", of_kind("RCC"))
def test_a_right_circular_cylinder_has_its_grains_and_is_as_long_as_wide(name):
    body = made(name=name)
    assert body.mass == pytest.approx(float(name.split()[1]) * GRAIN, rel=1e-3)
    assert body.length == 2 * body.radius


@pytest.mark.parametrize(
    "name", [name for name in OF_STEEL if name.partition(" ")[0] not in ("FSP", "RCC")]
)
def test_a_sphere_has_its_diameter_and_the_mass_of_steel(name):
    body = made(name=name)
    diameter = si(name.partition(" ")[2], "m")
    assert 2 * body.radius == pytest.approx(diameter)
    assert body.mass == pytest.approx(projectiles.density() * pi / 6 * diameter**3, rel=1e-3)


def test_a_file_beside_the_input_file_is_a_projectile_by_name(tmp_path):
    """Its numbers with or without a source; keys of the input file go first."""
    mass = '{ value = "3.2 g", source = "scale", status = "measured" }'
    (tmp_path / "mine.toml").write_text(
        f"mass = {mass}\ndiameter = '6 mm'\nedge_radius = '0.3 mm'\n"
    )
    table = {"name": "mine.toml", "strike_velocity": "90 m/s", "diameter": "5 mm"}
    shot = impact.check(SHOT | {"projectile": table}, tmp_path / "s.toml").projectile
    assert (shot.mass, shot.diameter, shot.edge_radius) == pytest.approx((3.2e-3, 5e-3, 0.3e-3))


def test_what_is_given_goes_before_the_data_of_the_name():
    plain = made(name="FSP 1.10 g")
    other = made(name="FSP 1.10 g", mass="1.13 g", obliquity="10 deg", friction=0.2)
    assert (plain.mass, other.mass, other.friction) == pytest.approx((1.10e-3, 1.13e-3, 0.2))


def test_what_is_not_given_is_the_data_of_the_name():
    plain = made(name="FSP 1.10 g")
    other = made(name="FSP 1.10 g", mass="1.13 g", obliquity="10 deg", friction=0.2)
    for field in ("radius", "length", "flat_width"):
        assert getattr(other, field) == getattr(plain, field)


@pytest.mark.parametrize(
    "shape, kept",
    [
        ("hemisphere", ("mass", "radius", "length", "edge_radius")),
        ("sphere", ("mass", "radius")),
    ],
)
def test_another_nose_keeps_what_both_have(shape, kept):
    plain = made(name="FSP 1.10 g")
    other = made(name="FSP 1.10 g", shape=shape)
    for field in kept:
        assert getattr(other, field) == getattr(plain, field)
    assert other.flat_width is None
    assert (other.length is None) == ("length" not in kept)


def test_editors_do_not_ask_for_what_the_name_says(tool):
    table = tool("reference_pages").json_schema(impact.Scene)["$defs"]["ProjectileTable"]
    assert table["required"] == ["strike_velocity"]
    assert table["anyOf"] == [
        {"required": ["name"]},
        {"required": ["mass", "diameter"]},
        {"required": ["stl"]},
    ]


@pytest.mark.parametrize("name", backings.list_names())
def test_a_backing_is_its_material(name):
    """A key beside the name replaces its number."""
    material = wc.setup("S-728", 100.0, backing=name).backing.material
    other = wc.setup(
        "S-728", 100.0, backing={"material": name, "yield_stress": "0.1 MPa"}
    ).backing.material
    for field in fields(material):
        wanted = getattr(backings.load(name), field.name)
        assert getattr(material, field.name) == pytest.approx(wanted, rel=1e-12)
        assert getattr(other, field.name) == pytest.approx(
            1e5 if field.name == "yield_stress" else wanted, rel=1e-12
        )
    assert material != load("backing")
    assert name in wc.backings().index
    written = impact.check(SHOT | {"backing": {"material": name}}, None).backing
    assert written.rate_exponent == material.rate_exponent
    assert written.min_size == pytest.approx(1e-3)  # that of every block
