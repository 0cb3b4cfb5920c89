"""Records of a compression test between platens: the rig taken off, the pressure law of a pack fitted,
and the gap between plies.

A record is what the platens have closed against their load; the rig's part is taken off at each load
(thesis Figure 2-3). What is left of N plies, from the first load on, follows eq. 2-5 of the thesis,

    P = K'' / (t - t_min)^n    ->    d(P) = d_full - (K'' / P)^(1/n),

d_full what is closed at the minimum volume. It is fitted with n free, and with n = 3, for which the
thesis chooses V_min. Intervals are those of the least squares fit, by draws from its covariance.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import curve_fit
from scipy.stats import t as student

from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.counted import counted
from fabrics.base.errors import InputError
from fabrics.base.tables import read_columns

CONFIDENCE = 0.95
# the exponent of the thesis
CUBE = 3.0
# rows that a fit of three numbers needs to say how uncertain they are
FEWEST = 10
DRAWS = 2000
# the random numbers of the draws: two reductions of one record give the same intervals
SEED = 1
# a curve for `calibrate --platen-curve` has so many rows
ROWS = 24


@dataclass(frozen=True, eq=False)
class CompressionRecord:
    """One record, loading only.

    Parameters
    ----------
    load : (n,) [N] rising on the whole, positive
    closed : (n,) [m] what the platens have closed at each
    source : name of the file
    """

    load: FloatArray
    closed: FloatArray
    source: str

    @classmethod
    def read(cls, path: FilePath) -> CompressionRecord:
        """Read a CSV with the columns force and displacement, up to its largest force: what follows
        is unloading.

        Raises
        ------
        InputError : one line naming the file, the row, the value and what is allowed
        """
        column = read_columns(
            path,
            {"force": "N", "displacement": "m"},
            what="a compression record",
            example="force [N]",
        )
        last = int(np.argmax(column["force"])) + 1 if len(column["force"]) else 0
        load = column["force"][:last]
        if last < FEWEST:
            allowed = f"at least {FEWEST} up to the largest force"
            raise InputError(file=path, key="rows", value=last, allowed=allowed)
        if not load.min() > 0:
            line = column.table.place(int(np.argmin(load)))
            allowed = "above 0: leave out the rows before the platens touch"
            raise InputError(
                file=path, key=f"{line}, force", value=f"{load.min():g} N", allowed=allowed
            )
        return cls(load, column["displacement"][:last], str(path))

    def without(self, rig: CompressionRecord) -> CompressionRecord:
        """Take off what the rig closes at each load.

        Raises
        ------
        InputError : the record of the rig does not reach the loads of this one
        """
        order = np.argsort(rig.load, kind="stable")
        low, high = rig.load[order[0]], rig.load[order[-1]]
        if self.load.min() < low * (1 - 1e-9) or self.load.max() > high * (1 + 1e-9):
            allowed = f"within those of the rig, {low:g} to {high:g} N: what the rig closes outside is not known"
            span = f"{self.load.min():g} to {self.load.max():g} N"
            raise InputError(file=self.source, key="force", value=span, allowed=allowed)
        closed = np.interp(self.load, rig.load[order], rig.closed[order])
        return CompressionRecord(self.load, self.closed - closed, self.source)


@dataclass(frozen=True, eq=False)
class PressureLaw:
    """d(P) = d_full - (K / P)^(1/n) fitted to a record of some plies.

    Parameters
    ----------
    plies : number
    pressure : (rows,) [Pa] of the record
    closed : (rows,) [m] without the rig, from the first load on
    full : [m] closed at the minimum volume, from the first load on
    stiffness : [Pa m^n] K''
    exponent : [-] n
    draws : (DRAWS, 3) full, ln stiffness, exponent, from the covariance of the fit
    rms : [m] of the record about the law
    """

    plies: int
    pressure: FloatArray
    closed: FloatArray
    full: float
    stiffness: float
    exponent: float
    draws: FloatArray
    rms: float

    @classmethod
    def fit(
        cls, record: CompressionRecord, area: float, plies: int, exponent: float | None = None
    ) -> PressureLaw:
        """Fit the law by least squares of what is closed.

        Parameters
        ----------
        area : [m2] of the platen
        exponent : n; fitted if it is None

        Raises
        ------
        InputError : the record does not determine the law
        """
        pressure = record.load / area
        closed = record.closed - record.closed[0]
        span = float(np.ptp(closed))
        # of d_full, in units of what is closed, and of ln((K / P_max)^(1/n)) in the same
        top = pressure.max()

        def law(P, full, rest, n):
            return full - np.exp(rest) * (top / P) ** (1 / n)

        start = [1.1, np.log(0.1), CUBE]
        free = slice(None)
        model: Callable[..., Any] = law
        if exponent is not None:
            free = slice(2)
            model = partial(law, n=exponent)

        try:
            found, covariance = curve_fit(model, pressure, closed / span, start[free], maxfev=20000)
        except RuntimeError:
            line = "rows that do not follow eq. 2-5: the fit of the pressure law does not end"
            raise InputError(line, file=record.source) from None
        if not np.all(np.isfinite(covariance)):
            line = "rows that do not determine the pressure law: more of them are needed, over more load"
            raise InputError(line, file=record.source)
        off = model(pressure, *found) - closed / span
        if exponent is not None:
            found = np.append(found, exponent)
            covariance = np.pad(covariance, ((0, 1), (0, 1)))
        # Student's t for few rows
        spread = student.ppf(0.5 + CONFIDENCE / 2, len(off) - len(found[free])) / 1.959964
        rng = np.random.default_rng(SEED)
        drawn = rng.multivariate_normal(found, spread**2 * covariance, DRAWS, check_valid="ignore")
        logarithm, n = _in_si(np.vstack([found, drawn]), span, top)
        # counted from the law at the first load, not from the first row, which has the noise of one row
        full = np.exp((logarithm - np.log(pressure.min())) / n)
        closed = closed + full[0] - found[0] * span
        draws = np.stack([full[1:], logarithm[1:], n[1:]], axis=1)
        rms = float(span * np.sqrt(np.mean(off**2)))
        K = float(np.exp(logarithm[0]))
        return cls(plies, pressure, closed, float(full[0]), K, float(n[0]), draws, rms)

    def at(self, pressure: Any) -> FloatArray:
        """Compute what is closed [m] at pressures [Pa]."""
        return self.full - (self.stiffness / np.asarray(pressure)) ** (1 / self.exponent)

    def drawn_at(self, pressure: float) -> FloatArray:
        """Compute what is closed (DRAWS,) [m] at a pressure [Pa] by each draw."""
        full, logarithm, n = self.draws.T
        return full - np.exp((logarithm - np.log(pressure)) / n)

    def intervals(self) -> dict[str, tuple[float, float]]:
        """Return {"full", "stiffness", "exponent": (low, high)} of CONFIDENCE."""
        full, logarithm, n = self.draws.T
        return {
            "full": interval(full),
            "stiffness": interval(np.exp(logarithm)),
            "exponent": interval(n),
        }

    def curve(self) -> tuple[FloatArray, FloatArray]:
        """Sample the law over its record: pressures (ROWS,) [Pa], closures (ROWS,) [m] from the
        first."""
        pressure = np.geomspace(self.pressure.min(), self.pressure.max(), ROWS)
        closed = self.at(pressure)
        return pressure, closed - closed[0]


def _in_si(parameters, span, top):
    """ln K'' and n of the parameters of a fit (rows, 3)."""
    _, rest, n = parameters.T
    return n * (rest + np.log(span)) + np.log(top), n


def interval(values: FloatArray) -> tuple[float, float]:
    """Return the middle CONFIDENCE of some draws."""
    tail = (1 - CONFIDENCE) / 2
    low, high = np.quantile(values, [tail, 1 - tail])
    return float(low), float(high)


@dataclass(frozen=True)
class Estimate:
    """A value [SI] with its interval."""

    value: float
    low: float
    high: float


def gap_between(one: PressureLaw, many: PressureLaw) -> Estimate:
    """Compute what neighbouring plies of a pack close between each other (eq. 5-4) [m].

    (d_N(P) - d_1(P)) / (N - 1) at the highest pressure that both records have, both counted from
    the higher of their first pressures.

    Raises
    ------
    InputError : the records have no pressure in common
    """
    low = max(one.pressure.min(), many.pressure.min())
    high = min(one.pressure.max(), many.pressure.max())
    if not high > low:
        allowed = "pressures that the record of one ply has too"
        value = f"{low:g} to {high:g} Pa"
        raise InputError(
            key=f"record of {counted(many.plies, 'ply')}", value=value, allowed=allowed
        )

    def gaps(closed):
        across = [closed(law, high) - closed(law, low) for law in (one, many)]
        return (across[1] - across[0]) / (many.plies - 1)

    middle = float(gaps(PressureLaw.at))
    return Estimate(middle, *interval(gaps(PressureLaw.drawn_at)))


def force_law(one: PressureLaw, area: float) -> dict[str, Estimate]:
    """Compute a [m] and b [m N^(1/3)] of one ply over an area [m2] (eqs. 2-8, 2-9), from the law
    with n = 3.

    d_c = a - b / F^(1/3), a = d_full, b = (K'' A)^(1/3), with K'' per unit area (erratum E-04).
    """
    full, logarithm, _ = one.draws.T
    a = Estimate(one.full, *interval(full))
    b = Estimate(float(np.cbrt(one.stiffness * area)), *interval(np.cbrt(np.exp(logarithm) * area)))
    return {"a": a, "b": b}


def laws_of(
    records: Sequence[CompressionRecord], plies: Sequence[int], area: float, exponent: float | None
) -> list[PressureLaw]:
    """Fit the pressure law of each record."""
    return [PressureLaw.fit(record, area, count, exponent) for record, count in zip(records, plies)]
