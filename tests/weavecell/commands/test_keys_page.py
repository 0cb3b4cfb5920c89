"""The examples of docs/reference.md, which `tools/pages.py` makes from the schema, are input files."""

import tomllib
from pathlib import Path

from fabrics.base.schema import tables
from weavecell.scenes import coupon, impact
from weavecell.scenes.fabric_table import check_scene


def test_the_examples_are_input_files(tool):
    """Those of all tables of an impact at once, then of each table in a table, and of each test of a coupon."""
    keys_page = tool("keys_page")
    found = {
        name: tomllib.loads(keys_page.about(table)[1])
        for name, table in tables(impact.Scene).items()
    }
    whole = {
        key: value
        for name, table in found.items()
        if "." not in name
        for key, value in table.items()
    }
    impact.check(whole, None)
    for name, table in found.items():
        if "." in name:
            first = next(iter(table))
            merged = whole | {first: whole[first] | table[first]}
            if "law" in table.get("fabric", ()):
                merged["fabric"] = table["fabric"] | {"name": "S-728"}
            if name == "panel.ply":
                del merged["panel"]["plies"]
            impact.check(merged, None)
    own = tables(coupon.CouponScene)
    for name in coupon.TESTS:
        example = tomllib.loads(keys_page.about(own[name])[1])
        check_scene(
            coupon.CouponScene, example | {"fabric": {"name": "S-728"}}, Path("coupon.toml")
        )
