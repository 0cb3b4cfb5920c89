"""What a fit of the solid's constants to measurements found, and what these say about each.

Covariance (J^T J)^-1 of the logarithms, J that of the residuals over their errors. Errors are the
rms misfits, but no better than what an instrument and a mesh can tell. A constant is called
determined if its 95 % interval excludes its half and its double. The product K_r E_c is judged too:
a measurement that never packs the yarn tells it alone. A constant that was kept is judged by the
covariance with it free.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
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
# of a logarithm: as good as unknown; by what a constant moves along a direction that is open
UNKNOWN = 50.0
MOVES = 0.3
RESOLUTION = 1e-6  # m: what a mesh and an extensometer can tell


@dataclass(frozen=True, eq=False)
class PlatenClosures:
    """A plate curve beside the crossover.

    Parameters
    ----------
    curve : PlateCurve fitted to
    pressure, measured, computed : (n,) [Pa], [m], [m] closures of the curve and of the fitted
        crossover
    before : (n,) [m] closures with the solids of the file
    checked : (k,) [m] closures of the fitted crossover on the finer mesh, at the k first pressures,
        which it reaches; or None
    failed : why the fitted crossover did not reach the highest pressures, where its closures go on
        straight in ln P; ""
    """

    curve: PlateCurve
    pressure: np.ndarray
    measured: np.ndarray
    computed: np.ndarray
    before: np.ndarray
    checked: np.ndarray | None = None
    failed: str = ""

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
            "curve": self.curve.source,
            "rms_m": self.misfit.closure,
            "rms_before_m": self.misfit_before.closure,
            "rms_relative_pressure": self.misfit.pressure,
            "rms_relative_pressure_before": self.misfit_before.pressure,
            "rms_checked_m": checked and checked.closure,
            "rms_relative_pressure_checked": checked and checked.pressure,
            "ended_early": self.failed,
            "pressure_Pa": self.pressure.tolist(),
            "closure_measured_m": self.measured.tolist(),
            "closure_computed_m": self.computed.tolist(),
            "closure_before_m": self.before.tolist(),
            "closure_checked_m": None if self.checked is None else self.checked.tolist(),
        }


@dataclass(frozen=True, eq=False)
class PulledLoads:
    """A measured biaxial test beside the crossover.

    Parameters
    ----------
    name : of the test
    strain : (n, 2) [-] of the fabric along warp and weft
    load : (n, 2) [N] measured of a yarn of warp and weft; nan where it was not
    computed, before : (n, 2) [N] loads of the fitted crossover, and with the solids of the file; nan
        where it found no equilibrium
    fitted : whether the constants were fitted to it; else it is predicted
    checked : (n, 2) [N] loads of the fitted crossover on the finer mesh; None without one
    """

    name: str
    strain: np.ndarray
    load: np.ndarray
    computed: np.ndarray
    before: np.ndarray
    fitted: bool
    checked: np.ndarray | None = None

    @property
    def role(self) -> str:
        """ "fitted" or "predicted"."""
        if self.fitted:
            return "fitted"
        return "predicted"

    def rms(self, computed: FloatArray) -> FloatArray:
        """Compute the rms [N] of measured less computed loads of warp and weft; nan where none was
        measured or computed."""
        with np.errstate(invalid="ignore"):
            squares = (self.load - computed) ** 2
            count = np.isfinite(self.load).sum(axis=0)
            total = np.where(np.isfinite(self.load), squares, 0.0).sum(axis=0)
            return np.sqrt(np.where(count > 0, total, np.nan) / np.maximum(count, 1))


@dataclass(frozen=True, eq=False)
class SolidFit:
    """What a fit found.

    Parameters
    ----------
    fabric : Fabric with the fitted solids
    started : Fabric with those of the file
    platens : PlatenClosures, or None without a plate curve
    pulls : PulledLoads of the biaxial tests
    values : {"E_c", "V_c", "K_r", "K_r E_c": value}
    intervals : {name: (low, high)} 95 %; of a constant that was kept as if it had been free too
    determined : {name: bool}
    free : names of those that were fitted
    correlation : (p, p) [-] of ln E_c, ln (V_c - Vf0), ln K_r as far as they were free
    singular_values : (p,) [-] of the Jacobian of the misfit over its errors, per unit of ln along
        each principal direction
    directions : (p, p) [-] those directions, one a row, best determined first
    limits : (low, high) Fabric on each direction, at the ends of its 95 %
    met : the fit ended where nothing more was to be had
    work : {"trials", "loaded from rest", "equilibria", "factorisations": number}
    sizes : of the two meshes, as texts
    """

    fabric: Fabric
    started: Fabric
    platens: PlatenClosures | None
    pulls: tuple[PulledLoads, ...]
    values: dict
    intervals: dict
    determined: dict
    free: tuple[str, ...]
    correlation: np.ndarray
    singular_values: np.ndarray
    directions: np.ndarray
    limits: tuple[tuple[Fabric, Fabric], ...]
    met: bool
    work: dict
    sizes: tuple

    @property
    def source(self) -> str:
        """What was fitted to, in words."""
        parts = [f"the biaxial test {one.name}" for one in self.pulls if one.fitted]
        if self.platens is not None:
            parts.insert(0, self.platens.curve.source)
        return " and ".join(parts)

    @property
    def greatest(self) -> FloatArray:
        """(2,) [N] greatest measured load of warp and weft; nan where none was measured."""
        return greatest_loads([one.load for one in self.pulls])

    def shares(self, one: PulledLoads, computed: FloatArray | None = None) -> FloatArray:
        """Compute the rms of loads (2,) [-] over the greatest of warp and weft; those of the fitted
        crossover if none are given."""
        return one.rms(one.computed if computed is None else computed) / self.greatest

    def summary(self) -> dict[str, Any]:
        """Return all numbers, as plain types."""
        content: dict[str, Any] = {
            "format": "weavecell solid fit 3",
            "fabric": self.fabric.name,
            "fitted_to": self.source,
            "values": self.values,
            "values_before": constants(self.started),
            "intervals_95": self.intervals,
            "determined": self.determined,
            "free": list(self.free),
            "correlation": self.correlation.tolist(),
            "singular_values": self.singular_values.tolist(),
            "directions": self.directions.tolist(),
            "limits_95_on_directions": [[constants(each) for each in pair] for pair in self.limits],
            "meshes": dict(zip(("fit", "check"), self.sizes)),
            "converged": self.met,
            "work": self.work,
        }
        if self.platens is not None:
            content |= self.platens.summary()
        if self.pulls:
            content["tests"] = [self._summary_of(one) for one in self.pulls]
        return content

    def _summary_of(self, one):
        found = {"test": one.name, "role": one.role}
        for name, computed in (
            ("", one.computed),
            ("_before", one.before),
            ("_checked", one.checked),
        ):
            if computed is not None:
                found[f"rms{name}_N"] = _plain(one.rms(computed))
                found[f"rms{name}_over_greatest"] = _plain(self.shares(one, computed))
        return found

    def write(self, path: FilePath) -> None:
        """Write the summary as JSON."""
        with write_whole(path) as file:
            json.dump(self.summary(), file, indent=2)
            file.write("\n")


def _plain(values):
    """Return a list with None in place of nan, which JSON has not."""
    return [float(value) if np.isfinite(value) else None for value in values]


def greatest_loads(loads: list[FloatArray]) -> FloatArray:
    """Find the greatest (2,) [N] of loads (n, 2) of several tests; nan where none was measured."""
    every = np.abs(np.concatenate(loads))
    found = [np.nanmax(column, initial=0.0) for column in every.T]
    return np.array([value if value > 0 else np.nan for value in found])


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
    evidence: Mapping[str, Any],
    limits: list,
    sizes: tuple[str, str],
    profiles: Mapping[str, tuple[float, float]],
) -> SolidFit:
    """Return the SolidFit of a finished fit.

    Parameters
    ----------
    fit : its trials, with fabric, densest, free (indices of `NAMES`), freedom, full_jacobian, work
        and with_constants
    found : least_squares.Found of all three constants, of the misfit over its errors
    evidence : {"platens": PlatenClosures or None, "pulls": of PulledLoads}
    limits : of ((x low, whether none was found as far as it was sought), (x high, ...))
    sizes : of the two meshes, as texts
    profiles : {name: (low, high) of its logarithm} of constants that have their intervals from those
    """
    free = list(fit.free)
    names = [NAMES[k] for k in free]
    _, correlation, singular, directions = identify(found.jacobian[:, free], 1.0, fit.freedom)
    half = np.empty(len(NAMES))
    half[free], loose = _half_widths(found.jacobian, free, fit.freedom)
    kept = [k for k in range(len(NAMES)) if k not in free]
    if kept:
        every = list(range(len(NAMES)))
        half[kept] = _half_widths(found.jacobian, every, fit.freedom)[0][kept]
    down, up = _reaches(found.x, limits)
    down = np.maximum(np.append(half, loose), down)
    up = np.maximum(np.append(half, loose), up)
    middle = np.append(found.x, found.x[0] + found.x[2])
    for k, name in enumerate((*NAMES, LOOSE)):
        if name in profiles:
            down[k] = min(middle[k] - profiles[name][0], UNKNOWN)
            up[k] = min(profiles[name][1] - middle[k], UNKNOWN)
    low = np.exp(found.x - down[:-1])
    high = np.exp(found.x + up[:-1])
    half = np.maximum(down, up)[:-1]
    ends = -down[-1], up[-1]
    value = np.exp(found.x)
    modulus = float(value[0] * value[2])
    shift = np.array([0.0, fit.densest, 0.0])  # V_c itself
    made = SolidFit(
        fabric=fit.with_constants(found.x),
        started=fit.fabric,
        platens=evidence["platens"],
        pulls=tuple(evidence["pulls"]),
        values=dict(zip(NAMES, map(float, value + shift))) | {LOOSE: modulus},
        intervals={n: (float(a), float(b)) for n, a, b in zip(NAMES, low + shift, high + shift)}
        | {LOOSE: tuple(modulus * float(np.exp(end)) for end in ends)},
        determined={name: bool(width < np.log(2)) for name, width in zip(NAMES, half)}
        | {LOOSE: bool(max(map(abs, ends)) < np.log(2))},
        free=tuple(names),
        correlation=correlation,
        singular_values=singular,
        directions=directions,
        limits=tuple((fit.with_constants(a), fit.with_constants(b)) for (a, _), (b, _) in limits),
        met=found.met,
        work=fit.work,
        sizes=sizes,
    )
    return replace(made, fabric=_with_sources(made))


def _reaches(x, limits):
    """Say how far (4,) ln E_c, ln (V_c - Vf0), ln K_r and ln K_r E_c go down and up over the points
    that were sought on all directions."""
    down = np.zeros(4)
    up = np.zeros(4)
    for pair in limits:
        moves = []
        for end, is_open in pair:
            move = np.append(end - x, end[0] + end[2] - x[0] - x[2])
            # what hardly moves along a direction is told though its end is not
            moves.append(np.where(is_open & (abs(move) > MOVES), np.sign(move) * UNKNOWN, move))
        down = np.hypot(down, np.max([np.zeros(4), *(-move for move in moves)], axis=0))
        up = np.hypot(up, np.max([np.zeros(4), *moves], axis=0))
    return np.minimum(down, UNKNOWN), np.minimum(up, UNKNOWN)


def _half_widths(jacobian, free, freedom):
    """Return (half widths (p,) of the logarithms of free constants, that of ln K_r E_c)."""
    half, _, singular, directions = identify(jacobian[:, free], 1.0, freedom)
    # of ln K_r E_c, from the directions: a difference of variances would be round-off where only
    # the product is known
    part = np.array([float(k != 1) for k in free])
    scale = np.maximum(singular, 1e-12)
    student = half[0] / np.hypot.reduce(directions[:, 0] / scale)
    loose = student * np.hypot.reduce(directions @ part / scale)
    return np.minimum(half, UNKNOWN), min(float(loose), UNKNOWN)


def _with_sources(fit):
    """The fabric, its fitted constants with their source."""
    fabric = fit.fabric
    sources = dict(fabric.sources)
    for family, solid in zip(("warp", "weft"), fabric.solid_laws):
        for name, unit in zip(NAMES, (" Pa", "", "")):
            if name in fit.free:
                sources[f"solid.{family}.{name}"] = {
                    "value": f"{getattr(solid, name):.4g}{unit}",
                    "source": f"fitted to {fit.source}",
                    "status": "fitted",
                }
    return replace(fabric, sources=sources)
