"""The Python interface: what `import weavecell` offers, by the modules that hold it."""

from fabrics import __version__
from fabrics.base.errors import DoubtfulResult, InputError, UndecidedError, UnstableError
from weavecell.api import crossover
from weavecell.api.biaxial_paths import BiaxialResult, biaxial
from weavecell.api.calibration import CalibrationResult, calibrate
from weavecell.api.comparison import ComparisonResult, TestsResult, compare
from weavecell.api.coupons import CouponResult, coupon
from weavecell.api.crossover_result import CrossoverResult
from weavecell.api.exports import DeckResult, export
from weavecell.api.limits import CriticalVelocityResult, critical_velocity
from weavecell.api.lists import (
    Tables,
    backings,
    fabrics,
    new_fabric,
    new_shot,
    projectiles,
    show,
    view,
)
from weavecell.api.meshes import MeshResult, mesh
from weavecell.api.result import Result
from weavecell.api.run_size import RunSize
from weavecell.api.runs import fabric, setup
from weavecell.api.scatter import V50Result, v50
from weavecell.api.shots import ShotResult, impact
from weavecell.api.surfaces import SurfaceResult, surface
from weavecell.api.sweeps import SweepResult, SweepTable, sweep

__all__ = [
    "BiaxialResult",
    "CalibrationResult",
    "ComparisonResult",
    "CouponResult",
    "CriticalVelocityResult",
    "CrossoverResult",
    "DeckResult",
    "DoubtfulResult",
    "InputError",
    "MeshResult",
    "Result",
    "RunSize",
    "ShotResult",
    "SurfaceResult",
    "SweepResult",
    "SweepTable",
    "Tables",
    "TestsResult",
    "UndecidedError",
    "UnstableError",
    "V50Result",
    "__version__",
    "backings",
    "biaxial",
    "calibrate",
    "compare",
    "coupon",
    "critical_velocity",
    "crossover",
    "export",
    "fabric",
    "fabrics",
    "impact",
    "mesh",
    "new_fabric",
    "new_shot",
    "projectiles",
    "setup",
    "show",
    "surface",
    "sweep",
    "v50",
    "view",
]
