"""Tests of a laboratory: read from a table, and held against computed shots."""

import numpy as np
import pytest
from scipy import stats

from shellfabric.impact.ballistic_limit import Limit, Shot
from weavecell.studies import compare

TABLE = """# a pack, made up
outcome, velocity [km/h], residual velocity [m/s]
PP, 360,
CP, 432, 40
complete, 468, 70
stopped, 396, 0
perforated, 504,
"""


def read(folder, text):
    (folder / "tests.csv").write_text(text)
    return compare.read(folder / "tests.csv")


def shot(velocity, residual):
    through = residual > 0
    return Shot(
        velocity, residual, "perforated" if through else "stopped", 1e-4, 0, (1.0, 1.0), 0.0, 0.0
    )


def test_a_table_is_read_in_any_unit_and_order(tmp_path):
    found = read(tmp_path, TABLE)
    np.testing.assert_allclose(found["velocity"], [100, 120, 130, 110, 140])
    assert [name[0] for name in found["outcome"]] == ["s", "p", "p", "s", "p"]
    np.testing.assert_array_equal(found["residual velocity"], [0, 40, 70, 0, np.nan])


def test_the_comparison_counts_outcomes_and_residuals(tmp_path):
    """Differences of known shots, their interval by Student's t as scipy has it, and V50 of the tests."""
    tests = read(tmp_path, TABLE)
    shots = [shot(v, r) for v, r in zip(tests["velocity"], (0.0, 44.0, 70.0, 15.0, 90.0))]
    found = compare.compare(tests, tuple(shots), Limit(104.0, 106.0, ()))
    assert found.agree == 4
    off = found.difference()
    assert (off["shots"], off["mean"], off["rms"]) == (2, 2.0, pytest.approx(np.sqrt(8)))
    interval = stats.ttest_1samp([4.0, 0.0], 0.0).confidence_interval(0.95)
    assert (off["low"], off["high"]) == pytest.approx((interval.low, interval.high))
    summary = found.summary()
    assert summary["tested_V50_m_s"] == pytest.approx(
        115.0
    )  # between 110, stopped, and 120, perforated
    assert summary["critical_velocity_over_V50"] == pytest.approx(105 / 115)
    low, high = summary["tested_V50_interval_m_s"]
    assert low < 115 < high
    assert found.tested is None  # two residual velocities determine no curve
    assert found.computed.limit == 105.0


def test_of_one_outcome_there_is_no_v50(tmp_path):
    tests = read(tmp_path, "velocity [m/s], outcome\n100, CP\n110, CP\n")
    found = compare.compare(tests, (shot(100.0, 20.0), shot(110.0, 40.0)), Limit(80.0, 81.0, ()))
    assert found.curve is None
    assert found.summary()["tested_V50_m_s"] is None
    assert found.difference()["mean"] is None
