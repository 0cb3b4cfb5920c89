"""Explicit dynamics of a fabric panel under impact: numba kernels on a structured grid of crossovers."""

from fabrics.kernel_cache import kernel_cache

# kernels call each other across files: one cache, emptied when any of them changes
with kernel_cache(__file__, "compiled.py", "borrow.py", "lanes.py", "team.py", "panel_arrays.py"):
    from shellfabric import (  # noqa: F401
        bar_kernels,
        block_contact_kernels,
        cable_kernels,
        march_kernels,
        pack_kernels,
        patch_kernels,
        quality_kernels,
        relax_kernels,
    )
