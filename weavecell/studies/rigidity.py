"""Whether a rigid projectile would have done in a shot, or the bar that it is moves tip against
tail."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError

if TYPE_CHECKING:
    from shellfabric.impact.result import ImpactResult

# Periods of contact (`contact_time`) from which on a rigid projectile is enough
# (docs/reports/numerics.md)
ENOUGH = 3.0


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
            verdict = "a rigid projectile is enough"
        else:
            verdict = f"tip and tail move apart: {advice}"
        return f"{times}: {verdict} (from {ENOUGH:g} periods on)"


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


def check_shot(result: ImpactResult) -> Rigidity | None:
    """Judge whether a rigid projectile is enough.

    Its contact is compared with the period of the bar that it is, or would be if it were of steel.
    None for other shapes than a flat cylinder, and if the fabric was never touched.
    """
    shot = result.setup.projectile
    try:
        bar = shot.bar or (shot.steel_bar() if shot.shape == "flat" else None)
        if bar is None:
            return None
        t = result.step_history[:, 0]
        force = result.step_history[:, 3]
        return rigid_is_enough(
            contact_time(t, force, bar.period),
            bar.period,
            find_held_force(t, force, 0.5 * bar.period),
            bar.yield_force,
            elastic=shot.bar is not None,
        )
    except InputError:
        return None
