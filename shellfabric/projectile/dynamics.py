"""The projectile's body in a run: rigid, or an elastic-plastic bar along its axis.

`bar` describes the bar, `bar_kernels` moves it; in a run it is a part, `BarBody`. A modelled part of
the panel has as much of the bar: masses and sections are its share of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base import sums
from fabrics.base.checks import FloatArray
from shellfabric.parts import Part
from shellfabric.projectile import bar_kernels
from shellfabric.projectile.state import BarRow

if TYPE_CHECKING:
    from shellfabric.projectile.bar import Bar

RIGID = ("z", "v", "force")  # columns of the step history, `loop.stack_kernels.record_step`
ENERGIES = "kinetic_projectile", "elastic_projectile", "plastic_projectile"
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
        """[s] period in which tip and tail swing against each other: of the strongest frequency of
        the difference of their velocities, between a third of the bar's first and three times it.
        NaN of a history of under three periods."""
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


def history(t: FloatArray, fine: FloatArray, row: Any, bar: Bar) -> BarHistory:
    """Return the history of a bar from the columns BAR of a run, and from its row at the end."""
    named = {name: fine[:, BAR.index(name)] for name in BAR[len(RIGID) :]}
    shortening = -sums.dot(np.expm1(row.plastic), row.h)
    return BarHistory(t, **named, period=bar.period, shortening=shortening)


def columns(motion: FloatArray) -> tuple[str, ...]:
    """Return the names of the columns of the history of a projectile with this `Stack.motion`."""
    return (*RIGID, *BAR[len(RIGID) :][: motion.size])


def make_row(bar: Bar, share: float, dt: float, velocity: float) -> BarRow:
    """Make the row that the kernels need of a bar in flight, without strain.

    Parameters
    ----------
    share : of the bar that is in the model
    dt : [s] time step of the fabric
    velocity : [m/s] along its axis
    """
    h, area = bar.mesh
    found = BarRow.zeros(nodes=h.size + 1, elements=h.size)
    found |= {
        "mass": share * bar.nodal_mass,
        "h": h,
        "area": share * area,
        "modulus": bar.material.modulus,
        "yield_stress": bar.material.yield_stress,
        "hardening": bar.material.hardening,
        "substeps": bar.substeps(dt),
    }
    found["v"][:] = velocity
    row = BarRow(**found)
    bar_kernels.note_motion(row)
    return row


class BarBody(Part):
    """A projectile that is a bar along its axis.

    Parameters
    ----------
    bar : Bar
    share : of it that is in the model
    dt : [s] time step of the fabric
    velocity : [m/s] along its axis
    """

    name = "bar"
    of_ply = False
    flight = bar_kernels.move_bar

    def __init__(self, bar: Bar, share: float, dt: float, velocity: float) -> None:
        self.bar = bar
        self.row = make_row(bar, share, dt, velocity)
        self.motion = self.row.motion

    def identity(self) -> tuple[Any, ...]:
        """Return what determines the bar, see Part."""
        return self.name, self.bar

    def energies(self) -> dict[str, float]:
        """Return the energies [J] of the bar, see Part."""
        row = self.row
        values = (
            bar_kernels.kinetic_energy(row),
            bar_kernels.elastic_energy(row),
            float(row.plastic_work),
        )
        return dict(zip(ENERGIES, values))

    def result(self, clock: FloatArray, steps: FloatArray) -> dict[str, Any]:
        """Return the history of the bar, see Part."""
        return {"bar": history(clock, steps, self.row, self.bar)}


def make_bodies(pack: Any, consts: Any, velocity: float) -> tuple[Part, ...]:
    """Make the body of a projectile that is not rigid and strikes a pack at a velocity [m/s]."""
    first = pack.plies[0]
    shot = first.shot
    if shot.bar is None:
        return ()
    along = velocity * sums.dot(shot.flight, shot.frame[2])
    return (BarBody(shot.bar, first.share, consts[0].dt, along),)


def audit(
    state: Any, const: Any, force: FloatArray, motion: FloatArray
) -> tuple[dict[str, float], float]:
    """Compute the energies of the projectile at the present whole step, but those of a body that is
    not rigid.

    A rigid body's velocity stands half a step back, and so does that of any body across its axis.

    Parameters
    ----------
    force : (3,) [N] on the projectile
    motion : `Stack.motion`

    Returns
    -------
    {name: energy [J]} of the modelled part, velocity along the normal [m/s]
    """
    energies = dict.fromkeys(ENERGIES, 0.0)
    kick = const.dt * force * const.free_dofs / const.projectile_mass
    speed = state.projectile_velocity
    if not motion.size:
        energies["kinetic_projectile"] = 0.5 * const.projectile_mass * sums.dot(speed, speed + kick)
        return energies, float(speed[2] + 0.5 * kick[2])
    axis = const.frame[2]
    across = speed - axis * sums.dot(axis, speed)
    pushed = kick - axis * sums.dot(axis, kick)
    beside = 0.5 * const.projectile_mass * sums.dot(across, across + pushed)
    velocity = across[2] + 0.5 * pushed[2] + axis[2] * motion[bar_kernels.CENTRE]
    energies["kinetic_projectile"] = beside
    return energies, float(velocity)


def velocity(state: Any, const: Any, motion: FloatArray) -> FloatArray:
    """Compute the velocity (3,) [m/s] of the projectile's centre of mass, half a step back; of a
    body that is not rigid along its axis at the present step."""
    speed = state.projectile_velocity.copy()
    if motion.size:
        axis = const.frame[2]
        speed += axis * (motion[bar_kernels.CENTRE] - sums.dot(axis, speed))
    return speed
