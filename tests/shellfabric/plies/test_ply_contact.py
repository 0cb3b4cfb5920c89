"""Contact of plies: the spline, forces against a slow plain twin, momentum, torn fabric, and that it has no memory."""

import math
from dataclasses import replace
from itertools import pairwise
from math import radians

import numpy as np
import pytest
from conftest_tools import Pressed, advance, far_from_nose, grid, momenta
from numpy.testing import assert_allclose
from scipy.integrate import trapezoid
from scipy.optimize import least_squares

from fabrics import catalogue
from fabrics.ply_law import PlyLaw
from shellfabric.impact.setup import ImpactSetup
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.slots import by_node
from shellfabric.plies import frame_kernels
from shellfabric.plies.model import Pack, PlyContact, at_angle
from shellfabric.projectile.projectile import Projectile
from shellfabric.surface import surface_kernels as surface

# soft, stiffer, then solid fibre; the second sample is on a line of the kernels' table
LAW = PlyLaw([0.0, 20e-6, 40e-6], [0.0, 1e6, 19e6], 1.4e13)
FOLLOWED = LAW.capped(PlyContact().stiffness)


def with_ghosts(x, const):
    """Control points (ni + 3, nj + 3, 3) of a ply: its nodes, images and continuations."""
    x = np.pad(x, ((1, 1), (1, 1), (0, 0)))
    for axis, mirrored in enumerate((const.mirror_x, const.mirror_y)):
        rows = np.moveaxis(x, axis, 0)
        image = rows[2] * np.where(np.arange(3) == axis, -1, 1)
        rows[0], rows[-1] = image if mirrored else 2 * rows[1] - rows[2], 2 * rows[-2] - rows[-3]
    return x


def without_ghosts(f, const):
    """Forces on control points, handed to the nodes that they hang on."""
    f = f.copy()
    for axis, mirrored in enumerate((const.mirror_x, const.mirror_y)):
        rows = np.moveaxis(f, axis, 0)
        if mirrored:
            rows[2] += rows[0] * np.where(np.arange(3) == axis, -1, 1)
        else:
            rows[1] += 2 * rows[0]
            rows[2] -= rows[0]
        rows[-2] += 2 * rows[-1]
        rows[-3] -= rows[-1]
    f = f[1:-1, 1:-1]
    for axis, mirrored in enumerate((const.mirror_x, const.mirror_y)):
        if mirrored:
            np.moveaxis(f, axis, 0)[0][..., axis] = 0.0
    return f


def bump(t):
    """The quadratic B-spline of the textbook, which is zero from 1.5 on."""
    t = abs(t)
    if t < 0.5:
        return 0.75 - t**2
    return 0.5 * max(1.5 - t, 0.0) ** 2


def near(at, n):
    """The three control points of n, which begin at -1, whose bumps reach a place; and the bumps there."""
    first = min(max(math.floor(at + 0.5), 0), n - 3)
    return slice(first, first + 3), np.array([bump(at - first + 1 - k) for k in range(3)])


def surface_at(x, a, b):
    """(3,) of the biquadratic B-spline of control points x that begin at -1."""
    (rows, wa), (columns, wb) = near(a, x.shape[0]), near(b, x.shape[1])
    return wb @ (wa @ x[rows, columns].reshape(3, 9)).reshape(3, 3)


def spline(x, a, b):
    """The place, and the weights of all control points."""
    weights = np.zeros((*x.shape[:2], 1))
    (rows, wa), (columns, wb) = near(a, x.shape[0]), near(b, x.shape[1])
    weights[rows, columns, 0] = np.outer(wa, wb)
    return surface_at(x, a, b), weights


def limited(weights, along, of_push, drag):
    """Shares of nodes that run `along` a push [m/s], of which those faster than `of_push` get less."""
    shares = weights[..., 0] * np.maximum(1 - drag * np.maximum(along - of_push, 0), 1e-6)
    return shares[..., None] / shares.sum()


def tilt(speeds, a, b):
    """By how much a surface as tilted as the speeds of its nodes has nodes ahead of a place: 1.5 times the smaller of
    the slopes between three rows, and of those between three columns; none where they differ in sign, less of rows of
    little weight."""
    (rows, wa), (columns, wb) = near(a, speeds.shape[0]), near(b, speeds.shape[1])
    block = speeds[rows, columns]
    total = 0.0
    for w, means in ((wa, block @ wb), (wb, wa @ block)):
        low, high = np.diff(means)
        if low * high > 0:
            total += min(abs(low), abs(high)) * min(min(w[0], w[2]) / 1e-3, 1.0)
    return 1.5 * total


def plain(pressed):
    """Forces on the first two plies (of one frame) and the spring energy, point by point: the closest point by
    minimising the distance, and limited shares."""
    pack = pressed.pack
    contact = pressed.contact
    (law,), density, n, grids, speeds = (
        pack.contact_laws,
        pack.plies[0].weave.areal_density,
        pack.contact.points,
        [],
        [],
    )
    for ply, z, state, const in zip(pack.plies, pack.places, pressed.states, pressed.consts):
        X, Y = ply.coordinates()
        u, v = (
            np.stack([grid(const, part) for part in vector], axis=-1)
            for vector in (state.u, state.v)
        )
        grids.append(with_ghosts(np.stack([X, Y, np.full_like(X, z)], axis=-1) + u, const))
        speeds.append(with_ghosts(v, const))
    (x, y), forces, energy = grids, [np.zeros_like(part) for part in grids], 0.0
    fc = pressed.consts[0]
    areas = (
        contact.pressure.area_ratio[: fc.ni * fc.nj].reshape(fc.ni, fc.nj) * fc.dx * fc.dy / n**2
    )
    for i in range(fc.ni * n):
        for j in range(fc.nj * n):
            a = (i + 0.5) / n
            b = (j + 0.5) / n
            at, weights = spline(x, a, b)
            lines = [
                (mine, other) for mine, other in zip(pack.plies[0].lines(), pack.plies[1].lines())
            ]
            guess = [
                np.interp(
                    np.interp(place, np.arange(mine.size), mine), other, np.arange(other.size)
                )
                for place, (mine, other) in zip((a, b), lines)
            ]

            def off(p, at=at):
                return 1e3 * (at - surface_at(y, *p))

            foot = least_squares(off, guess, method="lm", xtol=1e-12, ftol=1e-14).x
            offset = 1e-3 * off(foot)
            distance = np.linalg.norm(offset)
            closure = pressed.thickness - distance
            if closure <= 0:
                continue
            normal = -offset / distance
            opposite = spline(y, *foot)[1]
            front, rear = (v @ normal for v in speeds)
            front_mean = (weights[..., 0] * front).sum()
            rear_mean = (opposite[..., 0] * rear).sum()
            slope = (law.pressure_at(closure + 1e-12) - law.pressure_at(closure)) / 1e-12
            damping = pack.contact.damping * np.sqrt(slope * density)
            pressure = law.pressure_at(closure) + damping * (front_mean - rear_mean)
            back = pack.contact.resilience * law.energy_at(closure)
            energy += areas[i // n, j // n] * back
            if pressure <= 0:
                continue
            f = areas[i // n, j // n] * pressure * normal
            drag = 1.35 / (pack.contact.courant * pack.contact.damping) * damping / pressure
            both = min(tilt(front, a, b), tilt(rear, *foot))
            slower = min(front_mean, rear_mean) - both
            faster = max(front_mean, rear_mean) + both
            forces[0] -= limited(weights, -front, -slower, drag) * f
            forces[1] += limited(opposite, rear, faster, drag) * f
    return *(without_ghosts(f, const) for f, const in zip(forces, pressed.consts)), energy


def assert_as_plain(pressed):
    """Forces and energies as of `plain`, with what is at least to be there; the forces."""
    found, (on_front, on_rear, energy) = pressed.press(3), plain(pressed)
    size = abs(on_front).max()
    assert size > 0
    assert pressed.contact.pressure.max_closure[0] > 0.1 * pressed.thickness
    for mine, expected in zip(found, (on_front, on_rear)):
        assert_allclose(mine, expected, atol=1e-4 * size)
    assert pressed.spring() == pytest.approx(energy, rel=1e-5)
    return on_front, on_rear


@pytest.mark.parametrize("mirrored", [True, False])
def test_spline_is_smooth_and_goes_through_flat_cloth(mirrored):
    low = -0.5 if mirrored else 0.0
    for n in (3, 9):
        for a in np.linspace(low, n, 401):
            first, values, slopes, second = surface.spline_weights.py_func(a, n)
            assert -1 <= first <= n - 1
            assert sum(values) == pytest.approx(1, abs=1e-14)
            assert sum(slopes) == pytest.approx(sum(second), abs=1e-14)
            assert np.dot(values, first + np.arange(3)) == pytest.approx(a, abs=1e-13)
    for edge in (0.5, 1.5, 2.5):
        weights = np.zeros((2, 6, 2))
        for side, a in enumerate((edge - 1e-9, edge + 1e-9)):
            first, values, slopes, _ = surface.spline_weights.py_func(a, 9)
            weights[side, first + 1 : first + 4] = np.stack([values, slopes], axis=1)
        assert_allclose(weights[0], weights[1], atol=1e-8)


# each symmetry and each stacking once
@pytest.mark.parametrize("stacking, symmetry", [("alternating", "quarter"), ("aligned", "whole")])
def test_forces_against_a_plain_twin(ply, stacking, symmetry):
    side = {"quarter": 0.014, "whole": 0.012}[symmetry]
    panel = replace(ply, symmetry=symmetry, opening=(side, side))
    pack = Pack.stacked(panel, 2, stacking=stacking, gap=0.1e-3, law=LAW)
    assert_as_plain(Pressed(pack).bulge(np.random.default_rng(1), 0.25e-3, 3e-3))


@pytest.mark.parametrize(
    "opening, grading, width",
    [
        ((0.013, 0.012), None, 4e-3),  # 11 elements and a part of eight in a row
        ((0.036, 0.035), None, 7e-3),
        ((0.036, 0.035), ((8, 1), (np.inf, 2)), 7e-3),
    ],
)
@pytest.mark.parametrize("stacking", ["aligned", "alternating"])
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_eight_at_once_are_one_at_a_time(ply, stacking, opening, grading, width, friction):
    """Springs and forces, while plies that bulge into each other slide, come nearer and part."""
    panel = replace(ply, symmetry="whole", opening=opening, grading=grading)
    pack = Pack.stacked(panel, 2, stacking=stacking, gap=0.1e-3, law=LAW, friction=friction)
    pressed = Pressed(pack).bulge(np.random.default_rng(4), 0.2e-3, width)
    pressed.press(3)
    alone = pressed.copy().alone()
    seen = []
    for lift in (0.0, 1e-5, 2e-5, -1e-5, -6e-5, 3e-5, 9e-5, -2e-4, 1e-4, 2e-5):
        for one in (pressed, alone):
            grid(one.consts[0], one.states[0].u[2])[:] += lift
            grid(one.consts[0], one.states[0].u[0])[:] += 2e-5
        # those of points that are clear are followed less closely by eight
        for name in (
            "closest_a",
            "closest_b",
        ):
            getattr(alone.contact.pressure, name)[:] = getattr(pressed.contact.pressure, name)
        both = pressed.press(), alone.press()
        size = abs(both[0][0]).max()
        for eight, one in zip(*both):
            assert_allclose(eight, one, atol=1e-9 * max(size, 1e-9))
        for energy in ("spring_energy", "max_closure", "friction_work", "lost_energy"):
            mine, other = (getattr(run.contact.pressure, energy) for run in (pressed, alone))
            assert_allclose(mine, other, rtol=1e-8)
        seen.append((both[0][0] != 0).sum())
    assert min(seen) < 0.7 * max(seen)


@pytest.mark.parametrize("share", [0.4, 0.75])
@pytest.mark.parametrize("alone", [True, False])
def test_plies_give_back_a_share_of_what_closed_them(ply, share, alone):
    """Flat plies that are closed, parted by some, closed deeper, parted until they leave, and closed anew: pressure
    along the branches, and of the energy of closing, which the law bends, the share that comes back."""
    panel = replace(ply, symmetry="whole", opening=(0.012, 0.011))
    numbers = PlyContact(damping=0.0, resilience=share)
    pack = Pack.stacked(panel, 2, gap=30e-6, law=LAW, contact=numbers)
    pressed = Pressed(pack)
    if alone:
        pressed = pressed.alone()
    const = pressed.consts[0]
    area = np.prod(panel.opening)
    front = pressed.states[0]
    turns = np.array([0.0, 66e-6, 60e-6, 74e-6, 20e-6, 58e-6])  # [m] of the front ply
    places = np.concatenate([np.linspace(*ends, 60)[1:] for ends in pairwise(turns)])
    forces = []
    before = 0.0
    for place in places:
        grid(const, front.u[2])[:] = place
        grid(const, front.v[2])[:] = (place - before) / const.dt
        before = place
        on_front, _ = pressed.press()
        forces.append(-on_front[..., 2].sum() / area)
        assert pressed.spring() <= area * FOLLOWED.energy_at(44e-6)
    deepest = 0.0
    expected = []
    for closure in np.maximum(places - 30e-6, 0.0):
        deepest = max(deepest, closure) if closure > 0 else 0.0
        expected.append(FOLLOWED.pressure_at(deepest - (deepest - closure) / share))
    assert_allclose(forces, expected, rtol=1e-6, atol=1e-6 * max(expected))
    falls = slice(59 * 3 - 1, 59 * 4)
    back = -trapezoid(forces[falls], places[falls])
    assert back == pytest.approx(share * FOLLOWED.energy_at(44e-6), rel=0.02)


@pytest.mark.parametrize("share", [0.3, 0.8])
def test_free_plies_part_with_the_root_of_the_share(ply, share):
    """Without dampers, of plies that are not alike in weight: momentum is kept, and the energy that does not come back
    is in the books as that of the contact."""
    free = replace(ply, boundary="free", symmetry="whole", opening=(0.011, 0.012))
    numbers = PlyContact(damping=0.0, courant=0.1, resilience=share)
    solver = far_from_nose(Pack((free, free), (20e-6,), numbers))
    speeds = 120.0, -35.0
    for state, speed, factor in zip(solver.states, speeds, (1.0, 1.7)):
        state.mass[:] *= factor
        state.dt_over_mass[:] /= factor
        state.v[2][:] = np.where(state.mass > 0, speed, 0.0)
    masses = np.array([state.mass.sum() for state in solver.states])
    solver.samples.clear()
    solver.energy_at_start = None  # the plies have been set in motion
    solver._sample()
    advance(solver, round(0.6e-6 / solver.const.dt))
    solver._sample()
    moved = momenta(solver)[:, 2]
    assert moved.sum() == pytest.approx(masses @ speeds, rel=1e-12)
    after = moved / masses
    assert after[1] - after[0] == pytest.approx(share**0.5 * (120.0 + 35.0), rel=0.01)
    relative = 0.5 * masses.prod() / masses.sum() * 155.0**2
    assert solver.sample("ply_contact")[-1] == pytest.approx((1 - share) * relative, rel=0.02)
    assert abs(solver.sample("error")).max() < 1e-6 * relative


@pytest.mark.parametrize("points", [1, 2])
@pytest.mark.parametrize("alone", [True, False])
def test_plies_that_slide_on_each_other_make_no_energy(ply, points, alone):
    """A bulging ply that is drawn over another: what its springs hold is what it was pushed by, if they give all of it
    back. With a direction that is a step behind, forces would lean the way of the sliding and do a work that nothing
    gives."""
    numbers = PlyContact(points=points, damping=0.0, resilience=1.0)
    pack = Pack.stacked(replace(ply, symmetry="whole"), 2, gap=50e-6, contact=numbers)
    pressed = Pressed(pack).bulge(np.random.default_rng(2), 0.1e-3)
    pressed = pressed.alone() if alone else pressed
    for state in pressed.states:
        for v in state.v:
            v[:] = 0.0
    front = pressed.states[0]
    const = pressed.consts[0]
    speed = 150.0
    pressed.press(3)
    grid(const, front.v[0])[:] = speed
    pressed.press()
    pressed.contact.pressure.work[:], held = 0.0, pressed.spring()
    off = 0.0
    largest = 0.0
    most = 0.0
    for _ in range(round(0.25e-3 / (const.dt * speed))):  # a third of an element
        grid(const, front.u[0])[:] += const.dt * speed
        pressed.press()
        now = pressed.spring()
        off = max(off, abs(now - held - pressed.contact.pressure.work.sum()))
        largest = max(largest, now)
        most = max(most, abs(now - held))
    assert pressed.contact.pressure.max_closure[0] < 0.8 * pressed.thickness
    assert most > 0.2 * largest
    assert off < 5e-4 * largest


@pytest.mark.parametrize("angle", [0.0, 0.4])
def test_the_contact_remembers_nothing(ply, angle):
    """The same plies, come to the same places by motion, press on each other alike, whatever has been before; also from
    a search that begins an element aside. Of smooth plies that give all back: others remember how deep they were, and
    their elastic slip."""
    panel = replace(ply, symmetry="whole", opening=(0.03, 0.03), round=True, trellis=True)
    elastic = PlyContact(resilience=1.0)
    pack = Pack((panel, at_angle(panel, angle)), (0.05e-3,), elastic)
    pressed = Pressed(pack).bulge(np.random.default_rng(5), 0.2e-3)
    forces = pressed.press(4)
    for aside in (0.3, -0.8):
        pressed.contact.pressure.closest_a[:] += aside
        pressed.contact.pressure.closest_b[:] -= aside
        for mine, expected in zip(pressed.press(2), forces):
            assert_allclose(mine, expected, atol=1e-3 * abs(expected).max())


MOTIONS = {"undamped": (0.0, 1e-8), "turning": (0.7, 1e-8), "shaken": (0.7, 1e-6)}


@pytest.mark.parametrize("motion", MOTIONS)
def test_forces_and_their_moments_vanish(ply, motion):
    """Along the line between both points: also about the third axis, and of torn fabric. Damped contact has limited
    shares, which move a push among the nodes of its point: not on plies that turn as one, and on nodes that are shaken
    at random by less than a thousandth of an element (1 mm) in the mean."""
    damping, within = MOTIONS[motion]
    panel = replace(ply, symmetry="whole", opening=(0.02, 0.02))
    pack = Pack((panel, panel), (0.05e-3,), PlyContact(damping=damping))
    pressed = Pressed(pack).bulge(np.random.default_rng(6), 0.2e-3)
    if motion == "turning":
        X, Y = panel.coordinates()
        for const, state in zip(pressed.consts, pressed.states):
            for aside in state.v[:2]:
                aside[:] = 0.0
            grid(const, state.v[2])[:] = 90.0 + 4e3 * X - 7e3 * Y
    else:
        tear(pressed, 0, slice(4, 7))
    forces = pressed.press(3)
    sums = 0.0
    moments = 0.0
    for p, f in enumerate(forces):
        g = pressed.contact.base[p] + np.add.outer(
            np.arange(f.shape[0]) * pressed.contact.row_stride[p], np.arange(f.shape[1])
        )
        x = np.moveaxis(pressed.contact.x[:, g], 0, -1)
        sums = sums + f.sum(axis=(0, 1))
        moments = moments + np.cross(x, f).sum(axis=(0, 1))
    size = abs(forces[0]).sum()
    assert_allclose(sums, 0.0, atol=1e-13 * size)
    assert_allclose(moments, 0.0, atol=within * size)


class Flat(Pressed):
    """Flat plies at rest without gaps, of which the front one is moved."""

    def __init__(self, ply, plies=2, friction=0.0, law=None, **numbers):
        contact = PlyContact(**{"damping": 0.0} | numbers)
        super().__init__(
            Pack.stacked(ply, plies, gap=0.0, contact=contact, friction=friction, law=law)
        )

    def place(self, height):
        """[N] along z on the front ply, at a height [thicknesses] above its place at rest."""
        grid(self.consts[0], self.states[0].u[2])[:] = height * self.thickness
        return self.press(2)[0][..., 2].sum()


@pytest.mark.parametrize("grading", [None, ((np.inf, 0.5),), ((6, 0.5), (np.inf, 1))])
@pytest.mark.parametrize("alone", [True, False])
def test_pressure_is_the_same_on_every_mesh(ply, grading, alone):
    """At a prescribed closure, in the travel of the law and beyond it, whatever the elements and the time step."""
    two = Flat(replace(ply, grading=grading), law=LAW)
    two = two.alone() if alone else two
    area = np.prod([np.ptp(x) for x in two.pack.plies[0].lines()])
    for closure in (5e-6, 15e-6, 30e-6, 43e-6):
        assert -two.place(closure / two.thickness) / area == pytest.approx(
            float(FOLLOWED.pressure_at(closure)), rel=1e-6
        )
        back = PlyContact().resilience * float(FOLLOWED.energy_at(closure))
        assert two.spring() / area == pytest.approx(back, rel=1e-6)


def test_a_distance_has_no_sign(ply):
    """A ply is pushed away from the next, on whichever side it is."""
    two = Flat(ply)
    before = two.place(0.3)
    behind = two.place(1.7)
    assert before < 0
    assert behind == pytest.approx(-before, rel=1e-9)


def tear(pressed, p, rows, flag=1):
    """Cut one warp yarn of a ply in the rows of elements `rows`; or, of the flag 7, have a square of them eroded."""
    state = pressed.states[p]
    const = pressed.consts[p]
    columns = rows if flag == 7 else rows.start
    grid(const, state.element_flag)[rows, columns] = flag
    grid(const, state.intact_fraction[0])[rows, columns] = 0.0
    state.failures += 1


@pytest.mark.parametrize("torn", [0, 1])
def test_torn_fabric_presses_as_whole_does(ply, torn):
    """Flat plies, of which some elements are facets: the same law. What has eroded presses on nothing; points before a
    hole that is wider than the thickness do not find fabric."""
    two = Flat(ply)
    whole = two.place(0.2)
    elements = two.consts[0].ni * two.consts[0].nj
    tear(two, torn, slice(1, 3))
    assert two.place(0.2) == pytest.approx(whole, rel=1e-9)
    tear(two, torn, slice(4, 8), flag=7)
    left = two.place(0.2) / whole
    assert left == pytest.approx(
        1 - 16 / elements, abs=0.05 * 16 / elements if torn == 0 else 8 / elements
    )


def contract(pressed, factor):
    """Draw the first ply together in its plane."""
    for u, X in zip(pressed.states[0].u, pressed.pack.plies[0].coordinates()):
        grid(pressed.consts[0], u)[:] = (factor - 1) * X


@pytest.mark.parametrize("alone", [True, False])
def test_a_torn_ply_that_contracts_presses_with_its_area_at_rest(ply, alone):
    two = Flat(ply).alone() if alone else Flat(ply)
    whole = two.place(0.2)
    two.states[0].failures += 1
    for factor in (0.8, 0.5, 0.1):
        contract(two, factor)
        assert two.place(0.2) == pytest.approx(whole, rel=1e-6)


@pytest.mark.parametrize("torn", [True, False])
@pytest.mark.parametrize("alone", [True, False])
def test_plies_that_are_at_a_depth_without_motion_do_not_press(ply, alone, torn):
    """What a search finds at once gives no energy: beside tears, and in folds of whole plies."""
    two = Flat(ply).alone() if alone else Flat(ply)
    two.states[0].failures += torn
    grid(two.consts[0], two.states[0].u[2])[:] = 0.2 * two.thickness
    two.press()
    assert two.force(0, frame_kernels.BEHIND)[..., 2].sum() == 0.0


@pytest.mark.parametrize("hole", [True, False])
def test_plies_meet_through_a_hole(ply, hole):
    """The first of three plies on the third: by the law where the second has a hole, else not at all."""
    three = Flat(ply, 3)
    if hole:
        tear(three, 1, slice(3, 9), flag=7)
    grid(three.consts[0], three.states[0].u[2])[:] = 1.2 * three.thickness
    three.press(2)
    met = three.force(2, frame_kernels.BEFORE)[..., 2].sum()
    if not hole:
        assert met == 0.0
    else:
        area = 36 * three.consts[0].dx * three.consts[0].dy
        assert met == pytest.approx(
            area * float(three.pack.contact_laws[0].pressure_at(0.2 * three.thickness)), rel=0.25
        )


def test_a_pack_that_tears_stays_mirror_symmetric():
    """Of the half of a panel, whose two quarters are alike; from the first hole on 5e-8 m in place of 2e-13."""
    chisel = Projectile(
        mass=1.1e-3, radius=2.73e-3, shape="chisel", flat_width=2.57e-3, flat_angle=radians(35), edge_radius=0.3e-3
    )  # fmt: skip
    setup = ImpactSetup(
        catalogue.load("S-728"),
        350.0,
        projectile=chisel,
        opening=0.08,
        plies=8,
        symmetry="half",
        length_effect=False,
    )
    solver = PackSolver(setup.target(setup.table(kept=True)), 350.0, 14e-6).run()
    assert solver.held_apart > 0
    assert sum(int(state.failures) for state in solver.states) > 40
    for _, const, state in solver.plies:
        for part, sign in zip(state.u, (1, -1, 1)):
            u = by_node(part, const)
            assert np.abs(u - sign * u[:, ::-1]).max() < 1e-9
