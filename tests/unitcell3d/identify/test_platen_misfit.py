"""Closures and pressures of a computed compression beside those of a curve, the offset of the closure free."""

import numpy as np
import pytest

from fabrics.errors import UnstableError
from fabrics.plate_curve import PlateCurve
from unitcell3d.identify.platen_misfit import closures, platen_misfit


class Pressed:
    """A stand-in history: plates that close by 10 um per e-fold of pressure, up to 1 MPa."""

    pressure = np.geomspace(1e3, 1e6, 50)
    F_plate = (
        np.stack([2 * pressure, 0 * pressure], axis=1) * 1e-6
    )  # the mean of both plates counts
    plates = 2e-4 - 5e-6 * np.log(pressure)


class Snapped(Pressed):
    """The force falls for a step."""

    pressure = np.concatenate(
        [Pressed.pressure[:25], Pressed.pressure[20:21], Pressed.pressure[25:]]
    )
    F_plate = np.stack([2 * pressure, 0 * pressure], axis=1) * 1e-6
    plates = np.concatenate([Pressed.plates[:25], [Pressed.plates[24] - 1e-9], Pressed.plates[25:]])


@pytest.mark.parametrize("history", [Pressed, Snapped])
def test_closures_are_moved_to_the_measured_ones_and_go_on_beyond_the_end(history):
    pressure = np.geomspace(1e4, 1e7, 9)
    measured = 1e-5 * np.log(pressure) + 3e-3
    assert closures(history, 1e-6, pressure, measured) == pytest.approx(measured, rel=1e-9)


def curve_of(shift=0.0, factor=1.0):
    """The stand-in's own curve from 10 kPa to 10 MPa, moved by `shift` [m], its pressures times `factor`."""
    pressure = np.geomspace(1e4, 1e7, 40)
    return PlateCurve(factor * pressure, 1e-5 * np.log(pressure) + shift, "closed form")


def test_an_offset_is_no_misfit_and_on_a_straight_curve_neither_is_a_factor_on_the_pressure():
    for curve in (curve_of(shift=3e-3), curve_of(factor=1.3)):
        found = platen_misfit(Pressed, 1e-6, curve)
        assert found.closure < 1e-12
        assert found.pressure < 1e-5


def test_a_slope_that_is_wrong_is_a_misfit_of_both():
    """Twice the closure an e-fold: the misfit is 10 um ln P about its mean, and P computed goes as the square of P."""
    pressure = np.geomspace(1e4, 1e7, 40)
    curve = PlateCurve(pressure, 2e-5 * np.log(pressure), "twice as soft")
    at = np.geomspace(1e4, 1e7, 16)
    found = platen_misfit(Pressed, 1e-6, curve, at)
    assert found.closure == pytest.approx(1e-5 * np.std(np.log(at)), rel=1e-3)
    # P computed / P measured = c P with the c that makes the rms of c P - 1 least
    c = at.sum() / (at**2).sum()
    assert found.pressure == pytest.approx(np.sqrt(np.mean((c * at - 1) ** 2)), rel=1e-3)


def test_platens_that_never_press():
    class Untouched(Pressed):
        F_plate = np.zeros((50, 2))
        failed = ""

    with pytest.raises(UnstableError, match="never met"):
        platen_misfit(Untouched, 1e-6, curve_of())
