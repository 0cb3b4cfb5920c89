"""Whether a rigid projectile would have done in a shot, or the bar that it is moves tip against
tail, or the metal of its nose flows."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, log1p, pi
from typing import TYPE_CHECKING

import numpy as np

from fabrics import metals
from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from shellfabric.impact.proposals import fill

if TYPE_CHECKING:
    from shellfabric.impact.result import ImpactResult
    from shellfabric.projectile.projectile import Projectile

# Periods of contact (`contact_time`) from which on a rigid projectile is enough
# (docs/reports/numerics.md)
ENOUGH = 3.0
# of which a nose may be, by the density of the whole body within this share (a jacket lowers that of lead)
CANDIDATES = ("lead", "OFHC copper", "42CrMo4")
SAME_DENSITY = 0.15


@dataclass(frozen=True)
class Rigidity:
    """Whether a rigid projectile would have done.

    Parameters
    ----------
    contact_time, period : [s]
    force, yield_force : [N] that pressed on it for half a period, and at which its thinnest section
        yields
    enough : bool
    elastic : whether the shot had the elastic projectile
    """

    contact_time: float
    period: float
    enough: bool
    force: float = 0.0
    yield_force: float = inf
    elastic: bool = False

    def __str__(self):
        periods = self.contact_time / self.period
        times = f"contact lasts {1e6 * self.contact_time:.3g} us, {periods:.3g} periods of the bar"
        times = f"{times} ({1e6 * self.period:.3g} us)"
        advice = "use the elastic projectile"
        if self.elastic:
            advice = "a rigid projectile is not enough"
        if self.force > self.yield_force:
            forces = f"{self.force:.0f} N press on it, and its thinnest section yields at {self.yield_force:.0f} N"
            return f"{times}; {forces}: {advice}"
        if self.enough:
            return f"{times}: a rigid projectile is enough, as from {ENOUGH:g} periods on"
        return f"{times}, fewer than {ENOUGH:g}, so that tip and tail move apart: {advice}"


def rigid_is_enough(
    contact_time: float,
    bar_period: float,
    force: float = 0.0,
    yield_force: float = inf,
    *,
    elastic: bool = False,
) -> Rigidity:
    """Compare the time of contact with the period of the bar, both [s]; see ENOUGH. And the force,
    `find_held_force`, with that at which it yields, both [N]: a wall that is squeezed takes energy that
    a rigid body would have to keep.

    Raises
    ------
    InputError : a time that is not positive
    """
    for key, value in (("contact_time", contact_time), ("bar_period", bar_period)):
        if not 0 < value < inf:
            raise InputError(key=key, value=value, allowed="above 0")
    enough = contact_time >= ENOUGH * bar_period and force <= yield_force
    return Rigidity(contact_time, bar_period, enough, float(force), float(yield_force), elastic)


def find_held_force(t: FloatArray, force: FloatArray, span: float) -> float:
    """Compute the largest mean [N] over a span [s] of the force in a history (n,) [s], (n,) [N] of
    even steps.

    A blow that is shorter than half a period does not reach the thin sections behind the tip as a
    force.
    """
    width = 1
    if len(t) > 1:
        width = max(1, round(span / (t[1] - t[0])))
    total = np.concatenate([[0.0], np.cumsum(np.abs(force)), np.full(width, np.sum(np.abs(force)))])
    return float(np.max(total[width:] - total[:-width], initial=0.0)) / width


def contact_time(t: FloatArray, force: FloatArray, period: float) -> float:
    """Compute the time [s] for which the largest mean force over a period of the bar would have to
    act to give the impulse.

    Parameters
    ----------
    t, force : (n,) [s], (n,) [N] history of even steps
    period : [s] of the bar; what is shorter the bar does not follow

    The momentary largest force instead of that mean would depend on the mesh: a finer one begins
    with a higher and shorter peak of the same impulse. A half sine of a duration T above the period
    P gives (2 T / pi) x / sin x with x = pi P / (2 T); what is shorter than the period gives the
    period.

    Raises
    ------
    InputError : a history without force
    """
    t = np.asarray(t, float)
    force = np.abs(np.asarray(force, float))
    if not np.max(force, initial=0.0) > 0:
        raise InputError("the projectile was never touched")
    return float(
        np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(t)) / find_held_force(t, force, period)
    )


@dataclass(frozen=True)
class SoftNose:
    """A rigid nose whose metal would have flowed.

    Parameters
    ----------
    pressure, flow_stress : [Pa] mean over its cross section, and of its metal at the rate of the shot
    metal : name of `fabrics.metals`
    sure : whether mass and drawing say that it is this metal
    advice : what to use in its place; "" if the set-up takes none
    """

    pressure: float
    flow_stress: float
    metal: str
    sure: bool
    advice: str = ""

    def __str__(self):
        pressures = (
            f"{1e-6 * self.pressure:.0f} MPa press on the nose, and {self.metal} flows at "
            f"{1e-6 * self.flow_stress:.0f} MPa"
        )
        condition = "" if self.sure else f" if it is a bullet of {self.metal}"
        advice = f"; {self.advice}" if self.advice else ""
        return f"{pressures}: a rigid nose is not enough{condition}{advice}"


def mean_density(shot: Projectile) -> float | None:
    """Compute mass over volume [kg/m3] of a solid of revolution; None of another, or if no length is
    given."""
    volume = shot.known.volume(shot)
    return None if volume is None else shot.mass / volume


def metal_of(shot: Projectile) -> tuple[str, bool] | None:
    """Find the metal of a rigid nose: (its name, whether mass and drawing say so).

    A hemisphere without a length may be a bullet of lead. None of a body whose density is that of no
    metal, and of shapes that a body of metal cannot have.
    """
    if not shot.known.of_metal:
        return None
    density = mean_density(shot)
    if density is None:
        if shot.known.if_soft is None:
            return None
        return shot.known.if_soft, False
    apart = {name: abs(density / metals.load(name).density - 1) for name in CANDIDATES}
    nearest = min(apart, key=lambda name: apart[name])
    return (nearest, True) if apart[nearest] <= SAME_DENSITY else None


def find_soft_nose(
    shot: Projectile, velocity: float, t: FloatArray, force: FloatArray
) -> SoftNose | None:
    """Judge whether the metal of a rigid nose would have flowed; None if not, or if it is not known.

    The pressure is the largest mean of the force over the time in which a wave crosses the diameter,
    over the cross section. The flow stress is that without plastic strain, at the rate that is the
    velocity [m/s] over the diameter.

    Parameters
    ----------
    t, force : (n,) [s], (n,) [N] history of even steps
    """
    found = metal_of(shot)
    if found is None:
        return None
    name, sure = found
    metal = metals.load(name)
    diameter = 2 * shot.radius
    held = find_held_force(t, force, diameter / metal.wave_speed)
    pressure = held / (pi * shot.radius**2)
    faster = 1 + metal.rate_coefficient * log1p(velocity / diameter / metal.reference_rate)
    flow_stress = metal.yield_stress * faster
    if pressure <= flow_stress:
        return None
    return SoftNose(pressure, flow_stress, name, sure)


def check_shot(result: ImpactResult) -> Rigidity | SoftNose | None:
    """Judge whether a rigid projectile is enough.

    The contact of a cylinder is compared with the period of the bar that it is, or would be if it
    were of steel. Of other noses that were stopped, the pressure is compared with the flow stress of
    their metal. None of a body of metal, and if nothing is to be said.
    """
    shot = result.setup.projectile
    if shot.body == "metal":
        return None
    t = result.step_history[:, 0]
    force = result.step_history[:, 3]
    try:
        bar = shot.bar or (shot.steel_bar() if shot.known.of_bar else None)
    except InputError:
        bar = None  # its mass is not that of a cylinder of steel
    if bar is not None:
        try:
            return rigid_is_enough(
                contact_time(t, force, bar.period),
                bar.period,
                find_held_force(t, force, 0.5 * bar.period),
                bar.yield_force,
                elastic=shot.bar is not None,
            )
        except InputError:
            return None  # the fabric was never touched
    if result.outcome != "stopped":
        return None
    found = find_soft_nose(shot, result.setup.strike_velocity, t, force)
    if found is None:
        return None
    return replace(found, advice=fill("use {body of metal}", result.setup))
