"""Numbers of cheap runs against those that are kept in tests/golden: of one ply, of a pack, of coupons.

The rest: `python tools/golden.py --check`. A wanted change is written by `python tools/golden.py`.
"""

import json

import pytest

# ten seconds of one core in all
CHEAP = (
    "impact-S-720-stops",
    "impact-own-fabric",
    "impact-S-728-pack",
    "coupon-S-720-frame",
    "coupon-S-720-warp",
    "coupon-S-726-pull-out",
)


@pytest.mark.parametrize("name", CHEAP)
def test_numbers_are_those_that_are_kept(name, tool):
    golden = tool("golden")
    run, source = golden.CASES[name]
    computed = golden.numbers(run(golden.EXAMPLES / f"{source}.toml"))
    kept = json.loads((golden.FOLDER / f"{name}.json").read_text())
    assert computed.keys() == kept.keys()
    off = [key for key in kept if not golden.same(kept[key], computed[key])]
    assert off == []
