"""Force, damping and energy of a contact point between plies, from its closure
(`fabrics.ply_law.PlyLaw`).

A table of `Pressure.laws` has a row for each of the equal cells of the closure up to the travel,
and a last one for all beyond: force [N] at its beginning, stiffness [N/m] in it, damping [N s/m],
and energy [J] at its beginning; those of a point of the smallest element. With the pressure p, its
slope k and the area A and mass m of a point (`numerics.law_tables`)

    f = A (p(d) + c v),     c = zeta sqrt(k m / A)

so that the damping is the same part of critical damping in the soft weave and in solid fibre, on
any mesh.
"""

from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import floor, gather_rows4, maximum, minimum, to_int32


@kernel(_nrt=False, forceinline=True)
def law_at(table, step, closure):
    """Return (force [N], damping [N s/m], energy [J]) of a point, or of eight, at a closure [m]; one
    below 0 counts as 0."""
    closure = maximum(closure, 0.0)
    cell = floor(minimum(closure / step, table.shape[0] - 1.0))
    force, stiffness, damping, energy = gather_rows4(table, to_int32(cell))
    rest = closure - cell * step
    return force + stiffness * rest, damping, energy + (force + 0.5 * stiffness * rest) * rest
