"""Pull-outs of a laboratory, and the friction between yarns that they tell.

The highest load of a yarn drawn through n held crossovers is that of `coupon.pull_out`, each slipping
at c0 + mu F_c; both are fitted by least squares of the logarithm of the peaks. Two numbers of
crossings tell both, one tells mu for each c0 only. So do two tensions of the crossing yarns, if yarns
resist bending; flexible ones lie straight under any tension, and without it the same peaks need half
as much friction again. The covariance is s^2 (J^T J)^-1, s from repeats and, of three or more numbers
of crossings, what the model misses of them. In a logarithm the peak is close to a straight line of mu
and ln c0, so that intervals of 90 %, Student's t, hold: of 100 noises of 10 % in five repeats of 10
and 20 crossings 89 had the friction that went in.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import exp, inf, log, sqrt
from typing import Any

import numpy as np
from scipy.optimize import brentq, least_squares
from scipy.stats import f as fisher
from scipy.stats import t as student

from fabrics.base import tables
from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.counted import counted
from fabrics.base.errors import InputError
from fabrics.base.units import refused
from shellfabric.coupon.pull_out import PullOut

CONFIDENCE = 0.9
YARNS = {"warp": "warp", "weft": "weft", "fill": "weft", "filling": "weft"}
# rows that a record of load and displacement has at least
FEWEST_ROWS = 10
MOST_CROSSINGS = 400
# shares of the peak between which the rise of a record is taken for straight: where its line meets
# no load, the slack of the machine ends
RISE = (0.2, 0.6)
# share of a record's displacement within whose end a peak may be no peak
END = 0.02
# [-] of the peak: a higher load at the beginning is no zero of the load cell
ZERO = 0.1
# crossings below which clamp and tail weigh as much as they
FEW = 5
# [-] standard deviation of the logarithm of repeats: that of yarns of one cloth is about .1
WIDE = 0.25
# [-] the slopes of the peaks in mu, over those in ln c0, differ by this at least, or else the tests
# tell one number only: those of 10 and 12 crossings do by .16
APART = 0.1
# [N] of crossing yarns whose tension nobody gave: any tension makes flexible ones straight, more of
# it does little
TENSED = 1.0
# probability with which peaks that the model meets are taken for such that it does not
UNLIKELY = 0.01
# [-] of the first guess: a lower c0 is none
LEAST = 1e-4
MOST_FRICTION = 5.0
# [-] of mu and ln c0, for slopes
STEP = 1e-4


@dataclass(frozen=True, eq=False)
class PullOutTest:
    """A yarn that was drawn out.

    Parameters
    ----------
    name : as the table has it, or its number
    pulled : "warp" or "weft"
    crossings : that the yarn is drawn through
    tension : [N] of each crossing yarn; None if it is not given
    peak : [N] highest load
    displacement, load : (n,) [m], [N] up to the largest displacement; empty of a table of peaks
    """

    name: str
    pulled: str
    crossings: int
    tension: float | None
    peak: float
    displacement: FloatArray = field(default_factory=lambda: np.empty(0))
    load: FloatArray = field(default_factory=lambda: np.empty(0))

    @property
    def group(self) -> tuple[str, int, float | None]:
        """What its repeats have in common."""
        return self.pulled, self.crossings, self.tension

    @property
    def at_peak(self) -> float | None:
        """[m] displacement of the crosshead at the peak, without slack; None of a table of peaks."""
        if not self.load.size:
            return None
        return float(self.displacement[np.argmax(self.load)]) - self.zero

    @property
    def slack(self) -> float | None:
        """[m] that the crosshead moves before the yarn is loaded; None of a table of peaks."""
        if not self.load.size:
            return None
        return self.zero - float(self.displacement[0])

    @cached_property
    def zero(self) -> float:
        """[m] displacement at which the straight part of the rise meets no load."""
        return find_zero(self.displacement, self.load)

    @property
    def doubts(self) -> Iterator[str]:
        """What is doubtful of its record."""
        if not self.load.size:
            return
        span = np.ptp(self.displacement)
        if self.displacement[np.argmax(self.load)] > self.displacement[-1] - END * span:
            yield f"test {self.name}: the peak is at the end of the record, it may still rise"
        start = float(np.median(self.load[:3]))
        if abs(start) > ZERO * self.peak:
            yield f"test {self.name}: the load begins at {start:.3g} N, not at 0"


def find_zero(displacement: FloatArray, load: FloatArray) -> float:
    """Find the displacement [m] at which the straight part of the rise to the peak meets no load."""
    top = int(np.argmax(load))
    shares = load[: top + 1] / load[top]
    low, high = (np.flatnonzero(shares <= share) for share in RISE)
    # the load is there from the first row on
    if not low.size:
        return float(displacement[0])
    first, last = low[-1], max(high[-1], low[-1] + 1)
    moved = displacement[last] - displacement[first]
    rise = load[last] - load[first]
    if not (moved > 0 and rise > 0):
        return float(displacement[first])
    return float(max(displacement[first] - load[first] * moved / rise, displacement[0]))


def read(
    path: FilePath,
    spacing: Mapping[str, float],
    *,
    crossings: int | None = None,
    tension: float | None = None,
    pulled: str | None = None,
) -> list[PullOutTest]:
    """Read pull-outs from a table of users (`fabrics.base.tables`): records of load and displacement
    one below the other, or a row a test with its peak.

    The columns are "displacement [mm]" and "force [N]", or "peak load [N]"; "crossings", or "length
    [mm]" of the yarn in the fabric; and, where they are known, "test", "pulled" (warp or weft), and
    "tension [N]" of each crossing yarn, or "transverse load [N]" of all of them together. A record
    ends where one of these changes, or the displacement falls back.

    Parameters
    ----------
    spacing : {"warp", "weft": [m]} of the crossovers along a yarn of this family
    crossings, tension, pulled : of a table that has no such columns; [-], [N]

    Raises
    ------
    InputError : one line naming the file, the line, the value and what is allowed
    """
    found = tables.read_table(
        path,
        {
            "test": tables.WORDS,
            "pulled": tables.WORDS,
            "crossings": tables.COUNTS,
            "length": "m",
            "tension": "N",
            "transverse load": "N",
            "displacement": "m",
            "force": "N",
            "peak": "N",
        },
        what="a table of pull-outs, CSV",
        example="force [N]",
        either=("force", "peak"),
        optional=(
            *("test", "pulled", "crossings", "length", "tension", "transverse load"),
            "displacement",
        ),
    )
    if not found.lines:
        raise InputError("has no pull-out", file=path, allowed="a heading and a row for each")
    if "force" in found.cells and "displacement" not in found.cells:
        allowed = 'displacement beside force; a table with a row a test has "peak load [N]"'
        raise InputError(file=path, key="columns", value="force", allowed=allowed)
    usual = {"crossings": crossings, "tension": tension, "pulled": pulled}
    for name in usual:
        others = {"crossings": "length", "tension": "transverse load"}
        if usual[name] is not None and {name, others.get(name)} & set(found.cells):
            raise InputError(key=name, allowed=f"left out: {path} has it in a column")
    rows = [_row(found, line, cells, spacing, usual) for line, cells in found.rows()]
    if "peak" in found.cells:
        return [
            PullOutTest(row["test"] or f"{number}", *row["group"], row["load"])  # type: ignore[call-arg]
            for number, row in enumerate(rows, 1)
        ]
    return [_record(path, number, part) for number, part in enumerate(_split(rows), 1)]


def _row(table, line, cells, spacing, usual):
    """Return {"test", "group", "displacement", "load", "line"} of a line of a Table, in SI."""

    def refusal(name, allowed):
        return refused(cells[name], allowed, file=table.path, key=f"{line}, {name}")

    def number(name, least=0.0, equal=True):
        value = table.number(line, name, cells[name])
        if value < least or (not equal and value == least):
            raise refusal(name, f"{'at least' if equal else 'above'} {least:g}")
        return value

    pulled = usual["pulled"] or "warp"
    if cells.get("pulled"):
        family = YARNS.get(cells["pulled"].lower())
        if family is None:
            raise refusal("pulled", "warp or weft")
        pulled = family
    count = usual["crossings"]
    if cells.get("crossings"):
        count = number("crossings", 1)
        if count != round(count) or count > MOST_CROSSINGS:
            raise refusal("crossings", f"a whole number, 1 to {MOST_CROSSINGS}")
    elif cells.get("length"):
        count = number("length", equal=False) / spacing[pulled]
        if not 1 <= round(count) <= MOST_CROSSINGS:
            raise refusal(
                "length", f"1 to {MOST_CROSSINGS} crossings of {1e3 * spacing[pulled]:.3g} mm"
            )
    if count is None:
        allowed = "given for each test: a column crossings, or length, or the option crossings"
        raise InputError(file=table.path, key=f"{line}, crossings", allowed=allowed)
    count = round(count)
    tension = usual["tension"]
    if cells.get("tension"):
        tension = number("tension")
    elif cells.get("transverse load"):
        tension = number("transverse load") / count
    row = {"test": cells.get("test", ""), "group": (pulled, count, tension), "line": line}
    if "peak" in cells:
        return row | {"load": number("peak", equal=False)}
    return row | {
        name: table.number(line, column, cells[column])
        for name, column in (("displacement", "displacement"), ("load", "force"))
    }


def _split(rows):
    """Return the lists of the rows of a record each."""
    span = np.ptp([row["displacement"] for row in rows])
    parts: dict[Any, list] = {}
    done = []
    for row in rows:
        key = row["test"], row["group"]
        # without names a record ends with the next
        if not row["test"] and key not in parts:
            done += parts.values()
            parts.clear()
        part = parts.setdefault(key, [])
        if part:
            moved = [one["displacement"] for one in (part[0], part[-1])]
            back = moved[1] - row["displacement"]
            if back > 0.05 * span and back > 0.5 * (moved[1] - moved[0]):
                done.append(part)
                parts[key] = part = []
        part.append(row)
    return [*done, *parts.values()]


def _record(path, number, rows):
    """Return the PullOutTest of the rows of a record."""
    name = rows[0]["test"] or f"{number}"
    if len(rows) < FEWEST_ROWS:
        allowed = (
            f'at least {FEWEST_ROWS} of each test; a table with a row a test has "peak load [N]"'
        )
        raise InputError(
            file=path,
            key=f"{rows[0]['line']}, rows of test {name}",
            value=len(rows),
            allowed=allowed,
        )
    moved = np.array([row["displacement"] for row in rows])
    last = int(np.argmax(moved)) + 1
    load = np.array([row["load"] for row in rows])[:last]
    # the median of three neighbours: a spike of one sample is no peak
    load[1:-1] = np.median([load[:-2], load[1:-1], load[2:]], axis=0)
    peak = float(load.max(initial=0.0))
    if not peak > 0:
        raise InputError(
            file=path,
            key=f"{rows[0]['line']}, peak load of test {name}",
            value=f"{peak:g} N",
            allowed="above 0: a yarn of no load has no friction that could be told",
        )
    return PullOutTest(name, *rows[0]["group"], peak, moved[:last], load)


@dataclass(frozen=True, eq=False)
class PullOutGroup:
    """Repeats of one pull-out.

    Parameters
    ----------
    coupon : PullOut of their crossings and tension
    tests : of them
    """

    coupon: PullOut
    tests: tuple[PullOutTest, ...]

    @property
    def logs(self) -> FloatArray:
        """(tests,) logarithms of the peaks [N]."""
        return np.log([test.peak for test in self.tests])

    @property
    def mean(self) -> float:
        """[N] geometric mean of the peaks."""
        return exp(self.logs.mean())

    def log_peak(self, mu: float, log_cohesion: float) -> float:
        """Compute the logarithm of the peak [N]; twice the strength stands for a yarn that breaks."""
        try:
            return log(self.coupon.changed(mu=mu, cohesion=exp(log_cohesion)).peak)
        except InputError:
            return log(2 * self.coupon.table.model.fabric.weave.warp.strength)

    def find_log_cohesion(self, mu: float) -> float | None:
        """Find ln c0 [N] with which a friction meets the mean of the peaks; None if no c0 does."""
        # without friction the peak is c0 for each crossing
        high = log(self.mean / self.coupon.crossings)
        low = high + log(LEAST)

        def excess(log_cohesion):
            return self.log_peak(mu, log_cohesion) - log(self.mean)

        if excess(low) > 0:
            return None
        if excess(high) <= 0:
            return high
        return float(brentq(excess, low, high, xtol=1e-4))


@dataclass(frozen=True)
class FittedFriction:
    """Friction of a crossover, c0 + mu F_c, from pull-outs.

    Parameters
    ----------
    groups : repeats of the same pull-out each
    mu : [-]; None if the tests tell no mu without c0
    cohesion : [N] c0; None likewise
    mu_error : [-] standard error of mu; None without repeats
    log_error : [-] standard error of ln c0
    freedom : degrees of freedom of the errors
    scatter : [-] standard deviation of repeats about the mean of their logarithms; None without
    misfit : [-] probability that repeats miss the fit by as much, of three or more groups; else None
    pairs : (mu, c0 [N]) each of which meets the peaks, where the tests tell one number only
    tensed : [-] mu if the crossing yarns had the tension TENSED, where none is given; else None
    """

    groups: tuple[PullOutGroup, ...]
    mu: float | None = None
    cohesion: float | None = None
    mu_error: float | None = None
    log_error: float | None = None
    freedom: int = 0
    scatter: float | None = None
    misfit: float | None = None
    pairs: tuple[tuple[float, float], ...] = ()
    tensed: float | None = None

    @property
    def tests(self) -> tuple[PullOutTest, ...]:
        """All tests, by groups."""
        return tuple(test for group in self.groups for test in group.tests)

    @property
    def quantile(self) -> float:
        """Half width of an interval of CONFIDENCE over its standard error."""
        return float(student.ppf(0.5 + CONFIDENCE / 2, self.freedom))

    @property
    def mu_interval(self) -> tuple[float, float] | None:
        """(low, high) [-] of CONFIDENCE; None without repeats."""
        if self.mu is None or self.mu_error is None:
            return None
        half = self.quantile * self.mu_error
        return max(self.mu - half, 0.0), self.mu + half

    @property
    def cohesion_interval(self) -> tuple[float, float] | None:
        """(low, high) [N] of CONFIDENCE; None without repeats."""
        if self.cohesion is None or self.log_error is None:
            return None
        factor = exp(self.quantile * self.log_error)
        return self.cohesion / factor, self.cohesion * factor

    @property
    def is_flexible(self) -> bool:
        """Whether the yarns resist no bending, so that their peaks hardly depend on the tension."""
        return not any(self.groups[0].coupon.bending)

    def computed(self, coupon: PullOut) -> float | None:
        """Compute the peak [N] of a pull-out with the fitted friction; None without one."""
        if self.mu is None or self.cohesion is None:
            return None
        return coupon.changed(mu=self.mu, cohesion=self.cohesion).peak

    @property
    def doubts(self) -> tuple[str, ...]:
        """What is doubtful of the tests and of the fit."""
        found = []
        if self.mu is None:
            found.append("the tests tell one number, not both friction and c0")
        elif self.mu_interval is None:
            found.append("no test was repeated: there is no interval")
        elif self.mu_interval[0] <= 0:
            found.append("the interval of the friction reaches 0: more repeats, or a longer yarn")
        if self.misfit is not None and self.misfit < UNLIKELY:
            found.append(
                "no one friction meets all peaks: they miss it by more than repeats scatter"
            )
        if self.scatter is not None and self.scatter > WIDE:
            found.append(
                f"repeats scatter by {100 * self.scatter:.0f} %, beyond {100 * WIDE:.0f} %"
            )
        found += [doubt for test in self.tests for doubt in test.doubts]
        few = min(group.coupon.crossings for group in self.groups)
        if few < FEW:
            words = counted(few, "crossing")
            found.append(f"{words}: below {FEW} the clamp and the tail weigh as much as they")
        if any(test.tension is None for test in self.tests):
            text = "the tension of the crossing yarns is not given, taken as 0 N"
            if self.tensed is not None:
                text += f": with {TENSED:g} N the friction is {self.tensed:.3f}"
            found.append(text)
        return tuple(found)


def group_tests(
    tests: Iterable[PullOutTest], make: Mapping[str, PullOut]
) -> tuple[PullOutGroup, ...]:
    """Group the repeats of each pull-out, the fewest crossings first.

    Parameters
    ----------
    make : {"warp", "weft": PullOut} of the families that are pulled; crossings and tension are those
        of the tests

    Raises
    ------
    InputError : a peak beyond the strength of the yarn, or what `PullOut` refuses
    """
    sorted_tests: dict[Any, list[PullOutTest]] = {}
    for test in tests:
        sorted_tests.setdefault(test.group, []).append(test)
    groups = []
    cells: dict[Any, PullOut] = {}
    for (pulled, crossings, tension), repeats in sorted_tests.items():
        strength = make[pulled].table.model.fabric.weave.warp.strength
        for test in repeats:
            if test.peak >= strength:
                allowed = f"below the strength of the yarn, {strength:.4g} N: it breaks"
                value = f"{test.peak:.4g} N"
                raise InputError(key=f"peak load of test {test.name}", value=value, allowed=allowed)
        # the cell under a tension is one for all lengths
        cell = pulled, tension or 0.0
        if cell not in cells:
            cells[cell] = replace(make[pulled], pre_tension=cell[1])
            _ = cells[cell].contact_forces
        coupon = cells[cell].changed(crossings=crossings)
        groups.append(PullOutGroup(coupon, tuple(repeats)))
    return tuple(sorted(groups, key=lambda one: (one.coupon.crossings, one.coupon.pre_tension)))


def reduce(
    tests: Sequence[PullOutTest], make: Mapping[str, PullOut], usual: Sequence[float]
) -> FittedFriction:
    """Fit friction and c0 to tests, and tell what a tension that is not given would change; the
    arguments are those of `group_tests` and `fit`."""
    found = fit(group_tests(tests, make), usual)
    if found.mu is None or all(test.tension is not None for test in tests):
        return found
    others = [test if test.tension is not None else replace(test, tension=TENSED) for test in tests]
    return replace(found, tensed=fit(group_tests(others, make), usual).mu)


def fit(groups: Sequence[PullOutGroup], usual: Sequence[float]) -> FittedFriction:
    """Fit friction and c0 to the peaks of the tests.

    c0 multiplies all peaks nearly alike; mu follows from how much faster than the number of crossings
    they grow.

    Parameters
    ----------
    usual : frictions [-] that stand for all, of which the c0 is told if the tests do not tell both

    Raises
    ------
    InputError : peaks that grow less than the number of crossings, which no friction does
    """
    groups = tuple(groups)
    count = np.array([len(group.tests) for group in groups])
    peaks = np.concatenate([group.logs for group in groups])
    inside = np.concatenate([group.logs - group.logs.mean() for group in groups])
    repeated = int(count.sum() - len(groups))
    scatter = sqrt(float(inside @ inside) / repeated) if repeated else None
    # those of the middle; c0 of each mu alone is told by any one group
    first = float(np.median(usual))
    start = groups[0].find_log_cohesion(first)
    if len(groups) == 1 or start is None or not _are_apart(groups, first, start):
        pairs = []
        for mu in usual:
            found = groups[0].find_log_cohesion(mu)
            pairs.append((float(mu), 0.0 if found is None else exp(found)))
        return FittedFriction(groups, scatter=scatter, pairs=tuple(pairs))

    def residuals(values):
        computed = [group.log_peak(*values) for group in groups]
        return np.repeat(computed, count) - peaks

    def slopes(values):
        # steps of their own: those of scipy are shares of mu, which may be 0
        at = residuals(values)
        steps = STEP * np.eye(2)
        return np.transpose([(residuals(values + step) - at) / STEP for step in steps])

    lowest = start + log(LEAST)
    found = least_squares(
        residuals,
        (first, start),
        bounds=((0.0, lowest), (MOST_FRICTION, inf)),
        jac=slopes,
        x_scale=(0.1, 0.5),
        xtol=1e-6,
        ftol=1e-8,
    )
    mu, log_cohesion = (float(value) for value in found.x)
    freedom = len(peaks) - 2
    mu_error = log_error = None
    misfit = None
    # the highest mu that repeats allow, below 0 too
    inverse = np.linalg.pinv(found.jac.T @ found.jac)
    highest = mu - float(inverse[0] @ found.jac.T @ found.fun)
    if freedom > 0 and repeated:
        squares = float(found.fun @ found.fun)
        mu_error, log_error = np.sqrt(squares / freedom * np.diag(inverse)).tolist()
        if len(groups) > 2 and scatter:
            missed = (squares - repeated * scatter**2) / (len(groups) - 2)
            misfit = float(fisher.sf(missed / scatter**2, len(groups) - 2, repeated))
    if scatter is not None:
        highest += (
            float(student.ppf(0.5 + CONFIDENCE / 2, repeated)) * scatter * sqrt(inverse[0, 0])
        )
    if highest <= 0:
        means = ", ".join(f"{one.mean:.3g} N of {one.coupon.crossings}" for one in groups)
        allowed = "growing at least as the number of crossings: no friction makes them grow less"
        raise InputError(key="peak loads", value=means, allowed=allowed)
    cohesion = exp(log_cohesion)
    return FittedFriction(groups, mu, cohesion, mu_error, log_error, freedom, scatter, misfit)


def _are_apart(groups, mu, log_cohesion):
    """Tell whether the groups tell mu and c0 from each other: their slopes differ."""
    step = 0.02
    tells = []
    for group in groups:
        at = group.log_peak
        by_mu = (at(mu + step, log_cohesion) - at(mu - step, log_cohesion)) / (2 * step)
        by_cohesion = (at(mu, log_cohesion + step) - at(mu, log_cohesion - step)) / (2 * step)
        tells.append(by_mu / max(by_cohesion, LEAST))
    return max(tells) - min(tells) > APART * max(tells)
