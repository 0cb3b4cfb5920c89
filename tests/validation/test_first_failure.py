"""The lowest strike velocity at which a yarn fails (`validation.cases.impact.first_failure`)."""

import pytest

from fabrics.base.errors import InputError
from shellfabric.impact.run import run_impact
from validation.cases import impact

SMALL = {"fabric": "S-720", "opening": "30.6 mm", "elements_per_crossover": 1}


def failed(velocity):
    """Whether a yarn fails in a shot to its end."""
    result = run_impact(impact.setup(velocity=velocity, end_time=500e-6, **SMALL))
    return result.failures[:, 0].sum() > 0


def test_a_yarn_fails_above_the_bracket_and_none_below_it():
    found = impact.first_failure(low=20.0, high=120.0, share=0.1, **SMALL)
    low, high = (found["velocity"] + side * found["half_width"] for side in (-1, 1))
    assert high / low <= 1.1
    assert (failed(low), failed(high)) == (False, True)
    assert 0 < found["error"] < 0.005


def test_ends_that_do_not_enclose_it_are_refused():
    for low, high in ((110.0, 120.0), (2.0, 3.0)):
        with pytest.raises(InputError, match="low"):
            impact.first_failure(low=low, high=high, **SMALL)
