"""The set-up of a shot and its pack are made once, and what checks and forecasts asks these."""

from collections import Counter

import pytest

import weavecell as wc
from shellfabric.impact.setup import ImpactSetup
from shellfabric.plies.model import Pack


@pytest.mark.parametrize("plies", [{}, {"plies": 2, "boundary": "free"}])
def test_a_shot_makes_its_set_up_and_its_pack_once(plies, monkeypatch):
    made = Counter()
    for kind in (ImpactSetup, Pack):
        own = kind.__post_init__

        def count(self, kind=kind, own=own):
            made[kind] += 1
            own(self)

        monkeypatch.setattr(kind, "__post_init__", count)
    wc.impact("S-720", "92.5 m/s", opening="40 mm", end_time="6 us", check=True, **plies)
    # a second set-up has nothing chosen: a forecast says what differs from it
    assert made == {ImpactSetup: 2, Pack: 1}
