"""Explicit dynamics of a fabric panel under impact: numba kernels on a structured grid of crossovers.

The public names are loaded when they are first used; `run` fires one shot.
"""

from __future__ import annotations

import importlib
from typing import Any

__all__ = [
    "Backing",
    "CellModel",
    "CellTable",
    "Grip",
    "HistoryRequest",
    "ImpactResult",
    "ImpactSetup",
    "LambertJonas",
    "Limit",
    "Numerics",
    "Pack",
    "Panel",
    "PlyContact",
    "Projectile",
    "PullIn",
    "ScanRange",
    "Shot",
    "critical_velocity",
    "run",
    "scan",
    "shoot",
]

# For callers alone: no module of ours takes these names from here, so that no digest of code follows them.
_MODULES = {
    "shellfabric.backing.block": ("Backing",),
    "shellfabric.cell.model": ("CellModel", "CellTable"),
    "shellfabric.impact.ballistic_limit": ("Limit", "Shot", "critical_velocity", "shoot"),
    "shellfabric.impact.lambert_jonas": ("LambertJonas",),
    "shellfabric.impact.limit_scan": ("ScanRange", "scan"),
    "shellfabric.impact.simulation": ("ImpactResult", "ImpactSetup", "run"),
    "shellfabric.output.histories": ("HistoryRequest",),
    "shellfabric.panel.boundary": ("Grip", "PullIn"),
    "shellfabric.panel.model": ("Numerics", "Panel"),
    "shellfabric.plies.model": ("Pack", "PlyContact"),
    "shellfabric.projectile.projectile": ("Projectile",),
}


def __getattr__(name: str) -> Any:
    for module, names in _MODULES.items():
        if name in names:
            return getattr(importlib.import_module(module), name)
    raise AttributeError(f"module 'shellfabric' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
