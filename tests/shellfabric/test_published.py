"""The twelve published single-ply outcomes (thesis Figures 5-4 to 5-15), with nothing fitted to them."""

import pytest

from fabrics import catalogue
from shellfabric.impact import ImpactSetup, run

OUTCOMES = {
    "S-720": (92.5, 155.0),
    "S-726": (96.0, 174.0),
    "S-727": (40.0, 158.0),
    "S-728": (76.0, 170.0),
    "S-731": (116.0, 132.0),
    "S-745": (110.0, 215.0),
}


def outcome(name, strike_velocity):
    return run(ImpactSetup(catalogue.load(name).effective(), strike_velocity))


@pytest.mark.parametrize(("strike_velocity", "expected"), list(zip(OUTCOMES["S-720"], ("stopped", "perforated"))))
def test_s720(strike_velocity, expected):
    result = outcome("S-720", strike_velocity)
    assert result.outcome == expected
    assert result.worst_balance < 1e-2


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in OUTCOMES if name != "S-720"])
def test_other_fabrics(name):
    for strike_velocity, expected in zip(OUTCOMES[name], ("stopped", "perforated")):
        result = outcome(name, strike_velocity)
        assert result.outcome == expected, strike_velocity
        assert result.worst_balance < 1e-2
