"""The projectile's body in a run: rigid, or an elastic-plastic bar along its axis (`bar`, `bar_kernels.advance_bar`).

A modelled part of the panel has as much of the bar: masses and sections are its share of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base.checks import FloatArray
from shellfabric.projectile import bar_kernels

if TYPE_CHECKING:
    from shellfabric.projectile.bar import Bar
    from shellfabric.projectile.projectile import Projectile

RIGID = ("z", "v", "force")  # columns of the step history, `solver.stack_kernels.record_step`
STATE = (
    "bar_u",
    "bar_v",
    "bar_plastic",
    "bar_stress",
    "bar_energy",
)  # fields of a State that are the body's
BAR = (*RIGID, "tip_velocity", "tail_velocity", "centre_velocity", "tip", "tail", "centre")


@dataclass(frozen=True)
class BarHistory:
    """A bar through time, along its axis.

    Parameters
    ----------
    t : (n,) [s]
    tip, tail, centre : (n,) [m] how far tip, tail and centre of mass have come
    tip_velocity, tail_velocity, centre_velocity : (n,) [m/s]
    period : [s] of the first mode of the bar
    shortening : [m] by plastic strain, at the end
    """

    t: np.ndarray
    tip: np.ndarray
    tail: np.ndarray
    centre: np.ndarray
    tip_velocity: np.ndarray
    tail_velocity: np.ndarray
    centre_velocity: np.ndarray
    period: float
    shortening: float

    @property
    def swing(self) -> float:
        """[s] period in which tip and tail swing against each other: of the strongest frequency of the difference of
        their velocities, between a third of the bar's first and three times it. NaN of a history of under three
        periods."""
        t = self.t
        apart = self.tip_velocity - self.tail_velocity
        if t.size < 2 or t[-1] < 3 * self.period:
            return float("nan")
        late = t > self.period  # past the first blow
        t = t[late]
        apart = apart[late]
        window = np.hanning(t.size)
        wave = (apart - np.average(apart, weights=window)) * window
        tries = np.geomspace(self.period / 3, 3 * self.period, 601)
        power = [abs(np.sum(wave * np.exp(2j * np.pi * t / period))) for period in tries]
        return float(tries[int(np.argmax(power))])


def history(t: FloatArray, fine: FloatArray, state: Any, bar: Bar) -> BarHistory:
    """The history of a bar from the columns BAR of a run, and from its state at the end."""
    named = {name: fine[:, BAR.index(name)] for name in BAR[len(RIGID) :]}
    return BarHistory(
        t, **named, period=bar.period, shortening=-float(np.expm1(state.bar_plastic) @ bar.mesh[0])
    )


def columns(projectile: Projectile) -> tuple[str, ...]:
    """Names of the columns of its history."""
    return RIGID if projectile.bar is None else BAR


def constants(projectile: Projectile, share: float, dt: float) -> dict[str, Any]:
    """What the kernels need to know of the body, by name; without elements where it is rigid."""
    if projectile.bar is None:
        none = np.zeros(0)
        return {
            "bar_mass": none,
            "bar_h": none,
            "bar_area": none,
            "bar_law": none,
            "bar_substeps": 0,
        }
    bar, (h, area) = projectile.bar, projectile.bar.mesh
    law = np.array([bar.material.modulus, bar.material.yield_stress, bar.material.hardening])
    return {
        "bar_mass": share * bar.nodal_mass,
        "bar_h": h,
        "bar_area": share * area,
        "bar_law": law,
        "bar_substeps": bar.substeps(dt),
    }


def state(projectile: Projectile, strike_velocity: float) -> dict[str, FloatArray]:
    """State of the body in flight, without strain, by name."""
    n = 0 if projectile.bar is None else projectile.bar.mesh[0].size
    along = strike_velocity * float(projectile.flight @ projectile.frame[2])
    nodes = n + 1 if n else 0
    return {
        "bar_u": np.zeros(nodes),
        "bar_v": np.full(nodes, along),
        "bar_plastic": np.zeros(n),
        "bar_stress": np.zeros(n),
        "bar_energy": np.zeros(2),
    }


def audit(state: Any, const: Any, force: FloatArray) -> tuple[float, float, float, float]:
    """Kinetic, elastic and plastic energy [J] of the modelled part, and the velocity along the normal [m/s], at the
    present whole step, where a force (3,) [N] acts on it. A rigid body's velocity stands half a step back, and so does
    a bar's across its axis."""
    kick = const.dt * force * const.free_dofs / const.projectile_mass
    speed = state.projectile_velocity
    if const.bar_mass.size == 0:
        return (
            0.5 * const.projectile_mass * float(speed @ (speed + kick)),
            0.0,
            0.0,
            float(speed[2] + 0.5 * kick[2]),
        )
    axis = const.frame[2]
    out = np.empty(2)
    across = speed - axis * (axis @ speed)
    pushed = kick - axis * (axis @ kick)
    bar_kernels.energies(
        state.bar_v,
        const.bar_mass,
        const.bar_h,
        const.bar_area,
        const.bar_law[0],
        state.bar_stress,
        out,
    )
    beside = 0.5 * const.projectile_mass * float(across @ (across + pushed))
    velocity = (
        across[2]
        + 0.5 * pushed[2]
        + axis[2] * bar_kernels.mass_average(const.bar_mass, state.bar_v)
    )
    plastic = float(state.bar_energy[bar_kernels.PLASTIC])
    return (
        float(out[bar_kernels.KINETIC]) + beside,
        float(out[bar_kernels.ELASTIC]),
        plastic,
        float(velocity),
    )


def velocity(state: Any, const: Any) -> FloatArray:
    """(3,) [m/s] of the projectile's centre of mass, half a step back; of a bar along its axis at the present step."""
    speed = state.projectile_velocity.copy()
    if const.bar_mass.size > 0:
        axis = const.frame[2]
        speed += axis * (bar_kernels.mass_average(const.bar_mass, state.bar_v) - axis @ speed)
    return speed
