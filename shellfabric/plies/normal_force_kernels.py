"""Normal forces of the contact points of a pack with friction, which Coulomb's law needs.

`Pair.normal_force` is an array in a pack with friction and the float 0 in one without. numba chooses by that type:
kernels of a pack without friction have no instruction of it.
"""

from numba import types
from numba.extending import overload

from shellfabric.jit.simd import load, mask_from_bits, masked_store, where


def clear_normal_forces(forces, start, end):
    """Set the normal forces of the points start .. end - 1 to 0."""


@overload(clear_normal_forces, inline="always")
def _clear_normal_forces(forces, start, end):
    if isinstance(forces, types.Float):
        return lambda forces, start, end: None

    def clear(forces, start, end):
        for q in range(start, end):
            forces[q] = 0.0

    return clear


def store_normal_force(forces, q, f):
    """Keep the normal force `f` [N] of point q."""


@overload(store_normal_force, inline="always")
def _store_normal_force(forces, q, f):
    if isinstance(forces, types.Float):
        return lambda forces, q, f: None

    def store(forces, q, f):
        forces[q] = f

    return store


def store_normal_force8(forces, q, f, which, count):
    """Keep the normal forces `f` [N] of those of eight points from q on whose bits are set in `which`."""


@overload(store_normal_force8, inline="always")
def _store_normal_force8(forces, q, f, which, count):
    if isinstance(forces, types.Float):
        return lambda forces, q, f, which, count: None

    def store8(forces, q, f, which, count):
        masked_store(forces, q, where(mask_from_bits(which), f, load(forces, q)), count)

    return store8
