"""The study of slipping edges: what it reads off a shot, and its page."""

import numpy as np
import pytest

from fabrics.errors import InputError
from shellfabric.impact.simulation import ImpactSetup, run
from shellfabric.panel.boundary import Grip
from validation.published.edge_slip.__main__ import MARKS, gripped_rows, led_rows, markdown, write_page
from validation.published.edge_slip.study import SLIPPED, Shot, departs, of, weft


def shot(name, v, slip):
    t = np.linspace(0, 300e-6, 301)
    place = {"warp": np.linspace(0, 0.1, 11), "weft": np.linspace(0, 0.1, 11)}
    slips = {"warp": np.zeros(11), "weft": slip}
    return Shot(name, "clamped", "stopped", t, v(t), 300e-6, 0.02, 0 * t, slips, place, 0.1, 0.2, 15.0, 1e-3)


def test_what_is_read_off_a_shot():
    still = shot("clamped", lambda t: 100 - 3e5 * t, np.zeros(11))
    slip = np.maximum(2e-3 * (1 - np.linspace(0, 0.1, 11) / 0.03), 0)
    moved = shot("1 mm", lambda t: 100 - 3e5 * t + 1e5 * np.maximum(t - 100e-6, 0), slip)
    assert moved.pulled("weft") == pytest.approx(2e-3)
    assert moved.width("weft") == pytest.approx(0.04)  # yarns at 0, 10 and 20 mm have slipped by more than SLIPPED
    assert (moved.width("warp"), still.width("weft")) == (0.0, 0.0)
    assert departs(moved, still) == pytest.approx(105e-6, abs=1.5e-6)
    assert np.isnan(departs(still, still))
    rows = led_rows({"clamped": still, "1 mm": moved})
    assert len(rows) == 3
    assert len({len(row) for row in rows}) == 1
    assert len({len(row) for row in gripped_rows({"20 N": moved}, {"20 N": 100.0})}) == 1
    assert markdown(rows).count("\n") == 4


def test_the_page_keeps_what_is_around_its_marks(tmp_path):
    page = tmp_path / "a.md"
    page.write_text(f"before {MARKS[0]} old {MARKS[1]} after")
    write_page({"**T.**": [("a", "b"), ("1", "2")]}, page)
    text = page.read_text()
    assert text.startswith("before")
    assert text.endswith("after")
    assert "| 1 | 2 |" in text
    assert "old" not in text
    page.write_text("no marks")
    with pytest.raises(InputError):
        write_page({}, page)


def test_slip_follows_from_a_grip(fabric_s728):
    """The weaker the clamp, the further yarns slip and the wider the zone; the energy goes into the grips."""
    found = []
    for force in (15.0, 60.0):
        setup = ImpactSetup(fabric_s728, 60.0, edge=Grip(force), opening=0.06, table_size=61, end_time=120e-6)
        found.append(of(f"{force:g} N", run(setup)))
    weak, strong = found
    assert weak.pulled("weft") > strong.pulled("weft") > SLIPPED
    assert weak.width("weft") >= strong.width("weft")
    assert weak.balance < 5e-3
    assert min(weak.gripped, strong.gripped) > 0


def test_weft_alone_is_led():
    warp, led = weft(1e-3, 0.0, 1e-4)
    assert warp == "clamped"
    assert led.length == 1e-3


@pytest.fixture(scope="module")
def fabric_s728():
    from fabrics import catalogue

    return catalogue.load("S-728").with_effective_density()
