"""What must hold of every force of the panel, whatever it is: it is a gradient, balanced, the same seen from any side.

A case has bodies, each an array (..., 3) of places, and gives the forces on them. A body that planes of symmetry cut is
a grid.
"""

from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from panels import COARSER, FINER, make_panel, plain_energies, rest, set_nodal, table
from scipy.spatial.transform import Rotation

from fabrics.materials import load
from fabrics.ply_law import PlyLaw
from shellfabric.backing import block_kernels
from shellfabric.backing.block import Backing
from shellfabric.cloth import boundary_kernels
from shellfabric.panel.boundary import Grip
from shellfabric.panel.model import SYMMETRIES, Numerics, Panel
from shellfabric.plies import contact_kernels as ply_contact_kernels
from shellfabric.plies.contact_simd_kernels import IN_CONTACT
from shellfabric.plies.model import Pack, PlyContact
from shellfabric.projectile import contact_kernels
from shellfabric.projectile.projectile import Projectile
from shellfabric.solver import ply_kernels

ANY, UPRIGHT = np.eye(3), np.eye(3)[2:]  # axes about which all bodies may be turned


class Case(NamedTuple):
    """Bodies in a random state, and the forces on them."""

    x: list  # [m] places of the bodies
    forces: Callable  # [N] of places and velocities
    energy: Callable | None = None  # [J] of places, at rest
    axes: np.ndarray = ANY
    mirrors: tuple = (False, False)
    step: float = 1e-9  # [m] of differences
    panel: Panel | None = None  # of cloth


def at_random(x, mirrors, size, seed):
    """Vectors like x, which keep to the planes of symmetry."""
    found = np.random.default_rng(seed).normal(scale=size, size=x.shape)
    for axis, mirrored in enumerate(mirrors):
        if mirrored and x.ndim > 1:
            on_plane = np.moveaxis(x, axis, 0)[0, ..., axis] == 0.0
            np.moveaxis(found, axis, 0)[0, ..., axis][on_plane] = 0.0
        elif mirrored:
            found[axis] = 0.0
    return found


def unfold(vectors, x, mirrors):
    """Vectors of a body at x with those of its images. Of what lies on a plane of symmetry there is no image."""
    for axis, mirrored in enumerate(mirrors):
        if mirrored and x.ndim > 1:
            image, shared = (
                np.where(np.arange(3) == axis, -1.0, 1.0),
                int(np.moveaxis(x, axis, 0)[0, ..., axis].max() == 0),
            )
            rows, places = np.moveaxis(vectors, axis, 0), np.moveaxis(x, axis, 0)
            vectors = np.moveaxis(np.concatenate([(image * rows[shared:])[::-1], rows]), 0, axis)
            x = np.moveaxis(np.concatenate([(image * places[shared:])[::-1], places]), 0, axis)
    return vectors


def nodal(components, like):
    """Flat components of nodes as vectors (..., 3)."""
    return np.array([part[: like[..., 0].size] for part in components]).T.reshape(like.shape)


def at_rest(x):
    """No velocities."""
    return [np.zeros_like(part) for part in x]


# the forces


def brought(panel, *places):
    """State of a panel whose nodes were at these places, one after the other. Scratch may hold anything."""
    state, const, work, random = panel.state(1.0), panel.constants(), panel.work(), np.random.default_rng(0)
    for part in (part for parts in work for part in (parts if isinstance(parts, tuple) else (parts,))):
        part[...] = random.uniform(0.5, 2.0, part.shape)
    for x in places:
        set_nodal(state.u, x - rest(panel))
        ply_kernels.initial_forces(state, const, None, work)
    return state


SMALL_BLOCKS = {"edge": "free", "numerics": Numerics(block=150, threads=1)}


def cloth(stretch=(1.015, 1.012), shear=0.005, noise=0.004, side=0.0306, form="variational", **changes):
    """Forces of a ply's elements, unevenly stretched, sheared and crumpled, and of its yarns' turns."""

    def make(seed, symmetry):
        panel = make_panel(side, form=form, symmetry=symmetry, failure=False, **SMALL_BLOCKS | changes)
        (X, Y, _), (s1, s2), dt = np.moveaxis(rest(panel), -1, 0), stretch, panel.time_step
        x = X * (s1 + shear * (2 * Y / side) ** 2), Y * (s2 + 0.5 * shear * (2 * X / side) ** 2)
        x = np.stack([*x, 5e-4 * s1 * np.cos(200 * X) * np.cos(170 * Y)], axis=-1)
        x += at_random(rest(panel), panel.mirrors, (1 + 2 * seed) * noise * min(panel.spacing), seed)

        def forces(x, v):
            state = brought(panel, x[0] - dt * v[0], x[0])
            return [nodal(np.add(state.f_int, state.f_int_above), x[0])]

        return Case([x], forces, lambda x: sum(plain_energies(panel, x[0])), mirrors=panel.mirrors, panel=panel)

    return make


def nose(firm=False, **shape):
    """The contact of a projectile that has gone a little into the fabric."""

    def make(seed, symmetry):
        panel = make_panel(symmetry=symmetry, projectile=Projectile(**shape))
        const, flat, tip = panel.constants(), rest(panel), panel.state(1.0).projectile_position
        x = [flat + at_random(flat, panel.mirrors, 0.05 * const.dx, seed), tip + 0.4e-3 * panel.shot.flight]

        def press(x, v):
            state, law = panel.state(1.0), const.point_law._replace(implicit_factor=16.0 if firm else 0.0)
            if firm:  # what is foreseen
                ahead = {name: tuple(np.zeros_like(u) for u in state.u) for name in ("dv_other", "dv_contact")}
                state = state._replace(force_scale=np.array([0.02]), **ahead)
                set_nodal(state.dv_other, 3.0 * v[0])
                set_nodal(state.dv_contact, 5.0 * v[0])
            set_nodal(state.u, x[0] - flat)
            set_nodal(state.v, v[0])
            state.projectile_position[:], state.projectile_velocity[:] = x[1], v[1]
            scratch = panel.work().contact_scratch
            _, spring = contact_kernels.contact_forces(state, const._replace(point_law=law), scratch)
            return [nodal(state.f_contact, x[0]), state.f_contact_nose.copy()], spring

        energy = None if firm else lambda x: press(x, at_rest(x))[1]
        return Case(x, lambda x, v: press(x, v)[0], energy, panel.shot.frame[2:], panel.mirrors)

    return make


def plies(stacking, points=2):
    """The contact of two plies that bulge into each other, with the feet of its points found."""
    law = PlyLaw([0.0, 20e-6, 40e-6], [0.0, 1e6, 19e6], 1.4e13)

    def make(seed, symmetry):
        ply = make_panel(0.02, table=table(size=41), symmetry=symmetry)
        pack = Pack.stacked(ply, 2, stacking=stacking, gap=0.1e-3, law=law, contact=PlyContact(points=points))
        (states, _), consts, x = pack.states(1.0), pack.constants(), []
        pair, flat = (
            pack.pairs(consts, states)[0],
            [rest(part) + np.array([0, 0, z]) for part, z in zip(pack.plies, pack.places)],
        )
        for part, height in zip(flat, (3.25e-3, 3e-3)):
            bulge = height * np.exp(-(part[..., 0] ** 2 + 1.3 * part[..., 1] ** 2) / 4e-3**2)
            x.append(
                part + bulge[..., None] * np.stack([-50 * part[..., 0], -30 * part[..., 1], 1 + 0 * bulge], axis=-1)
            )
            x[-1] += at_random(part, ply.mirrors, 2e-6, seed)

        def press(pair, x, v, times):
            for n, state in enumerate(states):
                set_nodal(state.u, x[n] - flat[n])
                set_nodal(state.v, v[n])
            for step in range(times):
                pair.status[:], pair.recheck_step[:], pair.depth_offset[:] = IN_CONTACT, 0, 0
                ply_contact_kernels.contact_forces(states[0], consts[0], states[1], consts[1], pair, pair, 8 * step)
            return [nodal(pair.f_front, x[0]), nodal(pair.f_rear, x[1])], pair.energy[ply_contact_kernels.SPRING]

        press(pair, x, at_rest(x), 200)
        energy = lambda x: press(deepcopy(pair), x, at_rest(x), 10)[1]  # noqa: E731
        return Case(x, lambda x, v: press(deepcopy(pair), x, v, 10)[0], energy, mirrors=ply.mirrors)

    return make


MATERIAL = replace(load("backing"), yield_stress=np.inf)
SMALL = Backing(MATERIAL, (0.012, 0.012, 0.008), 1e-3, 4e-3, 1.3, "free", hourglass=0.1)


def block(kind):
    """A bent block: its bricks, a sphere that has gone into its face, or points on that."""

    def make(seed, symmetry):
        backing, random = replace(SMALL, mirrors=SYMMETRIES[symmetry]), np.random.default_rng(seed)
        flat = np.stack(np.meshgrid(*backing.lines, indexing="ij"), axis=-1)
        height = lambda x: 2e-3 * np.cos(250 * x[..., 0]) + 1e-3 * np.cos(400 * x[..., 1])  # noqa: E731
        x = flat + at_random(flat, backing.mirrors, 3e-5, seed)
        x[..., :2] *= 1 + 20 * flat[..., 2:]
        x[..., 2] += height(flat) * (1 - flat[..., 2] / 0.01)
        points = 0.5e-3 * (1 + np.stack([*np.indices((8, 8)), np.zeros((8, 8))], axis=-1))
        points += random.normal(scale=5e-5, size=points.shape)
        points[..., 2] = height(points) + random.uniform(-2e-4, 2e-4, (8, 8))
        others = {"bricks": [], "nose": [np.array([0, 0, 3.5e-3])], "points": [points]}[kind]

        def bear(x, v):
            body = backing.block(1e-9)
            body.x[:], body.v[:] = x[0].reshape(-1, 3), v[0].reshape(-1, 3)
            if kind == "bricks":
                elements = (body._gradient, body._volume, body._twist, body._control, body._edges)
                memory = (body.metric, body.alpha, body.last, body.past, body.gone)
                block_kernels.forces(body.shape, body.x, elements, body._law, 0.0, memory, body._own, body.energy)
                np.add.at(body._outer, body.bricks, body._own)
                on_others = []
            elif kind == "nose":
                on_others = [body.strike(x[1], v[1], Projectile(shape="sphere", radius=3e-3))]
            else:
                given = x[1].reshape(-1, 3), v[1].reshape(-1, 3), np.full(x[1][..., 0].size, 1e3)
                body.press(*given)
                body._outer[:], body._memory[:] = 0.0, (1.0, 0.0)  # no depth is that of a step of the face
                on = body.press(*given, damping=1e-3 * given[2])
                on_others = [on.reshape(x[1].shape)]
            energies = body.energies()
            return [-(body._outer + body._drags).reshape(flat.shape), *on_others], sum(
                energies[name] for name in ("elastic", "hourglass", "contact")
            )

        axes = ANY if kind == "bricks" else UPRIGHT
        return Case([x, *others], lambda x, v: bear(x, v)[0], lambda x: bear(x, at_rest(x))[1], axes, backing.mirrors)

    return make


def grips(seed, symmetry):
    """What clamps take of fabric that has partly slipped out of them."""
    pulled = cloth((1.004, 1.006), 0.02, 0.0005, edge=Grip(15.0))(seed, symmetry)
    panel = make_panel(symmetry=symmetry, failure=False, edge=Grip(15.0))
    const = panel.constants()

    def hold(x, v):
        state = brought(panel, x[0])
        set_nodal(state.v, 0.01 * v[0])
        boundary_kernels.update_slip_nodes(state, const, 0.0)
        held = np.zeros((3, state.u[0].size))
        held[const.slip_axis, const.slip_node] = state.slip_force
        return [nodal(held, x[0])]

    return Case(pulled.x, hold, mirrors=panel.mirrors)


SLACK = {"stretch": (0.9, 0.88), "shear": 0.0, "noise": 0.005, "trellis": False}
FORCES = {
    "membrane": cloth(trellis=False),
    "membrane, equilibrium form": cloth(trellis=False, form="equilibrium"),
    "membrane, coarser": cloth(trellis=False, side=0.06, grading=COARSER),
    "membrane, finer": cloth(trellis=False, side=0.06, grading=FINER),
    "trellis": cloth((0.7, 0.7), 0.25, 0.01),
    "trellis, drawn together": cloth((0.05, 0.08), 0.03, 0.001),
    "trellis, finer": cloth((0.7, 0.7), 0.25, 0.01, side=0.06, grading=FINER),
    "bending": cloth(**SLACK, bending=(2e-6, 4e-6)),
    "bending, clamped": cloth(**SLACK, bending=(2e-6, 4e-6), edge="clamped"),
    "bending, finer": cloth(**SLACK, bending=(2e-6, 4e-6), side=0.06, grading=FINER),
    "jamming": cloth(**SLACK, jam=(100.0, 0.9)),
    "jamming, finer": cloth(**SLACK, jam=(100.0, 0.9), side=0.06, grading=FINER),
    "nose": nose(),
    "nose, askew": nose(shape="cone", half_angle=0.6, tip_radius=5e-4, obliquity=0.3, azimuth=0.7),
    "nose, implicit": nose(firm=True, shape="hemisphere"),
    "plies": plies("aligned"),
    "plies, alternating": plies("alternating", points=1),
    "bricks": block("bricks"),
    "nose on the block": block("nose"),
    "plies on the block": block("points"),
    "grips": grips,
}
CLOTH = [name for name in FORCES if name.split(",")[0] in ("membrane", "trellis", "bending", "jamming")]
EXCEPT = {  # of a test: the forces it is not made with, and why
    "gradient": {
        "membrane, equilibrium form": "has no potential",
        "nose, implicit": "is that of the end of the step",
        "grips": "are friction",
    },
    "balance": {"grips": "are held by the frame"},
    "moment": {"grips": "are held by the frame", "bending, clamped": "has its moment from the clamp"},
    "turn": {"grips": "pull along x and y", "bending, clamped": "bends against the direction of the clamp"},
    "parts": {"nose, askew": "has no plane of symmetry"},
    "damping": {
        "grips": "are held by the frame",
        "bricks": "are found at rest",
        "nose, implicit": "foresees more than the motion",
    },
}


@cache
def case(name, seed, symmetry="whole"):
    return FORCES[name](seed, symmetry)


def all_but(test, names=tuple(FORCES)):
    """Parametrise a test by the forces it is made with and two seeds."""
    chosen = [name for name in names if name not in EXCEPT.get(test, {})]
    return lambda function: pytest.mark.parametrize("name", chosen)(pytest.mark.parametrize("seed", [0, 1])(function))


def velocities(x, mirrors, seed):
    return [at_random(part, mirrors, 1.0, seed + 10) for part in x]


def dot(one, other):
    return sum(float(np.sum(a * b)) for a, b in zip(one, other))


@all_but("gradient")
def test_forces_are_minus_the_gradient_of_the_energy(name, seed):
    """Of its definition, where there is one in Python. Along random ways."""
    one = case(name, seed)
    force = one.forces(one.x, at_rest(one.x))
    for way in (velocities(one.x, one.mirrors, seed + n) for n in range(3)):
        ends = ([x + sign * one.step * w for x, w in zip(one.x, way)] for sign in (1, -1))
        slope = np.subtract(*map(one.energy, ends)) / (2 * one.step)
        size = sum(np.abs(f * w).sum() for f, w in zip(force, way))
        assert size > 0
        assert slope == pytest.approx(-dot(force, way), abs=1e-6 * size)


@all_but("balance")
def test_forces_add_up_to_nothing(name, seed):
    one = case(name, seed)
    force = one.forces(one.x, velocities(one.x, one.mirrors, seed))
    total = sum(f.reshape(-1, 3).sum(axis=0) for f in force)
    assert np.abs(total).max() < 1e-12 * max(np.abs(f).sum() for f in force)


@all_but("moment")
def test_forces_have_no_moment(name, seed):
    """About the axes about which the bodies may be turned."""
    one = case(name, seed)
    force = one.forces(one.x, velocities(one.x, one.mirrors, seed))
    about = one.x[-1] if one.x[-1].ndim == 1 else np.zeros(3)
    moment = sum(np.cross(x - about, f).reshape(-1, 3).sum(axis=0) for x, f in zip(one.x, force))
    size = sum(np.abs(f).sum() * np.abs(x - about).max() for x, f in zip(one.x, force))
    assert np.abs(one.axes @ moment).max() < 1e-9 * size


@all_but("turn")
def test_turned_bodies_have_turned_forces(name, seed):
    one = case(name, seed)
    v, random = velocities(one.x, one.mirrors, seed), np.random.default_rng(seed)
    turn = Rotation.from_rotvec(random.uniform(0.3, 1.0, len(one.axes)) @ one.axes).as_matrix().T
    about = one.x[-1] if one.x[-1].ndim == 1 else np.zeros(3)
    found = one.forces([(x - about) @ turn + about for x in one.x], [part @ turn for part in v])
    for turned, force in zip(found, one.forces(one.x, v)):
        np.testing.assert_allclose(turned, force @ turn, rtol=0, atol=1e-7 * np.abs(force).max())


@pytest.mark.parametrize("symmetry", ["half", "quarter"])
@all_but("parts")
def test_a_part_has_the_forces_and_the_energy_of_the_whole(name, seed, symmetry):
    """Forces on what lies on a plane of symmetry are those of one side, but for those that hold it there."""
    part, whole = case(name, seed, symmetry), case(name, seed)
    v, images = velocities(part.x, part.mirrors, seed), 2 ** sum(part.mirrors)
    x = [unfold(x, x, part.mirrors) for x in part.x]
    found = whole.forces(x, [unfold(*both, part.mirrors) for both in zip(v, part.x)])
    for place, mine, theirs in zip(part.x, part.forces(part.x, v), found):
        if place.ndim == 1:
            np.testing.assert_allclose(images * mine[2], theirs[2], rtol=1e-9)
            continue
        theirs = theirs[tuple(slice(-n, None) for n in place.shape[:-1])].copy()
        for axis, mirrored in enumerate(part.mirrors):
            on_plane = (place[..., axis] == 0.0) & mirrored
            theirs[on_plane] *= 0.5
            theirs[on_plane, axis] = mine[on_plane, axis] = 0.0
        np.testing.assert_allclose(mine, theirs, rtol=0, atol=1e-9 * np.abs(theirs).max())
    if part.energy:
        assert images * part.energy(part.x) == pytest.approx(whole.energy(x), rel=1e-9)


@all_but("damping")
def test_motion_is_damped(name, seed):
    """The forces that motion adds take energy from it."""
    one = case(name, seed)
    v = velocities(one.x, one.mirrors, seed)
    moving, still = one.forces(one.x, v), one.forces(one.x, at_rest(one.x))
    added = dot([a - b for a, b in zip(moving, still)], v)
    assert added < 0 or name.split(",")[0] in ("trellis", "bending", "jamming")  # which have no viscosity


@all_but("cloth", [name for name in CLOTH if "equilibrium" not in name])
def test_the_audit_has_the_energies_of_the_definitions(name, seed):
    one = case(name, seed)
    panel, state, out = one.panel, brought(one.panel, one.x[0]), np.empty(5)
    ply_kernels.energies(state, panel.constants(), None, out)
    np.testing.assert_allclose(out[1:], plain_energies(panel, one.x[0]), rtol=1e-10, atol=1e-15)
