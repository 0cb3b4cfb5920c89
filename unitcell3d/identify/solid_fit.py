"""E_c, V_c and K_r of the solid yarn from a measured compression between platens (thesis section
3.4.3.2).

What the platens of a crossover close is compared with the curve at `POINTS` of its pressures. No
test gives the thickness at rest or the moment of first touch well, so the curve is free to be moved
as a whole: the mean of the misfit is taken out. The closures have weights 1 / sqrt(s^2 +
RESOLUTION^2), s being the closure that a `PRESSURE_ERROR` stands for, so that relative errors in
pressure count about equally. Least squares over the logarithms

    x = (ln E_c, ln (V_c - Vf0), ln K_r)

of both yarns together (Vf0: the denser yarn's), so that no bound is needed: E_c > 0, V_c > Vf0, K_r
> 0; K_r is kept below 1/2. G follows E_c (eq. 3-16).

Each trial starts from the equilibria of an earlier one, which give the Jacobian J = d closure / d x
as well (`unitcell3d.identify.platen_states`). The result is computed once more on a finer mesh,
loaded from rest.

Intervals come from the covariance (`unitcell3d.identify.solid_record`). Since its J is that of the
solution, and a constant that is not determined goes far from it, two points are also sought on each
principal direction of the covariance where the sum of squares itself has risen by what 95 % allow,
F(1, n - p - 1) s^2: `SolidFit.limits`, from which the intervals of what follows from the constants
are taken.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.stats import t as student

from fabrics.base.errors import UnstableError
from fabrics.fabric import Fabric
from fabrics.plate_curve import PlateCurve
from meshing import crossover as mesher
from meshing.inputs import Size
from unitcell3d.identify import least_squares
from unitcell3d.identify.platen_misfit import POINTS
from unitcell3d.identify.platen_states import PlatenSolver
from unitcell3d.identify.solid_record import NAMES, RESOLUTION, SolidFit, record, with_solid_laws

BOUNDS = np.log([1e6, 1e-3, 1e-4]), np.log([1e12, 10.0, 0.5])
PRESSURE_ERROR = 0.15  # relative
FARTHEST = 2.0  # in a logarithm: how far along a direction a limit is sought
SEARCH = 5  # trials on each side of a direction
NEAR_LIMIT = 0.2  # relative error of the sum of squares that is enough


def fit_solid(
    fabric: Fabric,
    curve: PlateCurve,
    size: Size = (4, 3, 2),
    check_size: Size | None = "coarse",
    on_progress: Callable[[int, float], object] | None = None,
) -> SolidFit:
    """Fit E_c, V_c and K_r of both yarns to a plate curve.

    Parameters
    ----------
    fabric : Fabric, with solid laws to start from
    curve : fabrics.plate_curve.PlateCurve
    size : mesh size of the fit (`meshing.crossover.build`)
    check_size : mesh size on which the result is computed once more, or None
    on_progress : called as on_progress(trials so far, rms misfit [m]) after each trial

    Returns
    -------
    SolidFit

    Raises
    ------
    InputError : the fabric cannot be meshed
    UnstableError : the crossover of the file's own solids does not reach half of the curve's
        pressures
    """
    fit = _Fit(fabric, curve, size, on_progress)
    try:
        first = fit.states(fit.start())
        if first.failed and first.pressure[-1] < 0.5 * fit.pressure[-1]:
            raise UnstableError(f"no plate curve to fit: {first.failed}")
        before = fit.closures(first)
        found = least_squares.solve(fit.evaluate, fit.start(), BOUNDS)
        limits = fit.limits(found)
        last = fit.states(found.x)
        computed = fit.closures(last)
    finally:
        fit.solver.close()
    checked = None
    if check_size is not None:
        checked = _on_mesh(fit, check_size, found.x)
    return record(
        fit, found, before, computed, checked, limits, (str(size), str(check_size)), last.failed
    )


class _Fit:
    """Trials of one fabric on one mesh, their closures and their misfit to a curve."""

    def __init__(self, fabric, curve, size, on_progress=None):
        mesh = mesher.build(fabric, size=size)
        assert fabric.solid_laws is not None  # else the mesher has refused it
        self.fabric = fabric
        self.curve = curve
        self._on_progress = on_progress
        self.densest = max(*mesh.Vf0, *(solid.Vf0 for solid in fabric.solid_laws))
        self.pressure = np.geomspace(curve.pressure[0], curve.pressure[-1], POINTS)
        self.measured = curve.at(self.pressure)
        # d closure / d ln P of the curve: the closure that a relative error of the pressure stands
        # for
        slope = np.gradient(self.measured, np.log(self.pressure))
        self.weight = 1 / np.hypot(PRESSURE_ERROR * slope, RESOLUTION)
        self.solver = PlatenSolver(mesh, fabric, self.with_constants, self.pressure)
        self.trials = 0

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

    def states(self, x):
        """Equilibria at x."""
        return self.solver.at(x)

    def closures(self, states):
        """(n,) [m] moved to the weighted mean of the measured ones."""
        at = states.closures(self.pressure)
        return at - self._mean(at - self.measured)

    def _mean(self, values):
        return np.average(values, axis=0, weights=self.weight**2)

    def evaluate(self, x):
        """Weighted misfit, and its Jacobian; a trial without equilibria has a misfit that is not
        finite."""
        self.trials += 1
        try:
            states = self.states(x)
        except UnstableError:
            return np.full(len(self.pressure), np.nan), np.zeros((len(self.pressure), len(x)))
        misfit = self.closures(states) - self.measured
        jacobian = states.jacobian(self.pressure)
        if self._on_progress is not None:
            self._on_progress(self.trials, float(np.sqrt(np.mean(misfit**2))))
        return misfit * self.weight, (jacobian - self._mean(jacobian)) * self.weight[:, None]

    def limits(self, found):
        """(x low, x high) on each principal direction of the covariance."""
        _, singular, directions = np.linalg.svd(found.jacobian, full_matrices=False)
        least = np.sum(found.residual**2)
        allowed = student.ppf(0.975, self.freedom) ** 2 * max(least / self.freedom, self.floor**2)
        return [
            tuple(
                self._limit(found.x, sign * direction, least + allowed, np.sqrt(allowed) / value)
                for sign in (-1, 1)
            )
            for value, direction in zip(np.maximum(singular, 1e-9), directions)
        ]

    @property
    def floor(self):
        """Of a weighted misfit: what a mesh and an extensometer can tell."""
        return RESOLUTION * float(np.sqrt(np.mean(self.weight**2)))

    @property
    def freedom(self):
        """Degrees of freedom of the misfit: the curve's offset uses one up as well."""
        return len(self.pressure) - len(NAMES) - 1

    def _limit(self, x, direction, wanted, length):
        """Where the sum of squares along a direction from x is as `wanted`, or as far as is
        sought."""
        rooms = np.where(direction > 0, BOUNDS[1] - x, x - BOUNDS[0]) / np.maximum(
            np.abs(direction), 1e-12
        )
        farthest = min(FARTHEST, float(rooms.min()))
        length = min(length, farthest)
        inside = 0.0
        outside = np.inf
        for _ in range(SEARCH):
            square = float(np.sum(self.evaluate(x + length * direction)[0] ** 2))
            if abs(square / wanted - 1) < NEAR_LIMIT or (square < wanted and length >= farthest):
                break
            if square < wanted:
                inside = length
            else:
                outside = length
            length = 0.5 * (inside + outside)
            if np.isinf(outside):
                length = min(2 * inside, farthest)
        return x + length * direction


def _on_mesh(fit, size, x):
    """Closures (k,) [m] at x on another mesh, loaded from rest, at the k pressures that it
    reaches."""
    other = _Fit(fit.fabric, fit.curve, size)
    try:
        # the same constants: the other mesh may have made a yarn denser
        room = max(np.exp(x[1]) + fit.densest - other.densest, np.exp(BOUNDS[0][1]))
        states = other.states(np.array([x[0], np.log(room), x[2]]))
        return other.closures(states)[: len(states.pressure)]
    except UnstableError:
        return np.empty(0)
    finally:
        other.solver.close()
