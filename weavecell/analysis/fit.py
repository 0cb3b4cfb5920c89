"""Parameters of a model fitted to a measured curve by least squares, with what the curve determines of them.

Unknowns are u = (value - low) / (high - low), from 0 to 1. The misfit of a point is computed less measured, over the
largest measured value of its column. Its Jacobian J is by central differences of `STEP` in u, one-sided at the bounds;
the minimum by scipy's trust region.

Intervals follow from the covariance s^2 (J^T J)^-1 with Student's t of n - p degrees of freedom, s^2 the mean square
misfit. They hold for scatter. Where the model cannot follow the curve, neighbouring misfits are alike: with r their
correlation, s^2 is multiplied by (1 + r) / (1 - r), the variance of a mean over a first-order autoregressive series
(G. E. P. Box, G. M. Jenkins, Time Series Analysis, 1970, chapter 2).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from fabrics.checks import FloatArray
from fabrics.errors import InputError, UnstableError
from unitcell3d.identify.least_squares import identify

STEP = 0.02  # of a range, to each side; smaller ones are lost among yarns that fail a step earlier or later
CONVERGED, MOST = 1e-3, 30  # change of the unknowns and of the sum of squares; evaluations
TOGETHER = 0.95  # correlation beyond which two parameters are known only together


@dataclass(frozen=True)
class Parameter:
    """A number that is fitted.

    Parameters
    ----------
    name : of a key of an input file, or of a factor on a fabric
    unit : SI; "" of a factor
    low, high, start : where it is sought, and from where
    """

    name: str
    unit: str
    low: float
    high: float
    start: float

    def __post_init__(self):
        if not self.low < self.high:
            raise InputError(
                key=self.name, value=f"{self.low:g}..{self.high:g}", allowed="a range LOW..HIGH that rises"
            )
        if not self.low <= self.start <= self.high:
            text = f"{self.low:g}..{self.high:g}"
            raise InputError(key=self.name, value=text, allowed=f"a range about {self.start:g}, where the fit begins")


@dataclass(frozen=True, eq=False)
class Fit:
    """What a fit found.

    Parameters
    ----------
    parameters : (p,) of Parameter
    values : (p,) fitted, in SI units
    half : (p,) half widths of the 95 % intervals
    correlation : (p, p) of the parameters
    measured, before, computed : (n,) points; computed at the start and at the end
    scale : (n,) by which misfits are divided
    likeness : [-] correlation of neighbouring misfits, at least 0
    met : converged within `MOST` evaluations
    """

    parameters: tuple[Parameter, ...]
    values: FloatArray
    half: FloatArray
    correlation: FloatArray
    measured: FloatArray
    before: FloatArray
    computed: FloatArray
    scale: FloatArray
    likeness: float
    met: bool

    @property
    def intervals(self) -> list[tuple[float, float]]:
        """(low, high) of each parameter, 95 %, no wider than where it was sought."""
        ends = zip(self.parameters, self.values - self.half, self.values + self.half)
        return [(max(one.low, low), min(one.high, high)) for one, low, high in ends]

    @property
    def determined(self) -> list[bool]:
        """Whether the interval of each excludes its half and its double, and leaves half of its range at least."""
        return [
            bool(half < 0.5 * abs(value) and 2 * half < 0.5 * (one.high - one.low))
            for one, value, half in zip(self.parameters, self.values, self.half)
        ]

    @property
    def at_bound(self) -> list[bool]:
        """Whether each ended where it was not sought further."""
        shares = ((value - one.low) / (one.high - one.low) for one, value in zip(self.parameters, self.values))
        return [bool(share < 1e-3 or share > 1 - 1e-3) for share in shares]

    @property
    def together(self) -> list[tuple[str, str, float]]:
        """(name, name, correlation) of the parameters that the data know only together."""
        names, p = [one.name for one in self.parameters], len(self.parameters)
        pairs = ((i, j) for i in range(p) for j in range(i))
        return [
            (names[j], names[i], float(self.correlation[i, j]))
            for i, j in pairs if abs(self.correlation[i, j]) > TOGETHER
        ]  # fmt: skip

    def rms(self, computed: FloatArray) -> float:
        """[-] root mean square misfit over the scale."""
        return float(np.sqrt(np.mean(((computed - self.measured) / self.scale) ** 2)))

    def summary(self) -> dict[str, Any]:
        """All of it as plain numbers in SI units."""
        rows = zip(self.parameters, self.values, self.intervals, self.determined, self.at_bound)
        return {
            "parameters": {
                one.name: {
                    "unit": one.unit, "value": float(value), "interval_95": [float(end) for end in interval],
                    "determined": known, "at_the_end_of_its_range": bound, "start": one.start,
                    "sought": [one.low, one.high],
                }
                for one, value, interval, known, bound in rows
            },
            "correlation": self.correlation.tolist(),
            "known_only_together": [list(pair) for pair in self.together],
            "points": len(self.measured), "rms": self.rms(self.computed), "rms_before": self.rms(self.before),
            "correlation_of_neighbouring_misfits": self.likeness, "converged": self.met,
        }  # fmt: skip


def solve(
    evaluate: Callable[[Sequence[FloatArray]], Sequence[FloatArray]],
    parameters: Sequence[Parameter],
    measured: FloatArray,
    scale: FloatArray,
    report: Callable[[int, float], object] = lambda trials, rms: None,
) -> Fit:
    """Fit parameters to measured points.

    Parameters
    ----------
    evaluate : gives the computed (n,) points for each of several (p,) values; NaN where there are none
    parameters, measured, scale : as of Fit
    report : called as report(trials so far, rms misfit over the scale)

    Returns
    -------
    Fit

    Raises
    ------
    InputError : no more points than parameters
    UnstableError : the model cannot be computed at the start, or on either side of a point
    """
    low, high = (np.array([getattr(one, end) for one in parameters]) for end in ("low", "high"))
    freedom = len(measured) - len(parameters)
    if freedom < 1:
        raise InputError(key="points", value=len(measured), allowed=f"more than the {len(parameters)} parameters")
    trials = _Trials(lambda many: evaluate([low + u * (high - low) for u in many]), measured, scale, report)
    start = (np.array([one.start for one in parameters]) - low) / (high - low)
    [before] = trials.points([start])
    if not np.isfinite(before).all():
        raise UnstableError("the model cannot be computed with the values that the fit begins with")
    found = least_squares(
        trials.misfit, np.clip(start, 1e-6, 1 - 1e-6), jac=trials.jacobian, bounds=(0.0, 1.0), xtol=CONVERGED,
        ftol=CONVERGED, max_nfev=MOST,
    )  # fmt: skip
    likeness = _likeness(found.fun)
    noise = sqrt(np.sum(found.fun**2) / freedom * (1 + likeness) / (1 - likeness))
    half, correlation, _, _ = identify(found.jac, noise, freedom)
    [computed] = trials.points([found.x])
    return Fit(
        tuple(parameters), low + found.x * (high - low), half * (high - low), correlation, measured, before, computed,
        scale, likeness, found.status > 0,
    )  # fmt: skip


class _Trials:
    """Misfit and Jacobian by u, from runs of which none is made twice.

    Parameters
    ----------
    evaluate : gives the computed points for each of several u
    measured, scale, report : as of `solve`
    """

    def __init__(self, evaluate, measured, scale, report):
        self._evaluate, self._measured, self._scale, self._report = evaluate, measured, scale, report
        self._known = {}

    def points(self, many):
        """Computed points at each of several u."""
        wanted = {u.tobytes(): u for u in many if u.tobytes() not in self._known}
        self._known.update(zip(wanted, self._evaluate(list(wanted.values()))))
        return [self._known[u.tobytes()] for u in many]

    def misfit(self, u):
        """(n,)"""
        off = (self.points([u])[0] - self._measured) / self._scale
        self._report(len(self._known), float(np.sqrt(np.mean(off**2))))
        return off

    def jacobian(self, u):
        """(n, p) of the misfit."""
        ends = [np.clip(u + sign * STEP * axis, 0.0, 1.0) for axis in np.eye(len(u)) for sign in (-1, 1)]
        middle, *found = self.points([u, *ends])
        columns = []
        for k in range(len(u)):
            pairs = [(ends[j][k], found[j]) for j in (2 * k, 2 * k + 1)]
            sides = [(at, values) for at, values in pairs if at != u[k] and np.isfinite(values).all()]
            if not sides:
                raise UnstableError(f"no run on either side of a trial of the {k + 1}. parameter")
            (a, left), (b, right) = sides[0], sides[-1] if len(sides) > 1 else (u[k], middle)
            columns.append((right - left) / (b - a) / self._scale)
        return np.stack(columns, axis=1)


def _likeness(misfit):
    """Correlation of neighbours in a series, 0 to 0.99; 0 where it is no more than scatter gives."""
    square = np.sum(misfit**2)
    r = float(np.sum(misfit[1:] * misfit[:-1]) / square) if square > 0 else 0.0
    return min(r, 0.99) if r > 2 / sqrt(len(misfit)) else 0.0
