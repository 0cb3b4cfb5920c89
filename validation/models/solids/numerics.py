"""The numbers of the method of a patch of solid yarns."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from fabrics.base.errors import InputError


@dataclass(frozen=True)
class SolidNumerics:
    """Numbers that belong to the method, set by stability and convergence; none is fitted to an outcome.

    Parameters
    ----------
    cfl : Courant factor, the time step over its stability bound, which is found anew every few steps
    hourglass : factor on the stiffness of the hourglass control; 1 is that of the full rule at rest
    full_rule : whether the law is integrated at 2 x 2 x 2 points of a brick, as in the 3D crossover,
        in place of one point and the hourglass control
    solid_viscosity, fibre_viscosity : damping ratios of the highest mode through a yarn, and along it
    penalty : [Pa/m] of yarns on each other, both passes together, and of the projectile on yarns
    toe : [m] penetration over which the contact stiffness sets in
    contact_damping : ratio to critical of a facet on its spring
    edge_diameter : [-] of the rounded edges at which parallel neighbours meet, over the largest
        thickness of the yarn. Assumed, between 0.1 and 0.5
    slack_width : [-] fibre strain over which a fibre becomes taut
    slack_stiffness : [-] fraction of its stiffness left to a slack fibre
    take_off_overlap : whether facets that overlap where they are meshed count as just touching. At
        rest the contact then stores nothing; the quasi-static crossover has no such rule
    """

    cfl: float = 0.8
    hourglass: float = 1.0
    full_rule: bool = False
    solid_viscosity: float = 0.1
    fibre_viscosity: float = 0.1
    penalty: float = 1e14
    toe: float = 0.5e-6
    contact_damping: float = 0.3
    edge_diameter: float = 0.25
    slack_width: float = 1e-4
    slack_stiffness: float = 1e-3
    take_off_overlap: bool = True

    def __post_init__(self):
        for key in ("cfl", "penalty", "toe", "edge_diameter", "slack_width", "slack_stiffness"):
            if not 0 < getattr(self, key) < inf:
                raise InputError(key=key, value=getattr(self, key), allowed="above 0")
        for key in ("hourglass", "solid_viscosity", "fibre_viscosity", "contact_damping"):
            if not 0 <= getattr(self, key) < inf:
                raise InputError(key=key, value=getattr(self, key), allowed="at least 0")
        if self.cfl > 1:
            raise InputError(key="cfl", value=self.cfl, allowed="at most 1")
