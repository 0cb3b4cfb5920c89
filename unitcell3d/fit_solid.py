"""E_c, V_c and K_r of the solid yarn from a measured compression between plates (source thesis section 3.4.3.2).

The crossover is pressed between plates (`cases.plate_compression`), and what the plates close is compared with the
curve at `POINTS` of its pressures. No test gives the thickness at rest or the moment of first touch well, so the curve
is free to be moved as a whole: the mean of the misfit is taken out. Least squares over the logarithms

    x = (ln E_c, ln (V_c - Vf0), ln K_r)

of both yarns together (Vf0: the denser yarn's), so that no bound is needed: E_c > 0, V_c > Vf0, K_r > 0; K_r is kept
below 1/2. G follows E_c (eq. 3-16).

What the curve says about each parameter comes from the Jacobian J = d closure / d x at the solution: covariance
s^2 (J^T J)^-1, s the rms misfit, but no better than `RESOLUTION`. A parameter is called determined if its 95 % interval
excludes its half and its double. The product K_r E_c is judged too: a curve that never packs the yarn tells it alone.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.optimize import least_squares
from scipy.stats import t as student

from fabrics.errors import UnstableError
from fabrics.files import write_whole
from meshing import crossover as mesher
from unitcell3d import cases
from unitcell3d.history import History
from unitcell3d.stepping import Steps

NAMES = ("E_c", "V_c", "K_r")
LOOSE = "K_r E_c"  # the modulus of the loose yarn (eq. 3-10), which a curve may tell where it tells neither factor
POINTS = 16  # of the curve, at equal ratios of pressure
RESOLUTION = 1e-6  # m: what the coarse mesh and an extensometer can tell
DIFFERENCE = 0.02  # of ln: step of the Jacobian, well above what the stepping leaves
STEPS = Steps(largest=0.03)  # short: a history is interpolated to the curve's pressures, and its error must not hop
CLOSEST = 0.3  # of the plates' distance at rest: soft trial yarns close further than real ones
LARGEST = 12  # rounds of the least squares
BOUNDS = np.log(([1e6, 1e-3, 1e-4], [1e12, 10.0, 0.5]))


@dataclass(frozen=True, eq=False)
class SolidFit:
    """What a fit found.

    Parameters
    ----------
    fabric : Fabric with the fitted solids
    curve : PlateCurve fitted to
    pressure, measured, computed : (n,) [Pa], [m], [m] closures of the curve and of the fitted crossover
    before : (n,) [m] closures with the solids of the file
    values : {"E_c", "V_c", "K_r", "K_r E_c": value}
    intervals : {name: (low, high)} 95 %
    determined : {name: bool}
    correlation : (3, 3) [-] of ln E_c, ln (V_c - Vf0), ln K_r
    singular_values : (3,) [m] of the Jacobian: closure per unit of ln along each principal direction
    directions : (3, 3) [-] those directions, one a row, best determined first
    runs : plate compressions solved
    history : History of the fitted crossover
    """

    fabric: object
    curve: object
    pressure: np.ndarray
    measured: np.ndarray
    computed: np.ndarray
    before: np.ndarray
    values: dict
    intervals: dict
    determined: dict
    correlation: np.ndarray
    singular_values: np.ndarray
    directions: np.ndarray
    runs: int
    history: History

    @property
    def rms(self):
        """[m] of the misfit."""
        return float(np.sqrt(np.mean((self.computed - self.measured) ** 2)))

    def summary(self):
        """All numbers, as plain types."""
        return {
            "format": "weavecell solid fit 1",
            "fabric": self.fabric.name,
            "curve": self.curve.source,
            "values": self.values,
            "intervals_95": self.intervals,
            "determined": self.determined,
            "correlation_of_ln_E_c_ln_V_c-Vf0_ln_K_r": self.correlation.tolist(),
            "singular_values_m": self.singular_values.tolist(),
            "directions": self.directions.tolist(),
            "rms_m": self.rms,
            "rms_before_m": float(np.sqrt(np.mean((self.before - self.measured) ** 2))),
            "runs": self.runs,
            "pressure_Pa": self.pressure.tolist(),
            "closure_measured_m": self.measured.tolist(),
            "closure_computed_m": self.computed.tolist(),
        }

    def write(self, path):
        """Write the summary as JSON."""
        with write_whole(path) as file:
            json.dump(self.summary(), file, indent=2)
            file.write("\n")


def closures(history, cell_area, pressure, measured):
    """(n,) [m] what the plates of a history close up to each pressure [Pa], moved to the mean of the `measured` ones.

    Beyond the last pressure that the history reached, the closure goes on as it ended, straight in ln P, so that a
    misfit does not jump where a compression ends early.
    """
    pressed = history.F_plate.mean(axis=1) / cell_area
    closed = 2 * (history.plates[0] - history.plates)
    touched = np.maximum(np.argmax(pressed > 0), 1)
    known, closed = np.log(pressed[touched:]), closed[touched:]
    curve = PchipInterpolator(known, closed)
    wanted = np.log(pressure)
    at = curve(np.clip(wanted, known[0], known[-1])) + curve(known[-1], 1) * np.maximum(wanted - known[-1], 0)
    return at - np.mean(at - measured)


def fit_solid(fabric, curve, *, size="coarse", progress=None):
    """Fit E_c, V_c and K_r of both yarns to a plate curve.

    Parameters
    ----------
    fabric : Fabric, with solid laws to start from
    curve : fabrics.plate_curve.PlateCurve
    size : mesh size (`meshing.crossover.build`)
    progress : called as progress(runs so far, rms misfit [m]) after each compression

    Returns
    -------
    SolidFit

    Raises
    ------
    InputError : the fabric cannot be meshed
    UnstableError : the crossover of the file's own solids does not reach half of the curve's pressures
    """
    mesh = mesher.build(fabric, size=size)
    densest = max(*mesh.Vf0, *(solid.Vf0 for solid in fabric.solids))
    pressure = np.geomspace(curve.pressure[0], curve.pressure[-1], POINTS)
    measured, area = curve.at(pressure), fabric.weave.cell_area
    known = {}

    def run(x):
        key = tuple(np.round(x, 12))
        if key not in known:
            trial = with_solids(fabric, x, densest)
            history = cases.plate_compression(mesh, trial, pressure=pressure[-1], closest=CLOSEST, steps=STEPS)
            known[key] = closures(history, area, pressure, measured), history
            if progress is not None:
                progress(len(known), float(np.sqrt(np.mean((known[key][0] - measured) ** 2))))
        return known[key][0]

    first = fabric.solids[0]
    start = np.clip(np.log([first.E_c, first.V_c - densest, first.K_r]), BOUNDS[0] + 1e-6, BOUNDS[1] - 1e-6)
    before = run(start)
    reached = known[tuple(np.round(start, 12))][1]
    if reached.failed and reached.F_plate.mean(axis=1)[-1] < 0.5 * pressure[-1] * area:
        raise UnstableError(f"no plate curve to fit: {reached.failed}")

    def jacobian(x):
        rows = []
        for i in range(3):
            step = np.zeros(3)
            step[i] = DIFFERENCE if x[i] + DIFFERENCE < BOUNDS[1][i] else -DIFFERENCE
            rows.append((run(x + step) - run(x)) / step[i])
        return np.stack(rows, axis=1)

    # in units of the resolution: least_squares stops by absolute sizes too
    found = least_squares(
        lambda x: (run(x) - measured) / RESOLUTION,
        start,
        jac=lambda x: jacobian(x) / RESOLUTION,
        bounds=BOUNDS,
        ftol=1e-4,
        xtol=1e-4,
        max_nfev=LARGEST,
    )
    computed, history = known[tuple(np.round(found.x, 12))]
    return _judge(fabric, curve, pressure, measured, computed, before, found, densest, len(known), history)


def with_solids(fabric, x, densest):
    """The fabric whose solids have x = (ln E_c, ln (V_c - densest), ln K_r)."""
    E_c, room, K_r = np.exp(x)
    solids = tuple(replace(solid, E_c=float(E_c), V_c=float(densest + room), K_r=float(K_r)) for solid in fabric.solids)
    return replace(fabric, solids=solids)


def identify(jacobian, noise, n):
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


def _judge(fabric, curve, pressure, measured, computed, before, found, densest, runs, history):
    misfit = np.sqrt(np.sum((computed - measured) ** 2) / (len(measured) - 4))
    half, correlation, singular, directions = identify(found.jac * RESOLUTION, max(misfit, RESOLUTION), len(measured))
    loose = np.sqrt(max(half[0] ** 2 + half[2] ** 2 + 2 * correlation[0, 2] * half[0] * half[2], 0.0))
    half, loose = np.minimum(half, 50), min(float(loose), 50.0)  # e^50 is as good as unknown
    low, high = np.exp(found.x - half), np.exp(found.x + half)
    value = np.exp(found.x)
    modulus = float(value[0] * value[2])
    shift = np.array([0.0, densest, 0.0])  # V_c itself
    fitted = with_solids(fabric, found.x, densest)
    sources = dict(fabric.sources)
    for family, solid in zip(("warp", "weft"), fitted.solids):
        for name, unit in zip(NAMES, (" Pa", "", "")):
            sources[f"solid.{family}.{name}"] = {
                "value": f"{getattr(solid, name):.4g}{unit}",
                "source": f"fitted to {curve.source}",
                "status": "fitted",
            }
    return SolidFit(
        fabric=replace(fitted, sources=sources),
        curve=curve,
        pressure=pressure,
        measured=measured,
        computed=computed,
        before=before,
        values=dict(zip(NAMES, map(float, value + shift))) | {LOOSE: modulus},
        intervals={n: (float(a), float(b)) for n, a, b in zip(NAMES, low + shift, high + shift)}
        | {LOOSE: (modulus * float(np.exp(-loose)), modulus * float(np.exp(loose)))},
        determined={name: bool(width < np.log(2)) for name, width in zip(NAMES, half)} | {LOOSE: loose < np.log(2)},
        correlation=correlation,
        singular_values=singular,
        directions=directions,
        runs=runs,
        history=history,
    )
