"""One shot as a row of plain values."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from shellfabric.membrane.indicator import OK, Indicator, status


def row_of(result: Any, problem: str = "") -> dict[str, Any]:
    """Return outcome, velocity, energy, deflection, tensions and checks of a shot.

    Parameters
    ----------
    result : ImpactResult, or an ImpactRecord, which has the tensions of each ply
    problem : why it became unstable, or ""
    """
    warp, weft = np.reshape(result.peak_tension, (-1, 2)).max(axis=0)
    return {
        "outcome": "unstable" if problem else result.outcome,
        "residual_velocity_m_s": float(result.residual_velocity),
        "absorbed_energy_J": result.absorbed_energy,
        "max_deflection_m": float(result.max_deflection),
        "peak_tension_warp_N": float(warp),
        "peak_tension_weft_N": float(weft),
        "cut_yarns": float(result.cut_yarns[-1]),
        "energy_error_max": float(result.energy_error_max),
        "checks": with_reasons(result.checks),
    }


def with_reasons(indicators: Sequence[Indicator]) -> str:
    """Write "ok", or "doubtful: ..." or "noted: ..." with every indicator of that status, its value and
    its limit."""
    worst = status(indicators)
    reasons = "; ".join(str(indicator) for indicator in indicators if indicator.status == worst)
    if worst == OK:
        return worst
    return f"{worst}: {reasons}"
