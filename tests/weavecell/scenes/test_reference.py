"""Meanings and JSON Schemas of scene keys: complete, and the schemas accept the examples as they are written."""

import tomllib
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

from weavecell.scenes import coupon, impact

EXAMPLES = Path(__file__).parents[3] / "examples"


@pytest.fixture
def reference(tool):
    return tool("reference_pages")


def problems(scene, schema):
    return [error.message for error in Draft202012Validator(schema).iter_errors(scene)]


@pytest.mark.parametrize(
    "file",
    sorted([*EXAMPLES.glob("*.toml"), *EXAMPLES.glob("coupons/*.toml")]),
    ids=lambda file: file.stem,
)
def test_the_schema_accepts_the_examples(reference, file):
    schema = reference.json_schema(
        coupon.CouponScene if file.parent.name == "coupons" else impact.Scene
    )
    assert problems(tomllib.loads(file.read_text("utf-8")), schema) == []


@pytest.mark.parametrize(
    "table, key, value",
    [
        ("projectile", "mass", 0.003),
        ("panel", "plies", "4"),
        ("run", "end", "1 us"),
        ("fabric", "cell_model", "rigid"),
    ],
)
def test_the_schema_rejects(reference, table, key, value):
    schema = reference.json_schema(impact.Scene)
    scene = tomllib.loads((EXAMPLES / "S-720-stops.toml").read_text("utf-8"))
    scene[table] = scene[table] | {key: value}
    assert len(problems(scene, schema)) == 1
    diameter = schema["$defs"]["ProjectileTable"]["properties"]["diameter"]
    assert diameter["description"] == 'diameter [m]; a length above 0, such as "5.5 mm"'
