"""What a fit of the solid's constants to a compression between platens found, and what the curve
says about each.

Covariance s^2 (J^T J)^-1 of the logarithms, s the rms misfit, but no better than `RESOLUTION`. A
constant is called determined if its 95 % interval excludes its half and its double. The product K_r
E_c is judged too: a curve that never packs the yarn tells it alone.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.files import write_whole
from fabrics.fabric import Fabric
from fabrics.plate_curve import PlateCurve
from fabrics.variants import with_solids
from unitcell3d.identify.least_squares import Found, identify
from unitcell3d.identify.platen_misfit import PlatenMisfit, misfit_of_points

NAMES = ("E_c", "V_c", "K_r")
# the modulus of the loose yarn, which a curve may tell where it tells neither factor
LOOSE = "K_r E_c"
LEAST_CHECKED = 4  # pressures that a finer mesh has to reach for a misfit
RESOLUTION = 1e-6  # m: what a mesh and an extensometer can tell


@dataclass(frozen=True, eq=False)
class SolidFit:
    """What a fit found.

    Parameters
    ----------
    fabric : Fabric with the fitted solids
    started : Fabric with those of the file
    curve : PlateCurve fitted to
    pressure, measured, computed : (n,) [Pa], [m], [m] closures of the curve and of the fitted
        crossover
    before : (n,) [m] closures with the solids of the file
    checked : (k,) [m] closures of the fitted crossover on the finer mesh, at the k first pressures,
        which it reaches; or None
    values : {"E_c", "V_c", "K_r", "K_r E_c": value}
    intervals : {name: (low, high)} 95 %
    determined : {name: bool}
    correlation : (3, 3) [-] of ln E_c, ln (V_c - Vf0), ln K_r
    singular_values : (3,) [-] of the Jacobian of the weighted misfit, per unit of ln along each
        principal direction
    directions : (3, 3) [-] those directions, one a row, best determined first
    limits : (low, high) Fabric on each direction, at the ends of its 95 %
    met : the fit ended where nothing more was to be had
    work : {"trials", "loaded from rest", "equilibria", "factorisations": number}
    sizes : of the two meshes, as texts
    failed : why the fitted crossover did not reach the highest pressures, where its closures go on
        straight in ln P; ""
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
    failed: str = ""

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
        if self.checked is None or len(self.checked) < LEAST_CHECKED:
            return None
        return self._misfit(self.checked)

    def _misfit(self, closure):
        reached = len(closure)
        return misfit_of_points(self.pressure[:reached], closure, self.measured[:reached])

    def summary(self) -> dict[str, Any]:
        """Return all numbers, as plain types."""
        checked = self.misfit_checked
        return {
            "format": "weavecell solid fit 2",
            "fabric": self.fabric.name,
            "curve": self.curve.source,
            "values": self.values,
            "values_before": {
                name: getattr((self.started.solid_laws or (None,))[0], name) for name in NAMES
            },
            "intervals_95": self.intervals,
            "determined": self.determined,
            "correlation_of_ln_E_c_ln_V_c-Vf0_ln_K_r": self.correlation.tolist(),
            "singular_values": self.singular_values.tolist(),
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
            "ended_early": self.failed,
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


def constants(fabric: Fabric) -> dict[str, float]:
    """Return the constants {"E_c", "V_c", "K_r": value} of the warp's solid."""
    return {name: getattr((fabric.solid_laws or (None,))[0], name) for name in NAMES}


def with_solid_laws(fabric: Fabric, x: ArrayLike, densest: float) -> Fabric:
    """Return the fabric whose solids have x = (ln E_c, ln (V_c - densest), ln K_r)."""
    E_c, room, K_r = map(float, np.exp(x))
    return with_solids(fabric, E_c=E_c, V_c=float(densest + room), K_r=K_r)


def record(
    fit: Any,
    found: Found,
    before: FloatArray,
    computed: FloatArray,
    checked: FloatArray | None,
    limits: list,
    sizes: tuple[str, str],
    failed: str = "",
) -> SolidFit:
    """Return the SolidFit of a finished fit.

    Parameters
    ----------
    fit : its trials, with fabric, curve, pressure, measured, densest, freedom, floor, trials,
        solver and with_constants
    found : least_squares.Found, of the weighted misfit
    before, computed : (n,) [m] closures
    checked : as in a SolidFit
    limits : of (x low, x high)
    sizes : of the two meshes, as texts
    failed : as in a SolidFit
    """
    fabric = fit.fabric
    curve = fit.curve
    noise = max(float(np.sqrt(np.sum(found.residual**2) / fit.freedom)), fit.floor)
    half, correlation, singular, directions = identify(found.jacobian, noise, fit.freedom)
    # of ln K_r E_c, from the directions: a difference of variances would be round-off where only
    # the product is known
    scale = np.maximum(singular, 1e-12)
    loose = half[0] * np.hypot.reduce((directions[:, 0] + directions[:, 2]) / scale)
    loose /= np.hypot.reduce(directions[:, 0] / scale)
    # e^50 is as good as unknown
    half = np.minimum(half, 50)
    loose = min(float(loose), 50.0)
    low = np.exp(found.x - half)
    high = np.exp(found.x + half)
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
        singular_values=singular,
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
        failed=failed,
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
