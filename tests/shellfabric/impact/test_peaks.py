"""Deflection, and time and place of the peak tension."""

from dataclasses import replace

import numpy as np
import pytest

from shellfabric.impact.simulation import run


@pytest.fixture
def shoot(shoot):
    """With a sample every microsecond."""
    return lambda *velocity, **changes: shoot(*velocity, **{"table_size": 51, "audit_interval": 1e-6} | changes)


@pytest.mark.parametrize("plies", [1, 2])
def test_deflection_is_that_of_the_last_ply(shoot, plies):
    result = shoot(60.0, plies=plies)
    nodes, rest = result.last[-1].nodes, 0.0 if plies == 1 else result.target.places[-1]
    assert result.deflection[-1] == pytest.approx(nodes[..., 2].max() - rest, rel=1e-12)
    assert result.deflection[0] == 0.0
    assert result.max_deflection == result.deflection.max()


def test_deflection_leaves_out_what_is_cut_out(shoot):
    """A plug that flies on with the projectile is no cloth of the panel any more."""
    result = shoot(600.0, end_time=100e-6)
    assert result.outcome == "perforated"
    assert result.max_deflection < 0.5 * result.last[0].nodes[..., 2].max()
    assert result.max_deflection < 0.5 * result.nose_position[-1]


@pytest.mark.parametrize("plies", [1, 3])
def test_peak_tension_has_its_time_and_place(shoot, plies):
    """Another run that ends at the peak's time finds the same peak there, and one a step shorter a lower one."""
    result = shoot(60.0, end_time=40e-6, plies=plies)
    setup = result.setup
    last = result.peaks[-1]
    peaks, times, places = last[:, 0], last[:, 1], last[:, 2:]
    dt, middle = result.step_history[0, 0], 0.25 * 0.0508
    for family in range(2):
        assert 0 < times[family] <= setup.end_time + dt
        assert np.all((places[family] >= 0) & (places[family] <= 2 * middle))
        until = run(replace(setup, end_time=times[family] - 0.5 * dt))
        short = run(replace(setup, end_time=times[family] - 1.5 * dt))
        assert until.peaks[-1, family, 0] == peaks[family]
        assert short.peaks[-1, family, 0] < peaks[family]
