"""Pictures of panels: what is near covers what is far, where it lies and in its colour."""

import numpy as np
import pytest

from weavecell.report import pictures3d
from weavecell.results import vtk

STRENGTH = np.array([1.0, 1.0])
FAR_BODY = np.full((2, 2, 3), -1.0)


def square(x, y, z, half):
    return np.array(
        [
            [x - half, y - half, z],
            [x + half, y - half, z],
            [x + half, y + half, z],
            [x - half, y + half, z],
        ]
    )


def picture(*squares, mirrors=(False, False)):
    """Squares of (corners, tension, number of failed yarns), as (rows, columns) of brightness."""
    corners, tension, failed = zip(*squares)
    grid = vtk.grid(np.concatenate(corners), np.arange(4 * len(corners)).reshape(-1, 4))
    grid.cell_data.update(
        {
            "tension_warp_N": tension,
            "tension_weft_N": np.zeros(len(corners)),
            "failed_yarns": failed,
        }
    )
    return pictures3d.panel(grid, STRENGTH, FAR_BODY, mirrors, 0.05).mean(axis=2)


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_the_nearer_covers_the_farther(order):
    squares = [(square(0, 0, 0, 0.02), 0.0, 0), (square(0, 0, 0.005, 0.01), 1.0, 0)]
    image = picture(*(squares[n] for n in order))
    rows, columns = (length // 2 for length in image.shape)
    assert image.shape == pictures3d.SIZE[::-1]
    # dark before light before white
    assert image[rows, columns] < 100 < image[rows, columns - 90] < 250
    assert image[5, 5] == 255


def test_x_goes_to_the_right_and_is_mirrored_and_what_has_failed_is_left_out():
    one = square(0.02, 0, 0, 0.01), 1.0, 0
    half = pictures3d.SIZE[0] // 2
    left, right = ((picture(one)[:, part] < 200).sum() for part in (slice(half), slice(half, None)))
    assert left == 0 < right
    assert (picture(one, mirrors=(True, False)) < 200).sum() == pytest.approx(2 * right, rel=0.02)
    assert np.all(
        picture((one[0], 1.0, 2), (square(0, 0, 0, 0.001), 0.0, 0))[:, half + 100 :] == 255
    )
