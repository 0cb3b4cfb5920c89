"""A fabric panel with its projectile, and the arrays that its kernels take."""

from __future__ import annotations

from dataclasses import dataclass

from shellfabric.membrane import arrays
from shellfabric.membrane.grid import PanelGrid


@dataclass(frozen=True)
class Panel(PanelGrid):
    """A fabric panel with its projectile.

    Its parameters are those of `PanelGrid`.
    """

    def constants(self) -> arrays.Constants:
        """Return what the kernels need to know, as plain numbers and arrays
        (`arrays.constants`)."""
        return arrays.constants(self)

    def state(self, strike_velocity: float) -> arrays.State:
        """Return the panel at rest, flat at z = 0, touched by the projectile that flies at it at
        `strike_velocity` [m/s]."""
        return arrays.state(self, strike_velocity)

    def work(self) -> arrays.Work:
        """Allocate the scratch of one thread, for one block of elements."""
        return arrays.work(self)
