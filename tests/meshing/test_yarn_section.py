"""Yarn sections: areas in closed form, the cut of the tips, the order of the meshed area."""

import numpy as np
import pytest
from scipy.integrate import quad, trapezoid

from meshing.section import KINDS, Section

WIDTH, AREA = 1.27e-3, 1.6e-7


@pytest.mark.parametrize("tip_thickness_ratio", [0.02, 0.1, 0.5])
@pytest.mark.parametrize("kind", KINDS)
def test_area_is_the_integral_of_the_thickness(kind, tip_thickness_ratio):
    section = Section.of_area(kind, WIDTH, AREA, tip_thickness_ratio)
    integral, _ = quad(lambda y: 2e6 * section.half_thickness(y), -section.half_width, section.half_width)
    assert section.area == pytest.approx(AREA, rel=1e-14)
    assert integral * 1e-6 == pytest.approx(AREA, rel=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_the_cut_has_the_asked_share_of_the_thickness(kind):
    section = Section(kind, WIDTH, 2e-4, 0.08)
    assert 2 * section.half_thickness(section.half_width) == pytest.approx(0.08 * 2e-4, rel=1e-12)
    assert 2 * section.half_thickness(0.0) == 2e-4
    assert section.half_thickness(-1e-4) == section.half_thickness(1e-4)


@pytest.mark.parametrize("kind", KINDS)
def test_meshed_area_converges_with_order_two(kind):
    section = Section.of_area(kind, WIDTH, AREA, 0.075)
    errors = []
    for n in (12, 24, 48):
        y = section.stations(n)
        assert y[0] == 0
        assert y[-1] == section.half_width
        assert np.all(np.diff(y) > 0)
        errors.append(AREA - 4 * trapezoid(section.half_thickness(y), y))
    assert np.all(np.array(errors) > 0)
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.1)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2, abs=0.05)
