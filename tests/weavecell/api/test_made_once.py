"""The set-up of a shot and its pack are made as seldom as can be, and what checks and forecasts asks these."""

from collections import Counter

import pytest

import weavecell as wc
from shellfabric.impact.setup import ImpactSetup
from shellfabric.plies.model import Pack

PACK = {"plies": 2, "boundary": "free"}


@pytest.mark.parametrize(
    "plies, setups, packs",
    [
        # the set-up as it is read, with resolved yarns, with frictions on nose and between yarns in the middle of
        # their ranges, struck on a yarn, and one with nothing chosen, from which a forecast says what differs; the
        # pack with no table filled, by which yarns are found to be resolved as asked, and that of the run
        ({}, 6, 2),
        # with the friction between plies; of the first two packs each once more, as its grids are shifted
        (PACK, 7, 4),
        # as it is read, with friction on the nose, and one with nothing chosen
        ({"crossovers": "pinned"}, 3, 1),
    ],
)
def test_a_shot_makes_its_set_up_and_its_pack_as_seldom_as_can_be(
    plies, setups, packs, monkeypatch
):
    made = Counter()
    for kind in (ImpactSetup, Pack):
        own = kind.__post_init__

        def count(self, kind=kind, own=own):
            made[kind] += 1
            own(self)

        monkeypatch.setattr(kind, "__post_init__", count)
    wc.impact("S-720", "92.5 m/s", opening="40 mm", end_time="6 us", check=True, **plies)
    assert made == {ImpactSetup: setups, Pack: packs}
