"""What can be asked of an impact, with the share of what its error is measured in.

A residual velocity goes to zero at the critical velocity, and so would any share of it: its error is counted in the
strike velocity, that of the energy in the strike energy. A panel that is perforated has no largest deflection, and its
peak tension is the yarn's strength with whatever the last step before failure added.
"""

from __future__ import annotations

from math import nan

NAMES = ("residual_velocity", "absorbed_energy", "deflection", "peak_tension")
WORDS = {
    "residual_velocity": "residual velocity, over the strike velocity",
    "absorbed_energy": "energy absorbed, over the strike energy",
    "deflection": "largest deflection of a panel that stops, over itself",
    "peak_tension": "peak tensions of a panel that stops, warp and weft, over themselves",
}


def of(result):
    """{name: value or (values)} of an ImpactResult, with its outcome.

    Velocities and energies are shares of those of the strike. Deflection [m] and tensions (warp, weft) [N] are nan
    where the panel is perforated.
    """
    speed = max(result.residual_velocity, 0.0) if result.outcome != "stopped" else 0.0
    share, through = speed / result.setup.strike_velocity, result.outcome == "perforated"
    return {
        "outcome": result.outcome,
        "residual_velocity": share,
        "absorbed_energy": 1 - share**2,
        "deflection": nan if through else float(max(result.z)),
        "peak_tension": (nan, nan) if through else tuple(result.peak_tension),
    }


def differences(one, other):
    """{name: error of `one` against `other`, as a share}; nan where a quantity is not there in both."""
    found = {name: abs(one[name] - other[name]) for name in ("residual_velocity", "absorbed_energy")}
    found["deflection"] = abs(one["deflection"] / other["deflection"] - 1)
    found["peak_tension"] = max(abs(a / b - 1) for a, b in zip(one["peak_tension"], other["peak_tension"]))
    return found
