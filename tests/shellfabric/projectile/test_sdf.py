"""Signed distances of the projectile's shapes, against brute force: the nearest point of their drawn faces."""

from math import cos, radians, sin

import numpy as np
import pytest
from numpy.testing import assert_allclose

from shellfabric.projectile.projectile import Projectile
from shellfabric.projectile.shapes import SHAPES
from tests.stl_noses import distances

# an STL body has any shape, and an ogive a polygon for its meridian: `test_stl_noses`, `test_profile`
ANALYTIC = [shape for shape in SHAPES if shape not in ("stl", "ogive")]
R = 2.7e-3
RHO = 0.3e-3
TIP = 0.5e-3
LENGTH = 8e-3
FORMS = {
    "cone": {"half_angle": radians(35), "tip_radius": TIP},
    "chisel": {"flat_width": 2.54e-3, "flat_angle": radians(35)},
}
END = 14e-3  # of the drawn faces of a body without an end


def body(shape, **changes):
    return Projectile(1e-3, R, RHO, shape, **(FORMS.get(shape, {}) | changes))


def turned(r, z):
    """A face from an outline r(s), z(s), turned about the axis."""
    return lambda s, t: (r(s) * np.cos(around(t)), r(s) * np.sin(around(t)), z(s) + 0 * t)


def around(t):
    """An angle that overlaps its beginning, so that the nearest point lies within."""
    return 2.5 * np.pi * t - 0.41


def arc(centre_r, centre_z, radius, low, high):
    """Outline of an arc; the angle counts from the plane z = 0 to the axis."""
    return turned(
        lambda s: centre_r + radius * np.cos(low + s * (high - low)),
        lambda s: centre_z + radius * np.sin(low + s * (high - low)),
    )


def line(start, end):
    return turned(
        lambda s: start[0] + s * (end[0] - start[0]), lambda s: start[1] + s * (end[1] - start[1])
    )


def cone_nose():
    """Rounded tip, flank, shoulder. The flank's ends are where the two circles have their common tangent."""
    angle = FORMS["cone"]["half_angle"]
    joint = np.array([TIP * cos(angle), -TIP + TIP * sin(angle)])
    along = np.array([sin(angle), -cos(angle)])
    shoulder = joint + (R - RHO * (1 - cos(angle)) - joint[0]) / sin(angle) * along
    centre = shoulder - RHO * np.array([cos(angle), sin(angle)])
    return [arc(0, -TIP, TIP, angle, np.pi / 2), line(joint, shoulder), arc(*centre, RHO, 0, angle)]


def chisel_faces(end):
    """Faces of the sharp chisel that a ball of radius RHO rolls round: strip, two flats, side."""
    slope = FORMS["chisel"]["flat_angle"]
    radius = R - RHO
    # where planes set back by RHO from strip and flat meet
    half = 0.5 * FORMS["chisel"]["flat_width"] - RHO * (1 - cos(slope)) / sin(slope)

    def top(x):
        return -RHO - np.maximum(abs(x) - half, 0) * np.tan(slope)

    def across(x, t):
        return x, (2 * t - 1) * np.sqrt(np.maximum(radius**2 - x**2, 0)), top(x)

    return [
        lambda s, t: across((2 * s - 1) * half + 0 * t, t),
        lambda s, t: across(half + s * (radius - half) + 0 * t, t),
        lambda s, t: across(-half - s * (radius - half) + 0 * t, t),
        lambda s, t: (
            radius * np.cos(around(t)) + 0 * s,
            radius * np.sin(around(t)) + 0 * s,
            top(radius * np.cos(around(t))) * (1 - s) - s * (end - RHO),
        ),
    ]


def faces(shape, length):
    """(drawn faces, how far the body reaches beyond them)."""
    end = length or END
    if shape == "chisel":
        return chisel_faces(end) + (
            [line((0, RHO - end), (R - RHO, RHO - end))] if length else []
        ), RHO
    if shape == "sphere":
        return [arc(0, -R, R, -np.pi / 2, np.pi / 2)], 0.0
    nose = {
        "flat": [line((0, 0), (R - RHO, 0)), arc(R - RHO, -RHO, RHO, 0, np.pi / 2)],
        "hemisphere": [arc(0, -R, R, 0, np.pi / 2)],
        "cone": cone_nose(),
    }[shape]
    side = line((R, -body(shape).shoulder), (R, RHO - end if length else -end))
    rear = [arc(R - RHO, RHO - end, RHO, -np.pi / 2, 0), line((0, -end), (R - RHO, -end))]
    return [*nose, side] + (rear if length else []), 0.0


def nearest(face, point):
    """Distance from a point to a face, by a grid that closes in on the nearest of its points."""
    low = np.zeros(2)
    high = np.ones(2)
    best = None
    for _ in range(9):
        s, t = np.meshgrid(
            np.linspace(low[0], high[0], 61), np.linspace(low[1], high[1], 61), indexing="ij"
        )
        gap = sum((x - p) ** 2 for x, p in zip(face(s, t), point))
        k = np.unravel_index(np.argmin(gap), gap.shape)
        best = gap[k]
        centre = np.array([s[k], t[k]])
        reach = 4 * (high - low) / 60
        low = np.maximum(centre - reach, 0)
        high = np.minimum(centre + reach, 1)
    return np.sqrt(best)


def points(shape, count, seed=0, length=None):
    """Points about the nose, or about the rear end, within and without."""
    rng = np.random.default_rng(seed)
    middle = -0.5 * length if length else -0.5 * R
    spread = 0.5 * length + R if length else 1.6 * R
    return np.column_stack(
        [rng.uniform(-1.1 * R, 1.1 * R, (count, 2)), middle + spread * rng.uniform(-1, 1, count)]
    )


@pytest.mark.parametrize(
    "shape, length",
    [(one, None) for one in ANALYTIC] + [("flat", LENGTH), ("cone", LENGTH), ("chisel", LENGTH)],
)
def test_distance_is_that_of_the_nearest_point(shape, length):
    shot = body(shape, length=length)
    drawn, beyond = faces(shape, length)
    inside = 0
    for point in points(shape, 48, length=length):
        depth, _ = shot.distance(point)
        inside += depth < 0
        gap = min(nearest(face, point) for face in drawn)
        # beyond K the body is a ball's radius away; within, its boundary is that much further than K's
        expected = {True: gap - beyond, False: -gap - beyond}[depth > -beyond]
        assert depth == pytest.approx(expected, abs=2e-9), point
    assert 6 < inside < 44


@pytest.mark.parametrize("shape", ANALYTIC)
def test_gradient_is_a_unit_vector_and_the_slope(shape):
    shot = body(shape, obliquity=0.4, azimuth=0.7, roll=0.3, length=None)
    step = 1e-8
    checked = 0
    for point in points(shape, 400, seed=1):
        depth, normal = shot.distance(point)
        if depth < -0.5 * RHO:  # deeper down nearest faces change, and with them the gradient jumps
            continue
        checked += 1
        assert np.linalg.norm(normal) == pytest.approx(1.0, abs=1e-12)
        slope = [
            (shot.distance(point + d)[0] - shot.distance(point - d)[0]) / (2 * step)
            for d in step * np.eye(3)
        ]
        assert_allclose(normal, slope, atol=1e-4, err_msg=f"{point}")
    assert checked > 100


@pytest.mark.parametrize("shape", ANALYTIC)
def test_shoulder_is_where_the_body_is_as_wide_as_it_gets(shape):
    shot = body(shape)
    for x in ((R, 0, -shot.shoulder - 1e-9), (R + 1e-6, 0, -shot.shoulder)):
        assert shot.distance(np.array(x))[0] == pytest.approx(x[0] - R, abs=1e-9)
    assert shot.distance(np.array([R, 0, 1e-4 - shot.shoulder]))[0] > 1e-7


@pytest.mark.parametrize("shape", ANALYTIC)
@pytest.mark.parametrize("obliquity", [0.0, 0.2, 0.8])
def test_a_shot_starts_where_it_just_touches_the_panel(shape, obliquity):
    shot = body(shape, obliquity=obliquity, azimuth=0.6, yaw=-0.1, roll=0.2)
    X, Y = np.meshgrid(*2 * [np.linspace(-3 * R, 3 * R, 121)])
    start = shot.start()
    places = np.column_stack([X.ravel(), Y.ravel(), np.zeros(X.size)]) - start
    gaps, _ = distances(shot, places)
    assert gaps[7777] == pytest.approx(shot.distance(places[7777])[0], abs=1e-15)
    assert min(gaps) > -1e-9  # what the kernels push at is no more than a nanometre
    assert min(gaps) < 0.02 * R
    # its line of flight goes to the origin
    middle = start - R * shot.frame[2]
    assert np.linalg.norm(np.cross(middle, shot.flight)) < 1e-15
    assert shot.frame @ shot.frame.T == pytest.approx(np.eye(3), abs=1e-15)


def test_mirror_planes():
    assert body("flat").mirrored(0)
    assert body("chisel").mirrored(0)
    assert body("chisel", roll=np.pi / 2).mirrored(1)
    assert not body("chisel", roll=0.3).mirrored(0)
    along_warp = body("cone", obliquity=0.3)
    along_weft = body("cone", obliquity=0.3, azimuth=np.pi / 2)
    assert not along_warp.mirrored(0)
    assert along_warp.mirrored(1)
    assert along_weft.mirrored(0)
    assert not along_weft.mirrored(1)
