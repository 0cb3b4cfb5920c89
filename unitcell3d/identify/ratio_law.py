"""Compression of a yarn that depends on the ratio of warp and weft tension as well as on the
contact force."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares

from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError


def imbalance(T1: ArrayLike, T2: ArrayLike) -> FloatArray:
    """Compute the imbalance m [-] of warp and weft tensions [N], from -1 to 1; 0 where neither is
    taut."""
    T1 = np.maximum(T1, 0)
    T2 = np.maximum(T2, 0)
    total = T1 + T2
    return np.divide(T1 - T2, total, out=np.zeros(np.broadcast(T1, T2).shape), where=total > 0)


@dataclass(frozen=True)
class RatioLaw:
    """Compression of one yarn under the contact force, at a tension imbalance m.

        d_c = c F / (1 + F / F0),   c = exp(p0 + p1 m),   m = (T1 - T2) / (T1 + T2)

    The thesis uses one a and b for all ratios; a taut yarn keeps its section and presses into the
    slack one, so that the compression at one force depends on which of the two is taut. m = 1: all
    tension in the warp, -1: in the weft.

    The force enters with exponent 1 instead of the 1/3 of the regularised law (erratum E-05): the
    residual of that law on single paths does not depend on the ratio. The parameter is a compliance
    c instead of a limit a = c F0 because all samples determine it: those of an unbalanced glass
    weave stay on d = c F. Residuals with other exponents: docs/reports/material-tests.md.

    Parameters
    ----------
    p : (p0, p1) of ln(c / (1 m/N))
    F0 : [N] force at which half of the limit c F0 is reached; infinite where none shows
    residual_rms : [m] of the fit
    m_range : (lowest, highest) [-] imbalance of the fitted samples
    """

    p: tuple[float, float]
    F0: float
    residual_rms: float | None = None
    m_range: tuple[float, float] | None = None

    def compliance(self, m: ArrayLike) -> FloatArray:
        """Compute the compression [m/N] per force at the first contact, at the imbalance `m`."""
        return np.exp(self.p[0] + self.p[1] * np.asarray(m, float))

    def d(self, F: ArrayLike, m: ArrayLike) -> FloatArray:
        """Compute the compression [m] at the contact force `F` [N] and the imbalance `m`; zero
        without force."""
        F = np.maximum(np.asarray(F, float), 0)
        return self.compliance(m) * F / (1 + F / self.F0)

    @classmethod
    def fit(cls, F: ArrayLike, m: ArrayLike, d: ArrayLike) -> RatioLaw:
        """Fit the law by least squares in d over samples (n,) [N], [-], [m] with F > 0.

        Raises
        ------
        InputError : fewer than five samples in contact, or no fit found
        """
        F, m, d = (np.asarray(column, float) for column in (F, m, d))
        F, m, d = F[F > 0], m[F > 0], d[F > 0]
        if F.size < 5:
            raise InputError(
                "a law of the tension ratio needs at least five samples in contact",
                value=int(F.size),
            )
        length = float(np.max(np.abs(d)))
        force = float(np.max(F))

        def distance(x):
            return np.exp(x[0] + x[1] * m) * (F / force) / (1 + x[2] * F / force) - d / length

        bounds = ((-np.inf, -np.inf, 0), np.inf)
        found = least_squares(distance, (2.0, 0.0, 10.0), x_scale=(1, 1, 10), bounds=bounds)
        if not found.success:
            raise InputError(f"no law of the tension ratio fits the samples: {found.message}")
        p0, p1, bend = map(float, found.x)
        return cls(
            (p0 + float(np.log(length / force)), p1),
            force / bend if bend > 1e-3 else np.inf,  # below, the samples know no limit
            length * float(np.sqrt(np.mean(found.fun**2))),
            (float(m.min()), float(m.max())),
        )
