"""The contact of solid yarns: forces against the slope of their energy, invariants, friction, overlaps."""

import numpy as np
import pytest

pytest.importorskip("gmsh")

from tests.validation.models.solids.solid_patches import FABRIC, SHOT, pressed, settled, woven
from validation.models.solids import facet_kernels, nose_kernels, spline_kernels, tip_kernels
from validation.models.solids.mesh import SolidMesh
from validation.models.solids.model import SolidPatch

KERNELS = {"facets": facet_kernels.contact_forces, "tips": tip_kernels.tip_forces}


@pytest.fixture(scope="module", params=[False, True], ids=["whole", "quarter"])
def model(request):
    return SolidPatch(SolidMesh.of(woven(), quarter=request.param), FABRIC, clamped=False)


def contact(model, x, kind):
    """Forces (n, 3) on the nodes and the energy of one kind of contact at places x."""
    row = settled(model, x)
    KERNELS[kind](row, 0.0)
    energies = {"facets": row.contact_energy, "tips": row.tip_energy}[kind]
    return -row.f_other, energies


@pytest.mark.parametrize("kind", ["facets", "tips"])
def test_forces_are_the_slope_of_their_energy(model, kind):
    """Feet beyond the sides of a face, where the share fades, are among them."""
    x = pressed(model)
    force, energies = contact(model, x, kind)
    assert np.count_nonzero(energies) > 5
    random = np.random.default_rng(5)
    for _ in range(3):
        way = random.normal(size=x.shape) * model._free()
        up = contact(model, x + 2e-11 * way, kind)[1].sum()
        down = contact(model, x - 2e-11 * way, kind)[1].sum()
        assert -np.sum(force * way) == pytest.approx((up - down) / 4e-11, rel=1e-5)


@pytest.mark.parametrize("kind", ["facets", "tips"])
def test_contact_makes_no_momentum_and_no_moment(kind):
    model = SolidPatch(SolidMesh.of(woven()), FABRIC, clamped=False)
    x = pressed(model)
    force, _ = contact(model, x, kind)
    scale = np.abs(force).sum()
    assert scale > 1.0
    assert force.sum(axis=0) == pytest.approx(0, abs=1e-12 * scale)
    if kind == "tips":
        assert np.cross(x, force).sum(axis=0) == pytest.approx(0, abs=1e-15 * scale)


def test_the_pressure_is_that_of_the_quasi_static_crossover():
    theirs = pytest.importorskip("unitcell3d.contact.surface_contact_kernels")
    for depth in (1e-8, 4e-7, 5e-7, 3e-6):
        p = facet_kernels.pressure(depth, 1e14, 5e-7)[0]
        assert p == pytest.approx(theirs.pressure(-depth, 1e14, 5e-7)[0], rel=1e-12)
        up = facet_kernels.pressure(depth + 1e-11, 1e14, 5e-7)[1]
        down = facet_kernels.pressure(depth - 1e-11, 1e14, 5e-7)[1]
        assert p == pytest.approx((up - down) / 2e-11, rel=1e-4)


def test_the_surface_is_that_of_the_quasi_static_crossover():
    theirs = pytest.importorskip("unitcell3d.contact.surface_kernels")
    w = np.empty(4)
    slope = np.empty(4)
    found = np.empty((3, 4))
    for t in (0.0, 0.3, 0.9):
        spline_kernels.cubics(t, w, slope)
        theirs.cubics(t, found)
        assert w == pytest.approx(found[0], abs=1e-15)
        assert slope == pytest.approx(found[1], abs=1e-14)


def test_a_line_goes_straight_on_beyond_its_ends():
    w = np.empty(4)
    slope = np.empty(4)
    values = np.array([0.0, 1.0, 4.0, 9.0, 16.0])
    found = []
    for xi in (-1.0, -0.5, 0.0, 4.0, 4.5, 5.0):
        cell = spline_kernels.line_weights(xi, 4, False, w, slope)
        nodes = np.clip(np.arange(cell - 1, cell + 3), 0, 4)
        found.append(w @ values[nodes])
        assert w.sum() == pytest.approx(1)
    assert found[2] - found[1] == pytest.approx(found[1] - found[0])
    assert found[5] - found[4] == pytest.approx(found[4] - found[3])


def test_the_energy_of_a_closed_path_round_a_side_is_nothing():
    """A yarn that is led down beside another, under its edge, and back up: a potential has no memory."""
    model = SolidPatch(SolidMesh.of(woven((1, 1))), FABRIC, clamped=False)
    warp = model.mesh.grids[0]
    work = 0.0
    largest = 0.0
    spot = np.array([0.0, 0.0])
    corners = [(0.0, -3e-6), (1.5e-4, -3e-6), (1.5e-4, 0.0), (0.0, 0.0)]
    for corner in corners:
        steps = 40
        for step in (np.array(corner) - spot) / steps * np.ones((steps, 1)):
            x = model.mesh.points.copy()
            x[warp, 0] += spot[0] + 0.5 * step[0]
            x[warp, 2] += spot[1] + 0.5 * step[1]
            force = contact(model, x, "facets")[0][warp].reshape(-1, 3).sum(axis=0)
            work += force[0] * step[0] + force[2] * step[1]
            largest = max(largest, abs(work))
            spot = spot + step
    assert largest > 1e-8
    assert abs(work) < 2e-2 * largest


def test_what_is_found_deep_inside_takes_no_energy_and_lets_go_as_it_comes_out():
    model = SolidPatch(SolidMesh.of(woven((1, 1))), FABRIC, clamped=False)
    warp = model.mesh.grids[0]
    row = model.row()
    row.reach = 1e-6
    heights = (-30e-6, -28e-6, -28.5e-6, 5e-6, -1e-7)
    energies = []
    for height in heights:
        row.x[:] = model.mesh.points
        row.x[warp, 2] += height
        row.wait[:] = 0
        row.f_other[:] = 0
        facet_kernels.contact_forces(row, 0.0)
        energies.append(row.contact_energy.sum())
    found, out, back, away, _ = energies
    assert found == out == away == 0
    assert back > 0
    assert row.overlap.min() > -1e-6


def slid(coefficient, way):
    """Row and forces of a warp that is pressed on a weft and dragged along it by `way` [m]."""
    model = SolidPatch(SolidMesh.of(woven((1, 1))), FABRIC, friction=coefficient, clamped=False)
    warp = model.mesh.grids[0]
    x = model.mesh.points.copy()
    x[warp, 2] -= 8e-6
    row = settled(model, x)
    speed = np.zeros(3)
    speed[1] = 1.0
    for _ in range(50):
        row.v[:] = 0
        row.v[warp] = speed
        row.f_other[:] = 0
        facet_kernels.contact_forces(row, way / 50)
    return row, -row.f_other[warp].reshape(-1, 3).sum(axis=0)


def test_sliding_takes_the_friction_coefficient_times_the_normal_force():
    free, along = slid(0.0, 10e-6)
    rough, held = slid(0.25, 10e-6)
    assert held[2] == pytest.approx(along[2], rel=0.05)
    assert along[1] - held[1] == pytest.approx(0.25 * held[2], rel=0.05)
    assert free.friction_work == 0
    # work: the normal force times the coefficient times the way that is slid, less the elastic slip
    assert 0.8 * 0.25 * held[2] * 10e-6 < rough.friction_work < 1.02 * 0.25 * held[2] * 10e-6


def test_a_small_slip_is_elastic():
    rough, held = slid(0.25, 1e-9)
    assert rough.friction_work == pytest.approx(0, abs=1e-3 * rough.contact_energy.sum())
    assert abs(held[1]) > 0


def test_the_nose_gets_what_the_yarns_get():
    model = SolidPatch(SolidMesh.of(woven()), FABRIC, SHOT, clamped=False)
    row = model.row(60.0)
    row.nose_position[2] += 3e-6
    row.v[:, 0] = 2.0
    nose_kernels.nose_forces(row, 1e-9)
    assert row.nose_force[2] < -0.1
    assert row.f_other.sum(axis=0) == pytest.approx(row.nose_force, abs=1e-12)
    assert row.nose_slider.any()
