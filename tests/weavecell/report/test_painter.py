"""Pictures of surfaces: what is near covers what is far, where it lies and in its colour."""

import numpy as np
import pytest

from weavecell.report.pictures_painter import Camera, paint

RED, BLUE = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
SIZE = (60, 40)
ABOVE = Camera((0.0, -1e-9, 10.0), (0.0, 0.0, 0.0), 2.0)  # along -z; x to the right, y to the top


def square(x, y, z, side):
    """Corners (4, 3) of a square about (x, y) at the height z."""
    a = 0.5 * side
    return np.array([[x - a, y - a, z], [x + a, y - a, z], [x + a, y + a, z], [x - a, y + a, z]])


def hue(image, row, column):
    """Which of red, green and blue is the largest in a pixel; None where it is white."""
    pixel = image[row, column]
    return None if np.all(pixel > 250) else int(np.argmax(pixel))


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_the_nearer_covers_the_farther(order):
    quads, colours = np.array([square(0, 0, 0, 2), square(0, 0, 1, 1)]), np.array([RED, BLUE])
    image = paint(quads[list(order)], colours[list(order)], ABOVE, SIZE)
    assert image.shape == (40, 60, 3)
    assert hue(image, 20, 30) == 2
    assert hue(image, 20, 22) == 0  # 8 pixels of 0.1 beside the centre: on the large one alone
    assert hue(image, 3, 3) is None


def test_one_that_counts_as_farther_is_covered():
    quads, colours = np.array([square(0, 0, 0, 2), square(0, 0, 1, 1)]), np.array([RED, BLUE])
    image = paint(quads, colours, ABOVE, SIZE, further=np.array([0.0, 1.5]))
    assert hue(image, 20, 30) == 0


def test_right_is_right_and_top_is_top():
    image = paint(np.array([square(1, 1, 0, 1), square(-1, -1, 0, 1)]), np.array([RED, BLUE]), ABOVE, SIZE)
    assert hue(image, 10, 40) == 0
    assert hue(image, 30, 20) == 2


def test_what_is_outside_is_left_out():
    assert np.all(paint(np.array([square(9, 9, 0, 1)]), np.array([RED]), ABOVE, SIZE) == 255)


def test_a_surface_turned_away_from_the_light_is_darker():
    turned = square(0, 0, 0, 1)
    turned[:2, 2] -= 2.0  # falls towards the bottom of the picture, away from the light
    flat, steep = (
        paint(np.array([one]), np.array([RED]), ABOVE, SIZE)[20, 30, 0] for one in (square(0, 0, 0, 1), turned)
    )
    assert steep < flat
