"""Cards give the warp before the weft."""

import pytest

from tests import unlike
from weavecell.report import chapters


def test_a_card_of_a_fabric_gives_the_warp_before_the_weft():
    fabric = unlike.fabric()
    weave = fabric.weave
    lines = chapters.fabric_card(fabric).lines
    pairs = {
        "crimp": [100 * weave.warp.crimp, 100 * weave.weft.crimp],
        "yarn strength": [weave.warp.strength, weave.weft.strength],
    }
    for name, values in pairs.items():
        (line,) = (line for line in lines if line.startswith(name))
        told = line.removeprefix(name).rstrip(" %N").split("/")
        assert [float(each) for each in told] == pytest.approx(values, rel=0.01)
        assert values[0] != pytest.approx(values[1], rel=0.05)
    density, unit = lines[0].split(", ")[0].rsplit(" ", 1)
    factor = {"denier": 9e6, "dtex": 1e7, "tex": 1e6}[unit]
    told = [float(each) for each in density.split("/")]
    assert told == pytest.approx([factor * yarn.linear_density for yarn in weave.yarns], abs=0.51)
