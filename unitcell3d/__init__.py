"""The quasi-static crossover of two yarns in three dimensions (dolfinx, PETSc), and the compression law it yields.

The public names are loaded when they are first used; `calibrate` needs dolfinx.
"""

from __future__ import annotations

import importlib
from typing import Any

from fabrics.kernel_cache import kernel_cache

__all__ = [
    "Calibration",
    "CrossoverModel",
    "History",
    "Load",
    "Numerics",
    "ShearFit",
    "SolidFit",
    "biaxial",
    "calibrate",
    "calibrate_all",
    "fit_solid",
    "plate_compression",
    "sample",
    "with_assumed_range",
]

with kernel_cache(__file__):  # kernels call each other across files: one cache, emptied when any of them changes
    from unitcell3d.assembly import sparsity_kernels  # noqa: F401
    from unitcell3d.contact import (  # noqa: F401
        edge_contact_kernels,
        plate_contact_kernels,
        slip_kernels,
        surface_contact_kernels,
        surface_kernels,
        surface_tangent_kernels,
    )
    from unitcell3d.material import fibre_kernels  # noqa: F401

# For callers alone: no module of ours takes these names from here, so that no digest of code follows them.
_MODULES = {
    "unitcell3d.cases.biaxial_and_platens": ("biaxial", "plate_compression"),
    "unitcell3d.identify.assumed_range": ("with_assumed_range",),
    "unitcell3d.identify.calibrate": ("calibrate", "calibrate_all"),
    "unitcell3d.identify.calibration": ("Calibration",),
    "unitcell3d.identify.response_surface": ("sample",),
    "unitcell3d.identify.shear_fit": ("ShearFit",),
    "unitcell3d.identify.solid_fit": ("fit_solid",),
    "unitcell3d.identify.solid_record": ("SolidFit",),
    "unitcell3d.model.crossover": ("CrossoverModel", "Load", "Numerics"),
    "unitcell3d.solver.history": ("History",),
}


def __getattr__(name: str) -> Any:
    for module, names in _MODULES.items():
        if name in names:
            return getattr(importlib.import_module(module), name)
    raise AttributeError(f"module 'unitcell3d' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
