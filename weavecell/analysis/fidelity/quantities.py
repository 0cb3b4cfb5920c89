"""Quantities of an impact that can have a target, with the share of what its error is measured in.

A residual velocity goes to zero at the critical velocity, and so would any share of it: its error is counted in the
strike velocity, that of the energy in the strike energy. A panel that is perforated has no largest deflection, and its
peak tension is the yarn's strength with whatever the last step before failure added.

How hard a scene is. Of a shot that goes through, v_r^2 = v^2 - v_c^2: what a model gets wrong in the energy that the
panel takes, a share A of the strike energy, it gets wrong in proportion to A, and in the residual velocity to
A / (2 v_r / v). Of one that is held, a model goes wrong by more where two coarse meshes are further apart: the
deflection in proportion to it, peak tensions, whose errors have more of chance, rather with its root (found by leaving
out one scene of the survey at a time). With yarns near their strength it may not be held at all.

Peak tensions come from above with elements of one crossover and from below with those of two and of a half: the mean
of two meshes errs less than either (`mixed`).
"""

from __future__ import annotations

from collections.abc import Iterable
from math import isnan, nan
from typing import Any

import numpy as np

from fabrics.yarn import Yarn, striking_velocity

NAMES = ("residual_velocity", "absorbed_energy", "deflection", "peak_tension")
WORDS = {
    "residual_velocity": "residual velocity, over the strike velocity",
    "absorbed_energy": "energy absorbed, over the strike energy",
    "deflection": "largest deflection of a panel that stops, over itself",
    "peak_tension": "peak tensions of a panel that stops, warp and weft, over themselves",
}


def of(result: Any) -> dict[str, Any]:
    """{name: value or (values)} of an ImpactResult, with its outcome, load and haste.

    Velocities and energies are shares of those of the strike. Deflection [m] and tensions (warp, weft) [N] are nan
    where the panel is perforated. Peak tensions of a pack are the highest of any ply, those of turned plies with the
    fabric's own warp and weft. The load is the larger peak tension over the yarn's strength,
    the haste the strike velocity over that which fails a lone yarn at once (`fabrics.yarn.striking_velocity`).
    """
    speed, setup, peaks = max(result.residual_velocity, 0.0), result.setup, _peaks(result)
    share, through = speed / setup.strike_velocity, result.outcome == "perforated"
    strengths = [[yarn.strength for yarn in setup.fabric_of(p).weave.yarns] for p in range(len(peaks))]
    warp, weft = peaks.max(axis=0)
    return {
        "outcome": result.outcome,
        "haste": haste(setup.strike_velocity, setup.fabric.weave.yarns),
        "load": float(np.max(peaks / strengths)),
        "residual_velocity": share,
        "absorbed_energy": 1 - share**2,
        "deflection": nan if through else float(max(result.step_history[:, 1])),
        "peak_tension": (nan, nan) if through else (float(warp), float(weft)),
    }


def _peaks(result):
    """(plies, 2) [N] highest tension of each ply, by its fabric's own warp and weft."""
    return np.array([row[::-1] if result.setup.is_turned(p) else row for p, row in enumerate(result.ply_tensions)])


def haste(strike_velocity: float, yarns: Iterable[Yarn]) -> float:
    """[-] a strike velocity [m/s] over the lowest that fails a lone yarn at once (`fabrics.yarn.striking_velocity`)."""
    return strike_velocity / min(striking_velocity(yarn.wave_speed, yarn.failure_strain) for yarn in yarns)


def hasty(values: dict[str, Any]) -> bool:
    """Whether a shot is so fast that yarns fail under the nose before the mesh about it can tell one from the next."""
    return values["haste"] > _HASTY


def differences(one: dict[str, Any], other: dict[str, Any]) -> dict[str, float]:
    """{name: error of `one` against `other`, as a share}; nan where a quantity is not there in both."""
    found = {name: abs(one[name] - other[name]) for name in ("residual_velocity", "absorbed_energy")}
    found["deflection"] = abs(one["deflection"] / other["deflection"] - 1)
    found["peak_tension"] = max(abs(a / b - 1) for a, b in zip(one["peak_tension"], other["peak_tension"]))
    return found


def mixed(values: dict[str, Any], others: dict[str, Any], weight: float) -> dict[str, Any]:
    """`values` with peak tensions to which another mesh's contribute by `weight`."""
    if regime(values) != regime(others):
        return values
    pairs = zip(values["peak_tension"], others["peak_tension"])
    return values | {"peak_tension": tuple(one + weight * (other - one) for one, other in pairs)}


HELD, THROUGH = "held", "through"
_NEAR = 0.9  # load from which on another mesh may find the panel perforated
_HASTY = 0.27  # haste from which on the energy of a mesh of one element a crossover was off by 10 to 90 % of itself
_SLOW = 0.1  # residual velocity over that of the strike, below which the shot is too near the critical velocity to tell


def regime(values: dict[str, Any]) -> str:
    """HELD or THROUGH: what a scout made of a shot; one in flight at the end is held."""
    return THROUGH if values["outcome"] == "perforated" else HELD


def is_defined(name: str, regime: str) -> bool:
    """Whether a quantity is there at all: a panel that is perforated has neither largest deflection nor peak."""
    return regime != THROUGH or name in ("residual_velocity", "absorbed_energy")


def scale(name: str, fine: dict[str, Any], coarse: dict[str, Any], usual: float) -> float:
    """[-] what errors of a quantity are in proportion to; nan where the outcome is in doubt.

    Parameters
    ----------
    fine, coarse : what two scouts found, `of`
    usual : [-] how far the two are apart in a usual scene
    """
    if regime(fine) == THROUGH:
        taken, left = fine["absorbed_energy"], max(fine["residual_velocity"], _SLOW)
        return taken if name == "absorbed_energy" else taken / (2 * left)
    apart = differences(fine, coarse)[name]
    doubt = isnan(apart) or regime(coarse) == THROUGH or max(fine["load"], coarse["load"]) > _NEAR
    if doubt:
        return nan
    return (usual + apart) ** 0.5 if name == "peak_tension" else usual + apart
