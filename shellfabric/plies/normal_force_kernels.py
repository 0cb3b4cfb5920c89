"""Normal forces of the contact points of a pack with friction, which Coulomb's law needs.

`Pair.normal_force` is an array in a pack with friction. It is None in one without, whose kernels know nothing of it.
"""

from numba.extending import register_jitable

from shellfabric.jit.simd import load, mask_from_bits, masked_store, where


@register_jitable
def clear_normal_forces(forces, start, end):
    """Set the normal forces of the points start .. end - 1 to 0."""
    if forces is not None:
        for q in range(start, end):
            forces[q] = 0.0


@register_jitable
def store_normal_force(forces, q, f):
    """Keep the normal force `f` [N] of point q."""
    if forces is not None:
        forces[q] = f


@register_jitable
def store_normal_force8(forces, q, f, which, count):
    """Keep the normal forces `f` [N] of those of eight points from q on whose bits are set in `which`."""
    if forces is not None:
        masked_store(forces, q, where(mask_from_bits(which), f, load(forces, q)), count)
