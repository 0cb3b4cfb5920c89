"""The twelve single-ply outcomes in the captions of thesis Figures 5-4 to 5-15, with nothing fitted to them.

They hold with one element per crossover and a rigid projectile; with two and three elements 11 of them do
(docs/reports/published-shots.md).
"""

import pytest

from fabrics import catalogue
from shellfabric.impact.simulation import ImpactSetup, run
from validation.published.shots import CAPTIONS


def check(name, balance, **changes):
    """Both published shots on one fabric: the slower one is stopped, the faster one perforates."""
    for strike_velocity, expected in zip(CAPTIONS[name], ("stopped", "perforated")):
        result = run(ImpactSetup(catalogue.load(name).with_effective_density(), strike_velocity, **changes))
        assert result.outcome == expected, strike_velocity
        assert result.energy_error_max < balance


def test_s720():
    check("S-720", 5e-3)


@pytest.mark.slow(25)
@pytest.mark.parametrize("name", list(CAPTIONS)[1:])
def test_other_fabrics(name):
    check(name, 5e-3)


@pytest.mark.slow(25)
@pytest.mark.parametrize(
    "name",
    [
        *list(CAPTIONS)[:-1],
        pytest.param(
            "S-745",
            marks=pytest.mark.xfail(
                strict=True, reason="stops at 215 m/s, with yarns at 0.96 of their strength: its limit is 219.5 m/s"
            ),
        ),
    ],
)
def test_equilibrium_form(name):
    check(name, 1e-2, form="equilibrium")
