"""Contact of two plies: the spline, forces against a slow plain twin, momentum, and what torn cloth may do."""

from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

from fabrics.ply_law import PlyLaw
from shellfabric.panel.motion_kernels import FAILURES
from shellfabric.plies import contact_kernels as kernels
from shellfabric.plies import contact_simd_kernels as lanes
from shellfabric.plies import surface_kernels as surface
from shellfabric.plies.model import Pack, PlyContact

# soft, stiffer, then solid fibre; the second sample is on a line of the kernels' table
LAW = PlyLaw([0.0, 20e-6, 40e-6], [0.0, 1e6, 19e6], 1.4e13)


def lines(const):
    """((ni + 1,), (nj + 1,)) [m] places of the lines of a ply's grid at rest."""
    x, y = const.x0 + const.dx * np.arange(const.ni + 1), const.y0 + const.dy * np.arange(const.row_stride)
    if np.ndim(const.line_offset1):
        x, y = x + const.line_offset1[: x.size], y + const.line_offset2[: y.size]
    return x, y


def controls(state, const, component):
    """Control points (ni + 3, nj + 3) of a ply: its nodes, images and continuations."""
    x, y = lines(const)
    rest = np.stack([*np.meshgrid(x, y, indexing="ij"), np.zeros((x.size, y.size))])[component]
    x = np.pad(rest + state.u[component][: rest.size].reshape(rest.shape), 1)
    for axis, mirrored in enumerate((const.mirror_x, const.mirror_y)):
        rows = np.moveaxis(x, axis, 0)
        rows[0] = (-rows[2] if axis == component else rows[2]) if mirrored else 2 * rows[1] - rows[2]
        rows[-1] = 2 * rows[-2] - rows[-3]
    return x


def spline(x, a, b):
    """The biquadratic B-spline of control points x that begin at -1, by the textbook's bumps."""

    def bump(t):
        t = np.abs(t)
        return np.where(t < 0.5, 0.75 - t**2, np.where(t < 1.5, 0.5 * (1.5 - t) ** 2, 0.0))

    wa, wb = (bump(at - np.arange(-1, n - 1)) for at, n in zip((a, b), x.shape))
    return wa @ x @ wb, wa, wb


def unpad(force, const, component):
    """Forces on control points, handed to the nodes that they hang on."""
    f = force.copy()
    for axis, mirrored in enumerate((const.mirror_x, const.mirror_y)):
        rows = np.moveaxis(f, axis, 0)
        if mirrored:
            rows[2] += (-1 if axis == component else 1) * rows[0]
        else:
            rows[1] += 2 * rows[0]
            rows[2] -= rows[0]
        rows[-2] += 2 * rows[-1]
        rows[-3] -= rows[-1]
    f = f[1:-1, 1:-1]
    for axis, mirrored in enumerate((const.mirror_x, const.mirror_y)):
        if mirrored and axis == component:
            np.moveaxis(f, axis, 0)[0] = 0.0
    return f


def plain(front, fc, rear, rc, pair, pack):
    """Forces (3, nodes) on front and rear, and the spring energy, point by point: the foot by minimising a distance."""
    (law,), zeta, density = pack.laws, pack.contact.damping, pack.plies[0].weave.areal_density
    X, Y = ([controls(state, c, m) for m in range(3)] for state, c in ((front, fc), (rear, rc)))
    at_origin = {"x0": 0, "dx": 0, "y0": 0, "dy": 0, "line_offset1": None, "line_offset2": None}
    VX, VY = ([controls(state._replace(u=state.v), c._replace(**at_origin), m) for m in range(3)]
              for state, c in ((front, fc), (rear, rc)))  # fmt: skip
    F, G, energy = [np.zeros_like(x) for x in X], [np.zeros_like(y) for y in Y], 0.0
    shift = np.array([0.0, 0.0, pair.rest_distance])
    n = pair.points_per_side
    for i in range(fc.ni * n):
        for j in range(fc.nj * n):
            a, b = (i + 0.5) / n, (j + 0.5) / n
            x = np.array([spline(c, a, b)[0] for c in X])
            at = lambda p: np.array([spline(c, *p)[0] for c in Y]) + shift  # noqa: E731
            guess = tuple(
                np.interp(np.interp(place, np.arange(mine.size), mine), other, np.arange(other.size))
                for place, mine, other in zip((a, b), lines(fc), lines(rc))
            )
            foot = minimize(lambda p: 1e6 * np.sum((x - at(p)) ** 2), guess, tol=1e-14, method="Nelder-Mead").x  # noqa: B023
            y, steps = at(foot), 1e-5 * np.eye(2)
            normal = np.cross(*(at(foot + step) - at(foot - step) for step in steps))
            normal /= np.linalg.norm(normal)
            depth = pair.thickness - normal @ (y - x)
            if depth <= 0:
                continue
            (_, wa, wb), (_, za, zb) = spline(X[0], a, b), spline(Y[0], *foot)
            v = np.array([wa @ c @ wb for c in VX]) - np.array([za @ c @ zb for c in VY])
            area = pair.area_factor1[i // n] * pair.area_factor2[j // n] if np.ndim(pair.area_factor1) else 1.0
            area *= fc.dx * fc.dy / n**2
            slope = (law.pressure_at(depth + 1e-12) - law.pressure_at(depth)) / 1e-12
            f = area * max(0.0, law.pressure_at(depth) + zeta * np.sqrt(slope * density) * normal @ v)
            energy += area * law.energy_at(depth)
            for m in range(3):
                F[m] -= f * normal[m] * np.outer(wa, wb)
                G[m] += f * normal[m] * np.outer(za, zb)
    return [unpad(f, fc, m) for m, f in enumerate(F)], [unpad(g, rc, m) for m, g in enumerate(G)], energy


def bulging(pack, rng, together, width=4e-3):
    """States of two plies that bulge into each other, with feet that have settled."""
    states, _ = pack.states(1.0)
    consts = pack.constants()
    pairs = pack.pairs(consts, states)
    for p, (state, const) in enumerate(zip(states, consts)):
        X, Y = np.meshgrid(*lines(const), indexing="ij")
        bulge = (3e-3 + (1 - p) * together) * np.exp(-(X**2 + 1.3 * Y**2) / width**2)
        for c, size in enumerate((-0.05 * X * bulge / 1e-3, -0.03 * Y * bulge / 1e-3, bulge)):
            state.u[c][: X.size] = size.ravel()
            state.v[c][: X.size] = rng.normal(0, 5, X.size)
        if const.mirror_x:
            state.u[0][: const.row_stride] = state.v[0][: const.row_stride] = 0.0
            state.u[1][0 :: const.row_stride][: const.ni + 1] = state.v[1][0 :: const.row_stride][: const.ni + 1] = 0.0
    return states, consts, pairs[0]


def settled(states, consts, pair, times=200):
    """The contact with its feet found: from flat cloth they take steps of a quarter of an element."""
    for step in range(times):
        pair.status[:], pair.recheck_step[:] = lanes.CLEAR, 0
        kernels.contact_forces(states[0], consts[0], states[1], consts[1], pair, pair, 8 * step)
    # as if motion had brought the plies here: springs that are loaded by all of the depth
    pair.depth_offset[:], pair.recheck_step[:] = 0, 0
    kernels.contact_forces(states[0], consts[0], states[1], consts[1], pair, pair, 8 * times)
    pair.recheck_step[:] = 0


def test_spline_is_smooth_and_goes_through_flat_cloth():
    for mirrored in (True, False):
        for n in (3, 9):
            places = np.linspace(0, n, 401)
            for a in places:
                i, *w, d0, d1, d2, _, _ = surface.spline_weights(a, n, mirrored)
                assert 0 <= i <= n - 2
                assert sum(w) == pytest.approx(1, abs=1e-14)
                assert d0 + d1 + d2 == pytest.approx(0, abs=1e-14)
                inside = a > 0.5 or not mirrored
                assert not inside or w @ (i + np.arange(3)) == pytest.approx(a, abs=1e-13)
    for edge in (0.5, 1.5, 2.5):
        values = np.zeros((2, 5, 2))
        for side, a in enumerate((edge - 1e-9, edge + 1e-9)):
            i, w0, w1, w2, d0, d1, d2, _, _ = surface.spline_weights(a, 9, False)
            values[side, i : i + 3] = np.array([[w0, d0], [w1, d1], [w2, d2]])
        np.testing.assert_allclose(values[0], values[1], atol=1e-8)


@pytest.mark.parametrize("stacking", ["aligned", "alternating"])
@pytest.mark.parametrize("symmetry", ["quarter", "whole"])
def test_forces_against_a_plain_twin(ply, stacking, symmetry):
    opening = (0.02, 0.02) if symmetry == "quarter" else (0.012, 0.012)
    panel = replace(ply, symmetry=symmetry, opening=opening)
    pack = Pack.stacked(panel, 2, stacking=stacking, gap=0.1e-3, law=LAW)
    states, consts, pair = bulging(pack, np.random.default_rng(1), 0.25e-3)
    settled(states, consts, pair)
    on_front, on_rear, energy = plain(states[0], consts[0], states[1], consts[1], pair, pack)
    size = max(np.abs(f).max() for f in on_front)
    assert size > 0
    assert pair.energy[kernels.MAX_DEPTH] > 0.1 * pair.thickness
    for found, expected in ((pair.f_front, on_front), (pair.f_rear, on_rear)):
        for one, other in zip(found, expected):
            np.testing.assert_allclose(one[: other.size].reshape(other.shape), other, atol=1e-5 * size)
            assert not one[other.size :].any()
    assert pair.energy[kernels.SPRING] == pytest.approx(energy, rel=1e-6)


def one_at_a_time(front, fc, rear, rc, pair):
    """What the contact does of its points, by `contact_point` alone: (energy in the springs, deepest)."""
    for force in (*pair.f_front, *pair.f_rear):
        force[:] = 0.0
    found = np.zeros((fc.ni * fc.nj * pair.points_per_side**2, 2))
    for q in range(len(found)):
        found[q] = kernels.contact_point(front, fc, rear, rc, pair, pair, q, False)
    return found[:, 0].sum(), found[:, 1].max()


@pytest.mark.parametrize(("opening", "grading", "width"), [
    ((0.013, 0.012), None, 4e-3),  # 11 elements and a part of eight in a row
    ((0.036, 0.035), None, 7e-3),  # among whose points are some whose depth changes by next to what makes a jump
    ((0.036, 0.035), ((8, 1), (np.inf, 2)), 7e-3),
])  # fmt: skip
@pytest.mark.parametrize("stacking", ["aligned", "alternating"])
def test_eight_at_once_are_one_at_a_time(ply, stacking, opening, grading, width):
    """Feet, sides, springs and forces, while plies that bulge into each other slide, come nearer and part."""
    panel = replace(ply, symmetry="whole", opening=opening, grading=grading)
    pack = Pack.stacked(panel, 2, stacking=stacking, gap=0.1e-3, law=LAW)
    states, consts, pair = bulging(pack, np.random.default_rng(4), 0.2e-3, width)
    settled(states, consts, pair, 60)
    (front, rear), (fc, rc) = states, consts
    twin, seen, n = deepcopy(pair), [], (fc.ni + 1) * fc.row_stride
    for step, lift in enumerate((0.0, 1e-5, 2e-5, -1e-5, -6e-5, 3e-5, 9e-5, -2e-4, 1e-4, 2e-5), 1):
        front.u[2][:n] += lift
        front.u[0][:n] += 2e-5
        pair.recheck_step[:] = 0
        kernels.contact_forces(front, fc, rear, rc, pair, pair, 8 * step)
        spring, deepest = one_at_a_time(front, fc, rear, rc, twin)
        assert pair.energy[kernels.SPRING] == pytest.approx(spring, rel=1e-9)
        twin.energy[kernels.MAX_DEPTH] = max(twin.energy[kernels.MAX_DEPTH], deepest)
        assert pair.energy[kernels.MAX_DEPTH] == pytest.approx(twin.energy[kernels.MAX_DEPTH], rel=1e-9)
        assert pair.energy[lanes.MAX_COMPRESSION] == pytest.approx(twin.energy[lanes.MAX_COMPRESSION], rel=1e-9)
        np.testing.assert_array_equal(pair.status, twin.status)
        touching = pair.status == lanes.IN_CONTACT
        size = max(np.abs(f).max() for f in twin.f_front)
        for name, scale in (("closest_point", 1.0), ("cp_rate", 1.0), ("f_front", size), ("f_rear", size)):
            for one, other in zip(getattr(pair, name), getattr(twin, name)):
                np.testing.assert_allclose(one, other, atol=1e-9 * scale, rtol=0, err_msg=name)
        for one, other in zip(
            (*pair.normal, pair.last_depth, pair.depth_offset), (*twin.normal, twin.last_depth, twin.depth_offset)
        ):
            np.testing.assert_allclose(one[touching], other[touching], rtol=1e-7, atol=1e-10)
        seen.append(touching.sum())
    assert min(seen) < 0.5 * max(seen)
    assert max(seen) > 16


@pytest.mark.parametrize("points", [1, 2])
def test_plies_that_slide_on_each_other_make_no_energy(ply, points):
    """A bulging ply that is drawn over another: what its springs hold is what it was pushed by. With a foot that is a
    step behind, forces would lean the way of the sliding and do a work that nothing gives."""
    knobs = PlyContact(points=points, damping=0.0)
    pack = Pack.stacked(replace(ply, symmetry="whole"), 2, gap=50e-6, contact=knobs)
    states, consts, pair = bulging(pack, np.random.default_rng(2), 0.2e-3)
    for state in states:
        for v in state.v:
            v[:] = 0.0
    settled(states, consts, pair)
    front, const, speed = states[0], consts[0], 150.0
    front.v[0][: (const.ni + 1) * const.row_stride] = speed
    contact = lambda step: kernels.contact_forces(states[0], consts[0], states[1], consts[1], pair, pair, step)  # noqa: E731
    contact(0)
    pair.energy[kernels.WORK], held = 0.0, pair.energy[kernels.SPRING]
    off, largest, most = 0.0, 0.0, 0.0
    for step in range(1, round(1.1e-3 / (const.dt * speed)) + 1):  # an element and a half
        front.u[0][: (const.ni + 1) * const.row_stride] += const.dt * speed
        contact(step)
        now = pair.energy[kernels.SPRING]
        off, largest = max(off, abs(now - held - pair.energy[kernels.WORK])), max(largest, now)
        most = max(most, abs(now - held))
    assert most > 0.2 * largest
    assert off < 2e-3 * largest


def test_what_no_yarn_holds_does_not_push(ply):
    """One family that is left pushes as both do, since the mass is the same; none does not, on either side."""
    pack = Pack.stacked(ply, 2, gap=0.0)
    states, consts, pair = bulging(pack, np.random.default_rng(3), 0.1e-3)
    settled(states, consts, pair)
    whole = sum(pair.f_rear[2])
    front = states[0]
    front.element_flag[: consts[0].ni * consts[0].row_stride] |= 1
    front.intact_fraction[0][:] = 0.0
    settled(states, consts, pair, 1)
    assert sum(pair.f_rear[2]) == pytest.approx(whole, rel=1e-9)
    front.intact_fraction[1][:] = 0.0
    kernels.contact_forces(states[0], consts[0], states[1], consts[1], pair, pair, 0)
    assert sum(pair.f_rear[2]) == 0.0
    assert not (pair.status == lanes.IN_CONTACT).any()


class Flat:
    """Flat plies at rest without gaps, of which the front one is moved, and the contact of the first two."""

    def __init__(self, ply, plies=2, friction=0.0, law=None, **knobs):
        contact = PlyContact(**{"damping": 0.0} | knobs)
        self.pack = Pack.stacked(ply, plies, gap=0.0, contact=contact, friction=friction, law=law)
        (self.states, self.stack), self.consts = self.pack.states(1.0), self.pack.constants()
        self.pairs, const = self.pack.pairs(self.consts, self.states), self.consts[0]
        for pair in self.pairs:
            pair.front_box[:] = 0, const.ni, 0, const.nj
        self.pair, self.thickness, self.steps = self.pairs[0], self.pairs[0].thickness, 0
        self.nodes, self.own = (const.ni + 1) * const.row_stride, slice(self.pair.near_torn.size)

    def press(self, back=None):
        """A step's forces between the first two, with points behind too; the sum of those on the front ply along z."""
        front, fc, rear, rc = self.states[0], self.consts[0], self.states[1], self.consts[1]
        kernels.contact_forces(front, fc, rear, rc, self.pair, back or self.pair, self.steps)
        if back:
            kernels.contact_forces_back(rear, rc, front, fc, back, self.pair, self.steps)
        self.steps += 1
        return sum(self.pair.f_front[2])

    def place(self, height, moved=True, back=None):
        """The force with the front ply at a height [thicknesses] above its place at rest, to which it has been moved in
        a step, or where it stands at once."""
        u, v, place = self.states[0].u[2][: self.nodes], self.states[0].v[2], height * self.thickness
        v[: self.nodes] = (place - u) / self.consts[0].dt if moved else 0.0
        u[:] = place
        return self.press(back)

    def energy(self, kind):
        return self.pair.energy[kind]


@pytest.fixture
def flat(ply):
    """The front ply in touch by a tenth of the thickness."""
    two = Flat(ply)
    two.place(0.1)
    assert (two.pair.status[two.own] == lanes.IN_CONTACT).all()
    return two


@pytest.mark.parametrize("grading", [None, ((np.inf, 0.5),), ((6, 0.5), (np.inf, 1))])
def test_pressure_is_the_same_on_every_mesh(ply, grading):
    """At a prescribed closure, in the travel of the law and beyond it, whatever the elements and the time step."""
    two = Flat(replace(ply, grading=grading), law=LAW)
    area = np.prod([np.ptp(x) for x in lines(two.consts[0])])
    for closure in (5e-6, 15e-6, 30e-6, 43e-6):
        assert -two.place(closure / two.thickness) / area == pytest.approx(float(LAW.pressure_at(closure)), rel=1e-6)
        assert two.energy(kernels.SPRING) / area == pytest.approx(float(LAW.energy_at(closure)), rel=1e-6)


def test_a_point_that_touches_does_not_wait(flat):
    """Not even one that was thought to be far away, next to one that was not."""
    force = flat.place(0.2)
    flat.pair.status[:] = lanes.CLEAR
    wait = flat.pair.recheck_step[: 4 * flat.own.stop].reshape(4 * flat.consts[0].ni, flat.consts[0].nj)
    wait[6:-4, 1:-1] = 1e6
    wait[:, ::8] = 0.0
    flat.states[0].u[2][:] = 0.0  # from where it comes
    assert flat.place(0.2) == pytest.approx(force, rel=1e-9)
    assert flat.place(0.2) == pytest.approx(force, rel=1e-9)
    assert wait.max() <= 3


def test_a_normal_that_turns_over_throws_nothing(flat):
    """Cloth that is drawn in until an element lies upside down: what touched it is on the same side as before. Told by
    the normal alone it would be nearly two thicknesses deep, on the wrong side of it."""
    before, const = flat.energy(kernels.SPRING), flat.consts[1]
    k, u = 4 * const.row_stride + 5, flat.states[1].u[0]
    u[[k, k + 1]] += 0.9 * const.dx
    u[[k + const.row_stride, k + const.row_stride + 1]] -= 0.9 * const.dx
    assert [flat.place(0.1) for _ in range(39)][-1] < 0.0
    assert flat.energy(kernels.MAX_DEPTH) < 0.3 * flat.thickness
    assert flat.energy(kernels.SPRING) < 1.5 * before


def test_a_point_keeps_its_side_where_the_surface_changes_its_form(flat):
    """A foot goes over from facets, beside torn cloth, to the spline, on whose other side its point lies. It was held
    from behind, and a ply came through."""
    side, rear = flat.pair.normal[2][flat.own].copy(), flat.states[1]
    for torn, height in ((1, 0.3), (0, 1.3)):
        rear.block_damage[:], rear.element_flag[:] = torn, torn
        flat.place(height, moved=bool(torn))
        np.testing.assert_allclose(flat.pair.normal[2][flat.own], side)
    assert (flat.pair.status[flat.own] == lanes.IN_CONTACT).all()


def test_what_is_found_deep_is_not_thrown_but_held(flat):
    """A point that is found inside the thickness, beside a hole, begins without a force; none is let deeper."""
    force = flat.place(0.1)
    flat.pair.status[:] = lanes.CLEAR
    assert flat.place(0.6, moved=False) == 0.0
    assert flat.energy(kernels.SPRING) == 0.0
    assert flat.place(0.7) == pytest.approx(force, rel=0.02)
    assert flat.place(0.5) == 0.0
    assert flat.place(0.6) < 0.0  # from where it has been let to


def test_a_foot_that_leaps_brings_no_energy(flat):
    """Where the foot of a point that touches leaps, as in folds, it is let go; it goes on with its spring as it was."""
    force, stored = flat.place(0.2), flat.energy(kernels.SPRING)
    assert force < 0.0
    n, feet = 4 * flat.own.stop, flat.pair.closest_point[0]
    feet[:n] += np.where(feet[:n] < flat.consts[1].ni / 2, 0.5, -0.5)
    assert flat.place(0.3) == 0.0
    assert (flat.pair.status[:n] == lanes.LOST).all()
    assert [flat.place(0.4) for _ in range(5)][-1] == pytest.approx(force, rel=0.05)
    assert (flat.pair.status[:n] == lanes.IN_CONTACT).all()
    assert flat.energy(kernels.SPRING) < 1.05 * stored


@pytest.mark.parametrize("begins", [True, False])
@pytest.mark.parametrize("depth", [0.3, 0.8])
def test_a_depth_that_no_motion_has_made_loads_no_spring(flat, begins, depth):
    """The foot on another fold, or the normal turned over: several tenths of the thickness in a step without motion."""
    stored = 0.0 if begins else flat.energy(kernels.SPRING)
    if begins:
        flat.pair.status[:] = lanes.CLEAR
    flat.place(depth, moved=False)
    assert flat.energy(kernels.MAX_DEPTH) == pytest.approx(depth * flat.thickness, rel=1e-6)
    assert flat.energy(kernels.SPRING) == pytest.approx(stored, rel=0.05, abs=1e-30)
    assert flat.energy(lanes.MAX_COMPRESSION) < 0.15 * flat.thickness  # that of the beginning
    assert 0 > flat.place(depth + 0.05) > flat.place(depth + 0.1)  # and is let no deeper


def test_what_comes_round_a_rim_is_on_no_side_yet(flat):
    """Cloth that comes round the rim of a free panel, edge on: found in the middle of the thickness, where no motion
    through the face has brought it. It was taken as touching."""
    for moved in (False, True):
        flat.place(-0.1)
        flat.pair.status[:], flat.pair.recheck_step[:] = lanes.CLEAR, 0
        flat.place(0.95, moved=moved)
        assert (flat.pair.status[flat.own] == (lanes.IN_CONTACT if moved else lanes.CLEAR)).all()


def test_a_side_that_another_fold_has_is_not_the_point_s_own(flat):
    """A point that is found in the middle of another fold is let go, and held from the side on which it leaves it."""
    flat.place(0.2)
    flat.place(0.95, moved=False)
    assert (flat.pair.status[flat.own] == lanes.CLEAR).all()
    for height in (1.05, 1.05):
        flat.place(height)
    flat.place(1.3)  # 0.7 deep, from behind
    assert flat.place(1.25) > 0.0


def test_whole_cloth_that_comes_through_is_pushed_back(flat):
    assert np.all(np.diff([flat.place(height) for height in np.arange(0.25, 1.5, 0.1)]) < 0)
    assert flat.energy(kernels.MAX_DEPTH) > 1.3 * flat.thickness


@pytest.mark.parametrize("closure", [0.02, 0.1, 0.3, 0.6, 0.9])
def test_beside_torn_cloth_both_plies_have_points(ply, closure):
    """The middle of an element behind pushes on what hangs before it, and each way has half of the law, whatever the
    closure: points that began to exist took one above a tenth of the thickness for another fold, and pushed nothing.
    Where the elements beside torn ones of one ply are not those of the other, the ply in front has the whole law."""
    two = Flat(ply)
    (near, back), front, stride = two.pairs, two.states[0], two.consts[0].row_stride

    def pushes(height):
        return -two.place(height, back=back), sum(back.f_front[2])

    whole, none = [pushes(closure * number / 16) for number in range(1, 17)][-1]
    assert whole > 0
    assert none == 0
    front.element_flag[0] |= 1
    front.block_damage[:] = 1
    front.intact_fraction[0][0] = 0.0
    front.counter[2] += 1
    forwards, backwards = pushes(closure)
    assert backwards > 0
    assert forwards + backwards == pytest.approx(whole, rel=1e-9)
    i, j = np.divmod(np.arange(two.nodes), stride)
    assert not back.f_front[2][: two.nodes][(i > 6) | (j > 6)].any()
    for pair, beside in ((near, 1), (back, 0)):
        pair.near_torn[:] = beside
        assert sum(pushes(closure)) == pytest.approx(whole, rel=1e-9)


def test_a_point_keeps_its_side_when_the_cloth_before_it_tears(ply):
    """On the outside of a bend facets lie before the spline: a yarn that fails there leaves the point behind them."""
    pack = Pack.stacked(replace(ply, symmetry="whole"), 2, gap=0.0, contact=PlyContact(points=1))
    consts, (states, stack) = pack.constants(), pack.states(1.0)
    pair, const, apart = pack.pairs(consts, states)[0], consts[0], pack.places[1]
    node = 6 * const.row_stride + 5
    corners = node + np.array([0, 1, const.row_stride, const.row_stride + 1])
    states[1].u[2][node] = -0.8 * apart
    for c, moved in enumerate((-0.5 * const.dx, -0.5 * const.dy, 0.25 * apart)):
        states[0].u[c][corners] = moved
    number, pushed = 6 * const.nj + 5, []
    pair.front_box[:] = pair.rear_box[:] = 0, const.ni, 0, const.nj
    for step in range(12):
        if step == 9:
            states[1].element_flag[node] = 1
            states[1].block_damage[:] = 1
            stack.ply_counters[1, FAILURES] = 1
        kernels.contact_forces(states[0], consts[0], states[1], consts[1], pair, pair, 8 * step + 1)
        pushed.append((pair.status[number], pair.last_depth[number] / pair.thickness, pair.f_front[2][corners].sum()))
    assert all(status == lanes.IN_CONTACT and push < 0 for status, _, push in pushed[3:])
    assert 0.5 < pushed[8][1] < lanes.MAX_SQUEEZE
    assert 1 < pushed[9][1] < 1.3
