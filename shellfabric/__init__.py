"""Explicit dynamics of a fabric panel under impact: numba kernels on a structured grid of crossovers."""

from fabrics.kernel_cache import kernel_cache

with kernel_cache(__file__):  # kernels call each other across files: one cache, emptied when any of them changes
    from shellfabric.backing import contact_kernels as backing_contact_kernels  # noqa: F401
    from shellfabric.cable import step_kernels as cable_step_kernels  # noqa: F401
    from shellfabric.coupon import relaxation_kernels  # noqa: F401
    from shellfabric.panel import quality_kernels  # noqa: F401
    from shellfabric.panel import step_kernels as panel_step_kernels  # noqa: F401
    from shellfabric.plies import step_kernels as plies_step_kernels  # noqa: F401
    from shellfabric.projectile import bar_kernels  # noqa: F401
    from shellfabric.solid import step_kernels as solid_step_kernels  # noqa: F401
