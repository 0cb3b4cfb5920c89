"""E_c, V_c and K_r of the solid yarn from a measured compression between plates (thesis section 3.4.3.2).

The crossover is pressed between plates (`biaxial_and_platens.plate_compression`), and what the plates close is compared
with the curve at `POINTS` of its pressures. No test gives the thickness at rest or the moment of first touch well, so
the curve is free to be moved as a whole: the mean of the misfit is taken out. Least squares over the logarithms

    x = (ln E_c, ln (V_c - Vf0), ln K_r)

of both yarns together (Vf0: the denser yarn's), so that no bound is needed: E_c > 0, V_c > Vf0, K_r > 0; K_r is kept
below 1/2. G follows E_c (eq. 3-16).

A compression takes seconds on a few elements and minutes on many, and the softer the yarn the longer. So the fit
(`unitcell3d.identify.least_squares`) runs on a coarse mesh, without derivatives; its result is computed on a finer
one, and where that misses the curve by more than the `RESOLUTION` beyond what the coarse one does, the fit is taken up
again with the difference of the two meshes added to the coarse one (`CORRECTIONS` times at most).
What is reported is the fine mesh's.

What the curve says about each parameter comes from the Jacobian J = d closure / d x at the solution, by differences on
the coarse mesh: covariance s^2 (J^T J)^-1, s the rms misfit, but no better than `RESOLUTION`. A parameter is called
determined if its 95 % interval excludes its half and its double. The product K_r E_c is judged too: a curve that never
packs the yarn tells it alone.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import t as student

from fabrics import run_cache
from fabrics.checks import FilePath, FloatArray
from fabrics.errors import UnstableError
from fabrics.executors import open_executor
from fabrics.fabric import Fabric
from fabrics.files import write_whole
from fabrics.plate_curve import PlateCurve
from meshing import crossover as mesher
from meshing.inputs import Size
from unitcell3d.cases import biaxial_and_platens
from unitcell3d.identify import least_squares
from unitcell3d.identify.platen_misfit import POINTS, closures
from unitcell3d.model.crossover import Numerics
from unitcell3d.solver.history import History
from unitcell3d.solver.load_stepping import Steps

NAMES = ("E_c", "V_c", "K_r")
LOOSE = "K_r E_c"  # the modulus of the loose yarn (eq. 3-10), which a curve may tell where it tells neither factor
RESOLUTION = 1e-6  # m: what the coarse mesh and an extensometer can tell
STEPS = Steps(largest=0.05)  # short: a history is interpolated to the curve's pressures, and its error must not hop
MIN_PLATE_GAP = 0.3  # of the plates' distance at rest: soft trial yarns close further than real ones
CORRECTIONS = 2  # of the coarse mesh by the fine one
HISTORIES = run_cache.Format("h5", lambda path, history: history.write(path), History.read)
BOUNDS = np.log(([1e6, 1e-3, 1e-4], [1e12, 10.0, 0.5]))


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
    values : {"E_c", "V_c", "K_r", "K_r E_c": value}
    intervals : {name: (low, high)} 95 %
    determined : {name: bool}
    correlation : (3, 3) [-] of ln E_c, ln (V_c - Vf0), ln K_r
    singular_values : (3,) [m] of the Jacobian: closure per unit of ln along each principal direction
    directions : (3, 3) [-] those directions, one a row, best determined first
    met : the fit ended where nothing more was to be had; False: where the noise of a compression hid it
    runs : plate compressions solved, on the coarse and on the fine mesh
    sizes : of the two meshes, as texts
    history : History of the fitted crossover on the fine mesh
    """

    fabric: Fabric
    started: Fabric
    curve: PlateCurve
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
    met: bool
    runs: tuple
    sizes: tuple
    history: History

    @property
    def rms(self) -> float:
        """[m] of the misfit."""
        return float(np.sqrt(np.mean((self.computed - self.measured) ** 2)))

    def summary(self) -> dict[str, Any]:
        """All numbers, as plain types."""
        return {
            "format": "weavecell solid fit 1",
            "fabric": self.fabric.name,
            "curve": self.curve.source,
            "values": self.values,
            "values_before": {name: getattr((self.started.solid_laws or (None,))[0], name) for name in NAMES},
            "intervals_95": self.intervals,
            "determined": self.determined,
            "correlation_of_ln_E_c_ln_V_c-Vf0_ln_K_r": self.correlation.tolist(),
            "singular_values_m": self.singular_values.tolist(),
            "directions": self.directions.tolist(),
            "rms_m": self.rms,
            "rms_before_m": float(np.sqrt(np.mean((self.before - self.measured) ** 2))),
            "meshes": dict(zip(("fit", "check"), self.sizes)),
            "converged": self.met,
            "runs": dict(zip(("fit", "check"), self.runs)),
            "pressure_Pa": self.pressure.tolist(),
            "closure_measured_m": self.measured.tolist(),
            "closure_computed_m": self.computed.tolist(),
        }

    def write(self, path: FilePath) -> None:
        """Write the summary as JSON."""
        with write_whole(path) as file:
            json.dump(self.summary(), file, indent=2)
            file.write("\n")


def fit_solid(
    fabric: Fabric, curve: PlateCurve, *, size: Size = (4, 3, 2), check_size: Size = "coarse",
    executor: str | Executor = "local", jobs: int = 1, keep: FilePath | None = None, resume: bool = False,
    on_progress: Callable[[int, float], object] | None = None,
) -> SolidFit:  # fmt: skip
    """Fit E_c, V_c and K_r of both yarns to a plate curve.

    Parameters
    ----------
    fabric : Fabric, with solid laws to start from
    curve : fabrics.plate_curve.PlateCurve
    size, check_size : mesh sizes of the fit and of its check (`meshing.crossover.build`)
    executor, jobs : as of `fabrics.executors.open_executor`, for compressions beside each other
    keep : folder for the compressions while the fit goes on, or None
    resume : take the compressions that are in `keep`; the fit goes the same way through them
    on_progress : called as on_progress(runs so far, rms misfit [m]) after each compression

    Returns
    -------
    SolidFit

    Raises
    ------
    InputError : the fabric cannot be meshed
    UnstableError : the crossover of the file's own solids does not reach half of the curve's pressures
    """
    meshes = [mesher.build(fabric, size=each) for each in (size, check_size)]
    assert fabric.solid_laws is not None  # else the mesher has refused it
    densest = max(*(Vf0 for mesh in meshes for Vf0 in mesh.Vf0), *(solid.Vf0 for solid in fabric.solid_laws))
    pressure = np.geomspace(curve.pressure[0], curve.pressure[-1], POINTS)
    measured = curve.at(pressure)
    first = fabric.solid_laws[0]
    start = np.clip(np.log([first.E_c, first.V_c - densest, first.K_r]), BOUNDS[0] + 1e-6, BOUNDS[1] - 1e-6)
    with open_executor(executor, jobs, fresh=True) as pool:
        coarse, fine = (
            _Presses(pool, fabric, each, densest, pressure, measured, on_progress, keep, resume)
            for each in (size, check_size)
        )
        _, before = fine.many([start])[0]
        if before.failed and before.F_plate.mean(axis=1)[-1] < 0.5 * pressure[-1] * fabric.weave.cell_area:
            raise UnstableError(f"no plate curve to fit: {before.failed}")
        found, computed, history = _corrected_fit(coarse, fine, start, measured)
    if keep is not None:
        shutil.rmtree(keep, ignore_errors=True)
    return _judge(
        fabric, curve, pressure, measured, computed, fine.closed(before), found, densest,
        (coarse.runs, fine.runs), (str(size), str(check_size)), history,
    )  # fmt: skip


def _corrected_fit(coarse, fine, x, measured):
    """Fit on the coarse mesh, its misfit corrected by the fine one's; the fit, and closures and History on the fine."""
    defect = np.zeros(POINTS)
    for correction in range(1 + CORRECTIONS):
        found = least_squares.solve(
            lambda points, defect=defect: [
                (closed + defect - measured) / RESOLUTION for closed, _ in coarse.many(points)
            ],
            x,
            BOUNDS,
        )
        x = found.x
        computed, history = fine.many([x])[0]
        on_coarse = coarse.many([x])[0][0]
        beyond = _rms(computed - measured) - _rms(on_coarse + defect - measured)
        if beyond < RESOLUTION or correction == CORRECTIONS:
            break
        defect = computed - on_coarse
    return found, computed, history


class _Presses:
    """Compressions of one mesh, each solved once."""

    def __init__(self, pool, fabric, size, densest, pressure, measured, on_progress, keep, resume):
        self._pool, self._fabric, self._size, self._densest = pool, fabric, size, densest
        self._pressure, self._measured, self._on_progress = pressure, measured, on_progress
        self._keep, self._resume = None if keep is None else run_cache.RunCache(keep, HISTORIES), resume
        self._known = {}

    @property
    def runs(self):
        """Compressions solved."""
        return len(self._known)

    def many(self, points):
        """(closures (n,) [m], History) at each x."""
        keys = [tuple(np.round(x, 12)) for x in points]
        new = {key: self._job(x) for key, x in zip(keys, points) if key not in self._known}
        names = {key: self._name(job) for key, job in new.items()}
        for key, name in names.items():
            if self._resume and name is not None and name in self._keep:
                self._take(key, self._keep[name])
        jobs = {key: job for key, job in new.items() if key not in self._known}
        for key, history in zip(jobs, self._pool.map(press, *zip(*jobs.values())) if jobs else ()):
            if names[key] is not None:
                self._keep[names[key]] = history
            self._take(key, history)
        return [self._known[key] for key in keys]

    def _job(self, x):
        return with_solid_laws(self._fabric, x, self._densest), self._size, self._pressure[-1]

    def _name(self, job):
        return None if self._keep is None else run_cache.key((*job, Numerics(), STEPS), __name__)

    def _take(self, key, history):
        self._known[key] = self.closed(history), history
        if self._on_progress is not None:
            self._on_progress(self.runs, _rms(self._known[key][0] - self._measured))

    def closed(self, history):
        """(n,) [m] closures of a history."""
        return closures(history, self._fabric.weave.cell_area, self._pressure, self._measured)


def press(fabric: Fabric, size: Size, pressure: float) -> History:
    """History of the fabric's crossover between plates up to a pressure [Pa]."""
    mesh = mesher.build(fabric, size=size)
    return biaxial_and_platens.plate_compression(
        mesh, fabric, pressure=pressure, min_plate_gap=MIN_PLATE_GAP, steps=STEPS
    )


def _rms(misfit):
    return float(np.sqrt(np.mean(misfit**2)))


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


def _judge(fabric, curve, pressure, measured, computed, before, found, densest, runs, sizes, history):
    misfit = np.sqrt(np.sum((computed - measured) ** 2) / (len(measured) - 4))
    half, correlation, singular, directions = identify(
        found.jacobian * RESOLUTION, max(misfit, RESOLUTION), len(measured)
    )
    loose = np.sqrt(max(half[0] ** 2 + half[2] ** 2 + 2 * correlation[0, 2] * half[0] * half[2], 0.0))
    half, loose = np.minimum(half, 50), min(float(loose), 50.0)  # e^50 is as good as unknown
    low, high = np.exp(found.x - half), np.exp(found.x + half)
    value = np.exp(found.x)
    modulus = float(value[0] * value[2])
    shift = np.array([0.0, densest, 0.0])  # V_c itself
    fitted = with_solid_laws(fabric, found.x, densest)
    sources = dict(fabric.sources)
    for family, solid in zip(("warp", "weft"), fitted.solid_laws):
        for name, unit in zip(NAMES, (" Pa", "", "")):
            sources[f"solid.{family}.{name}"] = {
                "value": f"{getattr(solid, name):.4g}{unit}",
                "source": f"fitted to {curve.source}",
                "status": "fitted",
            }
    return SolidFit(
        fabric=replace(fitted, sources=sources),
        started=fabric,
        curve=curve,
        pressure=pressure,
        measured=measured,
        computed=computed,
        before=before,
        values=dict(zip(NAMES, map(float, value + shift))) | {LOOSE: modulus},
        intervals={n: (float(a), float(b)) for n, a, b in zip(NAMES, low + shift, high + shift)}
        | {LOOSE: (modulus * float(np.exp(-loose)), modulus * float(np.exp(loose)))},
        determined={name: bool(width < np.log(2)) for name, width in zip(NAMES, half)}
        | {LOOSE: bool(loose < np.log(2))},
        correlation=correlation,
        singular_values=singular,
        directions=directions,
        met=found.met,
        runs=runs,
        sizes=sizes,
        history=history,
    )
