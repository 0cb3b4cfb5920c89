# Public names and their modules: `fabrics.lazy.public` loads each when it is first used.
from fabrics import __version__ as __version__
from fabrics.errors import DoubtfulResult, InputError, UndecidedError, UnstableError
from weavecell.analysis.fit import fit
from weavecell.api.exports import export
from weavecell.api.quasi_static import calibrate, coupon
from weavecell.api.quasi_static_results import CalibrationResult, CouponResult
from weavecell.api.result import Result
from weavecell.api.results import CriticalVelocityResult, DrawsResult, ShotResult, SweepResult, V50Result
from weavecell.api.runs import (
    backings,
    critical_velocity,
    draws,
    fabric,
    fabrics,
    projectile,
    projectiles,
    setup,
    shoot,
    sweep,
    v50,
)

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
