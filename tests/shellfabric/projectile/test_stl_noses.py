"""The five analytic noses as any body: distance and normal between samples, and shots with their STL files."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from shellfabric.projectile import sdf_kernels
from shellfabric.projectile.projectile import Projectile
from tests import stl_noses

# with a grid of a third of the places of the whole bodies
SHORT = {
    name: replace(shot, length=shot.length and 4.2e-3) for name, shot in stl_noses.NOSES.items()
}


@pytest.fixture(scope="module")
def pairs():
    """{name: (analytic nose, the same by three samples in an edge radius)}."""
    return {
        name: (SHORT[name], stl_noses.sampled(SHORT[name], 3))
        for name in ("flat", "cone", "chisel")
    }


@pytest.mark.parametrize("name", ["flat", "cone", "chisel"])
def test_the_distance_between_samples_is_that_of_the_nose(pairs, name):
    """Within 1.5 % of the edge radius, down to half of it, and the normals within 6 degrees, 1 root mean square."""
    distance, normal = stl_noses.errors(*pairs[name], count=1500)
    assert abs(distance).max() < 0.015
    assert np.sqrt(np.mean(distance**2)) < 0.002
    assert normal.max() < 6
    assert np.sqrt(np.mean(normal**2)) < 1


def test_the_normal_is_the_direction_of_the_slope(pairs):
    """A central difference over 2 nm; linear interpolation between samples, whose slope jumps, would be off by degrees
    at the faces of the cells, which half of the places are next to."""
    _, body = pairs["chisel"]
    h = body.solid.spacing
    rng = np.random.default_rng(1)
    step = 1e-9
    at = rng.uniform((-2e-3, -2e-3, -1e-3), (2e-3, 2e-3, 0), (200, 3))
    at[::2] = h * np.round(at[::2] / h) + 0.5 * step
    for place in at:
        slope = [
            (body.distance(place + d)[0] - body.distance(place - d)[0]) / (2 * step)
            for d in step * np.eye(3)
        ]
        normal = body.distance(place)[1]
        assert np.linalg.norm(normal) == pytest.approx(1, abs=1e-12)
        assert_allclose(normal, slope / np.linalg.norm(slope), atol=2e-5)


def test_weights_of_b_splines():
    for t in np.linspace(0, 1, 11):
        w, slope = map(np.array, sdf_kernels.b_spline(t))
        places = np.arange(-1, 3) - t
        assert w.sum() == pytest.approx(1)
        assert slope.sum() == pytest.approx(0)
        assert w @ places == pytest.approx(0)
        assert slope @ (places + t) == pytest.approx(1)


def test_a_body_is_its_own_mirror_image_or_not(pairs):
    _, body = pairs["chisel"]
    assert body.mirrored(0)
    assert body.mirrored(1)
    assert not replace(body, roll=0.3).mirrored(0)
    assert replace(body, roll=np.pi / 2).mirrored(0)
    assert not replace(body, obliquity=0.3).mirrored(0)
    solid = body.solid
    lumped = solid.distances.copy()
    lumped[:10] -= 5e-5
    lopsided = replace(body, solid=replace(solid, digest="lopsided", distances=lumped))
    assert not lopsided.mirrored(0)
    assert lopsided.mirrored(1)
    assert not replace(lopsided, roll=np.pi / 2).mirrored(1)


MARKS = dict.fromkeys(("sphere", "hemisphere", "chisel", "flat"), pytest.mark.slow(10))


@pytest.mark.parametrize("name", [pytest.param(n, marks=MARKS.get(n, ())) for n in stl_noses.NOSES])
def test_a_shot_from_an_stl_file_is_the_analytic_one(tmp_path, name):
    """Peak force, deflection, absorbed energy and residual velocity within 1 %, below and above the ballistic limit.
    The error of the energy balance stays what it is.

    Above, the largest deflection is that of torn ends, which fly by chance: under the chisel it differs by 12 %.
    """
    shot = stl_noses.NOSES[name]
    path = stl_noses.write(tmp_path / "nose.stl", *stl_noses.triangles(shot, 121, 97))
    for velocity in stl_noses.VELOCITIES:
        (analytic, read), balance = stl_noses.fire(shot, stl_noses.from_file(path), velocity)
        if velocity == max(stl_noses.VELOCITIES):
            analytic, read = (np.delete(row, stl_noses.DEFLECTION) for row in (analytic, read))
        assert_allclose(read, analytic, rtol=0.01)
        assert balance.max() < 0.0025


def test_an_oblique_shot_with_friction_keeps_its_energy(pairs):
    """And a leaning body starts where it touches the panel."""
    attitude = {"obliquity": 0.4, "azimuth": 0.3, "yaw": 0.2, "roll": 0.3, "friction": 0.3}
    shot, body = (replace(one, **attitude) for one in pairs["chisel"])
    assert isinstance(body, Projectile)
    assert_allclose(body.start(), shot.start(), atol=2e-5)
    given = {
        "projectile": {"mass": "1.1 g", "diameter": "5.4 mm", "edge_radius": "0.3 mm"},
        "symmetry": "whole",
    }
    setup = stl_noses.runs.setup("S-720", 120.0, opening="50 mm", end_time="40 us", **given)
    analytic, read = (stl_noses.run_impact(replace(setup, projectile=one)) for one in (shot, body))
    assert read.residual_velocity == pytest.approx(analytic.residual_velocity, rel=0.01)
    assert read.max_deflection == pytest.approx(analytic.max_deflection, rel=0.01)
    assert read.energy_error_max < 0.0025
