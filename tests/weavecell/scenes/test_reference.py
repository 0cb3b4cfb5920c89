"""Meanings and JSON Schemas of scene keys: complete, and the schemas accept the examples as they are written."""

import tomllib
from pathlib import Path

import pytest

from weavecell.scenes import coupon, impact

EXAMPLES = Path(__file__).parents[3] / "examples"
TYPES = {
    "string": str,
    "number": (int, float),
    "integer": int,
    "boolean": bool,
    "array": list,
    "object": dict,
}


@pytest.fixture
def reference(tool):
    return tool("reference_pages")


def problems(value, schema, root, at=""):
    """What a JSON Schema finds wrong with a value, for the part of the standard that the schemas of scenes use."""
    if "$ref" in schema:
        return problems(value, root["$defs"][schema["$ref"].rpartition("/")[2]], root, at)
    for kinds in (schema.get("anyOf"), schema.get("oneOf")):
        if kinds and all(problems(value, kind, root, at) for kind in kinds):
            return [f"{at}: {value!r} is of none of the types"]
    found = []
    kind = schema.get("type")
    kinds = tuple(
        TYPES[one] for one in ([kind] if isinstance(kind, str) else kind or ()) if one != "null"
    )
    if kinds and not isinstance(value, kinds):
        return [f"{at}: {value!r} is no {kind}"]
    if "enum" in schema and value not in schema["enum"]:
        found.append(f"{at}: {value!r} is none of {schema['enum']}")
    if isinstance(value, dict):
        known = schema.get("properties", {})
        found += [
            f"{at}.{name}: missing" for name in schema.get("required", ()) if name not in value
        ]
        if schema.get("additionalProperties") is False:
            found += [f"{at}.{name}: unknown" for name in value if name not in known]
        for name in set(value) & set(known):
            found += problems(value[name], known[name], root, f"{at}.{name}")
    if isinstance(value, list):
        parts = schema.get("prefixItems") or [schema.get("items", {})] * len(value)
        for each, part in zip(value, parts):
            found += problems(each, part, root, at)
    return found


@pytest.mark.parametrize(
    "file",
    sorted([*EXAMPLES.glob("*.toml"), *EXAMPLES.glob("coupons/*.toml")]),
    ids=lambda file: file.stem,
)
def test_the_schema_accepts_the_examples(reference, file):
    schema = reference.json_schema(
        coupon.CouponScene if file.parent.name == "coupons" else impact.Scene
    )
    assert problems(tomllib.loads(file.read_text("utf-8")), schema, schema) == []


@pytest.mark.parametrize(
    ("table", "key", "value"),
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
    assert len(problems(scene, schema, schema)) == 1
    diameter = schema["$defs"]["ProjectileTable"]["properties"]["diameter"]
    assert diameter["description"] == 'diameter [m]; a length above 0, such as "5.5 mm"'
