"""A straight yarn struck across: the closed form, and the cable model's run of it."""

from math import sqrt

import numpy as np
import pytest

from fabrics import catalogue
from validation.models.cable.smith import smith, strike

YARN = catalogue.load("S-720").weave.warp
VELOCITIES = (50.0, 100.0, 200.0, 400.0)


@pytest.mark.parametrize("velocity", VELOCITIES)
def test_closed_form_keeps_momentum_and_geometry(velocity):
    wave = smith(YARN, velocity)
    # of yarn taken up by the kink, per second
    natural = wave.c * sqrt(wave.strain / (1 + wave.strain))
    assert wave.c == pytest.approx(sqrt(YARN.EA / YARN.linear_density))
    assert wave.U == pytest.approx(natural * (1 + wave.strain) - wave.c * wave.strain, rel=1e-12)
    assert np.hypot(wave.U, velocity) == pytest.approx(natural * (1 + wave.strain), rel=1e-12)
    assert wave.force == pytest.approx(2 * YARN.linear_density * natural * velocity, rel=1e-12)
    # the yarn arrives at the kink at W = c e and leaves it with none: the tension turns, and gives that momentum too
    turned = wave.tension * (1 - wave.U / np.hypot(wave.U, velocity))
    assert turned == pytest.approx(YARN.linear_density * natural * wave.c * wave.strain, rel=1e-9)


def test_strain_of_slow_impact():
    """e -> (V / c sqrt 2)^(4/3) as V -> 0."""
    wave = smith(YARN, 0.01)
    assert wave.strain == pytest.approx((0.01 / wave.c / sqrt(2)) ** (4 / 3), rel=1e-3)


@pytest.mark.parametrize("velocity", VELOCITIES)
def test_cable_model_is_smith_within_1_percent(velocity):
    """Measured with 2000 bars: strain, tension and U to 0.01 %, force 0.002 %, c 0.14 (400 m/s) to 0.54 % (50 m/s)."""
    run = strike(YARN, velocity)
    wave = smith(YARN, velocity)
    for name in ("strain", "tension", "U", "force"):
        assert getattr(run.computed, name) == pytest.approx(getattr(wave, name), rel=1e-3), name
    assert run.computed.c == pytest.approx(wave.c, rel=1e-2)
    assert abs(run.error) < 1e-5


def test_orders_of_convergence():
    """The kink's speed converges with the second order, the front's, which viscosity spreads, with the first."""
    wave = smith(YARN, 100.0)
    errors = []
    for bars in (500, 1000, 2000):
        measured = strike(YARN, 100.0, bars=bars).computed
        errors.append((abs(measured.U / wave.U - 1), abs(measured.c / wave.c - 1)))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert orders[:, 0] == pytest.approx(2.0, abs=0.15)
    assert orders[:, 1] == pytest.approx(1.0, abs=0.15)
