"""The Python interface: what `import weavecell` offers, by the modules that hold it.

A public name stands in `__all__` of its module.
"""

# ruff: noqa: F403

from fabrics import __version__
from fabrics.base.errors import DoubtfulResult, InputError, UndecidedError, UnstableError
from weavecell.api import (
    biaxial_paths,
    calibration,
    citations,
    comparison,
    coupons,
    crossover,
    crossover_result,
    exports,
    laboratory_tests,
    limits,
    lists,
    meshes,
    patches,
    reduction,
    result,
    run_size,
    runs,
    saved,
    scatter,
    shots,
    surfaces,
    sweeps,
)
from weavecell.api.biaxial_paths import *
from weavecell.api.calibration import *
from weavecell.api.citations import *
from weavecell.api.comparison import *
from weavecell.api.coupons import *
from weavecell.api.crossover_result import *
from weavecell.api.exports import *
from weavecell.api.laboratory_tests import *
from weavecell.api.limits import *
from weavecell.api.lists import *
from weavecell.api.meshes import *
from weavecell.api.patches import *
from weavecell.api.reduction import *
from weavecell.api.result import *
from weavecell.api.run_size import *
from weavecell.api.runs import *
from weavecell.api.saved import *
from weavecell.api.scatter import *
from weavecell.api.shots import *
from weavecell.api.surfaces import *
from weavecell.api.sweeps import *

__all__ = [
    "DoubtfulResult",
    "InputError",
    "UndecidedError",
    "UnstableError",
    "__version__",
    "crossover",
]
__all__ += biaxial_paths.__all__
__all__ += calibration.__all__
__all__ += citations.__all__
__all__ += laboratory_tests.__all__
__all__ += comparison.__all__
__all__ += coupons.__all__
__all__ += crossover_result.__all__
__all__ += exports.__all__
__all__ += limits.__all__
__all__ += lists.__all__
__all__ += meshes.__all__
__all__ += patches.__all__
__all__ += reduction.__all__
__all__ += result.__all__
__all__ += run_size.__all__
__all__ += runs.__all__
__all__ += saved.__all__
__all__ += scatter.__all__
__all__ += shots.__all__
__all__ += surfaces.__all__
__all__ += sweeps.__all__
__all__.sort()
