"""Bias and scatter of a quantity, and the validation uncertainty of a row. Of n rows with measured E_i and computed
M_i, ln(M / E) is taken as normal (FDS Validation Guide, chapter on errors):

    s^2 = 1 / (n - 1) sum (ln(M_i / E_i) - mean)^2,    sigma_M^2 = s^2 - sigma_E^2,
    bias = exp(mean + sigma_M^2 / 2 - sigma_E^2 / 2)

with relative sigmas of tests and model. sigma_E counts as s / 2^(1/2) at most: scatter cannot show that a model is more
accurate than the tests. One row has a bias, M / E, and no sigma. By ASME V&V 20 a row has E = S - D and
u_val^2 = u_num^2 + u_input^2 + u_D^2, and is within where E +- 1.645 u_val (90 %) holds 0,
or its outcome is that of the test.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import exp, nan, sqrt

import numpy as np
from scipy.stats import t as student

from fabrics.base.checks import FloatArray
from validation.values import rms

COVERAGE = 1.645  # u_val on either side that are the interval of 90 % which all answers have
MIDDLE = 0.6745  # that are the interval of 50 %
WITHIN = "within 90 %"  # column of measured-quantities.csv


@dataclass(frozen=True)
class Statistics:
    """Of a quantity: bias [-], relative sigma of the model (NaN of one row) and of the tests."""

    bias: float
    sigma_model: float
    sigma_test: float


def of(measured: Sequence[float], computed: Sequence[float], sigma: Sequence[float]) -> Statistics:
    """Compute the Statistics of a quantity.

    Parameters
    ----------
    measured, computed : (n,) above 0
    sigma : (n,) standard uncertainties of the tests, in the unit of `measured`
    """
    test = rms(np.divide(sigma, measured))
    logs = np.log(np.divide(computed, measured))
    if logs.size == 1:
        return Statistics(float(computed[0] / measured[0]), nan, test)
    scatter = float(logs.std(ddof=1))
    counted = min(test, scatter / sqrt(2))
    model = sqrt(scatter**2 - counted**2)
    return Statistics(exp(logs.mean() + (model**2 - counted**2) / 2), model, test)


def of_one_more(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Predict one more value from n alike: (mean, standard error), by Student's t. The error is such that COVERAGE of
    it on either side are the interval of 90 %.

    Parameters
    ----------
    values : (n, ...), n of 2 or more
    """
    n = len(values)
    wider = float(student.ppf(0.95, n - 1)) / COVERAGE
    spread = np.std(values, axis=0, ddof=1)
    return np.mean(values, axis=0), wider * sqrt(1 + 1 / n) * spread


def is_within(row: Mapping[str, str], coverage: float = COVERAGE) -> bool:
    """Tell whether a row of measured.csv that is computed is within; else a difference is shown."""
    if row["E_over_u_val"]:
        return abs(float(row["E_over_u_val"])) <= coverage
    return row["measured"] == (row["computed"] or row["coarse"])
