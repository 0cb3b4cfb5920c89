"""Bricks and bars of solid yarns against slow twins, and the quasi-static limit against dolfinx."""

import numpy as np
import pytest

pytest.importorskip("gmsh")

from fabrics.base.errors import InputError
from meshing import crossover
from shellfabric.block.hex8 import CORNERS
from shellfabric.projectile.projectile import Projectile
from tests.validation.models.solids.drawn import draw
from tests.validation.models.solids.solid_patches import FABRIC, SHOT, woven
from tests.validation.models.solids.test_solid_law_kernels import plain_stress
from validation.models.solids import step_kernels
from validation.models.solids.mesh import SolidMesh, corners
from validation.models.solids.model import SolidPatch
from validation.models.solids.numerics import SolidNumerics


@pytest.fixture(scope="module")
def model():
    return SolidPatch(SolidMesh.of(woven((1, 1))), FABRIC, failure=False)


def apart(model, x):
    """Row of a patch at places x, whose yarns do not meet."""
    row = model.row()
    row.partner[:] = -1
    row.side_partner[:] = -1
    row.x[:] = x
    step_kernels.forces(row)
    return row


def distorted(model):
    """Places (n, 3) of a stretched, sheared and wavy patch."""
    random = np.random.default_rng(8)
    strain = np.array([[0.01, 0.02, 0.0], [0.01, -0.02, 0.03], [0.05, 0.0, -0.08]])
    points = model.mesh.points
    return points + points @ strain.T + 1e-6 * random.normal(size=points.shape)


def test_brick_forces_equal_a_slow_twin(model):
    x = distorted(model)
    row = apart(model, x)
    expected = np.zeros_like(x)
    brick = 0
    for yarn, grid in enumerate(model.mesh.grids):
        for nodes in corners(grid):
            P = plain_stress(x[nodes].T @ row.gradient[brick], row.law[yarn])
            expected[nodes] += row.volume[brick] * row.gradient[brick] @ P.T
            brick += 1
    assert row.f_solid == pytest.approx(expected, rel=1e-8, abs=1e-9 * np.abs(expected).max())


def test_the_full_rule_sums_the_law_over_eight_points():
    """Gradients by differences of the trilinear map, in the place of those of the shape functions."""
    numerics = SolidNumerics(full_rule=True)
    model = SolidPatch(SolidMesh.of(woven((1, 1))), FABRIC, numerics=numerics, failure=False)
    x = distorted(model)
    row = apart(model, x)
    expected = np.zeros_like(x)
    for yarn, grid in enumerate(model.mesh.grids):
        for nodes in corners(grid):
            rest = model.mesh.points[nodes]
            for point in CORNERS / np.sqrt(3):
                slopes = shape_slopes(point)
                to_rest = rest.T @ slopes
                frame = np.linalg.qr(to_rest[:, :2])[0]
                frame = frame * np.sign(np.sum(frame * to_rest[:, :2], axis=0))
                frame = np.column_stack([frame, np.cross(frame[:, 0], frame[:, 1])])
                gradient = slopes @ np.linalg.inv(to_rest) @ frame
                P = plain_stress(x[nodes].T @ gradient, row.law[yarn])
                expected[nodes] += abs(np.linalg.det(to_rest)) * gradient @ P.T
    assert row.hourglass_energy == 0
    assert row.f_solid == pytest.approx(expected, rel=1e-7, abs=1e-8 * np.abs(expected).max())


def shape_slopes(point, step=1e-4):
    """(8, 3) central differences of the trilinear shape functions; exact, as each is linear in each
    direction."""
    found = np.empty((8, 3))
    for i in range(3):
        ends = []
        for sign in (1, -1):
            there = point + sign * step * np.eye(3)[i]
            ends.append(np.prod(1 + CORNERS * there, axis=1) / 8)
        found[:, i] = (ends[0] - ends[1]) / (2 * step)
    return found


def test_forces_of_bars_and_hourglass_control_are_the_slope_of_their_energy(model):
    x = distorted(model)
    row = apart(model, x)
    assert row.fibre_energy > 0
    assert row.hourglass_energy > 0
    way = np.random.default_rng(9).normal(size=x.shape)
    stored = []
    for step in (1e-11, -1e-11):
        other = apart(model, x + step * way)
        stored.append(other.fibre_energy + other.hourglass_energy)
    assert np.sum(row.f_other * way) == pytest.approx((stored[0] - stored[1]) / 2e-11, rel=1e-5)


def test_bars_fail_at_their_strain_and_bricks_go_with_half_of_them():
    model = SolidPatch(SolidMesh.of(woven((1, 1))), FABRIC)
    yarn = FABRIC.weave.yarns[0]
    row = apart(model, model.mesh.points * [1 + 1.06 * yarn.failure_strain, 1, 1])
    bars = row.first_bar[1]
    failed = ~row.bar_intact
    assert 0 < failed[:bars].sum() < bars  # where the crimped warp runs along x
    assert not failed[bars:].any()
    assert row.torn[: row.first_brick[1]].any()
    assert not row.torn[row.first_brick[1] :].any()
    lost = 0.5 * row.bar_stiffness * row.bar_length * (1.06 * yarn.failure_strain) ** 2
    assert 0.8 * lost[failed].sum() < row.failure_energy < lost[failed].sum()


@pytest.mark.parametrize("quarter", [False, True])
def test_the_mass_is_that_of_the_fibres(quarter):
    mesh = woven()
    model = SolidPatch(SolidMesh.of(mesh, quarter=quarter), FABRIC)
    expected = 0.0
    for yarn, (family, area) in enumerate(zip(mesh.families, mesh.bar_area)):
        grid = mesh.grids[yarn]
        along = np.linalg.norm(np.diff(mesh.points[grid], axis=0), axis=-1)
        section = area[: grid[0].size].reshape(grid[0].shape)
        expected += FABRIC.weave.yarns[family].fibre_density * (along * section).sum()
    assert model.row().mass.sum() / model.mesh.share == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("full_rule", [False, True])
def test_the_frequency_bound_holds(full_rule):
    """No motion of the nodes is stiffer over its mass than the bound, friction and damping left out."""
    numerics = SolidNumerics(full_rule=full_rule)
    model = SolidPatch(SolidMesh.of(woven((1, 1))), FABRIC, numerics=numerics, failure=False)
    x = distorted(model)
    row = apart(model, x)
    bound = step_kernels.highest_frequency(row)[0]

    def forces_at(places):
        row.x[:] = places
        step_kernels.forces(row)
        return row.f_solid + row.f_other

    way = np.random.default_rng(2).normal(size=x.shape)
    for _ in range(60):  # the power method finds the highest
        pull = forces_at(x + 1e-10 * way) - forces_at(x - 1e-10 * way)
        pull = pull / 2e-10 / row.mass[:, None]
        highest = np.linalg.norm(pull) / np.linalg.norm(way)
        way = pull / np.linalg.norm(pull)
    assert 0.1 * bound < highest < bound


def quasi_static(size, displacement, plates):
    """T1, T2, F_c [N] and the plates' forces of the 3D crossover of dolfinx."""
    pytest.importorskip("dolfinx")
    from unitcell3d.cases.biaxial_and_platens import row
    from unitcell3d.material.numerics import Numerics
    from unitcell3d.model.crossover import CrossoverModel, Load
    from unitcell3d.solver.path_following import follow

    mesh = crossover.build(FABRIC, size=size)
    model = CrossoverModel(mesh, FABRIC, Numerics(penalty=1e14))
    rest = model.plates.at_rest
    start = Load()
    end = Load(displacement)
    if plates is not None:
        start = Load(plates=rest)
        end = Load(displacement, plates=plates * rest)
    record = follow(model, [start, end], row(model))
    return [record[name][-1] for name in ("T1", "T2", "F_c", "F_plate")], rest


TARGET = 2.5e-3  # of tensions and forces off the 3D crossover on the same mesh
SIZE = (5, 5, 2)
PLATENS = 0.7  # distance of the platens over that at rest: 4 MPa
# what the default is off at 4 MPa: force of the yarns on each other, and of the platen on warp and on weft
SOFTER = (-0.0254, -0.0252, -0.0284)


def crossover_alone(**choices):
    """A whole crossover of free ends on the mesh of `quasi_static`."""
    whole = crossover.build(FABRIC, domain="whole", size=SIZE)
    return SolidPatch(
        SolidMesh.of(whole),
        FABRIC,
        fibre_fractions=tuple(whole.Vf0),
        numerics=SolidNumerics(take_off_overlap=False, **choices),
        failure=False,
        clamped=False,
    )


@pytest.mark.parametrize(
    "displacement",
    [
        pytest.param((2e-5, 2e-5), id="both drawn", marks=pytest.mark.slow(20)),
        pytest.param((2.5e-5, 0.0), id="warp drawn", marks=pytest.mark.slow),
    ],
)
def test_the_quasi_static_limit_is_the_crossover_of_dolfinx(displacement):
    """Equal meshes and penalties: tensions, and the force of the yarns on each other."""
    (T1, T2, F_c, _), _ = quasi_static(SIZE, displacement, None)
    found = draw(crossover_alone(), displacement)
    assert found.tension == pytest.approx([T1, T2], rel=TARGET)
    assert found.contact == pytest.approx(F_c, rel=TARGET)


def pressed_between_platens(duration, **choices):
    """Forces (3,) of the patch between platens over those of the 3D crossover, less 1: of the yarns
    on each other, and of the platens."""
    (_, _, F_c, F_plate), rest = quasi_static(SIZE, (0.0, 0.0), PLATENS)
    found = draw(crossover_alone(**choices), (0.0, 0.0), PLATENS * rest, duration)
    return np.array([found.contact, *found.plates]) / [F_c, *F_plate] - 1


@pytest.mark.slow(40)
def test_the_full_rule_between_platens_is_the_crossover_of_dolfinx():
    """At 4 MPa, with twice the time to come to rest: pressed yarns are soft in shear, and slow."""
    assert pressed_between_platens(120e-6, full_rule=True) == pytest.approx(0, abs=TARGET)


@pytest.mark.slow(10)
def test_one_point_between_platens_misses_the_target():
    """The default is softer than the 3D crossover at 4 MPa by ten times the target. One point of a brick
    does not see how the packing varies within it, and the hourglass control is for the yarn at rest. Whoever
    makes it better finds this number here, and in docs/theory-panel.md."""
    off = pressed_between_platens(60e-6)
    assert (np.abs(off) > TARGET).all()
    assert off == pytest.approx(SOFTER, abs=TARGET)


def test_a_crossover_alone_is_drawn():
    with pytest.raises(InputError, match="whole crossover of free ends"):
        draw(SolidPatch(SolidMesh.of(woven((1, 1))), FABRIC), (1e-5, 1e-5))


@pytest.mark.parametrize(
    "choices, words",
    [
        ({"friction": -0.1}, "friction = -0.1: must be at least 0"),
        ({"projectile": Projectile(obliquity=0.3)}, "struck straight on"),
        ({"projectile": Projectile(body="elastic_bar")}, "body = 'elastic_bar'"),
        ({"projectile": SHOT, "quarter": True, "aim": (1e-4, 0.0)}, "aim"),
        ({"quarter": True, "count": (2, 3)}, "only if both numbers are odd"),
    ],
)
def test_what_is_not_modelled_is_refused(choices, words):
    choices = dict(choices)
    mesh = woven(choices.pop("count", (1, 1)))
    with pytest.raises(InputError, match=words):
        SolidPatch(SolidMesh.of(mesh, quarter=choices.pop("quarter", False)), FABRIC, **choices)


def test_a_fabric_without_solid_laws_is_refused():
    from dataclasses import replace

    mesh = SolidMesh.of(woven((1, 1)))
    with pytest.raises(InputError, match=r"no \[solid\] tables"):
        SolidPatch(mesh, replace(FABRIC, solid_laws=None))


@pytest.mark.parametrize("key, value", [("cfl", 1.2), ("penalty", 0.0), ("hourglass", -1.0)])
def test_numerics_are_checked(key, value):
    with pytest.raises(InputError, match=key):
        SolidNumerics(**{key: value})
