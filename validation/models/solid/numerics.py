"""Numerical knobs of the explicit patch of solid yarns (`solid.model`)."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from fabrics.errors import InputError


@dataclass(frozen=True)
class PatchNumerics:
    """Set by stability and convergence; none is fitted to an outcome.

    Parameters
    ----------
    cfl : Courant factor, the time step over its stability bound, found anew before every audit from the state
    hourglass : factor on the stiffness of the hourglass control; 1 is the full rule's at rest
    solid_viscosity, fibre_viscosity : damping ratios of the highest mode through a yarn, and along it
    penalty : [Pa/m] of yarns on each other, both passes together, and of the projectile on yarns
    toe : [m] penetration over which the contact stiffness sets in
    deepest : [m] penetration beyond which a node is no partner of a face: it came in from the side of a yarn that is
        torn, or stands on edge beside the nose
    contact_damping : ratio to critical of a face's node on its spring
    slack_width : [-] fibre strain over which a fibre becomes taut
    slack_stiffness : [-] fraction of its stiffness left to a slack fibre
    """

    cfl: float = 0.8
    hourglass: float = 1.0
    solid_viscosity: float = 0.1
    fibre_viscosity: float = 0.1
    penalty: float = 1e14
    toe: float = 0.5e-6
    deepest: float = 20e-6
    contact_damping: float = 0.3
    slack_width: float = 1e-4
    slack_stiffness: float = 1e-3

    def __post_init__(self):
        for key in ("cfl", "penalty", "toe", "deepest", "slack_width", "slack_stiffness"):
            if not 0 < getattr(self, key) < inf:
                raise InputError(key=key, value=getattr(self, key), allowed="above 0")
        for key in ("hourglass", "solid_viscosity", "fibre_viscosity", "contact_damping"):
            if not 0 <= getattr(self, key) < inf:
                raise InputError(key=key, value=getattr(self, key), allowed="at least 0")
        if self.cfl > 1:
            raise InputError(key="cfl", value=self.cfl, allowed="at most 1")
