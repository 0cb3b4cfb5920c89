"""Guards of the explicit time integration: the limits beyond which a run has become unphysical."""

from __future__ import annotations

from collections.abc import Iterable

from fabrics.yarn import Yarn

ENERGY_ERROR_LIMIT = 0.02  # share of the strike energy by which the energy balance may be off
SPEED_FACTOR = 10.0
# of the strike energy lost to the length of the steps: beyond, a run is made again
MOST_STEP_LOSS = 0.004
# step of that second run over that of the first, the longest that is short enough: the loss falls with its square, a
# little less where cut yarns whip
SHORTER_STEPS = 0.7, 0.5
ENERGY_GAIN_LIMIT = 0.01  # share of the strike energy that a contact may seem to have given


def speed_limit(strike_velocity: float, yarns: Iterable[Yarn]) -> float:
    """Return the highest speed [m/s] of a node that a run goes on with: ten times the velocity that
    sets nodes in motion.

    That is the strike velocity or, in a slow strike, the velocity e c at which a yarn of the wave
    speed c that breaks at the strain e lets go of its end. Nodes are faster than either without any
    instability: the nose throws light ones at twice its own velocity and more, the end of a broken
    yarn flies at 2 e c (430 m/s in a sound strike at 20 m/s), and the free corner of a panel that
    is drawn in cracks as a whip does.

    Parameters
    ----------
    strike_velocity : [m/s]
    yarns : of the fabric
    """
    return SPEED_FACTOR * max(
        strike_velocity, *(yarn.failure_strain * yarn.wave_speed for yarn in yarns)
    )


def energy_gain_message(taken: float, strike_energy: float) -> str:
    """Write the message for a contact that has taken in `taken` [J]; "" unless it has given more
    than ENERGY_GAIN_LIMIT."""
    share = -taken / strike_energy
    if share > ENERGY_GAIN_LIMIT:
        return f"has given {100 * share:.2g} % of the strike energy that it never took"
    return ""
