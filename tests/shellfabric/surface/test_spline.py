"""The smooth surface of contact: against scipy's B-splines, at borders and gaps, and what it does to tensions."""

from functools import cache

import numpy as np
import pytest
from conftest_tools import foresee, on_grid
from numpy.testing import assert_allclose
from panels import make_panel, rest, set_nodal
from scipy.interpolate import BSpline

from shellfabric.membrane.numerics import Numerics
from shellfabric.membrane.slots import by_node
from shellfabric.projectile import contact_kernels, sdf_kernels
from shellfabric.projectile.projectile import Projectile
from shellfabric.projectile.window_kernels import place_near_nose
from shellfabric.surface import torn_kernels
from shellfabric.surface.grid_kernels import grid_of
from shellfabric.surface.surface_kernels import foot_at, vector_of


def shaken(panel, firm):
    """(state, constants) of a panel with its nodes out of place, a projectile that has gone a little into it, and all
    that moving; with firm springs, of a nose no faster than the nodes, also what they foresee, and by what they sped up
    the nodes a step ago."""
    rng = np.random.default_rng(0)
    state = panel.state(100.0)
    const = panel.constants()
    size = rest(panel).shape
    set_nodal(state.u, 0.05 * const.dx * rng.normal(size=size))
    set_nodal(state.v, rng.normal(size=size))
    state.projectile_position[2] += 0.4e-3
    if not firm:
        return state, const._replace(point_law=const.point_law._replace(implicit=0.0))
    due = 3.0 * rng.normal(size=size)
    given = 5.0 * rng.normal(size=size)
    state.last_contact_force[:] = rng.random(state.last_contact_force.shape)
    state.projectile_velocity[:] = 0.2, -0.1, 0.4
    law = const.point_law
    law = law._replace(stiffness=16.0 * law.stiffness, damping=4.0 * law.damping)
    drag = 3.0 * (0.5 * law.stiffness * law.mass) ** 0.5
    law = law._replace(implicit=1.0, share_drag=drag)
    return foresee(state, const, due, given), const._replace(point_law=law)


def vectors(components, const):
    """(ni+1, nj+1, 3) of the components of a vector at each node."""
    return np.stack([by_node(part, const) for part in components], axis=-1)


def pressed(panel, state, const):
    """Contact forces (ni+1, nj+1, 3) of the kernel, with its work and the energy of its springs."""
    scratch = panel.work()
    place_near_nose(state, const)
    made = contact_kernels.contact_forces(state, const, scratch.contact_scratch)
    return vectors(state.f_contact, const), *made


def whole_edge(state, const, family, i, j):
    """Whether an edge is there; planes of symmetry are not asked for here."""
    inside = 0 <= i <= const.ni and 0 <= j <= const.nj
    return inside and state.intact_fraction[family][i * const.row_stride + j] > 0


BUMP = BSpline.basis_element(np.arange(-1.5, 2.0))


@cache
def bump(z):
    """scipy's quadratic B-spline about zero."""
    return float(BUMP(z)) if abs(z) < 1.5 else 0.0


def plain_weights(state, const, i, j, s, t):
    """{node: weight} of the point (s, t) of element (i, j), by ghost nodes that go straight on beyond a yarn's end."""
    q = int(s > 0.5)
    r = int(t > 0.5)
    m = i + q
    n = j + r
    basis = [[bump(z - k) for k in (-1, 0, 1)] for z in (s - q, t - r)]
    along = [
        whole_edge(state, const, 0, m - 1, n) and whole_edge(state, const, 0, m, n),
        whole_edge(state, const, 1, m, n - 1) and whole_edge(state, const, 1, m, n),
    ]
    own = (1 - 2 * q, 1 - 2 * r)
    for a in (-1, 1):
        for b in (-1, 1):
            if (a, b) == own or (a != own[0] and not along[0]) or (b != own[1] and not along[1]):
                continue
            warp = whole_edge(state, const, 0, min(m, m + a), n + b)
            weft = whole_edge(state, const, 1, m + a, min(n, n + b))
            if not (warp or weft):
                along = [False, False]
    for weights, runs_on, side in zip(basis, along, own):
        if not runs_on:  # 2 x(0) - x(side) in place of x(-side)
            ghost = weights[1 - side]
            weights[1 - side] = 0.0
            weights[1] += 2 * ghost
            weights[1 + side] -= ghost
    return {
        (m + a - 1, n + b - 1): basis[0][a] * basis[1][b]
        for a in range(3)
        for b in range(3)
        if basis[0][a] * basis[1][b] != 0.0
    }


def limited(shares, v, push, size, drag):
    """Shares of the nodes of a point, of which those that run ahead of surface and nose along a push get less; v : over
    that of the nose."""
    mean = sum(w * v[k] for k, w in shares.items()) @ push
    found = {}
    for k, w in shares.items():
        ahead = max(v[k] @ push - max(mean, 0.0), 0.0)
        found[k] = w * max(1 - drag * ahead / size, 1e-6)
    whole = sum(found.values())
    return {k: w / whole for k, w in found.items()}


def plain_contact(panel, state, const):
    """What the kernel does without friction, point by point, on a panel without mirrors. A state that foresees other
    forces has firm springs and limited shares; the sizes of those of a step ago count in them alone."""
    force = np.zeros((const.ni + 1, const.nj + 1, 3))
    work = 0.0
    spring = 0.0
    x = rest(panel) + vectors(state.u, const) - state.projectile_position
    v = vectors(state.v, const) - state.projectile_velocity
    firm = const.point_law.implicit
    due = 0 * v
    pushed = 0 * v
    if firm:
        due = on_grid(const, state.dv_other)
        pushed = on_grid(const, state.dv_contact)
    i_near = const.window_limits[0]
    columns = const.window_limits[3] - const.window_limits[2]
    i0, i1, j0, j1 = state.contact_window
    for i in range(i0, i1):
        for j in range(j0, j1):
            for a in range(const.points_per_side):
                for b in range(const.points_per_side):
                    s = (a + 0.5) / const.points_per_side
                    t = (b + 0.5) / const.points_per_side
                    shares = plain_weights(state, const, i, j, s, t)
                    assert min(shares.values()) > 0
                    assert sum(shares.values()) == pytest.approx(1.0)
                    p = sum(w * x[k] for k, w in shares.items())
                    moving = sum(w * v[k] for k, w in shares.items())
                    depth, normal = sdf_kernels.distance(const.nose, const.frame @ p)
                    if depth >= 0 or p[2] >= 0:
                        continue
                    near = [
                        state.intact_fraction[0][i * const.row_stride + j + (t > 0.5)],
                        state.intact_fraction[1][(i + (s > 0.5)) * const.row_stride + j],
                    ]
                    part = np.mean(near)
                    normal = np.array(normal) @ const.frame
                    k = part * const.point_law.stiffness
                    c = part * const.point_law.damping
                    if firm:
                        c += k * const.dt
                        e = (i - i_near) * columns + j - const.window_limits[2]
                        before = (
                            state.last_contact_force[a * const.points_per_side + b, e]
                            + state.force_scale
                        )
                        speeding = max(normal @ sum(w * pushed[m] for m, w in shares.items()), 0.0)
                        speeding += state.force_scale * const.dt / const.point_law.mass
                        moving_on = moving + sum(w * due[m] for m, w in shares.items())
                        f = max(-c * normal @ moving_on - k * depth, 0.0) / (
                            1.0 + c * speeding / before
                        )
                    else:
                        f = max(-c * normal @ moving - k * depth, 0.0)
                    spring += 0.5 * -depth * (min(f, -k * depth) if firm else -k * depth)
                    if firm and f > 0.0:
                        drag = part * const.point_law.share_drag
                        shares = limited(shares, v, normal, f, drag)
                        moving = sum(w * v[m] for m, w in shares.items())
                    f = f * normal
                    work -= 0.5 * const.dt * f @ moving
                    for k, w in shares.items():
                        force[k] += w * f
    return force, work, spring


CUTS = {
    "whole": [],
    "a warp yarn": [(0, 12, 12)],
    "both at a crossover": [(0, 12, 12), (1, 12, 11)],
    "a node on no yarn": [(0, 11, 11), (0, 10, 11), (1, 11, 10), (1, 11, 11)],
}


def force_of_both(panel, state, const):
    """(ni+1, nj+1, 3) [N] contact forces of the kernel, after a check that it and its plain twin agree."""
    expected, work, spring = plain_contact(panel, state, const)
    force, taken, held = pressed(panel, state, const)
    assert_allclose(force, expected, atol=1e-12 * abs(expected).max())
    assert_allclose(
        state.f_contact_nose, -force.sum((0, 1)), rtol=1e-12, atol=1e-12 * abs(force).sum()
    )
    assert (taken, held) == pytest.approx((work, spring), rel=1e-12)
    return force


# each cut has one nose, each nose several cuts: the distance of a point knows of no cut
PRESSED = [
    ("whole", "flat"),
    ("whole", "hemisphere"),
    ("a warp yarn", "flat"),
    ("both at a crossover", "hemisphere"),
    ("a node on no yarn", "flat"),
]


@pytest.mark.parametrize("cuts, shape", PRESSED)
@pytest.mark.parametrize("firm", [False, True])
def test_kernel_is_its_plain_twin(cuts, shape, firm):
    panel = make_panel(symmetry="whole", projectile=Projectile(shape=shape))
    state, const = shaken(panel, firm)
    for family, i, j in CUTS[cuts]:
        state.intact_fraction[family][i * const.row_stride + j] = 0.0
        for a, b in ((i, j), (i, j - 1) if family == 0 else (i - 1, j)):
            state.element_flag[a * const.row_stride + b] |= 1 + family
    assert abs(force_of_both(panel, state, const)).max() > 0


@pytest.mark.parametrize("firm", [False, True])
def test_at_the_edges_of_a_panel_the_kernel_is_its_plain_twin(firm):
    """Its ghosts go straight on, and hand their forces back: the nose is over a corner of a small panel. Shares are
    plain: limited ones are the ghosts' own, which the twin does not have."""
    panel = make_panel(12e-3, symmetry="whole", projectile=Projectile(shape="hemisphere"))
    state, const = shaken(panel, firm)
    const = const._replace(point_law=const.point_law._replace(share_drag=0.0))
    state.projectile_position[:2] = const.x0 + const.dx, const.y0 + const.dy
    assert abs(force_of_both(panel, state, const)[0, 0]).max() > 0


@pytest.mark.parametrize("lean", [0.0, 0.6])
def test_an_element_that_is_apart_touches_nothing(lean):
    """Points of elements that the boxes of their nodes leave out are ahead of the nose or beside it."""
    shot = Projectile(obliquity=lean, yaw=-0.5 * lean)
    panel = make_panel(symmetry="whole", projectile=shot)
    rng = np.random.default_rng(2)
    const = panel.constants()
    work = panel.work().contact_scratch
    found = 0
    for _ in range(20):
        state = panel.state(100.0)
        set_nodal(state.u, const.dx * rng.normal(size=rest(panel).shape))
        state.projectile_position[2] += rng.uniform(-1.0, 1.0) * const.dx
        place_near_nose(state, const)
        contact_kernels.see_nose(state, const, work)
        i0, i1, j0, _ = state.contact_window
        for i in range(i0, i1):
            apart = contact_kernels.beside_nose8(state, const, i, j0, work)
            for lane in np.flatnonzero([apart >> lane & 1 for lane in range(8)]):
                found += 1
                for a, b in np.array([i, j0 + lane]) + rng.uniform(0, 1, (20, 2)):
                    shape = foot_at(grid_of(const), False, a, b)
                    p = const.frame @ (
                        vector_of(state.surface.x, shape) - state.projectile_position
                    )
                    assert p[2] > 0 or np.hypot(p[0], p[1]) > const.projectile_radius
    assert found > 100


@pytest.mark.parametrize("p", [2, 3, 4, 8, 16])
def test_an_element_without_failures_has_the_surface_of_whole_fabric(p):
    """With an odd number of points too, of which some are midway between two nodes."""
    const = make_panel(symmetry="whole", numerics=Numerics(contact_points=p)).constants()
    for a in range(p):
        for b in range(p):
            torn = dense(torn_kernels.torn_foot(const, torn_kernels.WHOLE, (12, 11), (a, b)))
            whole = foot_at(grid_of(const), False, 12 + (a + 0.5) / p, 11 + (b + 0.5) / p)
            assert_allclose(torn, dense(whole), atol=1e-15)


def dense(foot):
    """(5, 5) weights of the nodes (11, 10) ... (15, 14) in a foot."""
    i, j, _, along, across = foot
    found = np.zeros((5, 5))
    found[i - 11 : i - 8, j - 10 : j - 7] = np.outer(along, across)
    return found


@pytest.mark.parametrize("family", [0, 1])
def test_the_surface_of_torn_fabric_is_symmetric(family):
    """With an odd number of points too, of which some are midway between two corners: a yarn that ends before one
    corner of an element gives the mirror image of one that ends before the next, and all weights sum to one."""
    panel = make_panel(symmetry="whole", elements_per_crossover=3)
    const = panel.constants()
    found = []
    p = const.points_per_side
    assert p % 2 == 1
    for side in (0, 1):
        state = panel.state(100.0)
        place = [12, 12]
        place[family] -= 1
        place[1 - family] += side
        state.intact_fraction[family][place[0] * const.row_stride + place[1]] = 0.0
        bent = torn_kernels.bent_beside_failures(state, const, 12, 12)
        feet = [
            [torn_kernels.torn_foot(const, bent, (12, 12), (a, b)) for b in range(p)]
            for a in range(p)
        ]
        shares = np.array([[dense(foot)[:4, 1:] for foot in row] for row in feet])
        found.append(shares)
        assert_allclose(shares.sum(axis=(2, 3)), 1.0, rtol=1e-14)
    one, other = found
    # the next corner: points and nodes of the other family in reverse
    image = np.flip(other, axis=(1 - family, 3 - family))
    assert abs(one - other).max() > 0.01
    assert_allclose(one, image, atol=1e-15)
