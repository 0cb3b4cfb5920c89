"""The projectile: a rigid cylinder with a flat nose and a rounded edge, moving without turning."""

from __future__ import annotations

from dataclasses import dataclass

from fabrics.errors import InputError


@dataclass(frozen=True)
class Projectile:
    """Rigid right circular cylinder (source thesis section 2.3: 3 g, 5.5 mm, flat).

    Parameters
    ----------
    mass : [kg]
    radius : [m]
    edge_radius : [m] rounding of the edge; the contact needs one, see `contact_kernels`

    Raises
    ------
    InputError : a value is not positive, or the edge is rounder than the cylinder
    """

    mass: float = 3.0e-3
    radius: float = 2.75e-3
    edge_radius: float = 0.3e-3

    def __post_init__(self):
        for key in ("mass", "radius", "edge_radius"):
            if not 0 < getattr(self, key) < float("inf"):
                raise InputError(key=key, value=getattr(self, key), allowed="above 0")
        if self.edge_radius > self.radius:
            raise InputError(key="edge_radius", value=self.edge_radius, allowed=f"at most the radius {self.radius:g}")

    def energy(self, speed):
        """[J] kinetic energy at a speed [m/s]."""
        return 0.5 * self.mass * speed**2
