"""docs/reference/input.md is what its command writes, and names every key of every schema."""

import sys
from pathlib import Path

from weavecell.commands import keys_page
from weavecell.scenes import coupon, impact, supported

DOCS = Path(__file__).parents[3] / "docs"


def test_the_page_is_up_to_date():
    told = "python -m weavecell.commands.keys_page docs/reference/input.md"
    assert (DOCS / "reference" / "input.md").read_text(encoding="utf-8") == keys_page.page(), f"to renew it: {told}"


def test_every_key_has_a_row():
    page = keys_page.page()
    for model in (impact.Scene, coupon.CouponScene):
        assert [key for key in supported.keys(model) if f"| `{key}` |" not in page] == []


def test_what_a_row_says():
    rows = {row.split("`")[1]: row.split(" | ") for row in keys_page.page().splitlines() if row.startswith("| `")}
    assert rows["numerics.cfl"][1:4] == ["time step over its stability bound (Courant factor)", "", "0.9"]
    assert rows["backing.standoff"][2:4] == ["m", "0"]
    assert rows["panel.ply_gap"][5:] == ["yes", "yes", "yes", "yes |"]
    assert rows["panel.grading"][5:7] == ["yes", "no"]
    assert rows["run.end_time"][3] == "required"


def test_the_command_writes_it(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["keys_page", str(tmp_path / "keys.md")])
    keys_page.main()
    assert (tmp_path / "keys.md").read_text(encoding="utf-8") == keys_page.page()
