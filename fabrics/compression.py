"""Transverse compression of a yarn at a crossover: thickness lost, d_c, against contact force, F.

    printed       d_c = a - b / F^(1/3)                            (thesis eqs. 2-7, 4-12)
    regularised   d_c = a - b / (F + F0)^(1/3),  F0 = (b / a)^3    (erratum E-05)

The printed form falls to minus infinity as the force goes to zero, so that yarns at rest would push
each other apart. The regularised form has the same limit a and the same b, is zero at zero force,
and is van Wyk's law (eq. 2-1). a = b = 0 is a yarn that cannot be compressed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from fabrics import law_file
from fabrics.base.assumed_number import Assumed
from fabrics.base.checks import FilePath, FloatArray, not_negative, refuse
from fabrics.base.errors import InputError, placed
from fabrics.base.frozen import explain_frozen
from fabrics.base.range_texts import CUT_OFF
from fabrics.base.units import si

if TYPE_CHECKING:
    from fabrics.ply_law import PlyLaw
    from fabrics.weave import Weave

FORMS = ("regularised", "printed")
# standard deviations from the middle of a normal distribution to the ends of its 95 %
NORMAL_95 = 1.959963984540054


@explain_frozen
@dataclass(frozen=True)
class CompressionLaw:
    """Compression of one yarn under the contact force of a crossover.

    Parameters
    ----------
    a : [m] greatest compression
    b : [m N^(1/3)]
    form : "regularised" or "printed"
    provenance : where a and b come from
    residual_rms : [m] of the fit, None if there was none
    F_range : (lowest, highest) [N] force of the fitted samples
    a_interval, b_interval : (low, high) 95 % confidence intervals
    assumed_range : ((a, b), (a, b)) [m, m N^(1/3)] of the soft and the stiff end of what is not known
        of the crossover that the law was fitted from; None if all is
    spread : (variance of ln a, covariance of ln a and ln b, variance of ln b) over the same; None if
        all is known
    fabric : name of the fabric whose crossover or test it was fitted to; empty of constants that a
        user gives
    fitted_data : digest of the data of that fabric (`variants.data_digest`); empty if it is not
        known
    doubts : what is doubtful of the fit, in words; empty if nothing is

    Raises
    ------
    InputError : a or b negative, one of them zero without the other, or an unknown form
    """

    a: float
    b: float
    form: str = "regularised"
    provenance: str = ""
    residual_rms: float | None = None
    F_range: tuple[float, float] | None = None
    a_interval: tuple[float, float] | None = None
    b_interval: tuple[float, float] | None = None
    assumed_range: tuple[tuple[float, float], tuple[float, float]] | None = None
    fabric: str = ""
    fitted_data: str = ""
    doubts: str = ""
    spread: tuple[float, float, float] | None = None

    def __post_init__(self):
        not_negative(self, "a", "b")
        if (self.a == 0) != (self.b == 0):
            refuse(
                self,
                "b",
                "zero exactly where a is zero (an incompressible yarn)",
            )
        if self.form not in FORMS:
            refuse(self, "form", " or ".join(FORMS))

    @classmethod
    def incompressible(cls) -> CompressionLaw:
        """Return the limit of a yarn that keeps its thickness."""
        return cls(0.0, 0.0, provenance="incompressible limit")

    def at(self, share: float) -> CompressionLaw:
        """Return the law at a place in the range of its constants: 0 is the soft end, 0.5 the law as it is, 1
        the stiff end. Constants that are given with a range make an end soft by a large a and a small b."""
        a, b = (each if isinstance(each, Assumed) else Assumed(each) for each in (self.a, self.b))
        soft, stiff = self.assumed_range or ((a.high, b.low), (a.low, b.high))
        of_share = [
            float(np.interp(share, (0.0, 0.5, 1.0), ends))
            for ends in zip(soft, (self.a, self.b), stiff)
        ]
        return CompressionLaw(of_share[0], of_share[1], self.form, self.provenance)

    def ends(self) -> dict[str, CompressionLaw]:
        """Return the law at each end of its assumed range, {"soft", "stiff": CompressionLaw}; empty
        if nothing was assumed."""
        laws = {}
        for end, (a, b) in zip(("soft", "stiff"), self.assumed_range or ()):
            provenance = f"{self.provenance}; {end} end of the assumed range"
            laws[end] = CompressionLaw(a, b, self.form, provenance)
        return laws

    def slopes_of_compression(self) -> FloatArray:
        """Compute d ln d / d (ln a, ln b), (2,) [-], the mean over the forces of the fit.

        They add up to 1: a and b that grow alike make every compression grow as much.
        """
        low, high = self.F_range or (0.0, self.F0)
        x = np.linspace(low, high, 102)[1:] / self.F0
        g = x / 3 * (1 + x) ** (-4 / 3) / (1 - (1 + x) ** (-1 / 3))
        return np.array([1 + 3 * np.mean(g), -3 * np.mean(g)])

    def with_spread(self, covariance: ArrayLike) -> CompressionLaw:
        """Return the law with a joint range of a and b, the intervals of 95 % of each, and soft and
        stiff ends that bracket it at every force.

        At the ends a and b are larger or smaller by one factor, that by which 95 % of the range move
        the compression, on average over the forces of the fit.

        Parameters
        ----------
        covariance : (2, 2) of ln a and ln b, which that of the fit itself is added to
        """
        joint = np.array(covariance, float)
        for k, interval in enumerate((self.a_interval, self.b_interval)):
            if interval is not None and min(interval) > 0:
                joint[k, k] += (np.log(interval[1] / interval[0]) / 2 / NORMAL_95) ** 2
        half = np.exp(NORMAL_95 * np.sqrt(np.diag(joint)))
        toward = self.slopes_of_compression()
        factor = float(np.exp(NORMAL_95 * np.sqrt(toward @ np.asarray(covariance) @ toward)))
        return replace(
            self,
            a_interval=(float(self.a / half[0]), float(self.a * half[0])),
            b_interval=(float(self.b / half[1]), float(self.b * half[1])),
            assumed_range=(
                (self.a * factor, self.b * factor),
                (self.a / factor, self.b / factor),
            ),
            spread=(float(joint[0, 0]), float(joint[0, 1]), float(joint[1, 1])),
        )

    def sample(self, u: ArrayLike) -> CompressionLaw:
        """Draw a law of the joint range: a and b together. A law without a range is returned as it is.

        Parameters
        ----------
        u : (2,) [-] evenly drawn from 0, soft, to 1, stiff: of the compression on average over the forces of
            the fit; and of a against b where that stays. (1/2, 1/2) gives this law. A normal distribution
            that ends at CUT_OFF standard deviations
        """
        if self.spread is None:
            return self
        from scipy.special import ndtr, ndtri

        ends = ndtr([-CUT_OFF, CUT_OFF])
        of_mean, of_rest = ndtri(np.interp(np.asarray(u, float), (0.0, 1.0), ends))
        aa, ab, bb = self.spread
        toward = self.slopes_of_compression()
        together = np.array([[aa, ab], [ab, bb]]) @ toward
        variance = toward @ together
        if variance > 0:
            together = together / np.sqrt(variance)
        across = np.array([toward[1], -toward[0]]) * np.sqrt(
            max(aa * bb - ab**2, 0.0) / variance if variance > 0 else 0.0
        )
        a, b = np.exp(np.log([self.a, self.b]) - of_mean * together + of_rest * across)
        return replace(self, a=float(a), b=float(b), assumed_range=None, spread=None)

    def holds(self, a: float, b: float) -> bool:
        """Tell whether constants lie within the joint range of 95 %; none does of a law without
        one."""
        if self.spread is None:
            return False
        aa, ab, bb = self.spread
        off = np.log([a / self.a, b / self.b])
        # of two normal variables, 95 % lie within this square of the distance: -2 ln 0.05
        square = off @ np.linalg.pinv(np.array([[aa, ab], [ab, bb]]), rcond=1e-9) @ off
        return bool(square <= -2 * np.log(0.05))

    def outside_ends(self) -> list[str]:
        """Write a line for each end of the assumed range that the law lies outside of, up to the
        largest force of its fit.

        The soft end is to be compressed more than the law, the stiff end less.
        """
        lines = []
        F = np.linspace(0, self.F_range[1] if self.F_range else 0, 1001)[1:]
        for (end, law), sign, other in zip(self.ends().items(), (1, -1), ("stiffer", "softer")):
            if (outside := F[sign * (law.d(F) - self.d(F)) < 0]).size:
                forces = f"from {outside[0]:.3g} to {outside[-1]:.3g} N"
                lines.append(
                    f"{end} end {other} than the law {forces}: the ends do not bracket it there"
                )
        return lines

    def require_fabric(
        self, name: str, *, file: FilePath | None = None, key: str, value: object = None
    ) -> None:
        """Refuse a law that was fitted to a fabric of another name.

        Parameters
        ----------
        name : of the fabric that the law is to be used for
        file, key, value : where the law is named, and how

        Raises
        ------
        InputError : it states another fabric
        """
        if self.fabric not in ("", name):
            allowed = f"a law of {name}, or its constants a and b to use them all the same"
            raise InputError(
                f"is a law of fabric {self.fabric}",
                file=file,
                key=key,
                value=value,
                allowed=allowed,
            )

    @property
    def F0(self) -> float:
        """[N] (b / a)^3, the force at which the printed form starts."""
        if self.a > 0:
            return (self.b / self.a) ** 3
        return 0.0

    @property
    def _shift(self):
        if self.form == "regularised":
            return self.F0
        return 0.0

    def d(self, F: ArrayLike) -> FloatArray:
        """Compute the compression [m] at the contact force `F` [N]; without force it is zero
        (regularised form)."""
        F = np.asarray(F, float)
        if self.a == 0:
            return np.zeros_like(F)
        with np.errstate(divide="ignore"):
            closure = self.a - self.b / np.cbrt(np.maximum(F, 0) + self._shift)
        if self.form == "regularised":
            return np.where(F > 0, closure, 0.0)
        return closure

    def F(self, d: ArrayLike) -> FloatArray:
        """Compute the contact force [N] at the compression `d` [m]; infinite from d = a on."""
        d = np.asarray(d, float)
        with np.errstate(divide="ignore", invalid="ignore"):
            force = np.where(d < self.a, (self.b / (self.a - d)) ** 3 - self._shift, np.inf)
        if self.form == "regularised":
            return np.where(d > 0, force, 0.0)
        return force

    def dd_dF(self, F: ArrayLike) -> FloatArray:
        """Compute the compliance [m/N] at the contact force `F` [N] (eq. 4-28)."""
        F = np.asarray(F, float)
        if self.a == 0:
            return np.zeros_like(F)
        with np.errstate(divide="ignore"):
            return self.b / 3 * (np.maximum(F, 0) + self._shift) ** (-4 / 3)

    def energy(self, d: ArrayLike) -> FloatArray:
        """Compute the work [J] of the contact force from zero compression to `d` [m], 0 <= d < a
        (regularised form)."""
        d = np.asarray(d, float)
        return self.b**3 / 2 * ((self.a - d) ** -2 - self.a**-2) - self._shift * d

    @classmethod
    def fit(
        cls,
        F: ArrayLike,
        d: ArrayLike,
        *,
        provenance: str = "",
        confidence: float = 0.95,
        fabric: str = "",
    ) -> CompressionLaw:
        """Fit the regularised form to samples by least squares in d.

        Parameters
        ----------
        F : (n,) [N] contact forces; samples without contact (F <= 0) are left out
        d : (n,) [m] compression of one yarn
        confidence : of the intervals of a and b, from the linearised covariance

        Raises
        ------
        InputError : fewer than three samples in contact, or no fit found
        """
        from scipy.optimize import curve_fit
        from scipy.stats import t as student

        F = np.asarray(F, float)
        d = np.asarray(d, float)
        keep = F > 0
        F = F[keep]
        d = d[keep]
        if F.size < 3:
            raise InputError(
                "a compression law needs at least three samples in contact", value=int(F.size)
            )
        length = float(np.max(np.abs(d)))
        force = float(np.max(F))

        # a = exp(p), F0 = exp(q): both stay positive, and b = a F0^(1/3) follows
        def law(F, p, q):
            return np.exp(p) * (1 - (1 + F * np.exp(-q)) ** (-1 / 3))

        try:
            (p, q), covariance = curve_fit(
                law, F / force, d / length, p0=(0.3, np.log(0.03)), maxfev=10000
            )
        except RuntimeError as problem:
            raise InputError(f"no compression law fits the samples: {problem}") from problem
        a = length * np.exp(p)
        F0 = force * np.exp(q)
        b = a * np.cbrt(F0)
        spread = student.ppf(0.5 + confidence / 2, F.size - 2)
        da = spread * np.sqrt(covariance[0, 0])
        db = spread * np.sqrt(covariance[0, 0] + 2 / 3 * covariance[0, 1] + covariance[1, 1] / 9)
        fitted = cls(float(a), float(b), provenance=provenance, fabric=fabric)
        return replace(
            fitted,
            residual_rms=float(np.sqrt(np.mean((fitted.d(F) - d) ** 2))),
            F_range=(float(F.min()), float(F.max())),
            a_interval=(float(a * np.exp(-da)), float(a * np.exp(da))),
            b_interval=(float(b * np.exp(-db)), float(b * np.exp(db))),
        )

    def to_json(self, path: FilePath, contact: PlyLaw | None = None) -> None:
        """Write the law, its fit and its provenance; and `contact`, the law of plies on each other,
        beside it."""
        content: dict[str, Any] = {
            "form": self.form,
            "a": f"{self.a!r} m",
            "b": f"{self.b!r} m * N**(1/3)",
            "fabric": self.fabric,
            "fitted_data": self.fitted_data,
            "provenance": self.provenance,
            "fit": {
                "residual_rms_m": self.residual_rms,
                "F_range_N": self.F_range,
                "a_interval_m": self.a_interval,
                "b_interval_m_N^(1/3)": self.b_interval,
            },
            "assumed_range": self.assumed_range
            and [{"a": f"{a!r} m", "b": f"{b!r} m * N**(1/3)"} for a, b in self.assumed_range],
            "spread_of_ln_a_ln_b": self.spread,
            "ply_contact": contact and contact.table(),
        }
        if self.doubts:
            content["doubts"] = self.doubts
        law_file.write(path, content)

    @classmethod
    def from_json(cls, path: FilePath) -> CompressionLaw:
        """Read what `to_json` wrote.

        Raises
        ------
        InputError : no such file, not JSON, another format, or a bad value
        """
        content = law_file.read(path)
        with placed(path):
            fit = content.get("fit") or {}
            return cls(
                si(content.get("a"), "m", file=path, key="a"),
                si(content.get("b"), "m * N**(1/3)", file=path, key="b"),
                content.get("form", "regularised"),
                content.get("provenance", ""),
                fit.get("residual_rms_m"),
                _pair(fit.get("F_range_N")),
                _pair(fit.get("a_interval_m")),
                _pair(fit.get("b_interval_m_N^(1/3)")),
                _read_range(content.get("assumed_range"), path),
                str(content.get("fabric", "")),
                str(content.get("fitted_data", "")),
                str(content.get("doubts", "")),
                _triple(content.get("spread_of_ln_a_ln_b")),
            )


def check_room(
    laws: tuple[CompressionLaw, CompressionLaw], weave: Weave, *, file: FilePath | None, key: str
) -> None:
    """Check that warp and weft together cannot lose more thickness than the fabric has.

    A fabric of straight yarns has no thickness with which that could be compared.

    Parameters
    ----------
    file, key : where `a` of the laws stands

    Raises
    ------
    InputError : they can
    """
    most = sum(law.a for law in laws)
    if most >= weave.thickness > 0:
        value = " and ".join(f"{1e3 * a:g} mm" for a in dict.fromkeys(law.a for law in laws))
        allowed = (
            f"below {0.5e3 * weave.thickness:.3g} mm, the mean height of a yarn of this fabric"
        )
        raise InputError(file=file, key=key, value=value, allowed=allowed)


def _pair(values):
    return values and tuple(values)


def _triple(values):
    return values and tuple(map(float, values))


def _read_range(entries, path):
    if not entries:
        return None
    ends = []
    for entry in entries:
        a = si(entry.get("a"), "m", file=path, key="a")
        b = si(entry.get("b"), "m * N**(1/3)", file=path, key="b")
        ends.append((a, b))
    return tuple(ends)


class HasLaw(Protocol):
    """What has a fitted law, such as the result of `weavecell.calibrate`."""

    @property
    def law(self) -> CompressionLaw:
        """Of both yarn families."""
