"""A compression law that also sees how the two yarns share the tension.

    d_c = a (1 - (1 + F / F0)^(-1/3)),   a = exp(p0 + p1 m),   F0 = exp(q0 + q1 m),   m = (T1 - T2) / (T1 + T2)

At one m this is the regularised law (erratum E-05) with b = a F0^(1/3). The source uses one a and b for all ratios; a
taut yarn keeps its section and presses into the slack one, so the compression at one force depends on which is taut.
m = 1: all tension in the warp, -1: in the weft.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fabrics.compression import CompressionLaw
from fabrics.errors import InputError


def imbalance(T1, T2):
    """m [-] of warp and weft tensions [N], from -1 to 1; 0 where neither is taut."""
    T1, T2 = np.maximum(T1, 0), np.maximum(T2, 0)
    total = T1 + T2
    return np.divide(T1 - T2, total, out=np.zeros(np.broadcast(T1, T2).shape), where=total > 0)


@dataclass(frozen=True)
class RatioLaw:
    """Compression of one yarn under the contact force, at a tension imbalance m.

    Parameters
    ----------
    p : (p0, p1) of ln(a / 1 m)
    q : (q0, q1) of ln(F0 / 1 N)
    residual_rms : [m] of the fit
    m_range : (lowest, highest) [-] imbalance of the fitted samples
    """

    p: tuple[float, float]
    q: tuple[float, float]
    residual_rms: float | None = None
    m_range: tuple[float, float] | None = None

    def at(self, m) -> CompressionLaw:
        """The law at one imbalance."""
        a, F0 = np.exp(self.p[0] + self.p[1] * m), np.exp(self.q[0] + self.q[1] * m)
        return CompressionLaw(float(a), float(a * np.cbrt(F0)), provenance=f"ratio law at m = {m:.3f}")

    def d(self, F, m):
        """Compression [m] at the contact force `F` [N] and the imbalance `m`; zero without force."""
        F, m = np.maximum(np.asarray(F, float), 0), np.asarray(m, float)
        return np.exp(self.p[0] + self.p[1] * m) * (1 - (1 + F * np.exp(-self.q[0] - self.q[1] * m)) ** (-1 / 3))

    @classmethod
    def fit(cls, F, m, d) -> RatioLaw:
        """Least squares in d over samples (n,) [N], [-], [m] with F > 0.

        Raises
        ------
        InputError : fewer than five samples in contact, or no fit found
        """
        from scipy.optimize import least_squares

        F, m, d = (np.asarray(column, float) for column in (F, m, d))
        F, m, d = F[F > 0], m[F > 0], d[F > 0]
        if F.size < 5:
            raise InputError("a law of the tension ratio needs at least five samples in contact", value=int(F.size))
        length, force = float(np.max(np.abs(d))), float(np.max(F))

        def distance(x):
            return np.exp(x[0] + x[1] * m) * (1 - (1 + F / force * np.exp(-x[2] - x[3] * m)) ** (-1 / 3)) - d / length

        found = least_squares(distance, (0.3, 0.0, np.log(0.03), 0.0), x_scale=(1, 1, 3, 3))
        if not found.success:
            raise InputError(f"no law of the tension ratio fits the samples: {found.message}")
        p0, p1, q0, q1 = map(float, found.x)
        return cls(
            (p0 + float(np.log(length)), p1),
            (q0 + float(np.log(force)), q1),
            length * float(np.sqrt(np.mean(found.fun**2))),
            (float(m.min()), float(m.max())),
        )
