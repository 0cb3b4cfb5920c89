"""E_c, V_c and K_r of the solid yarn from measurements: a compression between platens (thesis section 3.4.3.2), biaxial
tests, or both. Least squares over the logarithms of both yarns together, so that no bound is needed,

    x = (ln E_c, ln (V_c - Vf0), ln K_r)        Vf0: the denser yarn's; K_r is kept below 1/2

G follows E_c (eq. 3-16). Each trial starts from the equilibria of an earlier one, which give the Jacobian as well
(`platen_states`, `biaxial_states`). Errors of platens, of loads of the warp and of the weft are the rms misfits of
each, over their share of the degrees of freedom, but at least what an instrument and a mesh can tell. The result is
computed once more on a finer mesh, loaded from rest. Intervals: `solid_record`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np
from scipy.stats import t as student

from fabrics.base.errors import InputError, UnstableError
from fabrics.fabric import Fabric
from fabrics.plate_curve import PlateCurve
from meshing import crossover as mesher
from meshing.inputs import Size
from unitcell3d.identify import least_squares
from unitcell3d.identify.biaxial_states import BiaxialSolver, PulledTest
from unitcell3d.identify.platen_misfit import POINTS
from unitcell3d.identify.platen_states import PlatenSolver
from unitcell3d.identify.solid_record import (
    LOOSE,
    NAMES,
    RESOLUTION,
    PlatenClosures,
    PulledLoads,
    SolidFit,
    greatest_loads,
    record,
    with_solid_laws,
)

BOUNDS = np.log([1e6, 1e-3, 3e-5]), np.log([1e12, 10.0, 0.5])
PRESSURE_ERROR = 0.15  # relative
# [-] of the greatest load: what a load cell and a mesh can tell
LOAD_RESOLUTION = 1e-3
PASSES = 3
FARTHEST = 1.5  # in a logarithm: how far along a direction a limit is sought
SEARCH = 4  # trials on each side of a direction
NEAR_LIMIT = 0.2  # relative error of the sum of squares that is enough
# of a logarithm: half widths up to which an interval is that of the covariance; first and furthest way
# to an end of a profile
STRAIGHT = 0.15
FIRST_WAY = 0.7
FURTHEST_WAY = 2.5
SOFTER = float(np.log(0.5))  # of ln E_c: from how far below a solution another is looked for
LINEAR = 0.05  # in a logarithm: within it the sum of squares is that of the covariance


def fit_solid(
    fabric: Fabric,
    curve: PlateCurve | None = None,
    tests: Sequence[PulledTest] = (),
    *,
    fitted: Sequence[str] = (),
    free: Sequence[str] = NAMES,
    size: Size = (4, 3, 2),
    check_size: Size | None = "coarse",
    on_progress: Callable[[int], object] | None = None,
) -> SolidFit:
    """Fit E_c, V_c and K_r of both yarns to a plate curve, biaxial tests, or both.

    Intervals come from the covariance (`solid_record`). Since its Jacobian is that of the solution,
    and a constant that is not determined goes far from it, two points are also sought on each
    principal direction of the covariance where the sum of squares itself has risen by what 95 %
    allow, F(1, n - p - 1) s^2: `SolidFit.limits`, from which the intervals of what follows from the
    constants are taken. An interval of a constant is at least as wide as the two points of all
    directions make it, added as squares, and has no end where one of them was not found. Those of
    constants that tests do not tell well, whose valley is bent, are those of the profile: where the
    least sum of squares over the other constants has risen by t^2.

    Parameters
    ----------
    fabric : Fabric, with solid laws to start from
    curve : fabrics.plate_curve.PlateCurve, or None
    tests : of PulledTest; those that are not fitted are predicted
    fitted : names of the tests that are fitted; all if none is given
    free : of `NAMES`
    size : mesh size of the fit (`meshing.crossover.build`)
    check_size : mesh size on which the result is computed once more, or None
    on_progress : called as on_progress(trials so far) after each trial

    Returns
    -------
    SolidFit

    Raises
    ------
    InputError : the fabric cannot be meshed, or too few measurements
    UnstableError : the crossover of the file's own solids does not reach half of the curve's
        pressures, or the strains of the tests
    """
    fit = _Fit(fabric, curve, tests, fitted, free, size, on_progress)
    try:
        before = fit.compute(fit.start())
        found = fit.solve()
        limits = fit.limits(found)
        profiles = fit.profiles(found) if tests else {}
        shown = fit.compute(found.x, before)
    finally:
        fit.close()
    if check_size is not None:
        shown = _on_mesh(fit, check_size, found.x, shown)
    return record(fit, found, shown, limits, (str(size), str(check_size)), profiles)


class _Platens:
    """A plate curve as evidence of the constants: closures against pressures.

    What platens close is compared with the curve at `POINTS` of its pressures. No test gives the
    thickness at rest or the moment of first touch well, so the mean of the misfit is taken out. The
    closures have weights 1 / sqrt(s^2 + RESOLUTION^2), s the closure that a `PRESSURE_ERROR` stands
    for: relative errors in pressure count about equally.
    """

    def __init__(self, curve, mesh, fabric, with_constants):
        self.curve = curve
        self.pressure = np.geomspace(curve.pressure[0], curve.pressure[-1], POINTS)
        self.measured = curve.at(self.pressure)
        # d closure / d ln P of the curve: the closure that a relative error of the pressure stands
        # for
        slope = np.gradient(self.measured, np.log(self.pressure))
        self.weight = 1 / np.hypot(PRESSURE_ERROR * slope, RESOLUTION)
        self.solver = PlatenSolver(mesh, fabric, with_constants, self.pressure)
        self.solvers = [self.solver]
        # the curve's offset uses up a degree of freedom
        self.groups = np.zeros(POINTS, int)
        self.offsets = 1
        # of a weighted misfit: what a mesh and an extensometer can tell
        self.floors = [RESOLUTION * float(np.sqrt(np.mean(self.weight**2)))]

    def compute(self, x, before=None):
        """Return PlatenClosures at x."""
        states = self.solver.at(x)
        if before is None and states.failed and states.pressure[-1] < 0.5 * self.pressure[-1]:
            raise UnstableError(f"no plate curve to fit: {states.failed}")
        closures = self._closures(states)
        found = PlatenClosures(self.curve, self.pressure, self.measured, closures, closures)
        if before is None:
            return found
        return replace(found, before=before.computed, failed=states.failed)

    def check(self, x, shown):
        """Return `shown` with the closures at x, at the pressures that are reached."""
        states = self.solver.at(x)
        return replace(shown, checked=self._closures(states)[: len(states.pressure)])

    def _closures(self, states):
        """Return (n,) [m] moved to the weighted mean of the measured ones."""
        at = states.closures(self.pressure)
        return at - self._mean(at - self.measured)

    def _mean(self, values):
        return np.average(values, axis=0, weights=self.weight**2)

    def evaluate(self, x):
        """Return the weighted misfit (n,), and its Jacobian (n, 3)."""
        states = self.solver.at(x)
        jacobian = states.jacobian(self.pressure)
        misfit = (self._closures(states) - self.measured) * self.weight
        return misfit, (jacobian - self._mean(jacobian)) * self.weight[:, None]


class _Pulls:
    """Biaxial tests as evidence of the constants: loads against strains.

    Loads are taken over the greatest of their family. Where there is more than one kind of
    evidence, its errors are found by fitting again.
    """

    offsets = 0

    def __init__(self, tests, fitted, mesh, fabric, with_constants):
        self._tests = list(tests)
        self._fitted = [test for test in tests if not fitted or test.name in fitted]
        self._others = [test for test in tests if test not in self._fitted]
        self._greatest = greatest_loads([test.load for test in tests])
        self._loads = np.concatenate([test.load for test in self._fitted])
        self._measured = np.isfinite(self._loads)
        self.groups = np.nonzero(self._measured)[1]
        self.floors = [LOAD_RESOLUTION] * 2
        self.solvers = [
            BiaxialSolver(mesh, fabric, with_constants, [test])
            for test in (*self._fitted, *self._others)
        ]

    def _computed(self, x):
        """Return {name of a test: loads (n, 2) [N] at x}; nan of a prediction that finds no
        equilibrium."""
        found = {}
        for test, solver in zip((*self._fitted, *self._others), self.solvers):
            try:
                found[test.name] = solver.loads(x, from_rest=True)[0][0]
            except UnstableError:
                if test in self._fitted:
                    raise
                found[test.name] = np.full_like(test.load, np.nan)
        return found

    def compute(self, x, before=None):
        """Return PulledLoads of all tests at x."""
        found = self._computed(x)
        names = [test.name for test in self._fitted]
        first = found if before is None else {one.name: one.computed for one in before}
        return tuple(
            PulledLoads(
                test.name,
                test.strain,
                test.load,
                found[test.name],
                first[test.name],
                test.name in names,
            )
            for test in self._tests
        )

    def check(self, x, shown):
        """Return `shown` with the loads at x."""
        found = self._computed(x)
        return tuple(replace(one, checked=found[one.name]) for one in shown)

    def evaluate(self, x):
        """Return the misfit (n,) of the measured loads over the greatest of their family, and its
        Jacobian (n, 3)."""
        solved = [solver.loads(x)[0] for solver in self.solvers[: len(self._fitted)]]
        loads, slopes = (np.concatenate(parts) for parts in zip(*solved))
        misfit = (loads - self._loads) / self._greatest
        slopes = slopes / self._greatest[:, None]
        return misfit[self._measured], slopes[self._measured]


class _Fit:
    """Trials of one fabric on one mesh, and their misfit to measurements."""

    def __init__(self, fabric, curve, tests, fitted, free, size, on_progress=None):
        mesh = mesher.build(fabric, size=size)
        assert fabric.solid_laws is not None  # else the mesher has refused it
        self.fabric = fabric
        self.given = curve, tests, fitted, free
        self._on_progress = on_progress
        self.densest = max(*mesh.Vf0, *(solid.Vf0 for solid in fabric.solid_laws))
        self.free = [k for k, name in enumerate(NAMES) if name in free]
        self.evidence = {}
        if curve is not None:
            self.evidence["platens"] = _Platens(curve, mesh, fabric, self.with_constants)
        if tests:
            self.evidence["pulls"] = _Pulls(tests, fitted, mesh, fabric, self.with_constants)
        groups = []
        floors = []
        for each in self.evidence.values():
            groups.append(each.groups + len(floors))
            floors += each.floors
        self._groups = np.concatenate(groups)
        self._floors = np.array(floors)
        self.errors = np.ones(len(floors))
        self.trials = 0
        offsets = sum(each.offsets for each in self.evidence.values())
        # degrees of freedom of the misfit
        self.freedom = len(self._groups) - len(self.free) - offsets
        if self.freedom < 1:
            allowed = f"more measurements than the {len(self.free)} constants that are fitted"
            raise InputError(key="measurements", value=len(self._groups), allowed=allowed)

    def start(self):
        """x of the fabric's own solids."""
        first = self.fabric.solid_laws[0]
        return np.clip(
            np.log([first.E_c, first.V_c - self.densest, first.K_r]),
            BOUNDS[0] + 1e-6,
            BOUNDS[1] - 1e-6,
        )

    def with_constants(self, x):
        """The fabric at x."""
        return with_solid_laws(self.fabric, x, self.densest)

    def compute(self, x, before=None):
        """Return {"platens": PlatenClosures or None, "pulls": PulledLoads of each test} at x,
        `before` those of the file."""
        found = {"platens": None, "pulls": ()}
        for name, each in self.evidence.items():
            found[name] = each.compute(x, before and before[name])
        return found

    def evaluate(self, x):
        """Return the misfit over its errors, and its Jacobian by all three constants; a trial without
        equilibria has a misfit that is not finite."""
        self.trials += 1
        count = len(self._groups)
        try:
            parts = [each.evaluate(x) for each in self.evidence.values()]
        except UnstableError:
            return np.full(count, np.nan), np.zeros((count, len(x)))
        if self._on_progress is not None:
            self._on_progress(self.trials)
        misfit, jacobian = (np.concatenate(each) for each in zip(*parts))
        errors = self.errors[self._groups]
        return misfit / errors, jacobian / errors[:, None]

    def solve(self):
        """Return the least_squares.Found of all three constants, those that are not free as they
        were."""
        x = self.start()
        free = self.free
        bounds = tuple(bound[free] for bound in BOUNDS)

        def of_free(part):
            misfit, jacobian = self.evaluate(self._full(x, part))
            return misfit, jacobian[:, free]

        # errors of one kind of evidence do not move the solution
        for turn in range(PASSES if len(np.unique(self._groups)) > 1 else 1):
            found = least_squares.solve(of_free, x[free], bounds)
            if turn == 0 and self._is_followed_badly(found):
                found = _look_below(found, of_free, bounds)
            x = self._full(x, found.x)
            self.errors = self._estimate_errors(x)
        misfit, jacobian = self.evaluate(x)
        return least_squares.Found(x, misfit, jacobian, found.met)

    def _is_followed_badly(self, found):
        """Whether the law of the solid misses the platens by more than they tell: such a sum of squares has more than
        one minimum, between which E_c differs by up to 1.7."""
        if "platens" not in self.evidence or 0 not in self.free:
            return False
        part = found.residual[self._groups == 0]
        return bool(np.sqrt(np.mean(part**2)) > self._floors[0])

    def _full(self, x, part):
        x = np.array(x)
        x[self.free] = part
        return x

    def _estimate_errors(self, x):
        """Return (g,) rms misfit of each kind of evidence over its share of the degrees of
        freedom."""
        misfit = self.evaluate(x)[0] * self.errors[self._groups]
        left = self.freedom / len(self._groups)
        found = np.array(self._floors)
        for group in np.unique(self._groups):
            part = misfit[self._groups == group]
            rms = np.sqrt(np.sum(part**2) / (len(part) * left))
            found[group] = max(rms, self._floors[group])
        return found

    def limits(self, found):
        """Return ((x low, whether it is open), (x high, ...)) on each principal direction of the
        covariance of the free constants."""
        jacobian = found.jacobian[:, self.free]
        _, singular, directions = np.linalg.svd(jacobian, full_matrices=False)
        least = np.sum(found.residual**2)
        allowed = student.ppf(0.975, self.freedom) ** 2
        found_limits = []
        for value, part in zip(np.maximum(singular, 1e-9), directions):
            direction = self._full(np.zeros(len(NAMES)), part)
            found_limits.append(
                tuple(
                    self._limit(
                        found.x, sign * direction, least + allowed, np.sqrt(allowed) / value
                    )
                    for sign in (-1, 1)
                )
            )
        return found_limits

    def _limit(self, x, direction, wanted, length):
        """Say where the sum of squares along a direction from x is as `wanted`, or as far as is
        sought, where the direction is open."""
        rooms = np.where(direction > 0, BOUNDS[1] - x, x - BOUNDS[0]) / np.maximum(
            np.abs(direction), 1e-12
        )
        farthest = min(FARTHEST, float(rooms.min()))
        if length < min(LINEAR, farthest):
            return x + length * direction, False
        length = min(length, farthest)
        is_open = False
        inside = 0.0
        outside = np.inf
        for _ in range(SEARCH):
            square = float(np.sum(self.evaluate(x + length * direction)[0] ** 2))
            is_open = square < wanted and length >= farthest
            if abs(square / wanted - 1) < NEAR_LIMIT or is_open:
                break
            if square < wanted:
                inside = length
            else:
                outside = length
            length = 0.5 * (inside + outside)
            if np.isinf(outside):
                length = min(2 * inside, farthest)
        return x + length * direction, is_open

    def profiles(self, found):
        """Return {name: (low, high) of its logarithm, 95 %} of constants, and of K_r E_c, that are
        not told well enough for the covariance: where the least sum of squares over the others has
        risen by t^2."""
        unit = np.eye(len(NAMES))
        wanted = {name: unit[k] for k, name in enumerate(NAMES) if k in self.free}
        if {0, 2} <= set(self.free):
            wanted[LOOSE] = unit[0] + unit[2]
        student_t = float(student.ppf(0.975, self.freedom))
        inverse = np.linalg.pinv(found.jacobian[:, self.free], rcond=1e-9)
        covariance = inverse @ inverse.T
        ends = {}
        for name, toward in wanted.items():
            part = toward[self.free]
            deviation = float(np.sqrt(part @ covariance @ part))
            if student_t * deviation < STRAIGHT:
                continue
            along = self._full(np.zeros(len(NAMES)), covariance @ part / deviation**2)
            low, high = (
                self._profile_end(found, toward, along, side, student_t, deviation)
                for side in (-1, 1)
            )
            ends[name] = low, high
        return ends

    def _profile_end(self, found, toward, along, side, wanted, deviation):
        """Return ln of the constant, toward . x, at an end of its profile; infinite if there is
        none as far as is sought, that of the covariance if equilibria end before. `along` is how x
        moves with it by the covariance."""
        middle = float(toward @ found.x)
        least = float(np.sum(found.residual**2))
        # directions that leave the constant as it is
        kept = np.linalg.svd(toward[None, self.free])[2][1:]
        x = found.x
        way = min(wanted * deviation, FIRST_WAY)
        reached = 0.0
        was_met = False
        for _ in range(2 * SEARCH):
            x = np.clip(x + side * (way - reached) * along, *BOUNDS)
            reached = way
            misfit, jacobian = self.evaluate(x)
            if not np.isfinite(misfit).all():
                return middle + side * wanted * deviation
            # a step of the other constants, and what it leaves by the linear misfit
            slopes = jacobian[:, self.free] @ kept.T
            step = np.linalg.lstsq(slopes, -misfit, rcond=1e-6)[0]
            step *= min(1.0, 0.7 / max(abs(step).max(), 1e-9))
            x = np.clip(self._full(x, x[self.free] + kept.T @ step), *BOUNDS)
            left = float(np.sum((misfit + slopes @ step) ** 2))
            rise = np.sqrt(max(left - least, 0.0))
            # met only if it stays so with the others fitted once more: their valley is bent
            met = abs(rise / wanted - 1) < 0.1
            if met and was_met:
                break
            was_met = met
            if met:
                continue
            if rise < wanted and way >= FURTHEST_WAY:
                return side * np.inf
            way = min(way * float(np.clip(wanted / max(rise, 1e-3), 0.4, 2.5)), FURTHEST_WAY)
        return middle + side * reached

    @property
    def work(self):
        """What it took."""
        solvers = [solver for each in self.evidence.values() for solver in each.solvers]
        return {
            "trials": self.trials,
            "loaded from rest": sum(solver.loaded for solver in solvers),
            "equilibria": sum(solver.equilibria for solver in solvers),
            "factorisations": sum(solver.tangents for solver in solvers),
        }

    def close(self):
        """Give the factorisations back."""
        for each in self.evidence.values():
            for solver in each.solvers:
                solver.close()


def _look_below(found, evaluate, bounds):
    """Return the lower of the solution and of what is found from half its first unknown, E_c: the solids of a file are
    stiffer than their platens, so that the first fit comes from above."""
    start = found.x.copy()
    start[0] += SOFTER
    other = least_squares.solve(evaluate, np.maximum(start, bounds[0]), bounds)
    return min(found, other, key=lambda one: float(np.sum(one.residual**2)))


def _on_mesh(fit, size, x, shown):
    """Say what is shown, with what x gives on another mesh, loaded from rest, as far as it gets."""
    other = _Fit(fit.fabric, *fit.given, size)
    # the same constants: the other mesh may have made a yarn denser
    room = max(np.exp(x[1]) + fit.densest - other.densest, np.exp(BOUNDS[0][1]))
    at = np.array([x[0], np.log(room), x[2]])
    checked = dict(shown)
    try:
        for name, each in other.evidence.items():
            with suppress(UnstableError):
                checked[name] = each.check(at, shown[name])
    finally:
        other.close()
    return checked
