"""The public names of Python, each with the module that holds it: the one list of them, which
`weavecell.api` reads when it is imported, as editors and type checkers do."""

from fabrics import __version__ as __version__
from fabrics.base.errors import DoubtfulResult as DoubtfulResult
from fabrics.base.errors import InputError as InputError
from fabrics.base.errors import UndecidedError as UndecidedError
from fabrics.base.errors import UnstableError as UnstableError
from weavecell.api import crossover as crossover
from weavecell.api.biaxial_fit import BiaxialFitResult as BiaxialFitResult
from weavecell.api.biaxial_paths import BiaxialResult as BiaxialResult
from weavecell.api.biaxial_paths import biaxial as biaxial
from weavecell.api.calibration import CalibrationResult as CalibrationResult
from weavecell.api.calibration import calibrate as calibrate
from weavecell.api.citations import Citations as Citations
from weavecell.api.citations import cite as cite
from weavecell.api.comparison import ComparisonResult as ComparisonResult
from weavecell.api.comparison import compare as compare
from weavecell.api.coupons import CouponResult as CouponResult
from weavecell.api.coupons import coupon as coupon
from weavecell.api.crossover_result import CrossoverResult as CrossoverResult
from weavecell.api.exports import DeckResult as DeckResult
from weavecell.api.exports import export as export
from weavecell.api.interval_comparison import (
    IntervalComparisonResult as IntervalComparisonResult,
)
from weavecell.api.laboratory_tests import TestsBesideShots as TestsBesideShots
from weavecell.api.laboratory_tests import TestsResult as TestsResult
from weavecell.api.laboratory_tests import reduce_tests as reduce_tests
from weavecell.api.limits import CriticalVelocityResult as CriticalVelocityResult
from weavecell.api.limits import critical_velocity as critical_velocity
from weavecell.api.lists import Tables as Tables
from weavecell.api.lists import backings as backings
from weavecell.api.lists import fabrics as fabrics
from weavecell.api.lists import metals as metals
from weavecell.api.lists import new_fabric as new_fabric
from weavecell.api.lists import new_shot as new_shot
from weavecell.api.lists import projectiles as projectiles
from weavecell.api.lists import show as show
from weavecell.api.lists import view as view
from weavecell.api.meshes import MeshResult as MeshResult
from weavecell.api.meshes import mesh as mesh
from weavecell.api.patches import PatchResult as PatchResult
from weavecell.api.patches import patch as patch
from weavecell.api.reduction import CompressionRecords as CompressionRecords
from weavecell.api.reduction import ShotRecord as ShotRecord
from weavecell.api.reduction import reduce_compression as reduce_compression
from weavecell.api.reduction import reduce_shot as reduce_shot
from weavecell.api.result import Result as Result
from weavecell.api.run_size import RunSize as RunSize
from weavecell.api.run_size import SizeOfPatch as SizeOfPatch
from weavecell.api.runs import fabric as fabric
from weavecell.api.runs import setup as setup
from weavecell.api.saved import SavedResult as SavedResult
from weavecell.api.saved import load as load
from weavecell.api.saved import overlay as overlay
from weavecell.api.scatter import V50Result as V50Result
from weavecell.api.scatter import v50 as v50
from weavecell.api.shots import ShotResult as ShotResult
from weavecell.api.shots import impact as impact
from weavecell.api.surfaces import SurfaceResult as SurfaceResult
from weavecell.api.surfaces import surface as surface
from weavecell.api.sweeps import SweepResult as SweepResult
from weavecell.api.sweeps import SweepTable as SweepTable
from weavecell.api.sweeps import sweep as sweep

def read_docstring(name: str) -> str: ...
