"""The compression law of the tension ratio: limits, and recovery of what made the samples."""

import numpy as np
import pytest

from fabrics.errors import InputError
from fabrics.ratio_law import RatioLaw, imbalance

LAW = RatioLaw((np.log(40e-6), 0.2), (np.log(2.0), -0.5))


def test_at_one_ratio_it_is_the_regularised_law():
    F = np.array([0.0, 0.1, 3.0, 200.0])
    for m in (-1.0, 0.0, 0.7):
        assert LAW.d(F, m) == pytest.approx(LAW.at(m).d(F), rel=1e-12)


def test_fit_finds_the_law_that_made_the_samples():
    F = np.tile(np.geomspace(0.05, 100, 12), 3)
    m = np.repeat([-0.8, 0.1, 0.9], 12)
    found = RatioLaw.fit(F, m, LAW.d(F, m))
    assert (*found.p, *found.q) == pytest.approx((*LAW.p, *LAW.q), abs=1e-5)
    assert found.residual_rms < 1e-10
    assert found.m_range == (-0.8, 0.9)


def test_imbalance():
    assert imbalance(np.array([1.0, 0.0, 3.0, 0.0, -0.1]), np.array([0.0, 2.0, 1.0, 0.0, 1.0])) == pytest.approx(
        [1, -1, 0.5, 0, -1]
    )


def test_too_few_samples():
    with pytest.raises(InputError, match="at least five samples"):
        RatioLaw.fit([1, 2, 0], [0, 0, 0], [1e-6, 2e-6, 0])
