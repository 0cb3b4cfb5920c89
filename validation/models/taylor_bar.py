"""The Taylor test: a cylinder of metal strikes a rigid wall without friction along its axis, and shortens."""

from __future__ import annotations

from dataclasses import dataclass

from fabrics.base.errors import UnstableError
from shellfabric.metal import body, motion_kernels
from shellfabric.metal.state import BodyRow
from shellfabric.projectile.turned import Turned

STEP = 1e-7  # [s] after which the bar is looked at; its own steps are shorter


@dataclass(frozen=True)
class Taylor:
    """A bar at the end of a Taylor test.

    Parameters
    ----------
    row : the body as it is
    energy_error : [-] what the balance misses of the kinetic energy at the start. The wall takes at once what the
        nodes of the front have, which counts
    """

    row: BodyRow
    energy_error: float

    @property
    def length(self) -> float:
        """[m] at the end."""
        return body.length(self.row)

    @property
    def width(self) -> float:
        """[m] largest diameter at the end."""
        return body.width(self.row)


def strike_wall(bar: Turned, velocity: float, duration: float = 80e-6) -> Taylor:
    """Fly a bar against a rigid wall at a velocity [m/s], for a duration [s].

    Raises
    ------
    UnstableError : an element turned inside out, or needs too short a step
    """
    row = body.make_row(bar, velocity=velocity, wall=0.0)
    for _ in range(round(duration / STEP)):
        motion_kernels.advance(row, STEP)
        if row.fault:
            raise UnstableError(f"element {row.critical} of the bar is deformed too far")
    start = 0.5 * row.mass.sum() * velocity**2
    front = row.mass[bar.places[:, 1] == 0].sum()
    left = row.kinetic_energy + row.elastic_energy + row.hourglass_energy
    left += row.plastic_work + row.viscous_work + 0.5 * front * velocity**2
    return Taylor(row, abs(left / start - 1))
