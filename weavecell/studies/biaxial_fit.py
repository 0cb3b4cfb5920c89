"""Constants of a fabric's cell from measured biaxial tests, by least squares (thesis section 5.3).

The loads of the chosen tests are those of the unit cell at their strains, those of a yarn alone in a
test whose other direction is free. Free constants (`CONSTANTS`) are any of

    a, b                     of d_c = a - b / (F + F0)^(1/3), one law for both yarns
    h                        [m] heights at rest of both yarns together, at most those of the crimp
    stiffening               [-] s of F = (1 + s e) f(d), with the yarn's strain e
    warp crimp, weft crimp   [-] with the yarns' own stiffness as it is
    start                    [-] of each test, by which its strains begin too late: the machine's
                             zero is where sagging yarns come to lie in one plane
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from itertools import product
from math import exp, inf, log, nan, sqrt
from typing import Any

import numpy as np
from scipy.optimize import brentq, least_squares, minimize_scalar
from scipy.stats import t as student

from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError, UnstableError
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from shellfabric.cell.model import CellModel
from shellfabric.membrane.indicator import Check, Indicator
from weavecell.studies.biaxial_tests import DIRECTIONS, BiaxialTest
from weavecell.studies.contact_share import judge_centreline

CONSTANTS = ("a", "b", "stiffening", "h", "warp crimp", "weft crimp", "start")
UNITS = {"a": "m", "b": "m N^(1/3)", "stiffening": "1", "h": "m"}
UNITS |= dict.fromkeys(("warp crimp", "weft crimp"), "%")
CONFIDENCE = 0.95
# [-] rms of a prediction without noise over the greatest load: what the thesis calls good agreement is not put in
# numbers; tests of one weave differ by about as much
AGREES = 0.05
# [-] half width of an interval over its value, above which the tests do not determine a constant
DETERMINED = 0.25
# [-] correlation of neighbouring residuals: that of noise is below this in 99 of 100 curves of 40
ALIKE = 0.4
WIDEST = Check(
    "widest interval",
    DETERMINED,
    "half width of the 95 % interval of a constant over its value",
    "a test at another ratio of strains determines more",
)
LIKENESS = Check(
    "likeness of neighbouring residuals",
    1.0,
    "correlation of a residual with the next; of a cell that is unlike the fabric it is near 1, and "
    "the intervals are too narrow",
    "state that the intervals are too narrow, or try the other centreline",
    note=ALIKE,
)
PREDICTION = Check(
    "error of prediction",
    AGREES,
    "rms of the loads of a test that was not fitted, without noise, over the greatest of all tests",
    "fit that test too, or state the error",
)
# of the start of the fit: a over the heights, F0 over the strength of the weaker yarn
FIRST_A = (0.08, 0.2, 0.4)
FIRST_F0 = (1e-4, 1e-3, 1e-2, 1e-1)
# [-] stiffening: of the start, and bounds; 100 doubles the force at a strain of 1 %
FIRST_STIFFENING = 20.0
STIFFENINGS = (0.1, 1e3)
PASSES = 3
# residual of constants with which a cell does not close
NOT_CLOSED = 1e3
# error of the end of an interval over its width; first step of the search for it in a logarithm
NEAR = 3e-3
FURTHEST = 0.7
# places of a profile on either side of the fit, in its standard errors
PROFILE = np.linspace(-2.5, 2.5, 11)


@dataclass(frozen=True)
class Constant:
    """A fitted constant.

    Parameters
    ----------
    name : of CONSTANTS; that of a start with the name of its test
    value, low, high : [SI] with the interval of 95 %; an end that is not found is infinite
    unit : of `results.display`
    """

    name: str
    value: float
    low: float
    high: float
    unit: str

    @property
    def spread(self) -> float:
        """[-] half width of the interval over the value."""
        return 0.5 * (self.high - self.low) / abs(self.value)

    @property
    def is_start(self) -> bool:
        """Whether it is the start of a test, which may be zero."""
        return self.name.startswith("start")

    @property
    def determined(self) -> bool:
        """Whether the interval is narrow enough to count as known."""
        return self.is_start or self.spread <= DETERMINED


@dataclass(frozen=True, eq=False)
class Comparison:
    """A measured test beside the fitted cell.

    Parameters
    ----------
    test : BiaxialTest
    computed : (n, 2) [N] loads of the cell; nan where none was measured
    fitted : whether the constants were fitted to it
    greatest : (2,) [N] greatest load of warp and weft in all tests
    start : [-] strain by which the test begins too late; 0 unless that was fitted
    own_start : [-] the same with which a predicted test would fit best; nan of a fitted one
    rms_at_own_start : (2,) [N] of loads with that; nan of a fitted one
    """

    test: BiaxialTest
    computed: FloatArray
    fitted: bool
    greatest: FloatArray
    start: float = 0.0
    own_start: float = nan
    rms_at_own_start: tuple[float, float] = (nan, nan)

    @property
    def name(self) -> str:
        """Of the test."""
        return self.test.name

    @property
    def ratio(self) -> str:
        """Of the test."""
        return self.test.ratio

    @property
    def role(self) -> str:
        """ "fitted" or "predicted"."""
        if self.fitted:
            return "fitted"
        return "predicted"

    @property
    def residual(self) -> FloatArray:
        """(n, 2) [N] measured less computed."""
        return self.test.load - self.computed

    @property
    def rms(self) -> tuple[float, float]:
        """[N] of the residuals of warp and weft; nan where none was measured."""
        return _rms(self.residual)

    @property
    def shares(self) -> tuple[float, float]:
        """[-] rms of warp and weft over the greatest load of their family."""
        warp, weft = np.array(self.rms) / self.greatest
        return float(warp), float(weft)

    @property
    def noise(self) -> tuple[float, float]:
        """[N] by which loads of warp and weft scatter about a smooth curve: half the mean square by
        which neighbouring residuals differ is its square (von Neumann 1941, Ann. Math. Stat. 12,
        367)."""
        return _rms(np.diff(self.residual, axis=0) / sqrt(2))

    @property
    def missed(self) -> tuple[float, float]:
        """[-] what of the rms of warp and weft is no noise, over the greatest load: no law predicts
        noise."""
        squares = np.square(self.rms) - np.square(self.noise)
        warp, weft = np.sqrt(np.maximum(squares, 0.0)) / self.greatest
        return float(warp), float(weft)

    @property
    def agrees_with_noise(self) -> bool:
        """Whether each rms, noise included, is at most AGREES of the greatest load."""
        return float(np.nanmax(self.shares)) <= AGREES

    @property
    def agrees(self) -> bool:
        """Whether what is missed, without noise, is at most AGREES of the greatest load."""
        return float(np.nanmax(self.missed)) <= AGREES

    @property
    def verdict(self) -> str:
        """ "agrees" or "differs"."""
        if self.agrees:
            return "agrees"
        return "differs"


@dataclass(frozen=True, eq=False)
class BiaxialFit:
    """Constants fitted to tests, and what they predict.

    Parameters
    ----------
    model : CellModel with the fitted constants
    law : CompressionLaw of both yarns, with its intervals
    constants : what was fitted
    correlation : (p, p) [-] of them
    comparisons : of all tests
    profiles : {name: (places, rises)} of a and b as far as they were free, places [SI] and rises of
        the least sum of squares over s^2
    """

    model: CellModel
    law: CompressionLaw
    constants: tuple[Constant, ...]
    correlation: FloatArray
    comparisons: tuple[Comparison, ...]
    profiles: Mapping[str, tuple[FloatArray, FloatArray]] = field(default_factory=dict)

    @property
    def values(self) -> dict[str, Constant]:
        """{name: Constant}"""
        return {constant.name: constant for constant in self.constants}

    @property
    def fitted(self) -> list[Comparison]:
        """The tests that were chosen."""
        return [one for one in self.comparisons if one.fitted]

    @property
    def predicted(self) -> list[Comparison]:
        """The others."""
        return [one for one in self.comparisons if not one.fitted]

    @property
    def undetermined(self) -> list[Constant]:
        """Constants that the chosen tests do not determine."""
        return [constant for constant in self.constants if not constant.determined]

    @property
    def checks(self) -> tuple[Indicator, ...]:
        """The indicators of centreline, determination, residuals and predictions."""
        found = []
        if not self.model.straight:
            found.append(judge_centreline(self.model.fabric))
        widest = max((one for one in self.constants if not one.is_start), key=_spread, default=None)
        if widest is not None:
            meaning = f"half width of the 95 % interval of {widest.name} over its value"
            found.append(WIDEST.judge(widest.spread, meaning))
        found.append(LIKENESS.judge(max(find_likeness(one.residual) for one in self.fitted)))
        if self.predicted:
            worst = max(self.predicted, key=lambda one: np.nanmax(one.missed))
            meaning = f"rms of the loads of test {worst.name}, without noise, over the greatest of all tests"
            found.append(PREDICTION.judge(float(np.nanmax(worst.missed)), meaning))
        return tuple(found)


def first_laws(fabric: Fabric, constants: Sequence[str]) -> tuple[CompressionLaw, CompressionLaw]:
    """Guess the laws of a fabric that has none, for the cell by which a fit of `constants` begins.

    Raises
    ------
    InputError : a or b is not fitted, so that the guess would stay
    """
    if not {"a", "b"} <= set(constants):
        allowed = f"with a and b: fabric {fabric.name} has no compression law"
        raise InputError(key="constants", value=", ".join(constants), allowed=allowed)
    weave = fabric.weave
    a = FIRST_A[0] * sum(weave.h0)
    strength = min(yarn.strength for yarn in weave.yarns)
    law = CompressionLaw(a, a * (FIRST_F0[-1] * strength) ** (1 / 3))
    return law, law


def fit(
    model: CellModel,
    tests: Sequence[BiaxialTest],
    chosen: Sequence[str] = (),
    constants: Sequence[str] = ("a", "b"),
    provenance: str = "",
    with_profiles: bool = True,
) -> BiaxialFit:
    """Fit constants of a cell to tests, and predict the others.

    All constants but the starts are fitted by their logarithms. Warp and weft have errors of their
    own: each residual is taken over the rms of its family, which is found by fitting again. The
    covariance is s^2 (J^T J)^-1. An interval of 95 % is that of the profile: where the least sum of
    squares over the other constants has risen by m t^2 s^2. Both errors are estimates, so that
    Student's t has the degrees of freedom of Welch and Satterthwaite, and m is what weights from
    estimated errors add to the variance of a mean (Meier 1953, Biometrics 9, 59): with the share
    w_f of a family in the variance of the constant, and its degrees of freedom v_f,

        1 / v = sum of w_f^2 / v_f,    m = 1 + 4 sum of w_f (1 - w_f) / v_f

    If neighbouring residuals are alike, and so no noise, intervals are too narrow, and the fit says
    so. A prediction counts as right if its rms, without the noise of the loads, is at most AGREES
    of the greatest load of warp, or weft, in all tests.

    Parameters
    ----------
    model : CellModel; its laws stay if a and b are not free, and begin the fit if they are
    tests : all of them
    chosen : names of the tests that are fitted; all if none is given
    constants : of CONSTANTS, which are free
    provenance : of the law
    with_profiles : whether the profiles of a and b are sampled, for a picture

    Raises
    ------
    InputError : an unknown test or constant, or tests that do not depend on a constant
    """
    names = [test.name for test in tests]
    for name in chosen:
        if name not in names:
            raise InputError(key="fitted", value=name, allowed=", ".join(names))
    for name in constants:
        if name not in CONSTANTS:
            raise InputError(key="constants", value=name, allowed=", ".join(CONSTANTS))
    selected = [test for test in tests if not chosen or test.name in chosen]
    problem = _Problem(model, selected, tuple(dict.fromkeys(constants)))
    x, weights = problem.solve()
    found = problem.describe(x, weights, tests, provenance)
    if not with_profiles:
        return found
    return replace(found, profiles=problem.profiles(x, weights))


class _Problem:
    """The least squares of chosen tests; x are the free constants as the optimiser has them."""

    def __init__(self, model, tests, constants):
        self.model = model
        self.tests = tests
        self.names = [name for name in CONSTANTS[:-1] if name in constants]
        self.starts = []
        if "start" in constants:
            self.starts = [test.name for test in tests]
        self.heights = sum(model.h0)
        loads = np.concatenate([test.load for test in tests])
        self.measured = np.isfinite(loads)
        self.loads = loads
        rows = int(self.measured.sum())
        if rows <= self.size:
            line = f"{rows} loads do not determine {self.size} constants"
            raise InputError(line, key="fitted")

    @property
    def size(self):
        return len(self.names) + len(self.starts)

    @cached_property
    def start_scale(self):
        """[-] unit of the starts: strains in which crimp is taken out."""
        return max(max(yarn.crimp for yarn in self.model.fabric.weave.yarns), 1e-4)

    def values_of(self, x):
        """{name: value [SI]} of x."""
        found = {name: exp(part) for name, part in zip(self.names, x)}
        for name, part in zip(self.starts, x[len(self.names) :]):
            found[f"start of {name}"] = self.start_scale * part
        return found

    def model_of(self, x):
        """The cell with the constants x."""
        values = self.values_of(x)
        fabric = self.model.fabric
        crimps = {}
        for name, yarn in zip(DIRECTIONS, fabric.weave.yarns):
            crimps[name] = values.get(f"{name} crimp", yarn.crimp)
        fabric = fabric.with_yarns(crimp=tuple(crimps.values()))
        laws = self.model.laws or self.model.fabric.laws
        if "a" in values or "b" in values:
            a = values.get("a", laws and laws[0].a)
            law = CompressionLaw(a, values.get("b", laws and laws[0].b))
            laws = (law, law)
        stiffening = values.get("stiffening", self.model.stiffening)
        cell = replace(
            self.model, fabric=fabric, laws=laws, stiffening=stiffening, crossover_gap=0.0
        )
        gap = self.model.crossover_gap
        if "h" in values:
            gap = max(sum(cell.h0) - values["h"], 0.0)
        return replace(cell, crossover_gap=gap)

    def starts_of(self, x):
        """{name of a test: its start [-]}"""
        return dict(zip(self.starts, self.start_scale * np.asarray(x[len(self.names) :])))

    def residuals(self, x, weights):
        """(rows,) measured less computed loads over the errors of their families."""
        try:
            cell = self.model_of(x)
            starts = self.starts_of(x)
            computed = np.concatenate(
                [loads_of(cell, test, starts.get(test.name, 0.0)) for test in self.tests]
            )
        except (UnstableError, InputError):
            return np.full(int(self.measured.sum()), NOT_CLOSED)
        return ((self.loads - computed) / weights)[self.measured]

    @cached_property
    def bounds(self):
        """(lowest, highest) of x."""
        low = {"a": 1e-4 * self.heights, "b": 1e-6 * self.heights, "h": 0.2 * self.heights}
        high = {"a": 0.999 * self.heights, "b": 1e3 * self.heights, "h": self.heights}
        low["stiffening"], high["stiffening"] = STIFFENINGS
        low |= dict.fromkeys(("warp crimp", "weft crimp"), 1e-5)
        high |= dict.fromkeys(("warp crimp", "weft crimp"), 0.5)
        # a start of more than the crimp would be another test
        starts = [1.0] * len(self.starts)
        lowest = [log(low[name]) for name in self.names]
        highest = [log(high[name]) for name in self.names]
        return np.array(lowest + [-2.0 * one for one in starts]), np.array(highest + starts)

    def begin(self, weights):
        """The best of some first guesses."""
        yarns = self.model.fabric.weave.yarns
        known = dict(zip(("warp crimp", "weft crimp"), (yarn.crimp for yarn in yarns)))
        known |= {"h": 0.98 * self.heights, "stiffening": FIRST_STIFFENING}
        strength = min(yarn.strength for yarn in yarns)
        laws = [
            (share * self.heights, share * self.heights * (part * strength) ** (1 / 3))
            for share, part in product(FIRST_A, FIRST_F0)
        ]
        own = self.model.laws or self.model.fabric.laws
        if own:
            laws.insert(0, (own[0].a, own[0].b))
        guesses = []
        for a, b in laws:
            values = known | {"a": a, "b": b}
            guesses.append([log(values[name]) for name in self.names] + [0.0] * len(self.starts))
        guesses = [np.clip(guess, *self.bounds) for guess in guesses]
        return min(guesses, key=lambda x: np.sum(self.residuals(x, weights) ** 2))

    def minimise(self, x, weights, held=None):
        """The x of the least sum of squares, from x; `held` is the index of one that stays."""
        free = [k for k in range(self.size) if k != held]
        if not free:
            return np.array(x)
        low, high = (bound[free] for bound in self.bounds)
        full = np.array(x)

        def residuals(part):
            full[free] = part
            return self.residuals(full, weights)

        inside = np.clip(full[free], low + 1e-9, high - 1e-9)
        found = least_squares(residuals, inside, bounds=(low, high), x_scale="jac", xtol=1e-10)
        full[free] = found.x
        return full

    def solve(self):
        """(x, weights (2,)) with the errors of warp and weft found by fitting again."""
        weights = np.array([1.0, 1.0])
        for m, loads in enumerate(self.loads.T):
            if np.isfinite(loads).any():
                weights[m] = max(float(np.nanmax(np.abs(loads))), 1e-12)
        x = self.begin(weights)
        for _ in range(PASSES):
            x = self.minimise(x, weights)
            weights = self.errors(x, weights)
        return x, weights

    def errors(self, x, weights):
        """(2,) [N] rms residual of warp and weft, over their share of the degrees of freedom."""
        full = np.full(self.loads.shape, nan)
        full[self.measured] = self.residuals(x, weights)
        count = self.measured.sum(axis=0)
        left = 1 - self.size / count.sum()
        found = np.array(weights)
        for m in range(2):
            if count[m]:
                rms = sqrt(np.nansum(full[:, m] ** 2) / (count[m] * left)) * weights[m]
                # loads without any error would have no weight
                found[m] = max(rms, 1e-9 * np.nanmax(np.abs(self.loads[:, m])))
        return found

    def describe(self, x, weights, tests, provenance):
        """The BiaxialFit of a solution."""
        covariance = self.covariance(x, weights)
        error = np.sqrt(np.diag(covariance))
        reach = self.reach(x, weights)
        correlation = covariance / np.outer(error, error)
        names = list(self.values_of(x))
        constants = []
        for k, name in enumerate(names):
            ends = [self.end(x, weights, k, side * error[k], reach[k]) for side in (-1, 1)]
            constants.append(self.constant(x, k, name, ends))
        model = self.model_of(x)
        law = self.law_of(model, constants, x, provenance)
        model = replace(model, laws=(law, law))
        starts = self.starts_of(x)
        greatest = np.nanmax([test.greatest for test in tests], axis=0)
        compared = [self.compare(model, test, starts, greatest) for test in tests]
        return BiaxialFit(model, law, tuple(constants), correlation, tuple(compared))

    def covariance(self, x, weights):
        """(p, p) s^2 (J^T J)^-1 of x."""
        jacobian = self.jacobian(x, weights)
        norms = np.linalg.norm(jacobian, axis=0)
        if not (norms > 0).all():
            loose = [name for name, norm in zip(self.values_of(x), norms) if not norm > 0]
            line = f"the chosen tests do not depend on {' and '.join(loose)}"
            raise InputError(line, key="fitted", value=", ".join(test.name for test in self.tests))
        squares = float(np.sum(self.residuals(x, weights) ** 2))
        variance = max(squares / (int(self.measured.sum()) - self.size), 1e-30)
        # columns of one length: constants differ by decades
        inverse = np.linalg.pinv((jacobian / norms).T @ (jacobian / norms))
        return variance * inverse / np.outer(norms, norms)

    def jacobian(self, x, weights):
        """(rows, p) by central differences."""
        columns = []
        for k in range(self.size):
            step = 1e-5 * np.eye(self.size)[k]
            rise = self.residuals(x + step, weights) - self.residuals(x - step, weights)
            columns.append(rise / 2e-5)
        return np.stack(columns, axis=1)

    def reach(self, x, weights):
        """(p,) [-] half widths of the intervals in standard errors, t sqrt(m)."""
        jacobian = self.jacobian(x, weights)
        # what each load adds to the variance of each constant
        parts = np.linalg.pinv(jacobian) ** 2
        _, family = np.nonzero(self.measured)
        count = self.measured.sum(axis=0)
        freedom = count * (1 - self.size / count.sum())
        found = []
        for part in parts:
            total = part.sum()
            inverse = 0.0
            more = 1.0
            for m in range(2):
                if count[m]:
                    share = part[family == m].sum() / total
                    inverse += share**2 / freedom[m]
                    more += 4 * share * (1 - share) / freedom[m]
            found.append(float(student.ppf(0.5 + CONFIDENCE / 2, 1 / inverse)) * sqrt(more))
        return found

    def end(self, x, weights, k, error, wanted):
        """The end of the profile's interval of x[k] on the side of `error`, its standard error with
        a sign, `wanted` of which it is wide; infinite if there is none within the bounds."""
        squares = float(np.sum(self.residuals(x, weights) ** 2))
        variance = squares / (int(self.measured.sum()) - self.size)
        if not variance > 0:
            return x[k]
        side = float(np.sign(error))
        low, high = (bound[k] for bound in self.bounds)
        room = max(x[k] - low, 0.0)
        if side > 0:
            room = max(high - x[k], 0.0)
        at = np.array(x)

        # the search begins where the last one ended, and a place has one value
        @cache
        def short(way):
            if way == 0:
                return -wanted
            at[k] = x[k] + side * way
            at[:] = self.minimise(at, weights, held=k)
            rise = np.sum(self.residuals(at, weights) ** 2) - squares
            return sqrt(max(rise, 0.0) / variance) - wanted

        # t of the profile rises nearly in proportion with the way
        way = min(wanted * abs(error), FURTHEST, room)
        while short(way) < 0:
            if way >= room:
                return side * inf
            way = min(2 * way, room)
        return x[k] + side * brentq(short, 0.0, way, xtol=NEAR * way, rtol=NEAR)

    def profiles(self, x, weights):
        """{name: (places [SI], rises of the least sum of squares over s^2)} of a and b, as far as
        they are free."""
        squares = float(np.sum(self.residuals(x, weights) ** 2))
        variance = max(squares / (int(self.measured.sum()) - self.size), 1e-30)
        error = np.sqrt(np.diag(self.covariance(x, weights)))
        found = {}
        for k, name in enumerate(self.names):
            if name not in ("a", "b"):
                continue
            low, high = (bound[k] for bound in self.bounds)
            places = np.clip(x[k] + PROFILE * error[k], low, high)
            rises = []
            for place in places:
                at = np.array(x)
                at[k] = place
                at = self.minimise(at, weights, held=k)
                rises.append((np.sum(self.residuals(at, weights) ** 2) - squares) / variance)
            found[name] = (np.exp(places), np.maximum(rises, 0.0))
        return found

    def constant(self, x, k, name, ends):
        """The Constant of x[k] with the ends of its interval in x."""
        if k < len(self.names):
            low, high = np.exp(ends)
            return Constant(name, exp(x[k]), float(low), float(high), UNITS[name])
        scale = self.start_scale
        return Constant(name, scale * x[k], scale * ends[0], scale * ends[1], "%")

    def law_of(self, model, constants, x, provenance):
        """The CompressionLaw with its intervals."""
        law = model.used_laws[0]
        found = {constant.name: constant for constant in constants}
        forces = []
        starts = self.starts_of(x)
        for test in self.tests:
            if not test.free:
                strain = test.strain + starts.get(test.name, 0.0) * test.direction
                forces.append(model.solve(*(1 + strain.T))["F"])
        reached = None
        if forces:
            every = np.concatenate(forces)
            reached = (float(every.min()), float(every.max()))
        intervals = {}
        for name in ("a", "b"):
            if name in found:
                intervals[f"{name}_interval"] = (found[name].low, found[name].high)
        return CompressionLaw(
            law.a,
            law.b,
            law.form,
            provenance or law.provenance,
            F_range=reached,
            fabric=model.fabric.name,
            **intervals,
        )

    def compare(self, model, test, starts, greatest):
        """The Comparison of a test."""
        start = starts.get(test.name, 0.0)
        computed = np.where(np.isfinite(test.load), loads_of(model, test, start), nan)
        if test.name in [one.name for one in self.tests]:
            return Comparison(test, computed, True, greatest, start)

        def off(shift):
            away = (test.load - loads_of(model, test, shift)) / greatest
            return np.nansum(away**2)

        reach = 0.5 * self.start_scale
        own = float(minimize_scalar(off, bounds=(-reach, reach), method="bounded").x)
        rms = _rms(test.load - loads_of(model, test, own))
        return Comparison(test, computed, False, greatest, start, own, rms)


def loads_of(model: CellModel, test: BiaxialTest, start: float = 0.0) -> FloatArray:
    """Compute the loads (n, 2) [N] of a yarn of warp and weft at the strains of a test, which begin
    too late by `start` [-]; zero of a free direction.

    Raises
    ------
    UnstableError : a cell that does not close
    """
    stretch = 1 + test.strain + start * test.direction
    if test.free:
        other = 1 - DIRECTIONS.index(test.free)
        loads = np.zeros_like(stretch)
        loads[:, other] = model.alone(other, stretch[:, other])
        return loads
    solved = model.solve(*stretch.T)
    return np.stack([solved["T1"], solved["T2"]], axis=1)


def _rms(residuals):
    """[N] of the columns of residuals (n, 2); nan of one without any."""
    found: list[Any] = [nan, nan]
    for m, column in enumerate(residuals.T):
        known = column[np.isfinite(column)]
        if known.size:
            found[m] = float(np.sqrt(np.mean(known**2)))
    return found[0], found[1]


def find_likeness(residuals: FloatArray) -> float:
    """Compute the correlation of neighbours in the columns of residuals (n, 2), the larger one."""
    found = [0.0]
    for column in residuals.T:
        known = column[np.isfinite(column)]
        if known.size > 2 and np.any(known):
            found.append(float(np.sum(known[1:] * known[:-1]) / np.sum(known**2)))
    return max(found)


def _spread(constant):
    return constant.spread
