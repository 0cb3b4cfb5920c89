"""The front door: commands, scene files, the walk of the data from fabric to impact, pictures and reports.

Python interface, loaded when it is first used:

    import weavecell as wc

    fabric = wc.fabric("S-720")
    shot = wc.shoot(fabric, "92.5 m/s")
    print(shot.outcome, shot.to_dataframe())
"""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

for _name in ("fabrics", "meshing", "unitcell3d", "shellfabric", "validation"):
    _found = importlib.util.find_spec(_name)
    if _found is not None and _found.origin and Path(_found.origin).parent.parent != Path(__file__).parent.parent:
        raise ImportError(
            f"{_found.origin} hides the package {_name} of weavecell, which has the same name: "
            "rename it, or run from another folder"
        )

from fabrics import __version__  # noqa: E402

__all__ = [
    "CalibrationResult",
    "CouponResult",
    "CriticalVelocityResult",
    "DoubtfulResult",
    "DrawsResult",
    "InputError",
    "Result",
    "ShotResult",
    "SweepResult",
    "UndecidedError",
    "UnstableError",
    "V50Result",
    "__version__",
    "backings",
    "calibrate",
    "convert",
    "coupon",
    "critical_velocity",
    "draws",
    "export",
    "fabric",
    "fabrics",
    "fit",
    "projectile",
    "projectiles",
    "setup",
    "shoot",
    "sweep",
    "v50",
]

# For callers alone: no module of ours takes these names from here, so that kept results do not depend on them.
_MODULES = {
    "weavecell.api.exports": ("convert", "export", "fit"),
    "weavecell.api.quasi_static": ("calibrate", "coupon"),
    "weavecell.api.quasi_static_results": ("CalibrationResult", "CouponResult"),
    "weavecell.api.result": ("Result",),
    "weavecell.api.results": ("CriticalVelocityResult", "DrawsResult", "ShotResult", "SweepResult", "V50Result"),
    "weavecell.api.runs": (
        "backings",
        "critical_velocity",
        "draws",
        "fabric",
        "fabrics",
        "projectile",
        "projectiles",
        "setup",
        "shoot",
        "sweep",
        "v50",
    ),
    "fabrics.errors": ("DoubtfulResult", "InputError", "UndecidedError", "UnstableError"),
}


def __getattr__(name: str) -> Any:
    for module, names in _MODULES.items():
        if name in names:
            return getattr(importlib.import_module(module), name)
    raise AttributeError(f"module 'weavecell' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
