"""Closures and pressures of a computed compression beside those of a curve, the offset of the closure free."""

import numpy as np
import pytest

from fabrics.base.errors import UnstableError
from fabrics.base.record import Record
from fabrics.plate_curve import PlateCurve
from unitcell3d.identify.platen_misfit import closures, platen_misfit


def history(pressure, plates):
    """A stand-in record of platens at half distances [m]; the mean of both platens' forces counts."""
    forces = np.stack([2 * pressure, 0 * pressure], axis=1) * 1e-6
    return Record({"F_plate": forces, "plates": plates}, {})


PRESSURES = np.geomspace(1e3, 1e6, 50)
PLACES = 2e-4 - 5e-6 * np.log(PRESSURES)  # plates close by 10 um per e-fold of pressure
PRESSED = history(PRESSURES, PLACES)
# the force falls for a step
SNAPPED = history(np.insert(PRESSURES, 25, PRESSURES[20]), np.insert(PLACES, 25, PLACES[24] - 1e-9))


@pytest.mark.parametrize("record", [PRESSED, SNAPPED], ids=["pressed", "snapped"])
def test_closures_are_moved_to_the_measured_ones_and_go_on_beyond_the_end(record):
    pressure = np.geomspace(1e4, 1e7, 9)
    measured = 1e-5 * np.log(pressure) + 3e-3
    assert closures(record, 1e-6, pressure, measured) == pytest.approx(measured, rel=1e-9)


def curve_of(shift=0.0, factor=1.0):
    """The stand-in's own curve from 10 kPa to 10 MPa, moved by `shift` [m], its pressures times `factor`."""
    pressure = np.geomspace(1e4, 1e7, 40)
    return PlateCurve(factor * pressure, 1e-5 * np.log(pressure) + shift, "closed form")


def test_an_offset_is_no_misfit_and_on_a_straight_curve_neither_is_a_factor_on_the_pressure():
    for curve in (curve_of(shift=3e-3), curve_of(factor=1.3)):
        found = platen_misfit(PRESSED, 1e-6, curve)
        assert found.closure < 1e-12
        assert found.pressure < 1e-5


def test_a_slope_that_is_wrong_is_a_misfit_of_both():
    """Twice the closure an e-fold: the misfit is 10 um ln P about its mean, and P computed goes as the square of P."""
    pressure = np.geomspace(1e4, 1e7, 40)
    curve = PlateCurve(pressure, 2e-5 * np.log(pressure), "twice as soft")
    at = np.geomspace(1e4, 1e7, 16)
    found = platen_misfit(PRESSED, 1e-6, curve, at)
    assert found.closure == pytest.approx(1e-5 * np.std(np.log(at)), rel=1e-3)
    # P computed / P measured = c P with the c that makes the rms of c P - 1 least
    c = at.sum() / (at**2).sum()
    assert found.pressure == pytest.approx(np.sqrt(np.mean((c * at - 1) ** 2)), rel=1e-3)


def test_platens_that_never_press():
    untouched = history(np.zeros(50), PLACES)
    with pytest.raises(UnstableError, match="never met"):
        platen_misfit(untouched, 1e-6, curve_of())
