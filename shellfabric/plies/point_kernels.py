"""The formulas of a contact point between plies (`plies.pressure_kernels`), each for one point and for
eight at once.

A kernel here is compiled for floats, and for vectors of eight of them. What it compares is a
boolean of one point, a mask of eight (`jit.simd`).
"""

from shellfabric.contact.normal_kernels import damped
from shellfabric.jit.compile import kernel
from shellfabric.jit.simd import both, fabs, greater, maximum, minimum, sqrt, where
from shellfabric.plies.law_kernels import law_at
from shellfabric.surface.vector_kernels import add, add_scaled, dot, scaled, subtract

_JUMP = 0.01  # [thicknesses] in a step that no motion has made
_FLAT = 1e-12  # squared sine between slopes below which fabric counts as drawn to a line
_CONVEX = 0.1  # share of the squared area of the slopes that Newton's matrix has to have
_LEAST_SPEED = 1e-60  # [m/s]
_LEAST_FORCE = 1e-12  # [N]


@kernel(_nrt=False, forceinline=True)
def products(w, slopes):
    """Return the products of the slopes y_a, y_b with each other, (aa, ab, bb), and with the offset
    w, (a, b)."""
    y_a, y_b = slopes
    return (dot(y_a, y_a), dot(y_a, y_b), dot(y_b, y_b)), (dot(y_a, w), dot(y_b, w))


@kernel(_nrt=False, forceinline=True)
def determinant(plain):
    """Compute aa bb - ab^2: of the products of slopes the squared area between them."""
    aa, ab, bb = plain
    return aa * bb - ab * ab


@kernel(_nrt=False, forceinline=True)
def height_after(w, plain, along):
    """Compute the squared distance after a step of Gauss and Newton, times the squared area of the
    slopes."""
    aa, ab, bb = plain
    a, b = along
    return dot(w, w) * determinant(plain) - (bb * a * a - 2.0 * (ab * a * b) + aa * b * b)


@kernel(_nrt=False, forceinline=True)
def normal_equations(w, slopes, thickness):
    """Set up the equations of a step of Gauss and Newton towards the closest point.

    w : offset of the point; slopes : of the surface along a and b

    Returns
    -------
    products of the slopes with each other and with the offset; whether there is a solution: fabric
    is not drawn to a line; whether the point will be within the thickness
    """
    plain, along = products(w, slopes)
    square = determinant(plain)
    solvable = greater(square, _FLAT * (plain[0] * plain[2]))
    near = greater(thickness * thickness * square, height_after(w, plain, along))
    return plain, along, solvable, near


@kernel(_nrt=False, forceinline=True)
def newton_matrix(plain, w, second, near):
    """Return the products of slopes less those of the offset with the second slopes aa, ab and bb,
    if `near` and these are convex; else the products alone."""
    aa, ab, bb = plain
    curved = aa - dot(w, second[0]), ab - dot(w, second[1]), bb - dot(w, second[2])
    area = greater(determinant(curved), _CONVEX * determinant(plain))
    use = both(near, both(greater(curved[0], 0.0), area))
    return where(use, curved[0], aa), where(use, curved[1], ab), where(use, curved[2], bb)


@kernel(_nrt=False, forceinline=True)
def solve(matrix, along):
    """Return the step (a, b) [elements] that solves the equations."""
    aa, ab, bb = matrix
    a, b = along
    square = determinant(matrix)
    return (bb * a - ab * b) / square, (aa * b - ab * a) / square


@kernel(_nrt=False, forceinline=True)
def offset_after(w, slopes, second, a, b):
    """Return the offset w [m] of a point from the surface after a step of its closest point by
    (a, b), to second order: eq. (4) of `plies.pressure_kernels`."""
    y_a, y_b = slopes
    y_aa, y_ab, y_bb = second
    along_a = add_scaled(y_a, 0.5, add(scaled(a, y_aa), scaled(b, y_ab)))
    along_b = add_scaled(y_b, 0.5, add(scaled(a, y_ab), scaled(b, y_bb)))
    return subtract(subtract(w, scaled(a, along_a)), scaled(b, along_b))


@kernel(_nrt=False, forceinline=True)
def unearned(closure, motion, memory, step, thickness):
    """Return the part [m] of a closure that no motion has made: what it had when the point first
    touched, and what it jumps by.

    Parameters
    ----------
    closure : [m]
    motion : [m] that motion has added in this step
    memory : step in which the point last touched, its closure and the unearned part then
    step : the present one
    thickness : [m] mean of both plies
    """
    last_step, last_closure, last_unearned = memory
    touched = greater(0.5, fabs(last_step - (step - 1.0)))
    jump = closure - motion - where(touched, last_closure, 0.0)
    kept = where(touched, last_unearned, 0.0)
    jumps = greater(fabs(jump), _JUMP * thickness)
    return minimum(where(jumps, maximum(kept + jump, 0.0), kept), closure)


@kernel(_nrt=False, forceinline=True)
def spring_at(pressure, p, closure, deepest):
    """Return (force [N], damping [N s/m], energy [J] that it gives back) of the spring of a point of
    ply p at a closure [m], which has been `deepest`: eq. (3) of `plies.pressure_kernels`."""
    on_law = deepest - (deepest - closure) / pressure.resilience
    spring, damping, energy = law_at(pressure.laws[p], pressure.law_cell[p], on_law)
    return spring, where(greater(on_law, 0.0), damping, 0.0), pressure.resilience * energy


@kernel(_nrt=False, forceinline=True)
def normal_force(pressure, p, area, closures, closing, touching):
    """Return the force [N] of a point of ply p along the normal, eq. (1), and the energy [J] that its
    spring gives back, 0 unless `touching`; and D / f [s/m] of its limited shares
    (`surface.surface_kernels`).

    area : that it stands for; closures : [m] now, and the deepest; closing : [m/s]
    """
    spring, damping, energy = spring_at(pressure, p, *closures)
    force = area * damped(spring, damping, closing)
    drag = pressure.share_drag * area * damping / maximum(force, _LEAST_FORCE)
    return where(touching, force, 0.0), where(touching, area * energy, 0.0), drag


@kernel(_nrt=False, forceinline=True)
def friction_force(pressure, dt, p, area, force, kept, sliding, n, touching):
    """Return the friction [N] of a point of ply p on the ply before, less its sign; its elastic slip
    [m] and the energy [J] that is lost in the step: eq. (2). All are 0 unless `touching`.

    force : [N] along the normal n; kept : [m] elastic slip of the last step; sliding : [m/s] velocity
    along the surface
    """
    stiffness = pressure.stick_stiffness[p] * area
    damping = pressure.stick_damping[p] * area
    limit = pressure.friction * force
    # the surface may have turned since the last step
    before = subtract(kept, scaled(dot(kept, n), n))
    slip = add(before, scaled(dt, sliding))
    size = stiffness * sqrt(dot(slip, slip))
    slip = scaled(minimum(limit / maximum(size, _LEAST_FORCE), 1.0), slip)
    # the damper has what the spring leaves of the limit, so that it takes energy, whatever the slip
    square = dot(sliding, sliding)
    left = maximum(limit - size, 0.0)
    damping = minimum(damping, left / maximum(sqrt(square), _LEAST_SPEED))
    pull = add(scaled(stiffness, slip), scaled(damping, sliding))
    work = 0.5 * stiffness * dot(add(before, slip), sliding) + damping * square
    # of points that nothing presses on any more the spring is let go
    work = where(greater(limit, 0.0), work, 0.0)
    stored = 0.5 * stiffness * (dot(slip, slip) - dot(kept, kept))
    lost = dt * work - stored
    return held(touching, pull), held(touching, slip), where(touching, lost, 0.0)


@kernel(_nrt=False, forceinline=True)
def held(which, vector):
    """Return a vector where `which`, else 0."""
    x, y, z = vector
    return where(which, x, 0.0), where(which, y, 0.0), where(which, z, 0.0)


@kernel(_nrt=False, forceinline=True)
def sliding_velocity(v, closing, n):
    """Return the velocity v [m/s] less its part along the normal n."""
    return subtract(v, scaled(closing, n))
