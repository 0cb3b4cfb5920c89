"""Pictures of a crossover, of a patch and of the quality: one file, of its size, with both yarns in it."""

import numpy as np
import pytest

pytest.importorskip("pyvista")

import pyvista

from fabrics import catalogue
from meshing import crossover, patch
from weavecell.report import pictures_mesh, pictures_patch, pictures_quality

SINE = {"size": (5, 4, 2), "section": "sine"}


def in_shades_of(pixels, colour):
    """Share of the pixels that are the colour, or the colour in less light."""
    target = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)], float)
    image = pixels.reshape(-1, 3)
    light = np.clip(image @ target / (target @ target), 0.4, 1.1)
    return np.mean(np.linalg.norm(image - light[:, None] * target, axis=1) < 20)


@pytest.mark.parametrize(
    ("draw", "size", "build", "choices", "ink"),
    [
        (pictures_mesh.picture, pictures_mesh.WINDOW, crossover.build, SINE, 0.05),
        (
            pictures_mesh.picture,
            pictures_mesh.WINDOW,
            crossover.build,
            SINE | {"domain": "whole"},
            0.05,
        ),
        (
            pictures_patch.picture,
            (1600, 900),
            patch.build,
            {"count": (2, 3), "size": (4, 3, 1)},
            0.05,
        ),
        (pictures_quality.picture, None, patch.build, {"count": (2, 2), "size": (4, 3, 1)}, 0.02),
    ],
)
def test_both_yarns_are_drawn_inside_the_frame(draw, size, build, choices, ink, tmp_path):
    path = tmp_path / "a.png"
    draw(build(catalogue.load("S-731"), **choices), path)
    assert list(tmp_path.iterdir()) == [path]
    image = pyvista.read(path)
    width, height, _ = image.dimensions
    pixels = np.asarray(image.active_scalars, float)[:, :3].reshape(height, width, 3)
    drawn = np.any(pixels < 240, axis=2)
    assert not drawn[[0, -1]].any()
    assert not drawn[:, [0, -1]].any()
    if size is None:  # the mesh on the left, bars of the yarns on the right
        assert drawn[height // 4 :, : width // 2].mean() > 0.2
        pixels = pixels[:, width * 2 // 3 :]
    else:
        assert (width, height) == size
    assert all(in_shades_of(pixels, colour) > ink for colour in pictures_mesh.COLOURS.values())
    if build is patch.build and size is not None:
        across, down = np.flatnonzero(drawn.any(axis=0)), np.flatnonzero(drawn.any(axis=1))
        filled = max(np.ptp(across) / width, np.ptp(down) / height)
        assert filled == pytest.approx(0.94, abs=0.02)
