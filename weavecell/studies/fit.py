"""Numbers of a model fitted to measured points by least squares, with what the points determine of them.

Intervals follow from the covariance s^2 (J^T J)^-1 of the misfits with Student's t of n - p degrees of freedom, s^2
their mean square and J their Jacobian. They hold for scatter. Where the model cannot follow the curve, neighbouring
misfits are alike: with r their correlation, s^2 is multiplied by (1 + r) / (1 - r), the variance of a mean over a
first-order autoregressive series (G. E. P. Box, G. M. Jenkins, Time Series Analysis, 1970, chapter 2).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from math import sqrt

import numpy as np
from numpy.typing import ArrayLike

from fabrics.checks import FloatArray
from fabrics.errors import InputError, UndecidedError, UnstableError

STEP = 0.02  # of a range, to each side; smaller ones are lost among yarns that fail a step earlier or later
CONVERGED, MOST = 1e-3, 30  # change of the unknowns and of the sum of squares; evaluations


@dataclass(frozen=True, eq=False)
class Fit:
    """What a fit found.

    Parameters
    ----------
    values, half : {name: value} and {name: half width of its 95 % interval}
    determined : {name: whether the interval excludes half and double of the value, and half of its range at least}
    correlation : (p, p) of the values: of two beyond 0.95 the points know one only together with the other
    computed, rms : (n,) points with the values, and their root mean square misfit over the scale
    likeness : [-] correlation of neighbouring misfits; above 0 the model does not follow the curve within its scatter
    converged : within `MOST` evaluations
    """

    values: dict[str, float]
    half: dict[str, float]
    determined: dict[str, bool]
    correlation: FloatArray
    computed: FloatArray
    rms: float
    likeness: float
    converged: bool


def fit(
    model: Callable[..., ArrayLike],
    measured: ArrayLike,
    unknowns: Mapping[str, tuple[float, float, float]],
) -> Fit:
    """Fit numbers of a model to measured points, of which the largest is the scale of all misfits.

    Parameters
    ----------
    model : called with a value of each unknown by its name; gives the (n,) computed points
    measured : (n,) points
    unknowns : {name: (low, start, high)}

    Raises
    ------
    InputError : a start outside of its range, a point that is not finite, or no more points than unknowns
    UnstableError : the model cannot be computed at the start

    Examples
    --------
    >>> from fabrics.variants import scale_shear
    >>> def stress(factor):
    ...     fabric = scale_shear(wc.fabric("S-720"), factor)
    ...     frame = wc.coupon(fabric, "picture_frame", shear_angle="5 deg", crossovers=2, steps=2)
    ...     return frame.to_dataframe()["shear_stress_Pa"]
    >>> round(wc.fit(stress, [0.38e6, 0.76e6], {"factor": (0.5, 1, 2)}).values["factor"], 2)
    0.9
    """
    from scipy.optimize import least_squares

    from unitcell3d.identify.least_squares import identify

    points, (low, start, high) = (
        np.asarray(measured, float),
        np.array(list(unknowns.values()), float).T,
    )
    for number in np.flatnonzero(~np.isfinite(points)):
        raise InputError(key=f"measured[{number}]", value=points[number], allowed="finite")
    freedom, scale, width = len(points) - len(unknowns), np.abs(points).max(), high - low
    if not np.all((low <= start) & (start <= high) & (low < high)):
        raise InputError(
            key="unknowns", value=unknowns, allowed="{name: (low, start, high)}, which rise"
        )
    if freedom < 1:
        raise InputError(
            key="measured", value=len(points), allowed=f"more than the {len(unknowns)} unknowns"
        )

    @cache
    def misfit(*u):
        """(computed - measured) / scale of a trial, by u = (value - low) / (high - low); NaN where it has no result."""
        try:
            computed = model(**dict(zip(unknowns, map(float, low + u * width))))
        except (UnstableError, UndecidedError):
            computed = np.nan
        return (np.asarray(computed, float) - points) / scale

    def jacobian(u):
        """By central differences, one-sided at the bounds and where a run fails."""
        columns = []
        for axis in STEP * np.eye(len(u)):
            at = [
                v
                for v in np.clip([u - axis, u, u + axis], 0.0, 1.0)
                if np.isfinite(misfit(*v)).all()
            ]
            # without a run on either side the points tell nothing of this unknown
            width = np.sum(at[-1] - at[0]) or 1.0
            columns.append((misfit(*at[-1]) - misfit(*at[0])) / width)
        return np.stack(columns, axis=1)

    begin = np.clip((start - low) / width, 1e-6, 1 - 1e-6)
    if not np.isfinite(misfit(*begin)).all():
        raise UnstableError("the model cannot be computed with the values that the fit begins with")
    solution = least_squares(
        lambda u: misfit(*u),
        begin,
        jac=jacobian,
        bounds=(0.0, 1.0),
        xtol=CONVERGED,
        ftol=CONVERGED,
        max_nfev=MOST,
    )
    off, values, square = solution.fun, low + solution.x * width, np.sum(solution.fun**2)
    r = float(np.sum(off[1:] * off[:-1]) / square) if square > 0 else 0.0
    r = min(r, 0.99) if r > 2 / sqrt(len(off)) else 0.0  # below it is no more than scatter gives
    half, correlation, _, _ = identify(
        solution.jac, sqrt(square / freedom * (1 + r) / (1 - r)), freedom
    )
    half *= width
    known = (half < 0.5 * np.abs(values)) & (half < 0.25 * width)
    fitted, halves, determined = (
        dict(zip(unknowns, numbers.tolist())) for numbers in (values, half, known)
    )
    return Fit(
        fitted,
        halves,
        determined,
        correlation,
        points + scale * off,
        sqrt(square / len(off)),
        r,
        solution.status > 0,
    )
