"""The Python interface: what `import weavecell` offers, by the modules that hold it."""

from fabrics import __version__
from fabrics.errors import DoubtfulResult, InputError, UndecidedError, UnstableError
from weavecell.api.calibration import calibrate
from weavecell.api.calibration_result import CalibrationResult
from weavecell.api.comparison import ComparisonResult, compare
from weavecell.api.coupons import CouponResult, coupon
from weavecell.api.exports import DeckResult, export
from weavecell.api.limits import CriticalVelocityResult, critical_velocity
from weavecell.api.result import Result
from weavecell.api.run_size import RunSize
from weavecell.api.runs import backings, fabric, fabrics, projectile, projectiles, setup
from weavecell.api.scatter import DrawsResult, SensitivityResult, V50Result, draws, sensitivity, v50
from weavecell.api.shots import ShotResult, shoot
from weavecell.api.sweeps import SweepResult, SweepTable, sweep
from weavecell.studies.fit import fit

__all__ = [
    "CalibrationResult",
    "ComparisonResult",
    "CouponResult",
    "CriticalVelocityResult",
    "DeckResult",
    "DoubtfulResult",
    "DrawsResult",
    "InputError",
    "Result",
    "RunSize",
    "SensitivityResult",
    "ShotResult",
    "SweepResult",
    "SweepTable",
    "UndecidedError",
    "UnstableError",
    "V50Result",
    "__version__",
    "backings",
    "calibrate",
    "compare",
    "coupon",
    "critical_velocity",
    "draws",
    "export",
    "fabric",
    "fabrics",
    "fit",
    "projectile",
    "projectiles",
    "sensitivity",
    "setup",
    "shoot",
    "sweep",
    "v50",
]
