"""Backings by name in an input file and in Python: their data stand for what is not given."""

from dataclasses import fields

import pytest

import weavecell as wc
from fabrics import backings
from fabrics.materials import load
from weavecell.scenes import impact

SCENE = {
    "fabric": {"name": "S-728"}, "projectile": {"name": "FSP 1.10 g", "strike_velocity": "100 m/s"},
    "panel": {"opening": "60 mm"}, "run": {"end_time": "50 us"},
}  # fmt: skip


@pytest.mark.parametrize("name", backings.list_names())
def test_a_name_is_its_material(name):
    made = wc.setup("S-728", 100.0, backing=name).backing.material
    for field in fields(made):
        assert getattr(made, field.name) == pytest.approx(getattr(backings.load(name), field.name), rel=1e-12)
    assert made != load("backing")
    assert name in wc.backings()


def test_a_key_beside_the_name_replaces_its_number():
    made = wc.setup("S-728", 100.0, backing={"material": "gelatine 10 %", "yield_stress": "0.1 MPa", "min_size": 2e-3})
    assert made.backing.material.yield_stress == 1e5
    assert made.backing.material.density == 1030
    assert made.backing.min_size == 2e-3


def test_the_data_stand_in_the_file():
    scene = impact.check(SCENE | {"backing": {"material": "Roma Plastilina No. 1"}}, None)
    assert scene.backing.rate_exponent == 0.15
    assert scene.backing.erosion_strain == float("inf")
    assert scene.backing.min_size is None
