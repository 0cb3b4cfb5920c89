"""Difference of V50 and the numbers of shots that decide it."""

from math import sqrt

import pytest

from weavecell.studies import paired


@pytest.mark.parametrize(("value", "low", "high"), [(4.0, -2.0, 9.0), (-3.0, -10.0, 2.5)])
def test_the_number_of_shots_that_would_decide(value, low, high):
    found = paired.Difference(value, low, high, 30, 0.9)
    needed = found.shots_to_decide()
    towards_zero = low if value > 0 else high
    left = value + (towards_zero - value) * sqrt(30 / needed)
    before = value + (towards_zero - value) * sqrt(30 / (needed - 1))
    assert left * value >= 0 > before * value
    rows = paired.forecast_widths(found, (needed - 1, needed, 4 * needed))
    assert rows[0][2] == paired.UNDECIDED
    assert rows[2][1] == pytest.approx(0.5 * rows[1][1])
    assert found.width_after(30) == pytest.approx(0.5 * (high - low))


def test_alike_panels_have_no_number_of_shots():
    assert paired.Difference(0.01, -8.0, 8.0, 40, 0.9).shots_to_decide() is None
