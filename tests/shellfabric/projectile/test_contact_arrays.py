"""Constants, state and scratch of the contact: what is the same for any number of points, and the sizes."""

from types import SimpleNamespace

import numpy as np
import pytest

from shellfabric.jit.simd import WIDTH
from shellfabric.projectile import contact, contact_kernels

MASS, DT, PENALTY, DAMPING = 3e-8, 4e-7, 0.6, 0.5
POINTS = (1, 2, 3, 4, 8)


def made(points):
    return contact.constants(points, MASS, DT, PENALTY, DAMPING)


@pytest.mark.parametrize("points", POINTS)
@pytest.mark.parametrize("quadratic", [False, True])
def test_shape_functions_reproduce_a_plane(points, quadratic):
    """They sum to one and interpolate the places -1, 0, 1, 2 of the nodes to a point's own, (a + 1/2) / points."""
    found = made(points)["shape_functions"][int(quadratic), :, : points**2]
    at = (np.arange(points) + 0.5) / points
    nodes = np.array([-1.0, 0.0, 1.0, 2.0])
    for rows, place in ((found[:4], np.repeat(at, points)), (found[4:], np.tile(at, points))):
        np.testing.assert_allclose(rows.sum(0), 1.0, rtol=0, atol=1e-14)
        np.testing.assert_allclose(nodes @ rows, place, rtol=0, atol=1e-14)


@pytest.mark.parametrize("points", POINTS)
def test_shape_functions_fill_whole_vectors_with_nothing(points):
    found = made(points)["shape_functions"]
    assert found.shape[:2] == (2, 8)
    assert found.shape[2] % WIDTH == 0
    assert 0 <= found.shape[2] - points**2 < WIDTH
    assert not found[:, :, points**2 :].any()


@pytest.mark.parametrize("points", POINTS)
def test_an_element_is_as_stiff_and_heavy_whatever_its_points(points):
    found = made(points)
    stiffness, damping, mass = (points**2 * value for value in found["point_law"][:3])
    assert found["points_per_side"] == points
    assert found["point_law"].implicit_factor == 0
    assert mass == pytest.approx(MASS, rel=1e-14)
    assert stiffness == pytest.approx(PENALTY * MASS / DT**2, rel=1e-14)
    assert damping / (2 * np.sqrt(stiffness * mass)) == pytest.approx(DAMPING, rel=1e-14)  # of critical


@pytest.mark.parametrize(("friction", "shape"), [(0.0, (0, 0, 6)), (0.2, (12, 9, 6))])
def test_state_has_a_place_for_each_element_and_point(friction, shape):
    shares = made(3)["shape_functions"]
    state = contact.contact_state((2, 5, 1, 5), 3, shares, friction)
    assert state["last_contact_force"].shape == (3 * 4, shares.shape[2])
    assert state["in_contact"].shape == (12,)
    assert not state["in_contact"].any()
    assert state["friction_state"].shape == shape
    assert state["force_scale"].tolist() == [contact_kernels.MIN_FORCE_SCALE]
    for name in contact.PREDICTED:
        assert [part.shape for part in state[name]] == [(0,)] * 3


def test_scratch_has_room_for_the_widest_of_several_panels():
    """All nodes of an element row and one beyond each end; an element of n columns has n + 3 of them."""
    consts = [
        SimpleNamespace(window_limits=(0, 9, low, high), shape_functions=made(points)["shape_functions"])
        for low, high, points in ((4, 11, 3), (0, 5, 8))
    ]
    scratch = contact.scratch(*consts)
    assert scratch.node_rows.shape == (4, 3, 7 + 3)
    assert scratch.box_low.shape == scratch.box_high.shape == (3, 7 + 3)
    assert scratch.torn_shape_functions.shape == (8, 64)
    assert scratch.point_data.shape == (13, WIDTH)
    assert scratch.node_position.shape == scratch.node_velocity.shape == (16, 3)
    assert scratch.node_dv.shape == (2, 16, 3)
    assert scratch.node_force.shape == (3, 16)
    assert not any(part.any() for part in scratch)
