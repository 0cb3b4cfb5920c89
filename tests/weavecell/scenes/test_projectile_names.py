"""Projectiles by name: data that agree with each other, and input files that name one."""

from math import pi

import numpy as np
import pytest
from test_keys_reach import SHOT

from fabrics import projectiles
from fabrics.units import si
from weavecell.scenes import build, impact, reference
from weavecell.scenes.words import shot_in_words

NAMES = projectiles.list_names()
SIMULATORS = [name for name in NAMES if name.startswith("FSP")]
GRAIN = 64.79891e-6  # [kg]


def scene(**keys):
    return impact.check(SHOT | {"projectile": {"strike_velocity": "90 m/s"} | keys}, "s.toml")


def made(**keys):
    return build.setup(build.build(scene(**keys), "s.toml", "s"), "s.toml").projectile


def volume(projectile):
    """[m3] of the closed surface that is drawn of it, from its facets by the divergence theorem."""
    rings = projectile.surface()
    a, b, c, d = rings[:-1, :-1], rings[1:, :-1], rings[1:, 1:], rings[:-1, 1:]
    return sum(abs(np.einsum("ijk,ijk->ij", p, np.cross(q, r)).sum()) for p, q, r in ((a, b, c), (a, c, d))) / 6


@pytest.mark.parametrize("name", NAMES)
def test_mass_over_volume_is_the_density_of_the_steel(name):
    """Within 1 %: facets have up to 0.3 % less volume, rounded edges up to 0.7 %; lengths have three digits."""
    body = made(name=name)
    assert body.mass / volume(body) == pytest.approx(projectiles.density(), rel=0.01)
    assert projectiles.density() == pytest.approx(7850)


@pytest.mark.parametrize("name", NAMES)
def test_every_number_has_a_source_and_a_status(name):
    shape, data = projectiles.entry(name)
    assert shape == {"FSP": "chisel", "RCC": "flat", "sphere": "sphere"}[name.split()[0]]
    for one in data.values():
        assert set(one) == {"value", "source", "status"}
        assert one["source"]
        assert one["status"] in projectiles.STATUSES


@pytest.mark.parametrize("name", NAMES)
def test_the_name_says_what_it_is(name):
    kind, _, size = name.partition(" ")
    body = made(name=name)
    if kind == "FSP":
        assert body.mass == pytest.approx(si(size, "kg"))
    elif kind == "RCC":
        assert body.mass == pytest.approx(float(size.split()[0]) * GRAIN, rel=1e-3)
        assert body.length == 2 * body.radius
    else:
        assert 2 * body.radius == pytest.approx(si(size, "m"))
        assert body.mass == pytest.approx(projectiles.density() * pi / 6 * si(size, "m") ** 3, rel=1e-3)


@pytest.mark.parametrize("name", SIMULATORS)
def test_fragment_simulators_are_alike(name):
    """One shape in seven sizes: within 3 % in the diameter, the strip 0.47 diameters, 1.1 to 1.25 diameters long."""
    body, middle = made(name=name), made(name="FSP 1.10 g")
    assert body.radius == pytest.approx(middle.radius * (body.mass / middle.mass) ** (1 / 3), rel=0.03)
    assert body.flat_width / (2 * body.radius) == pytest.approx(0.47, abs=0.003)
    assert 1.1 < body.length / (2 * body.radius) < 1.25
    tolerance = si(projectiles.entry(name)[1]["mass_tolerance"]["value"], "kg")
    assert tolerance == pytest.approx(0.03 / 1.1 * body.mass, rel=0.03)


def test_what_is_given_goes_before_the_data_of_the_name():
    plain, other = made(name="FSP 1.10 g"), made(name="FSP 1.10 g", mass="1.13 g", obliquity="10 deg", friction=0.2)
    assert (plain.mass, other.mass, other.friction) == pytest.approx((1.10e-3, 1.13e-3, 0.2))
    assert (other.radius, other.length, other.flat_width) == (plain.radius, plain.length, plain.flat_width)


@pytest.mark.parametrize(
    ("shape", "kept"), [("hemisphere", ("radius", "length", "edge_radius")), ("sphere", ("radius",))]
)
def test_another_nose_keeps_what_both_have(shape, kept):
    plain, other = made(name="FSP 1.10 g"), made(name="FSP 1.10 g", shape=shape)
    assert other.mass == plain.mass
    assert other.flat_width is None
    assert [getattr(other, key) for key in kept] == [getattr(plain, key) for key in kept]
    if shape == "sphere":
        assert other.length is None


def test_the_name_stands_in_words():
    assert shot_in_words(scene(name="FSP 2.79 g").projectile) == (
        "FSP 2.79 g, a chisel-nosed fragment simulator of 2.79 g and 7.49 mm"
    )


def test_editors_do_not_ask_for_what_the_name_says():
    table = reference.json_schema(impact.Scene)["$defs"]["ProjectileTable"]
    assert table["required"] == ["strike_velocity"]
    assert table["anyOf"] == [{"required": ["name"]}, {"required": ["mass", "diameter"]}, {"required": ["stl"]}]
