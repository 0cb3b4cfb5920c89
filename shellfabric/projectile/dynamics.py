"""The projectile's body in a run: rigid, or an elastic-plastic bar along its axis.

`bar` describes the bar, `bar_kernels` moves it; to the time loop it is a module (`state.Body`).
A modelled part of the panel has as much of the bar: masses and sections are its share of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base.checks import FloatArray
from shellfabric.projectile import bar_kernels
from shellfabric.projectile.state import BarRow
from shellfabric.state import Body

if TYPE_CHECKING:
    from shellfabric.projectile.bar import Bar

RIGID = ("z", "v", "force")  # columns of the step history, `solver.stack_kernels.record_step`
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
    """The history of a bar from the columns BAR of a run, and from its row at the end."""
    named = {name: fine[:, BAR.index(name)] for name in BAR[len(RIGID) :]}
    shortening = -float(np.expm1(row.plastic) @ row.h)
    return BarHistory(t, **named, period=bar.period, shortening=shortening)


def columns(bar: Bar | None) -> tuple[str, ...]:
    """Names of the columns of the history of a projectile: of a bar, or of a rigid one."""
    if bar is None:
        return RIGID
    return BAR


def make_row(bar: Bar, share: float, dt: float, velocity: float) -> BarRow:
    """What the kernels need to know of a bar in flight, without strain.

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


def body_of(row: BarRow, graded: bool) -> Body:
    """The body of a projectile that is a bar along its axis, before a uniform or a graded panel."""
    cell = bar_kernels.move_bar.cell(int(graded))
    return Body(
        cell=np.array([cell.place]),
        own=np.array([row._address]),
        force=row.force,
        motion=row.motion,
    )


def audit(state: Any, const: Any, force: FloatArray, bar: Any) -> tuple[dict[str, float], float]:
    """Energies of the projectile at the present whole step.

    A rigid body's velocity stands half a step back, and so does a bar's across its axis.

    Parameters
    ----------
    force : (3,) [N] on the projectile
    bar : its BarRow, or None of a rigid one

    Returns
    -------
    {name: energy [J]} of the modelled part, velocity along the normal [m/s]
    """
    energies = dict.fromkeys(ENERGIES, 0.0)
    kick = const.dt * force * const.free_dofs / const.projectile_mass
    speed = state.projectile_velocity
    if bar is None:
        energies["kinetic_projectile"] = 0.5 * const.projectile_mass * float(speed @ (speed + kick))
        return energies, float(speed[2] + 0.5 * kick[2])
    axis = const.frame[2]
    across = speed - axis * (axis @ speed)
    pushed = kick - axis * (axis @ kick)
    beside = 0.5 * const.projectile_mass * float(across @ (across + pushed))
    velocity = across[2] + 0.5 * pushed[2] + axis[2] * bar.motion[bar_kernels.CENTRE]
    energies["kinetic_projectile"] = bar_kernels.kinetic_energy(bar) + beside
    energies["elastic_projectile"] = bar_kernels.elastic_energy(bar)
    energies["plastic_projectile"] = float(bar.energy[bar_kernels.PLASTIC])
    return energies, float(velocity)


def velocity(state: Any, const: Any, bar: Any) -> FloatArray:
    """(3,) [m/s] of the projectile's centre of mass, half a step back; of a bar along its axis at
    the present step."""
    speed = state.projectile_velocity.copy()
    if bar is not None:
        axis = const.frame[2]
        speed += axis * (bar.motion[bar_kernels.CENTRE] - axis @ speed)
    return speed
