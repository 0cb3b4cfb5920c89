"""docs/reference/input.md is what its command writes, and has an entry for every key of every schema."""

import re
import sys
import tomllib
from pathlib import Path

import pytest

from weavecell.scenes import coupon, impact, supported

DOCS = Path(__file__).parents[3] / "docs"


@pytest.fixture
def keys_page(tool):
    return tool("keys_page")


@pytest.fixture
def entries(keys_page):
    """{key: its text} of the page; of [run], the one of impacts."""
    parts = re.split(r"^#### ", keys_page.page(), flags=re.MULTILINE)[1:]
    return {part.split("\n")[0]: re.split(r"\n##", part)[0] for part in reversed(parts)}


def test_the_page_is_up_to_date(keys_page):
    told = "python tools/keys_page.py"
    assert (DOCS / "reference" / "input.md").read_text(encoding="utf-8") == keys_page.page(), f"to renew it: {told}"


def test_every_key_has_an_entry(entries):
    for model in (impact.Scene, coupon.CouponScene):
        assert [key for key in supported.keys(model) if key not in entries] == []


def test_what_an_entry_says(entries):
    found = entries
    assert found["numerics.cfl"].startswith("numerics.cfl\n\nTime step over its stability bound (Courant factor).")
    assert "*Default:* 0.9. *Commands:* all." in found["numerics.cfl"]
    assert "*Unit:* m. *Default:* 0." in found["backing.standoff"]
    assert found["panel.ply_gap"].strip().endswith("*Commands:* all.")
    assert "refused by [accuracy]" in found["panel.crossovers"]
    assert (
        "*Default:* 0.0008. *Commands:* impact, [accuracy], sensitivity, export; ignored by limits."
        in (found["run.end_time"])
    )
    assert "*Commands:* coupon." in found["uniaxial.strain"]


def test_the_examples_are_input_files(keys_page):
    """Those of all tables of an impact at once, and of each test of a coupon."""
    found = {name: tomllib.loads(keys_page.about(table)[1]) for name, table in supported.tables(impact.Scene).items()}
    whole = {}
    for name, table in found.items():
        if "." not in name:
            whole |= table
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
    own = supported.tables(coupon.CouponScene)
    for name in coupon.TESTS:
        example = tomllib.loads(keys_page.about(own[name])[1])
        coupon.check(example | {"fabric": {"name": "S-728"}}, Path("coupon.toml"))


def test_the_command_writes_it(keys_page, tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["keys_page", str(tmp_path / "keys.md")])
    keys_page.main()
    assert (tmp_path / "keys.md").read_text(encoding="utf-8") == keys_page.page()
