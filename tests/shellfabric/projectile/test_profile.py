"""The meridian of a body of revolution as a nose: its distance against those of exact shapes, its motion and forces."""

import numpy as np
import pytest

from fabrics import metals
from shellfabric.jit.compile import entry
from shellfabric.metal import body, motion_kernels
from shellfabric.projectile import profile_kernels, sdf_kernels
from shellfabric.projectile.projectile import Projectile, profile_of
from shellfabric.projectile.turned import Turned

R = 3e-3
LENGTH = 20e-3
LEAD = metals.load("lead")


def noses(shape, size, edge_radius=0.3e-3, length=LENGTH):
    """Return a shape with its exact distance, and with that of the profile of its drawing in elements [m]."""
    exact = Projectile(shape=shape, radius=R, edge_radius=edge_radius, length=length).nose
    nose = 0.0 if shape == "flat" else R
    drawing = Turned(R, length, LEAD, nose_length=nose, element_size=size, edge_radius=edge_radius)
    own = exact._replace(kind=sdf_kernels.PROFILE, profile=profile_of(drawing))
    return exact, own


def places(low, high, count=400, seed=1):
    """Places about the axis, r and z between two bounds."""
    rng = np.random.default_rng(seed)
    r, z = rng.uniform(low, high, (count, 2)).T
    turn = rng.uniform(0, 2 * np.pi, count)
    return np.stack([r * np.cos(turn), r * np.sin(turn), z], axis=-1)


@pytest.mark.parametrize("size", [0.6e-3, 0.3e-3, 0.7e-3])
def test_the_profile_of_a_flat_is_exact(size):
    exact, own = noses("flat", size)
    checked = 0
    for point in places((0, -6e-3), (3.3e-3, 2e-4)):
        depth, normal = sdf_kernels.distance(exact, point)
        if -2.5e-4 < depth:
            found, along = sdf_kernels.distance(own, point)
            assert found == pytest.approx(depth, abs=1e-12)
            assert along == pytest.approx(normal, abs=1e-6)
            checked += 1
    assert checked > 50


def test_the_profile_of_a_hemisphere_is_of_second_order():
    off = []
    for size in (0.6e-3, 0.3e-3, 0.15e-3):
        exact, own = noses("hemisphere", size, edge_radius=0.1e-3)
        gaps = []
        for point in places((0, -6e-3), (3.1e-3, 2e-5)):
            depth, _ = sdf_kernels.distance(exact, point)
            if abs(depth) < 9e-5:
                gaps.append(abs(sdf_kernels.distance(own, point)[0] - depth))
        off.append(max(gaps))
    assert off[0] < 20e-6
    assert np.log2(off[0] / off[1]) == pytest.approx(2, abs=0.4)
    assert np.log2(off[1] / off[2]) == pytest.approx(2, abs=0.4)


@pytest.mark.parametrize("tip", [None, 1.5e-3])
def test_the_gradient_of_an_ogive_is_a_unit_vector_and_the_slope(tip):
    shot = Projectile(
        shape="ogive",
        radius=R,
        edge_radius=0.3e-3,
        length=14e-3,
        nose_length=6e-3,
        tip_diameter=tip,
        obliquity=0.3,
        azimuth=0.7,
    )
    step = 1e-8
    checked = 0
    for point in places((0, -16e-3), (3.5e-3, 1e-3)) @ shot.frame:
        depth, normal = shot.distance(point)
        # deeper down the nearest sides change, and with them the gradient jumps
        if not -0.1e-3 < depth:
            continue
        ways = step * np.eye(3)
        slope = [shot.distance(point + d)[0] - shot.distance(point - d)[0] for d in ways]
        if np.linalg.norm(slope) < 1.9 * step:
            continue  # across the line where two sides are as near
        assert np.linalg.norm(normal) == pytest.approx(1.0, abs=1e-12)
        assert np.array(slope) / (2 * step) == pytest.approx(normal, abs=2e-3)
        checked += 1
    assert checked > 100


@pytest.mark.parametrize(("tip", "nose"), [(None, 6e-3), (1.5e-3, 6e-3), (1.5e-3, 1.1e-3)])
def test_the_smallest_radius_of_an_ogive_is_that_of_its_ellipse(tip, nose):
    """Circles through three points beside each other on the ellipse, which begins at the edge of a flat tip."""
    shot = Projectile(
        shape="ogive",
        radius=R,
        edge_radius=0.1e-3,
        length=14e-3,
        nose_length=nose,
        tip_diameter=tip,
    )
    angle = np.linspace(-0.1, 0.5 * np.pi + 0.1, 4001)
    points = np.column_stack([(R - 0.5 * (tip or 0.0)) * np.sin(angle), nose * np.cos(angle)])
    first, second, third = points[:-2], points[1:-1], points[2:]
    a, b, c = (np.linalg.norm(d, axis=1) for d in (second - first, third - second, first - third))
    area = 0.5 * np.abs(np.cross(second - first, third - first))
    assert shot.nose_radius == pytest.approx((a * b * c / (4 * area)).min(), rel=1e-3)


def test_an_ogive_is_as_deep_as_its_ellipse():
    shot = Projectile(shape="ogive", radius=R, edge_radius=0.1e-3, length=14e-3, nose_length=6e-3)
    assert shot.shoulder == 6e-3
    for share in (0.2, 0.5, 0.8):
        r = R * np.sin(0.5 * np.pi * share)
        z = 6e-3 * (np.cos(0.5 * np.pi * share) - 1)
        assert shot.distance(np.array([r, 0, z]))[0] == pytest.approx(0.0, abs=25e-6)
    assert shot.distance(np.array([R, 0, -9e-3]))[0] == pytest.approx(0.0, abs=1e-9)
    assert shot.distance(np.array([1e-3, 0, -14e-3]))[0] == pytest.approx(0.0, abs=1e-9)


@entry()
def give_and_see(profile, point, force, radius):
    """Give a force to the profile at a point; the velocity of the foot there."""
    x, y, z = point
    side, share, _, _, _ = profile_kernels.foot_on_profile(profile, np.sqrt(x * x + y * y), z)
    profile_kernels.push_profile(profile, point, (side, share), force)
    return profile_kernels.profile_velocity(profile, point, (side, share))


def test_what_a_point_gives_the_rings_take_with_the_same_power():
    """Force times the velocity of the foot is what `profile_power` sums over the rings."""
    drawing = Turned(R, 12e-3, LEAD, nose_length=5e-3, element_size=0.6e-3)
    row = body.make_row(drawing)
    row.x[:] += np.random.default_rng(2).normal(0, 2e-6, row.x.shape) * (row.x[:, :1] > 0)
    motion_kernels.show_outline(row, drawing.edge_radius, 1e-7)
    assert abs(row.profile.velocity).max() > 1.0
    power = 0.0
    pushed = 0.0
    for point in places((1e-4, -3e-3), (3e-3, -1e-3), count=30):
        force = (2.0 * point[0] / R, 2.0 * point[1] / R, -3.0)
        velocity = give_and_see(row.profile, tuple(point), force, drawing.edge_radius)
        power += np.dot(force, velocity)
        pushed += force[2]
    assert profile_kernels.profile_power(row.profile) == pytest.approx(power, rel=1e-12)
    assert row.profile.force[:, 1].sum() == pytest.approx(pushed, rel=1e-12)
    assert np.array_equal(row.ring_force[0], row.profile.force)
