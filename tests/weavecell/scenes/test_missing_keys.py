"""All keys that a projectile lacks are named in one list: those of its shape and of pairs beside those of all."""

from itertools import chain, combinations

import pytest

from fabrics.base.errors import InputError
from fabrics.base.schema import validated
from weavecell.scenes.impact import ProjectileTable

ALL = {"mass": "8 g", "diameter": "9 mm", "strike_velocity": "150 m/s"}
EDGE = {"edge_radius": "0.2 mm"}
JACKET = {"jacket": "brass", "jacket_thickness": "0.4 mm"}
BULLET = {"shape": "ogive", "nose_length": "8 mm", "body": "metal"}
WHOLE = {
    "default": ALL | EDGE,
    "flat": ALL | EDGE | {"shape": "flat"},
    "hemisphere": ALL | EDGE | {"shape": "hemisphere"},
    "sphere": ALL | {"shape": "sphere"},
    "cone": ALL | EDGE | {"shape": "cone", "half_angle": "40 deg", "tip_radius": "0.6 mm"},
    "chisel": ALL | EDGE | {"shape": "chisel", "flat_width": "3 mm", "flat_angle": "35 deg"},
    "bullet": ALL | EDGE | BULLET | JACKET,
    "hollow point": ALL
    | EDGE
    | BULLET
    | {"tip_diameter": "4 mm", "cavity_diameter": "3 mm", "cavity_depth": "2 mm"},
}
FREE = {"shape", "body", "tip_diameter", "jacket", "cavity_diameter"}


def subsets(table):
    keys = [key for key in table if key not in FREE]
    return chain.from_iterable(combinations(keys, size) for size in range(len(keys) + 1))


@pytest.mark.parametrize("name", WHOLE)
def test_every_missing_key_is_named_at_once(name):
    table = WHOLE[name]
    for left_out in subsets(table):
        rest = {key: value for key, value in table.items() if key not in left_out}
        if not left_out:
            assert validated(ProjectileTable, rest, None).mass == 8e-3
            continue
        with pytest.raises(InputError) as refused:
            validated(ProjectileTable, rest, None)
        found = getattr(refused.value, "problems", [refused.value])
        assert {problem.key for problem in found} == set(left_out), left_out
        assert {problem.message for problem in found} == {"is missing"}


def test_what_else_is_wrong_stands_beside_them():
    table = {"shape": "cone", "mass": "8", "diametre": "9 mm", "half_angle": "40 deg"}
    with pytest.raises(InputError) as refused:
        validated(ProjectileTable, table, "mine.toml")
    lines = str(refused.value).splitlines()
    keys = [line.partition(": ")[2].partition(":")[0].partition(" =")[0] for line in lines]
    assert sorted(keys) == ["diametre", "edge_radius", "mass", "strike_velocity", "tip_radius"]
