"""E_c, V_c and K_r of the solid yarn from a measured compression between platens (thesis section 3.4.3.2).

What the platens of a crossover close is compared with the curve at `POINTS` of its pressures. No test gives the
thickness at rest or the moment of first touch well, so the curve is free to be moved as a whole: the mean of the misfit
is taken out. Least squares over the logarithms

    x = (ln E_c, ln (V_c - Vf0), ln K_r)

of both yarns together (Vf0: the denser yarn's), so that no bound is needed: E_c > 0, V_c > Vf0, K_r > 0; K_r is kept
below 1/2. G follows E_c (eq. 3-16).

Each trial starts from the equilibria of an earlier one, which give the Jacobian J = d closure / d x as well
(`unitcell3d.identify.platen_states`). The result is computed once more on a finer mesh, loaded from rest.

What the curve says about each constant: covariance s^2 (J^T J)^-1, s the rms misfit, but no better than `RESOLUTION`.
A constant is called determined if its 95 % interval excludes its half and its double. The product K_r E_c is judged
too: a curve that never packs the yarn tells it alone. Since J is that of the solution, and a constant that is not
determined goes far from it, two points are also sought on each principal direction of the covariance where the sum of
squares itself has risen by what 95 % allow, F(1, n - p - 1) s^2: `SolidFit.limits`, from which the intervals of what
follows from the constants are taken.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import t as student

from fabrics.checks import FilePath, FloatArray
from fabrics.errors import UnstableError
from fabrics.fabric import Fabric
from fabrics.files import write_whole
from fabrics.plate_curve import PlateCurve
from meshing import crossover as mesher
from meshing.inputs import Size
from unitcell3d.identify import least_squares
from unitcell3d.identify.platen_misfit import POINTS, PlatenMisfit, misfit_of_points
from unitcell3d.identify.platen_states import PlatenSolver

NAMES = ("E_c", "V_c", "K_r")
LOOSE = "K_r E_c"  # the modulus of the loose yarn (eq. 3-10), which a curve may tell where it tells neither factor
RESOLUTION = 1e-6  # m: what a mesh and an extensometer can tell
BOUNDS = np.log(([1e6, 1e-3, 1e-4], [1e12, 10.0, 0.5]))
FARTHEST = 2.0  # in a logarithm: how far along a direction a limit is sought
SEARCH, NEAR_LIMIT = 5, 0.2  # trials on each side of a direction; relative error of the sum of squares that is enough


@dataclass(frozen=True, eq=False)
class SolidFit:
    """What a fit found.

    Parameters
    ----------
    fabric : Fabric with the fitted solids
    started : Fabric with those of the file
    curve : PlateCurve fitted to
    pressure, measured, computed : (n,) [Pa], [m], [m] closures of the curve and of the fitted crossover
    before : (n,) [m] closures with the solids of the file
    checked : (n,) [m] closures of the fitted crossover on the finer mesh, or None
    values : {"E_c", "V_c", "K_r", "K_r E_c": value}
    intervals : {name: (low, high)} 95 %
    determined : {name: bool}
    correlation : (3, 3) [-] of ln E_c, ln (V_c - Vf0), ln K_r
    singular_values : (3,) [m] of the Jacobian: closure per unit of ln along each principal direction
    directions : (3, 3) [-] those directions, one a row, best determined first
    limits : (low, high) Fabric on each direction, at the ends of its 95 %
    met : the fit ended where nothing more was to be had
    work : {"trials", "loaded from rest", "equilibria", "factorisations": number}
    sizes : of the two meshes, as texts
    """

    fabric: Fabric
    started: Fabric
    curve: PlateCurve
    pressure: np.ndarray
    measured: np.ndarray
    computed: np.ndarray
    before: np.ndarray
    checked: np.ndarray | None
    values: dict
    intervals: dict
    determined: dict
    correlation: np.ndarray
    singular_values: np.ndarray
    directions: np.ndarray
    limits: tuple[tuple[Fabric, Fabric], ...]
    met: bool
    work: dict
    sizes: tuple

    @property
    def rms(self) -> float:
        """[m] of the misfit."""
        return self.misfit.closure

    @property
    def misfit(self) -> PlatenMisfit:
        """Of the fitted crossover."""
        return self._misfit(self.computed)

    @property
    def misfit_before(self) -> PlatenMisfit:
        """With the solids of the file."""
        return self._misfit(self.before)

    @property
    def misfit_checked(self) -> PlatenMisfit | None:
        """Of the fitted crossover on the finer mesh."""
        return None if self.checked is None else self._misfit(self.checked)

    def _misfit(self, closure):
        return misfit_of_points(self.pressure, closure, self.measured)

    def summary(self) -> dict[str, Any]:
        """All numbers, as plain types."""
        checked = self.misfit_checked
        return {
            "format": "weavecell solid fit 2",
            "fabric": self.fabric.name,
            "curve": self.curve.source,
            "values": self.values,
            "values_before": {name: getattr((self.started.solid_laws or (None,))[0], name) for name in NAMES},
            "intervals_95": self.intervals,
            "determined": self.determined,
            "correlation_of_ln_E_c_ln_V_c-Vf0_ln_K_r": self.correlation.tolist(),
            "singular_values_m": self.singular_values.tolist(),
            "directions": self.directions.tolist(),
            "limits_95_on_directions": [[constants(each) for each in pair] for pair in self.limits],
            "rms_m": self.rms,
            "rms_before_m": self.misfit_before.closure,
            "rms_relative_pressure": self.misfit.pressure,
            "rms_relative_pressure_before": self.misfit_before.pressure,
            "rms_checked_m": checked and checked.closure,
            "rms_relative_pressure_checked": checked and checked.pressure,
            "meshes": dict(zip(("fit", "check"), self.sizes)),
            "converged": self.met,
            "work": self.work,
            "pressure_Pa": self.pressure.tolist(),
            "closure_measured_m": self.measured.tolist(),
            "closure_computed_m": self.computed.tolist(),
            "closure_before_m": self.before.tolist(),
            "closure_checked_m": None if self.checked is None else self.checked.tolist(),
        }

    def write(self, path: FilePath) -> None:
        """Write the summary as JSON."""
        with write_whole(path) as file:
            json.dump(self.summary(), file, indent=2)
            file.write("\n")


def fit_solid(
    fabric: Fabric, curve: PlateCurve, size: Size = "coarse", check_size: Size | None = "medium",
    on_progress: Callable[[int, float], object] | None = None,
) -> SolidFit:  # fmt: skip
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
    UnstableError : the crossover of the file's own solids does not reach half of the curve's pressures
    """
    fit = _Fit(fabric, curve, size, on_progress)
    try:
        start = fit.start()
        first = fit.states(start)
        if first.failed and first.pressure[-1] < 0.5 * fit.pressure[-1]:
            raise UnstableError(f"no plate curve to fit: {first.failed}")
        before = fit.closures(first)
        found = least_squares.solve(fit.evaluate, start, BOUNDS)
        computed = fit.closures(fit.states(found.x))
        limits = fit.limits(found)
    finally:
        fit.solver.close()
    checked = None if check_size is None else _on_mesh(fit, check_size, found.x)
    return _judge(fit, found, before, computed, checked, limits, (str(size), str(check_size)))


class _Fit:
    """Trials of one fabric on one mesh, their closures and their misfit to a curve."""

    def __init__(self, fabric, curve, size, on_progress=None):
        mesh = mesher.build(fabric, size=size)
        assert fabric.solid_laws is not None  # else the mesher has refused it
        self.fabric, self.curve, self._on_progress = fabric, curve, on_progress
        self.densest = max(*mesh.Vf0, *(solid.Vf0 for solid in fabric.solid_laws))
        self.pressure = np.geomspace(curve.pressure[0], curve.pressure[-1], POINTS)
        self.measured = curve.at(self.pressure)
        self.solver = PlatenSolver(mesh, fabric, self.with_constants, self.pressure)
        self.trials = 0

    def start(self):
        """x of the fabric's own solids."""
        first = self.fabric.solid_laws[0]
        return np.clip(np.log([first.E_c, first.V_c - self.densest, first.K_r]), BOUNDS[0] + 1e-6, BOUNDS[1] - 1e-6)

    def with_constants(self, x):
        """The fabric at x."""
        return with_solid_laws(self.fabric, x, self.densest)

    def states(self, x):
        """Equilibria at x."""
        return self.solver.at(x)

    def closures(self, states):
        """(n,) [m] moved to the mean of the measured ones."""
        at = states.closures(self.pressure)
        return at - np.mean(at - self.measured)

    def evaluate(self, x):
        """Misfit over `RESOLUTION`, and its Jacobian; a trial without equilibria has a misfit that is not finite."""
        self.trials += 1
        try:
            states = self.states(x)
        except UnstableError:
            return np.full(len(self.pressure), np.nan), np.zeros((len(self.pressure), len(x)))
        misfit, jacobian = self.closures(states) - self.measured, states.jacobian(self.pressure)
        if self._on_progress is not None:
            self._on_progress(self.trials, float(np.sqrt(np.mean(misfit**2))))
        return misfit / RESOLUTION, (jacobian - jacobian.mean(axis=0)) / RESOLUTION

    def limits(self, found):
        """((x low, x high) on each principal direction of the covariance."""
        _, singular, directions = np.linalg.svd(found.jacobian, full_matrices=False)
        least = np.sum(found.residual**2)
        allowed = student.ppf(0.975, self.freedom) ** 2 * max(least / self.freedom, 1.0)
        return [
            tuple(self._limit(found.x, sign * direction, least + allowed, np.sqrt(allowed) / value) for sign in (-1, 1))
            for value, direction in zip(np.maximum(singular, 1e-9), directions)
        ]

    @property
    def freedom(self):
        """Degrees of freedom of the misfit: the curve's offset uses one up as well."""
        return len(self.pressure) - len(NAMES) - 1

    def _limit(self, x, direction, wanted, length):
        """Where the sum of squares along a direction from x is as `wanted`, or as far as is sought."""
        rooms = np.where(direction > 0, BOUNDS[1] - x, x - BOUNDS[0]) / np.maximum(np.abs(direction), 1e-12)
        farthest = min(FARTHEST, float(rooms.min()))
        length, inside, outside = min(length, farthest), 0.0, np.inf
        for _ in range(SEARCH):
            square = float(np.sum(self.evaluate(x + length * direction)[0] ** 2))
            if abs(square / wanted - 1) < NEAR_LIMIT or (square < wanted and length >= farthest):
                break
            inside, outside = (length, outside) if square < wanted else (inside, length)
            length = min(2 * length, farthest) if np.isinf(outside) else 0.5 * (inside + outside)
        return x + length * direction


def _on_mesh(fit, size, x):
    """Closures (n,) [m] at x on another mesh, loaded from rest; None where they are not reached."""
    other = _Fit(fit.fabric, fit.curve, size)
    try:
        return other.closures(other.solver.at(np.array([x[0], x[1] + _room(fit, other, x), x[2]])))
    except UnstableError:
        return None
    finally:
        other.solver.close()


def _room(fit, other, x):
    """Change of ln (V_c - Vf0) that leaves V_c as it is where another mesh makes a yarn denser."""
    room = np.exp(x[1])
    return np.log(max(room + fit.densest - other.densest, 1e-3) / room)


def constants(fabric: Fabric) -> dict[str, float]:
    """{"E_c", "V_c", "K_r": value} of the warp's solid."""
    return {name: getattr((fabric.solid_laws or (None,))[0], name) for name in NAMES}


def with_solid_laws(fabric: Fabric, x: ArrayLike, densest: float) -> Fabric:
    """The fabric whose solids have x = (ln E_c, ln (V_c - densest), ln K_r)."""
    E_c, room, K_r = map(float, np.exp(x))
    assert fabric.solid_laws is not None
    warp, weft = (replace(law, E_c=E_c, V_c=float(densest + room), K_r=K_r) for law in fabric.solid_laws)
    return replace(fabric, solid_laws=(warp, weft))


def identify(jacobian: FloatArray, noise: float, n: int) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """95 % half width of each ln parameter, their correlation, and the singular values and directions of J.

    Parameters
    ----------
    jacobian : (n, p) [m]
    noise : [m] standard deviation of one closure
    n : points, one of which the free zero of the curve uses up
    """
    _, singular, directions = np.linalg.svd(jacobian, full_matrices=False)
    covariance = noise**2 * (directions.T / np.maximum(singular, 1e-12) ** 2) @ directions
    deviation = np.sqrt(np.diag(covariance))
    half = student.ppf(0.975, n - jacobian.shape[1] - 1) * deviation
    return half, covariance / np.outer(deviation, deviation), singular, directions


def _judge(fit, found, before, computed, checked, limits, sizes):
    fabric, curve = fit.fabric, fit.curve
    noise = max(float(np.sqrt(np.sum(found.residual**2) / fit.freedom)), 1.0)
    half, correlation, singular, directions = identify(found.jacobian, noise, len(fit.pressure))
    loose = np.sqrt(max(half[0] ** 2 + half[2] ** 2 + 2 * correlation[0, 2] * half[0] * half[2], 0.0))
    half, loose = np.minimum(half, 50), min(float(loose), 50.0)  # e^50 is as good as unknown
    low, high = np.exp(found.x - half), np.exp(found.x + half)
    value = np.exp(found.x)
    modulus = float(value[0] * value[2])
    shift = np.array([0.0, fit.densest, 0.0])  # V_c itself
    solver = fit.solver
    return SolidFit(
        fabric=_with_sources(fit.with_constants(found.x), curve),
        started=fabric,
        curve=curve,
        pressure=fit.pressure,
        measured=fit.measured,
        computed=computed,
        before=before,
        checked=checked,
        values=dict(zip(NAMES, map(float, value + shift))) | {LOOSE: modulus},
        intervals={n: (float(a), float(b)) for n, a, b in zip(NAMES, low + shift, high + shift)}
        | {LOOSE: (modulus * float(np.exp(-loose)), modulus * float(np.exp(loose)))},
        determined={name: bool(width < np.log(2)) for name, width in zip(NAMES, half)}
        | {LOOSE: bool(loose < np.log(2))},
        correlation=correlation,
        singular_values=singular * RESOLUTION,
        directions=directions,
        limits=tuple((fit.with_constants(a), fit.with_constants(b)) for a, b in limits),
        met=found.met,
        work={
            "trials": fit.trials,
            "loaded from rest": solver.loaded,
            "equilibria": solver.equilibria,
            "factorisations": solver.tangents,
        },
        sizes=sizes,
    )


def _with_sources(fabric, curve):
    """The fabric, its fitted constants with their source."""
    sources = dict(fabric.sources)
    for family, solid in zip(("warp", "weft"), fabric.solid_laws):
        for name, unit in zip(NAMES, (" Pa", "", "")):
            sources[f"solid.{family}.{name}"] = {
                "value": f"{getattr(solid, name):.4g}{unit}",
                "source": f"fitted to {curve.source}",
                "status": "fitted",
            }
    return replace(fabric, sources=sources)
