"""The quasi-static crossover of two yarns in three dimensions (dolfinx, PETSc), and the compression law it yields.

The public names are loaded when they are first used; `calibrate` needs dolfinx.
"""

from __future__ import annotations

from fabrics import lazy
from fabrics.kernel_cache import kernel_cache

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

__getattr__, __dir__ = lazy.public(__name__, __file__)
