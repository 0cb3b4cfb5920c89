"""The runs of the study: one fabric on several meshes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from importlib import resources

from fabrics.errors import InputError
from fabrics.units import si
from shellfabric import limit
from shellfabric.impact import ImpactSetup
from validation.convergence.richardson import Extrapolation, extrapolate

ALLOWED = {1: 0.05, 2: 0.02}  # asked: share of the limit within which 1 and 2 elements a crossover are to be
TOLERANCE = 0.25  # [m/s] of the critical velocity's bracket: a tenth of what 2 % of it are


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
    def deviations(self):
        """(n,) [-] of the values from the limit, over the limit."""
        return tuple(value / self.extrapolation.limit - 1 for value in self.values)

    @property
    def met(self):
        """Whether the meshes that something is asked of are as close to the limit as asked."""
        found = dict(zip(self.elements, self.deviations))
        return all(abs(found[n]) <= allowed for n, allowed in ALLOWED.items() if n in found)


def quantity(fabric, name, unit, elements, values, noise=0.0):
    """A Quantity with its extrapolation."""
    extrapolation = extrapolate([1 / n for n in elements], values, noise)
    return Quantity(fabric, name, unit, tuple(elements), tuple(map(float, values)), noise, extrapolation)


def velocities():
    """{fabric: [m/s]} strike velocities for the peak tensions."""
    import tomllib

    text = (resources.files("validation.convergence") / "velocities.toml").read_text("utf-8")
    return {name: si(value, "m/s", key=name) for name, value in tomllib.loads(text)["velocities"].items()}


def study(fabric, velocity, *, elements=(1, 2, 3), setup=None, tolerance=TOLERANCE, workers=1, report=None):
    """Critical velocity, and peak tensions of warp and weft at one velocity, on several meshes.

    Parameters
    ----------
    fabric : Fabric, as it is to be used (see Fabric.effective)
    velocity : [m/s] of the shot for peak tensions, one that stops on every mesh
    elements : a crossover, at least three meshes, from coarse to fine
    setup : ImpactSetup of another panel or projectile
    tolerance : [m/s] of the critical velocity
    report : called as report(elements a crossover, Shot) after each shot

    Returns
    -------
    (Quantity, Quantity, Quantity)

    Raises
    ------
    InputError : meshes that are not at least three from coarse to fine, or a shot at `velocity` that perforates
    UnstableError : as `limit.critical_velocity`
    """
    if len(elements) < 3 or list(elements) != sorted(set(elements)):
        raise InputError(key="elements", value=list(elements), allowed="at least three numbers that rise")
    coarse = (setup or ImpactSetup(fabric, velocity)).panel()
    critical, warp, weft, guess, half = [], [], [], None, 0.0
    for n in elements:
        panel = replace(coarse, elements_per_crossover=n)

        def told(_, shot, n=n):
            if report is not None:
                report(n, shot)

        found = limit.critical_velocity(panel, tolerance=tolerance, guess=guess, workers=workers, report=told)
        (shot,) = limit.shoot(panel, [velocity], report=told)
        if shot.perforated:
            raise InputError(
                f"fabric {fabric.name} with {n} elements a crossover is perforated", key="velocity", value=velocity,
                allowed="one that stops on every mesh",
            )  # fmt: skip
        critical.append(found.velocity)
        warp.append(shot.peak_tension[0])
        weft.append(shot.peak_tension[1])
        guess, half = found.velocity, max(half, found.half_width)
    return (
        quantity(fabric.name, "critical velocity", "m/s", elements, critical, half),
        quantity(fabric.name, "peak warp tension", "N", elements, warp),
        quantity(fabric.name, "peak weft tension", "N", elements, weft),
    )
