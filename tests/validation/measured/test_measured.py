"""Rows of what was measured, their statistics, and their coarse runs: as stored but for 2 % that round-off may do."""

from math import exp, sqrt

import pytest

from validation import study
from validation.measured import rows, statistics

KEPT = {row["id"]: row["coarse"] for row in study.read(study.DATA / "measured.csv")[1]}


def test_rows_have_a_source_and_a_number_or_a_reason():
    for row in rows.read():
        reason = row.assumed.startswith(("no model", "no data", "input"))
        assert row.source, row.id
        assert reason == (row.case is None), row.id
        assert reason or row.value, row.id


def test_bias_and_scatter_of_two_rows_and_of_one():
    """ln(M / E) of 0.3 and -0.1: mean 0.1, s^2 = 0.08; of tests of 10 % and of 30 %, which count as s / 2^(1/2)."""
    of = lambda sigma: statistics.of([1.0, 10.0], [exp(0.3), 10 * exp(-0.1)], [sigma, 10 * sigma])  # noqa: E731
    assert (of(0.1).sigma_model, of(0.1).bias) == pytest.approx((sqrt(0.07), exp(0.1 + 0.03)))
    assert (of(0.3).sigma_model, of(0.3).bias) == pytest.approx((sqrt(0.04), exp(0.1)))
    assert (
        str(statistics.of([2.0], [3.0], [0.2]))
        == "Statistics(bias=1.5, sigma_model=nan, sigma_test=0.1)"
    )


@pytest.mark.slow(180)
@pytest.mark.parametrize(
    "row", [row for row in rows.read() if row.coarse_case], ids=lambda row: row.id
)
def test_the_coarse_run_is_as_stored(row):
    value, _, error = rows.compute(row.coarse_case)
    assert value == (
        KEPT[row.id] if isinstance(value, str) else pytest.approx(float(KEPT[row.id]), rel=0.02)
    )
    assert error < 0.02
