"""The compression law of the tension ratio: limits, and recovery of what made the samples."""

import numpy as np
import pytest

from fabrics.errors import InputError
from unitcell3d.identify.ratio_law import RatioLaw, imbalance

LAW = RatioLaw((np.log(20e-6), 0.2), 2.0)


def test_limits():
    for m in (-1.0, 0.0, 0.7):
        assert LAW.d(0.0, m) == LAW.d(-1.0, m) == 0
        assert LAW.d(1e-6, m) == pytest.approx(1e-6 * LAW.compliance(m), rel=1e-6)
        assert LAW.d(1e9, m) == pytest.approx(40e-6 * np.exp(0.2 * m), rel=1e-8)


def test_fit_finds_the_law_that_made_the_samples():
    F = np.tile(np.geomspace(0.05, 100, 12), 3)
    m = np.repeat([-0.8, 0.1, 0.9], 12)
    found = RatioLaw.fit(F, m, LAW.d(F, m))
    assert (*found.p, found.F0) == pytest.approx((*LAW.p, LAW.F0), abs=1e-5)
    assert found.residual_rms < 1e-10
    assert found.m_range == (-0.8, 0.9)
    straight = RatioLaw((np.log(20e-6), 0.2), np.inf)
    found = RatioLaw.fit(F, m, straight.d(F, m))
    assert found.F0 == np.inf
    assert found.p == pytest.approx(straight.p, abs=1e-5)


def test_imbalance():
    assert imbalance(np.array([1.0, 0.0, 3.0, 0.0, -0.1]), np.array([0.0, 2.0, 1.0, 0.0, 1.0])) == pytest.approx(
        [1, -1, 0.5, 0, -1]
    )


def test_too_few_samples():
    with pytest.raises(InputError, match="at least five samples"):
        RatioLaw.fit([1, 2, 0], [0, 0, 0], [1e-6, 2e-6, 0])
