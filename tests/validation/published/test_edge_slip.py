"""The study of slipping edges: what it reads off a shot, and its page."""

import numpy as np
import pytest

from fabrics import catalogue
from shellfabric.impact.simulation import ImpactSetup, run
from shellfabric.panel.boundary import Grip
from validation.published.edge_slip import SLIPPED, Shot, departs, gripped_rows, led_rows, of


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


def test_slip_follows_from_a_grip():
    """The weaker the clamp, the further yarns slip and the wider the zone; the energy goes into the grips."""
    fabric, found = catalogue.load("S-728").with_effective_density(), []
    for force in (15.0, 60.0):
        setup = ImpactSetup(fabric, 60.0, edge=Grip(force), opening=0.06, table_size=61, end_time=120e-6)
        found.append(of(f"{force:g} N", run(setup)))
    weak, strong = found
    assert weak.pulled("weft") > strong.pulled("weft") > SLIPPED
    assert weak.width("weft") >= strong.width("weft")
    assert weak.balance < 5e-3
    assert min(weak.gripped, strong.gripped) > 0
