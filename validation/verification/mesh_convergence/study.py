"""The runs of the study: one fabric on several meshes.

The mesh of level n has elements with sides of 1/n crossover within FINE of the impact point and of one crossover
beyond. Level 1 is the default mesh. All levels share the outer mesh, so that the study is of the resolution about the
projectile; what the outer mesh contributes is checked by a level on a uniform mesh (`uniform`).
"""

from __future__ import annotations

import time
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources
from math import ceil, inf
from pathlib import Path
from typing import Any

from fabrics import catalogue, run_cache
from fabrics.errors import InputError
from fabrics.units import si
from shellfabric.impact import ballistic_limit
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.panel.model import Panel
from shellfabric.panel.numerics import Numerics
from validation.verification.richardson import Extrapolation, extrapolate, uncertainty

LEVELS = (1, 2, 3, 4)  # elements per crossover about the impact point, along each side
TARGETS = {"m/s": 0.01, "J": 0.03, "N": 0.03}  # [-] of the value: uncertainty of the finest mesh, error of the others
FACTORS = (1.1, 1.5)  # strike velocities of the shots that perforate, over the critical velocity
FINE = 20e-3  # [m] from the impact point up to which elements are small: seven radii of the nose
TOLERANCE = 0.25  # [m/s] of the critical velocity's bracket
NEAR = 1.02  # first step from the limit of a coarser mesh


@dataclass(frozen=True)
class Strikes:
    """Strike velocities of one fabric, the same on all meshes.

    Parameters
    ----------
    stops : [m/s] of the shot for the peak tensions
    critical : [m/s] rounded critical velocity, of which FACTORS give the shots that perforate
    """

    stops: float
    critical: float

    @property
    def perforate(self) -> tuple[float, ...]:
        """[m/s] of the shots that perforate."""
        return tuple(factor * self.critical for factor in FACTORS)


@dataclass(frozen=True)
class Point:
    """One fabric on one mesh.

    Parameters
    ----------
    fabric : name
    elements : per crossover about the impact point, along each side
    uniform : whether everywhere
    cells : number of elements of the modelled part
    critical_velocity, half_width : [m/s] and of its bracket
    velocity : [m/s] of the shot for the peak tensions, which stops
    warp, weft : [N] peak tensions of that shot, anywhere in the panel
    strikes : (2,) [m/s] of the shots that perforate
    residuals : (2,) [m/s] their residual velocities
    absorbed : (2,) [J] what the projectile loses in them
    form : of the cell
    seconds : [s] CPU time of all its shots
    """

    fabric: str
    elements: int
    uniform: bool
    cells: int
    critical_velocity: float
    half_width: float
    velocity: float
    warp: float
    weft: float
    strikes: tuple[float, ...]
    residuals: tuple[float, ...]
    absorbed: tuple[float, ...]
    form: str
    seconds: float

    @property
    def results(self) -> tuple[tuple[str, str, float, float], ...]:
        """(name, unit, value, half the width of its bracket) of each quantity."""
        found = [("critical velocity", "m/s", self.critical_velocity, self.half_width)]
        for name, unit, values in (
            ("residual velocity", "m/s", self.residuals),
            ("absorbed energy", "J", self.absorbed),
        ):
            found += [(f"{name} at {v:.0f} m/s", unit, value, 0.0) for v, value in zip(self.strikes, values)]
        found += [(f"peak tension of the {name}", "N", value, 0.0)
                  for name, value in (("warp", self.warp), ("weft", self.weft))]  # fmt: skip
        return tuple(found)


@dataclass(frozen=True)
class Quantity:
    """One quantity of one fabric over the meshes.

    Parameters
    ----------
    fabric, name, unit : what
    elements : (n,) per crossover about the impact point
    values : (n,)
    noise : to which a value is known
    extrapolation : to an infinite number of elements
    uncertainty : of the value on the finest mesh, see `richardson.uncertainty`
    """

    fabric: str
    name: str
    unit: str
    elements: tuple[int, ...]
    values: tuple[float, ...]
    noise: float
    extrapolation: Extrapolation
    uncertainty: float

    @property
    def deviations(self) -> tuple[float, ...]:
        """(n,) [-] of the values from the limit, over the limit."""
        return tuple(value / self.extrapolation.limit - 1 for value in self.values)

    @property
    def share(self) -> float:
        """[-] uncertainty of the value on the finest mesh over that value."""
        return self.uncertainty / abs(self.values[-1])

    @property
    def met(self) -> bool:
        """Whether the uncertainty on the finest mesh is within its target."""
        return self.share <= TARGETS[self.unit]


def quantity(
    fabric: str, name: str, unit: str, elements: Sequence[int], values: Sequence[float], noise: float = 0.0
) -> Quantity:
    """A Quantity with its extrapolation and uncertainty."""
    sizes = [1 / n for n in elements]
    found = extrapolate(sizes, values, noise)
    share = uncertainty(sizes, values, found, noise)
    return Quantity(fabric, name, unit, tuple(elements), tuple(map(float, values)), noise, found, share)


def velocities() -> dict[str, Strikes]:
    """{fabric: Strikes}."""
    text = (resources.files("validation.verification.mesh_convergence") / "velocities.toml").read_text("utf-8")
    found = tomllib.loads(text)
    return {
        name: Strikes(si(value, "m/s", key=name), si(found["critical"][name], "m/s", key=name))
        for name, value in found["velocities"].items()
    }


def mesh(coarse: Panel, n: int, uniform: bool = False) -> Panel:
    """The panel on the mesh of level n, or with n elements per crossover everywhere."""
    if n == 1 or uniform:
        return replace(coarse, elements_per_crossover=n, grading=None)
    reach = ceil(FINE / (2 * min(coarse.weave.w)))
    return replace(coarse, elements_per_crossover=1, grading=((float(reach), 1 / n), (inf, 1)))


@cache
def coarse(name: str) -> Panel:
    """The panel of a fabric of the catalogue on the default mesh."""
    fabric = catalogue.load(name).with_effective_density()
    return ImpactSetup(fabric, 100.0, numerics=Numerics(threads=1)).panel()


def point(
    name: str, strikes: Strikes, n: int, uniform: bool = False, tolerance: float = TOLERANCE, guess: float | None = None
) -> Point:
    """All quantities of a fabric on the mesh of level n.

    Parameters
    ----------
    name : of the fabric
    strikes : velocities of the shots
    uniform : whether elements are small everywhere
    tolerance : [m/s] of the critical velocity
    guess : [m/s] of a coarser mesh

    Raises
    ------
    InputError : a shot at `strikes.stops` that perforates
    UnstableError : as `ballistic_limit.critical_velocity`
    """
    panel, began = mesh(coarse(name), n, uniform), time.process_time()
    stopped, *through = ballistic_limit.shoot(panel, [strikes.stops, *strikes.perforate])
    if stopped.perforated:
        raise InputError(
            f"fabric {name} with {n} elements per crossover is perforated", key="velocity", value=strikes.stops,
            allowed="one that stops on every mesh",
        )  # fmt: skip
    near: dict[str, Any] = {} if guess is None else {"guess": guess, "step": NEAR}
    found, mass = ballistic_limit.critical_velocity(panel, tolerance=tolerance, **near), panel.projectile.mass
    return Point(
        name, n, uniform, panel.elements, found.velocity, found.half_width, strikes.stops, *stopped.peak_tension,
        strikes.perforate, tuple(shot.residual_velocity for shot in through),
        tuple(0.5 * mass * (shot.strike_velocity**2 - shot.residual_velocity**2) for shot in through),
        panel.table.model.form, time.process_time() - began,
    )  # fmt: skip


def quantities(points: Sequence[Point]) -> list[Quantity]:
    """The quantities of one fabric from its points, from coarse to fine."""
    found = []
    for entries in zip(*(one.results for one in points)):
        (name, unit, *_), noise = entries[0], max(entry[3] for entry in entries)
        values = [entry[2] for entry in entries]
        found.append(quantity(points[0].fabric, name, unit, [one.elements for one in points], values, noise))
    return found


def study(
    strikes: Mapping[str, Strikes], folder: Path, *, elements: Sequence[int] = LEVELS, check: int | None = None,
    tolerance: float = TOLERANCE, jobs: int = 1,
) -> tuple[list[Quantity], list[tuple[Point, Point]]]:  # fmt: skip
    """All quantities of some fabrics on several meshes; each point is kept in the folder as soon as it is done.

    Parameters
    ----------
    strikes : {fabric: velocities of its shots}
    elements : levels, at least three, from coarse to fine
    check : level that is run on a uniform mesh as well, or None
    tolerance : [m/s] of the critical velocities
    jobs : fabrics beside each other

    Returns
    -------
    quantities of all fabrics, and of each fabric the points (graded, uniform) at the level `check`

    Raises
    ------
    InputError, UnstableError : meshes that are not at least three from coarse to fine, or as `point`
    """
    if len(elements) < 3 or list(elements) != sorted(set(elements)):
        raise InputError(key="elements", value=list(elements), allowed="at least three numbers that rise")
    found: dict[tuple[str, int, bool], Point] = {}
    guesses: dict[str, float | None] = dict.fromkeys(strikes)
    for n, uniform in [(n, False) for n in elements] + ([] if check is None else [(check, True)]):
        cases = [(name, each, n, uniform, tolerance, guesses[name]) for name, each in strikes.items()]
        for name, one in zip(strikes, run_cache.results(point, cases, folder=folder, jobs=jobs)):
            found[name, n, uniform], guesses[name] = one, one.critical_velocity
    pairs = [] if check is None else [(found[name, check, False], found[name, check, True]) for name in strikes]
    return [each for name in strikes for each in quantities([found[name, n, False] for n in elements])], pairs
