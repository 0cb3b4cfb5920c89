"""Guards of the explicit time integration: the limits beyond which a run has become unphysical."""

from __future__ import annotations

from typing import Any

ENERGY_GAIN_LIMIT = 0.01  # share of the strike energy that a contact may seem to have given


def speed_limit(const: Any) -> float:
    """[m/s] the highest speed of a node that a run goes on with: one shorter side of an element in a step.

    Nodes are fast without any instability. The nose throws light ones at twice its own velocity and more, a yarn that
    breaks at the strain e lets go of its free end at 2 e c, with c the wave speed of the fabric, and the free corner of
    a panel that is drawn in cracks as a whip does. None of this is bounded by the strike velocity alone. What central
    differences cannot follow is a change of shape within a step: their bound takes the stiffness as constant over it,
    while one end of a segment that moves by the segment's length has turned it over. As the step is a share of the time
    that a wave takes over an element, such a node is faster than sound in the fabric. Below the bound the energy error
    decides whether a run is good, and ends it if not.

    Parameters
    ----------
    const : with dx, dy [m], the sides of the smallest element, and dt [s]
    """
    return min(const.dx, const.dy) / const.dt


def energy_gain_message(taken: float, strike_energy: float) -> str:
    """Message for a contact that has taken in `taken` [J]; "" unless it has given more than ENERGY_GAIN_LIMIT."""
    share = -taken / strike_energy
    return f"has given {100 * share:.2g} % of the strike energy that it never took" if share > ENERGY_GAIN_LIMIT else ""
