"""Explicit dynamics of a fabric panel under impact: numba kernels on a structured grid of crossovers."""

from fabrics.kernel_cache import kernel_cache

with kernel_cache(__file__):  # kernels call each other across files: one cache, emptied when any of them changes
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
