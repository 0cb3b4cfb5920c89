"""What holds of all forces of a panel, whatever they are: they are a gradient, balanced, the same seen from any side.

A case has bodies, each an array (..., 3) of places, and gives the forces on them. Bodies that a plane of symmetry cuts
are grids.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import product
from typing import NamedTuple

import numpy as np
import pytest
from conftest_tools import Pressed, foresee, grid
from numpy.testing import assert_allclose
from panels import COARSER, FINER, make_panel, plain_energies, rest, set_nodal, table
from scipy.spatial.transform import Rotation

from fabrics.materials import load
from fabrics.ply_law import PlyLaw
from shellfabric.block import block_kernels
from shellfabric.block.block import Backing
from shellfabric.jit.table import Row
from shellfabric.loop import ply_kernels
from shellfabric.membrane import boundary_kernels, failure_kernels
from shellfabric.membrane.boundary import Grip
from shellfabric.membrane.grid import SYMMETRIES
from shellfabric.membrane.model import Panel
from shellfabric.membrane.numerics import Numerics
from shellfabric.plies.model import Pack, PlyContact
from shellfabric.projectile import contact_kernels
from shellfabric.projectile.projectile import Projectile
from shellfabric.projectile.window_kernels import place_near_nose
from shellfabric.state import DAMAGED, INTACT

STEP = 1e-9  # [m] of central differences


class Case(NamedTuple):
    """Bodies in a random state, and the forces on them."""

    x: list  # [m] places of the bodies
    forces: Callable  # [N] of places and velocities
    energy: Callable | None = None  # [J] of places, at rest
    axes: np.ndarray = np.eye(3)  # about which all bodies may be turned
    mirrors: tuple = (False, False)
    panel: Panel | None = None  # of elements of a ply


def at_random(x, mirrors, size, seed):
    """Vectors of a body at x, which keep to the planes of symmetry."""
    vectors = np.random.default_rng(seed).normal(scale=size, size=x.shape)
    for axis, mirrored in enumerate(mirrors):
        vectors[..., axis][mirrored & (x[..., axis] == 0.0)] = 0.0
    return vectors


def unfold(vectors, x, mirrors):
    """Vectors of a body at x, with those of its images. What lies on a plane of symmetry has none."""
    for axis in np.flatnonzero(mirrors) if x.ndim > 1 else ():
        image, rows, places = (
            np.where(np.arange(3) == axis, -1.0, 1.0),
            *(np.moveaxis(y, axis, 0) for y in (vectors, x)),
        )
        beyond = slice(None, None if places[0, ..., axis].any() else 0, -1)
        vectors, x = (
            np.moveaxis(np.concatenate([image * y[beyond], y]), 0, axis) for y in (rows, places)
        )
    return vectors


def nodal(components, like):
    """Flat components of nodes as vectors (..., 3)."""
    return np.array([part[: like[..., 0].size] for part in components]).T.reshape(like.shape)


def at_rest(x):
    """No velocities."""
    return [np.zeros_like(part) for part in x]


# the forces


def arrays_of(row):
    """The arrays of a table's row, of the rows and tuples in it too."""
    for part in row:
        if isinstance(part, Row | tuple):
            yield from arrays_of(part)
        elif isinstance(part, np.ndarray):
            yield part


def state_at(panel, *places, damage=INTACT, torn=()):
    """State of a panel whose nodes were at these places, one after the other. Scratch may hold anything.

    torn : segments (family, row, column) that have failed, as all their images, in crossovers from the impact point
    """
    state = panel.state(1.0)
    const = panel.constants()
    work = panel.work()
    random = np.random.default_rng(0)
    for part in arrays_of(work):
        part[...] = random.uniform(0.5, 2.0, part.shape)
    for family, *place in torn:
        lines = []
        n = panel.lines_per_crossover
        for axis, at in enumerate(place):
            middle = 0 if panel.mirrors[axis] else panel.counts[axis] // 2
            lines.append(
                [middle + n * at, middle - n * at - n * (axis == family)][: 2 - panel.mirrors[axis]]
            )
        for (i, j), m in product(product(*lines), range(n)):
            at = (i + m, j) if family == 0 else (i, j + m)
            grid(const, state.failed[family])[at] = 1
        failure_kernels.break_edges(const, state, family, 0, const.ni)
    state.block_damage[:] = DAMAGED if torn else damage
    for x in places:
        set_nodal(state.u, x - rest(panel))
        ply_kernels.initial_forces(state, const, work)
    return state


def audited(state, panel):
    """[J] energies of yarns, trellis, bending and packing that the audit finds."""
    energies = np.empty(5)
    ply_kernels.energies(state, panel.constants(), energies)
    return energies[1:]


def elements(
    stretch=(1.015, 1.012),
    shear=0.005,
    noise=0.004,
    side=0.03048,
    damage=INTACT,
    torn=(),
    **changes,
):
    """The elements of a ply, unevenly stretched, sheared and crumpled, in several blocks."""
    changes = {
        "boundary": "free",
        "numerics": Numerics(block=150, threads=1),
        "yarn_failure": False,
    } | changes

    def make(seed, symmetry):
        panel = make_panel(side, symmetry=symmetry, **changes)
        X, Y, _ = np.moveaxis(rest(panel), -1, 0)
        s1, s2 = stretch
        dt = panel.time_step
        x = X * (s1 + shear * (2 * Y / side) ** 2), Y * (s2 + 0.5 * shear * (2 * X / side) ** 2)
        x = np.stack([*x, 5e-4 * s1 * np.cos(200 * X) * np.cos(170 * Y)], axis=-1)
        x += at_random(
            rest(panel), panel.mirrors, (1 + 2 * seed) * noise * min(panel.spacing), seed
        )

        def forces(x, v):
            state = state_at(panel, x[0] - dt * v[0], x[0], damage=damage, torn=torn)
            return [nodal(np.add(state.f_int, state.f_int_above), x[0])]

        def energy(x):
            return sum(
                audited(state_at(panel, x[0], torn=torn), panel)
                if torn
                else plain_energies(panel, x[0])
            )

        return Case(
            [x],
            forces,
            energy,
            np.eye(3)[: 3 * (changes["boundary"] == "free")],
            panel.mirrors,
            panel,
        )

    return make


def grips(seed, symmetry):
    """What clamps take of fabric that has partly slipped out of them."""
    _, _, _, _, mirrors, panel = case = elements((1.004, 1.006), 0.02, 0.0005, boundary=Grip(15.0))(
        seed, symmetry
    )
    const = panel.constants()

    def forces(x, v):
        state = state_at(panel, x[0])
        set_nodal(state.v, 0.01 * v[0])
        boundary_kernels.update_slip_nodes(state, const, 0.0)
        held = np.zeros((3, state.u[0].size))
        held[const.slip_axis, const.slip_node] = state.slip_force
        return [nodal(held, x[0])]

    return Case(case.x, forces, mirrors=mirrors)


def nose(implicit=False, elements=1, **shape):
    """The contact of a projectile that has gone a little into the fabric, along its own axis."""

    def make(seed, symmetry):
        panel = make_panel(
            symmetry=symmetry, projectile=Projectile(**shape), elements_per_crossover=elements
        )
        const = panel.constants()
        flat = rest(panel)
        tip = panel.state(1.0).projectile_position
        law = const.point_law._replace(implicit=0.0)
        if implicit:
            law = law._replace(
                implicit=1.0, stiffness=16.0 * law.stiffness, damping=4.0 * law.damping
            )
        x = [
            flat + at_random(flat, panel.mirrors, 0.05 * const.dx, seed),
            tip + 0.4e-3 * panel.shot.flight,
        ]

        def press(x, v):
            state = panel.state(1.0)
            if implicit:  # with velocities that it predicts
                state = foresee(state, const, 3.0 * v[0], 5.0 * v[0])
            set_nodal(state.u, x[0] - flat)
            set_nodal(state.v, v[0])
            state.projectile_position[:] = x[1]
            state.projectile_velocity[:] = v[1]
            place_near_nose(state, const)
            scratch = panel.work().contact_scratch
            _, spring = contact_kernels.contact_forces(
                state, const._replace(point_law=law), scratch
            )
            return [nodal(state.f_contact, x[0]), state.f_contact_nose.copy()], spring

        energy = None if implicit else lambda x: press(x, at_rest(x))[1]
        return Case(x, lambda x, v: press(x, v)[0], energy, panel.shot.frame[2:], panel.mirrors)

    return make


def plies(stacking, **contact):
    """The contact of two plies that bulge into each other, with the closest points found."""
    law = PlyLaw([0.0, 20e-6, 40e-6], [0.0, 1e6, 19e6], 1.4e13)
    # what plies keep of a closure is no gradient: `plies/test_ply_contact.py` has it
    elastic = PlyContact(resilience=1.0, **contact)

    def make(seed, symmetry):
        ply = make_panel(0.02, table=table(size=41), symmetry=symmetry)
        pack = Pack.stacked(ply, 2, stacking=stacking, gap=0.1e-3, law=law, contact=elastic)
        pressed = Pressed(pack)
        x = []
        flat = [rest(part) + np.array([0.0, 0.0, z]) for part, z in zip(pack.plies, pack.places)]
        for part, height in zip(flat, (3.25e-3, 3e-3)):
            bulge = height * np.exp(
                -np.sum(np.array([1, 1.3]) * part[..., :2] ** 2, axis=-1, keepdims=True) / 4e-3**2
            )
            x.append(
                part
                + bulge * (part * [-50, -30, 0] + [0, 0, 1])
                + at_random(part, ply.mirrors, 2e-6, seed)
            )

        def press(x, v):
            for state, place, begin, speed in zip(pressed.states, x, flat, v):
                set_nodal(state.u, place - begin)
                set_nodal(state.v, speed)
            return list(pressed.press(4)), pressed.spring()

        return Case(
            x, lambda x, v: press(x, v)[0], lambda x: press(x, at_rest(x))[1], mirrors=ply.mirrors
        )

    return make


ELASTIC = replace(load("backing"), yield_stress=np.inf)
BLOCK = Backing(
    ELASTIC,
    size=(0.012, 0.012, 0.008),
    min_size=1e-3,
    refined_depth=4e-3,
    growth=1.3,
    outer_boundary="free",
    hourglass=0.1,
)


def block(kind):
    """A bent block: its bricks, a sphere that has gone into its face, or points on that."""

    def make(seed, symmetry):
        backing = replace(BLOCK, mirrors=SYMMETRIES[symmetry])
        random = np.random.default_rng(seed)
        flat = np.stack(np.meshgrid(*backing.lines, indexing="ij"), axis=-1)
        # points meet a face of up to 60 degrees: else a turning facet could make energy unseen
        steep = 3.0 if kind == "points" else 1.0

        def height(x):
            return steep * (2e-3 * np.cos(250 * x[..., 0]) + 1e-3 * np.cos(400 * x[..., 1]))

        x = flat + at_random(flat, backing.mirrors, 3e-5, seed)
        x[..., :2] *= 1 + 20 * flat[..., 2:]
        x[..., 2] += height(flat) * (1 - flat[..., 2] / 0.01)
        points = 0.5e-3 * (1 + np.moveaxis(np.indices((8, 8, 1)), 0, -1)[:, :, 0]) + random.normal(
            0, 5e-5, (8, 8, 3)
        )
        points[..., 2] = height(points) + random.uniform(-2e-4, 2e-4, (8, 8))
        others = {"bricks": [], "nose": [np.array([0, 0, 3.5e-3])], "points": [points]}[kind]

        def bear(x, v):
            body = backing.block(1e-9)
            on_others = []
            body.x[:], body.v[:] = x[0].reshape(-1, 3), v[0].reshape(-1, 3)
            if kind == "bricks":
                block_kernels.forces(body.row, 0.0)
                np.add.at(body.row.outer, body.bricks, body.row.own)
            elif kind == "nose":
                on_others = [body.strike(x[1], v[1], Projectile(shape="sphere", radius=3e-3))]
            else:
                contact = (
                    x[1].reshape(-1, 3),
                    v[1].reshape(-1, 3),
                    np.full(64 * x[1].size // points.size, 1e3),
                )
                body.press(*contact)
                # no depth is that of a step of the face
                body.row.outer[:] = 0.0
                body.points.inside[:] = 1.0
                body.points.offset[:] = 0.0
                on_others = [body.press(*contact, damping=1e-3 * contact[2]).reshape(x[1].shape)]
            stored = sum(body.energies()[name] for name in ("elastic", "hourglass", "contact"))
            return [-(body.row.outer + body.row.drags).reshape(flat.shape), *on_others], stored

        axes = np.eye(3) if kind == "bricks" else np.eye(3)[2:]
        return Case(
            [x, *others],
            lambda x, v: bear(x, v)[0],
            lambda x: bear(x, at_rest(x))[1],
            axes,
            backing.mirrors,
        )

    return make


SLACK = {"stretch": (0.9, 0.88), "shear": 0.0, "noise": 0.005, "trellis": False}
BENDING = SLACK | {"bending": (2e-6, 4e-6)}
PACKED = SLACK | {"stretch": (0.7, 0.68)}
SHEARED = {"stretch": (0.7, 0.7), "shear": 0.25, "noise": 0.01}
TORN = ((0, 2, 3), (1, 2, 3), (1, 3, 3), (0, 5, 1))
GRADED = {"side": 0.06, "grading": FINER}
FORCES = {
    "membrane": elements(trellis=False),
    "membrane, equilibrium form": elements(trellis=False, cell_formulation="equilibrium"),
    "membrane, coarser": elements(trellis=False, side=0.06, grading=COARSER),
    "membrane, finer": elements(trellis=False, **GRADED),
    "membrane, one by one": elements(trellis=False, damage=DAMAGED),
    "trellis": elements(**SHEARED),
    "trellis, drawn together": elements((0.05, 0.08), 0.03, 0.001),
    "trellis, finer": elements(**SHEARED, **GRADED),
    "trellis, one by one": elements(**SHEARED, damage=DAMAGED),
    "torn": elements(torn=TORN),
    "torn, finer": elements(torn=TORN, **GRADED),
    "torn, out of plane": elements(torn=TORN, **BENDING | PACKED, **GRADED),
    "bending": elements(**BENDING),
    "bending, clamped": elements(**BENDING, boundary="clamped"),
    "bending, finer": elements(**BENDING, **GRADED),
    "packing": elements(**PACKED),
    "packing, folded": elements(**PACKED | {"stretch": (0.1, 0.08), "noise": 0.05}),
    "packing, finer": elements(**PACKED, **GRADED),
    "packing, torn": elements(**PACKED, torn=TORN),
    "nose": nose(),
    "nose, odd points": nose(elements=3),
    "nose, askew": nose(shape="cone", half_angle=0.6, tip_radius=5e-4, obliquity=0.3, azimuth=0.7),
    "nose, implicit": nose(implicit=True, shape="hemisphere"),
    "plies, aligned": plies("aligned"),
    "plies, undamped": plies("alternating", points=1, damping=0.0),
    "bricks": block("bricks"),
    "nose on the block": block("nose"),
    "plies on the block": block("points"),
    "grips": grips,
}
NO_GRADIENT = {
    "membrane, equilibrium form": "has no potential",
    "nose, implicit": "is the force at the end of the step",
    "grips": "are friction",
}
EXCEPT = {  # of a test: the forces it is not made with, and why
    "gradient": NO_GRADIENT,
    "balance": {
        "grips": "are held by the frame",
        "plies, aligned": "share a push out by limited shares, which move it among the nodes of its point",
    },
    "turn": {"grips": "pull along x and y"},
    "parts": {"nose, askew": "has no plane of symmetry"},
    "damping": NO_GRADIENT
    | dict.fromkeys(("trellis", "bending", "packing", "bricks"), "are found without viscosity")
    | {"plies, undamped": "have no damper", "torn, out of plane": "are slack, without viscosity"},
    "audit": NO_GRADIENT
    | dict.fromkeys(("torn", "nose", "plies", "bricks"), "have no definition in panels.py"),
}


@cache
def case_of(name, seed, symmetry="whole"):
    return FORCES[name](seed, symmetry)


def all_but(test):
    """Parametrise a test by the forces it is made with, and two seeds."""
    kinds = {name: name.split(",")[0].split(" on ")[0] for name in FORCES}
    names = [name for name, kind in kinds.items() if not {name, kind} & set(EXCEPT[test])]
    return lambda function: pytest.mark.parametrize("name", names)(
        pytest.mark.parametrize("seed", [0, 1])(function)
    )


def velocities(case, seed=10):
    return [at_random(part, case.mirrors, 1.0, seed) for part in case.x]


def centre(x):
    """The tip of a projectile, or the origin."""
    return x[-1] if x[-1].ndim == 1 else np.zeros(3)


def dot(vectors, others):
    return sum(float(np.sum(a * b)) for a, b in zip(vectors, others))


@all_but("gradient")
def test_forces_are_minus_the_gradient_of_the_energy(name, seed):
    """Of its definition, where panels.py has it. Along random ways."""
    case = case_of(name, seed)
    force = case.forces(case.x, at_rest(case.x))
    for way in (velocities(case, number) for number in range(3)):
        ends = ([x + step * w for x, w in zip(case.x, way)] for step in (STEP, -STEP))
        slope = np.subtract(*map(case.energy, ends)) / (2 * STEP)
        size = sum(abs(f * w).sum() for f, w in zip(force, way))
        assert size > 0
        assert slope == pytest.approx(-dot(force, way), abs=1e-6 * size)


@all_but("balance")
def test_forces_add_up_to_nothing_and_have_no_moment(name, seed):
    """About the axes about which the bodies may be turned."""
    case = case_of(name, seed)
    force = case.forces(case.x, velocities(case))
    arms = [x - centre(case.x) for x in case.x]
    size = max(abs(f).sum() for f in force)
    total = sum(f.reshape(-1, 3).sum(axis=0) for f in force)
    moment = sum(np.cross(arm, f).reshape(-1, 3).sum(axis=0) for arm, f in zip(arms, force))
    assert abs(total).max() < 1e-12 * size
    assert abs(case.axes @ moment).max(initial=0.0) < 1e-9 * size * max(
        abs(arm).max() for arm in arms
    )


@all_but("turn")
def test_turned_bodies_have_turned_forces(name, seed):
    case = case_of(name, seed)
    v = velocities(case)
    angles = np.random.default_rng(seed).uniform(0.3, 1.0, len(case.axes))
    origin = centre(case.x)
    turn = Rotation.from_rotvec(angles @ case.axes).as_matrix().T
    turned = case.forces(
        [(x - origin) @ turn + origin for x in case.x], [part @ turn for part in v]
    )
    for after, before in zip(turned, case.forces(case.x, v)):
        assert_allclose(after, before @ turn, rtol=0, atol=1e-7 * abs(before).max())


@pytest.mark.parametrize("symmetry", ["half", "quarter"])
@all_but("parts")
def test_a_part_has_the_forces_and_the_energy_of_the_whole(name, seed, symmetry):
    """Forces on what lies on a plane of symmetry are those of one side, but for those that hold it there."""
    part = case_of(name, seed, symmetry)
    whole = case_of(name, seed)
    images = 2 ** sum(part.mirrors)
    v = velocities(part)
    x = [unfold(x, x, part.mirrors) for x in part.x]
    forces = whole.forces(x, [unfold(*both, part.mirrors) for both in zip(v, part.x)])
    for place, mine, theirs in zip(part.x, part.forces(part.x, v), forces):
        if place.ndim == 1:
            assert_allclose(images * mine[2], theirs[2], rtol=1e-9)
            continue
        theirs = theirs[tuple(slice(-n, None) for n in place.shape[:-1])].copy()
        for axis in np.flatnonzero(part.mirrors):
            on_plane = place[..., axis] == 0.0
            theirs[on_plane] *= 0.5
            theirs[on_plane, axis] = mine[on_plane, axis] = 0.0
        assert_allclose(mine, theirs, rtol=0, atol=1e-9 * abs(theirs).max())
    if part.energy:
        assert images * part.energy(part.x) == pytest.approx(whole.energy(x), rel=1e-9)


@all_but("damping")
def test_motion_is_damped(name, seed):
    """The forces that it adds take energy from it."""
    case = case_of(name, seed)
    v = velocities(case)
    assert dot(case.forces(case.x, v), v) < dot(case.forces(case.x, at_rest(case.x)), v)


@all_but("audit")
def test_the_audit_has_the_energies_of_the_definitions(name, seed):
    """Found eight at once, and one by one as where yarns have failed."""
    panel = case_of(name, seed).panel
    x = case_of(name, seed).x[0]
    for damage in (INTACT, DAMAGED):
        energies = audited(state_at(panel, x, damage=damage), panel)
        assert_allclose(energies, plain_energies(panel, x), rtol=1e-10, atol=1e-15)
