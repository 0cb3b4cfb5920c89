"""The runs of the study: one fabric on several meshes."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from importlib import resources
from typing import TYPE_CHECKING, Any

from fabrics.errors import InputError
from fabrics.units import si
from shellfabric.impact import ballistic_limit
from shellfabric.impact.single_ply import ImpactSetup
from weavecell.analysis.richardson import Extrapolation, extrapolate

if TYPE_CHECKING:
    from fabrics.fabric import Fabric
    from shellfabric.panel.model import Panel

ALLOWED = {1: 0.05, 2: 0.02}  # target: share of the limit within which 1 and 2 elements a crossover are to be
TOLERANCE = 0.25  # [m/s] of the critical velocity's bracket: a tenth of what 2 % of it are
NEAR = 1.02  # first step from the limit of a coarser mesh


@dataclass(frozen=True)
class Point:
    """One fabric on one mesh.

    Parameters
    ----------
    fabric : name
    elements : a crossover, along each side
    critical_velocity, half_width : [m/s] and of its bracket
    velocity : [m/s] of the shot for the peak tensions, which stops
    warp, weft : [N] peak tensions of that shot
    form : of the cell
    seconds : [s] CPU time of all its shots
    """

    fabric: str
    elements: int
    critical_velocity: float
    half_width: float
    velocity: float
    warp: float
    weft: float
    form: str
    seconds: float


@dataclass(frozen=True)
class Quantity:
    """One quantity of one fabric over the meshes.

    Parameters
    ----------
    fabric, name, unit : what
    elements : (n,) a crossover, along each side
    values : (n,)
    noise : to which a value is known
    extrapolation : to an infinite number of elements
    """

    fabric: str
    name: str
    unit: str
    elements: tuple[int, ...]
    values: tuple[float, ...]
    noise: float
    extrapolation: Extrapolation

    @property
    def deviations(self) -> tuple[float, ...]:
        """(n,) [-] of the values from the limit, over the limit."""
        return tuple(value / self.extrapolation.limit - 1 for value in self.values)

    @property
    def met(self) -> bool:
        """Whether the meshes that have a target are within it of the limit."""
        found = dict(zip(self.elements, self.deviations))
        return all(abs(found[n]) <= allowed for n, allowed in ALLOWED.items() if n in found)


def quantity(
    fabric: str, name: str, unit: str, elements: Sequence[int], values: Sequence[float], noise: float = 0.0
) -> Quantity:
    """A Quantity with its extrapolation."""
    extrapolation = extrapolate([1 / n for n in elements], values, noise)
    return Quantity(fabric, name, unit, tuple(elements), tuple(map(float, values)), noise, extrapolation)


def velocities() -> dict[str, float]:
    """{fabric: [m/s]} strike velocities for the peak tensions."""
    import tomllib

    text = (resources.files("validation.verification.mesh_convergence") / "velocities.toml").read_text("utf-8")
    return {name: si(value, "m/s", key=name) for name, value in tomllib.loads(text)["velocities"].items()}


def point(
    coarse: Panel, velocity: float, n: int, *, tolerance: float = TOLERANCE, guess: float | None = None,
    executor: str = "local", jobs: int = 1, report: Callable[..., object] | None = None,
) -> Point:  # fmt: skip
    """Critical velocity of a panel with n elements a crossover, and peak tensions at one velocity, as a Point.

    Parameters
    ----------
    coarse : Panel of any mesh
    velocity : [m/s] of the shot for peak tensions, one that stops
    tolerance : [m/s] of the critical velocity
    guess : [m/s] of a coarser mesh
    executor, jobs : as of `ballistic_limit.critical_velocity`
    report : called as report(elements a crossover, Shot) after each shot

    Raises
    ------
    InputError : a shot at `velocity` that perforates
    UnstableError : as `ballistic_limit.critical_velocity`
    """
    panel, began = replace(coarse, elements_per_crossover=n), time.process_time()

    def report_shot(_, shot):
        if report is not None:
            report(n, shot)

    (shot,) = ballistic_limit.shoot(panel, [velocity], report=report_shot)
    if shot.perforated:
        raise InputError(
            f"fabric {panel.fabric.name} with {n} elements a crossover is perforated", key="velocity", value=velocity,
            allowed="one that stops on every mesh",
        )  # fmt: skip
    known = {} if guess is None else {"guess": guess, "step": NEAR}
    found = ballistic_limit.critical_velocity(
        panel, tolerance=tolerance, executor=executor, jobs=jobs, report=report_shot, **known
    )
    return Point(
        panel.fabric.name, n, found.velocity, found.half_width, velocity, *shot.peak_tension, panel.table.model.form,
        time.process_time() - began,
    )  # fmt: skip


def quantities(points: Sequence[Point]) -> tuple[Quantity, ...]:
    """The three quantities of one fabric from its points; InputError unless they are at least three meshes."""
    points = sorted(points, key=lambda one: one.elements)
    elements = [one.elements for one in points]
    if len(set(elements)) < 3 or len(set(elements)) < len(elements):
        raise InputError(key="elements", value=elements, allowed="at least three numbers that rise")
    name, half = points[0].fabric, max(one.half_width for one in points)
    return (
        quantity(name, "critical velocity", "m/s", elements, [one.critical_velocity for one in points], half),
        quantity(name, "peak warp tension", "N", elements, [one.warp for one in points]),
        quantity(name, "peak weft tension", "N", elements, [one.weft for one in points]),
    )


def study(
    fabric: Fabric, velocity: float, *, elements: Sequence[int] = (1, 2, 3), setup: ImpactSetup | None = None,
    known: Iterable[Point] = (), keep: Callable[[Point], object] | None = None, **options: Any,
) -> tuple[Quantity, ...]:  # fmt: skip
    """Critical velocity, and peak tensions of warp and weft at one velocity, on several meshes.

    Parameters
    ----------
    fabric : Fabric, as it is to be used (see Fabric.effective)
    velocity : [m/s] of the shot for peak tensions, one that stops on every mesh
    elements : a crossover, at least three meshes, from coarse to fine
    setup : ImpactSetup of another panel or projectile
    known : Points of earlier runs, which are not run again
    keep : called as keep(Point) after each mesh that was run
    options : of `point`

    Returns
    -------
    (Quantity, Quantity, Quantity)

    Raises
    ------
    InputError : meshes that are not at least three from coarse to fine, or a shot at `velocity` that perforates
    UnstableError : as `ballistic_limit.critical_velocity`
    """
    if len(elements) < 3 or list(elements) != sorted(set(elements)):
        raise InputError(key="elements", value=list(elements), allowed="at least three numbers that rise")
    coarse = (setup or ImpactSetup(fabric, velocity)).panel()
    found, there = [], {one.elements: one for one in known if one.fabric == fabric.name}
    for n in elements:
        if n in there:
            found.append(there[n])
            continue
        guess = found[-1].critical_velocity if found else None
        found.append(point(coarse, velocity, n, guess=guess, **options))
        if keep is not None:
            keep(found[-1])
    return quantities(found)
