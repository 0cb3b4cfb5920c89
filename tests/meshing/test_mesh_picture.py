"""The picture of a crossover: there, of its size, with both yarns and ink in it."""

import numpy as np
import pytest

from fabrics import catalogue
from meshing.crossover import build

pyvista = pytest.importorskip("pyvista")


def in_shades_of(image, colour):
    """Share of the pixels (n, 3) that are the colour, or the colour in less light."""
    target = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)], float)
    light = np.clip(image @ target / (target @ target), 0.4, 1.1)
    return np.mean(np.linalg.norm(image - light[:, None] * target, axis=1) < 20)


@pytest.mark.parametrize("domain", ["quarter", "whole"])
def test_picture_shows_both_yarns_inside_its_frame(domain, tmp_path):
    from meshing.pictures import COLOURS, WINDOW, picture

    path = tmp_path / "crossover.png"
    picture(build(catalogue.load("S-731"), size=(5, 4, 2), domain=domain, section="sine"), path)
    image = np.asarray(pyvista.read(path).active_scalars, float)[:, :3]
    assert len(image) == WINDOW[0] * WINDOW[1]
    for colour in COLOURS.values():
        assert in_shades_of(image, colour) > 0.05
    frame = image.reshape(WINDOW[1], WINDOW[0], 3)
    for edge in (frame[:5], frame[-5:], frame[:, :5], frame[:, -5:]):
        assert np.all(edge > 250)
    assert list(tmp_path.iterdir()) == [path]


def test_picture_of_a_patch_fills_its_frame_with_both_yarns(tmp_path):
    from meshing import patch, pictures_patch
    from meshing.pictures import COLOURS

    path = tmp_path / "patch.png"
    pictures_patch.picture(patch.build(catalogue.load("S-720"), (2, 3), size=(4, 3, 1)), path)
    width, height = pictures_patch.WINDOW
    image = np.asarray(pyvista.read(path).active_scalars, float)[:, :3]
    assert (width, height) == (1600, 900)
    assert len(image) == width * height
    for colour in COLOURS.values():
        assert in_shades_of(image, colour) > 0.05
    ink = np.any(image.reshape(height, width, 3) < 240, axis=2)
    across, down = np.flatnonzero(ink.any(axis=0)), np.flatnonzero(ink.any(axis=1))
    assert max(np.ptp(across) / width, np.ptp(down) / height) == pytest.approx(pictures_patch.FILL, abs=0.02)
    assert not ink[[0, -1]].any()
    assert not ink[:, [0, -1]].any()


def test_picture_of_the_quality_shows_the_yarns_and_their_shares(tmp_path):
    from meshing import patch, pictures_quality
    from meshing.pictures import COLOURS

    path = tmp_path / "quality.png"
    pictures_quality.picture(patch.build(catalogue.load("S-731"), (2, 2), size=(4, 3, 1)), path)
    image = pyvista.read(path)
    width, height, _ = image.dimensions
    pixels = np.asarray(image.active_scalars, float)[:, :3].reshape(height, width, 3)
    for colour in COLOURS.values():  # bars
        assert in_shades_of(pixels[:, width * 2 // 3 :].reshape(-1, 3), colour) > 0.02
    scene = pixels[height // 4 :, : width // 2].reshape(-1, 3)
    assert np.mean(np.any(scene < 240, axis=1)) > 0.2
    assert list(tmp_path.iterdir()) == [path]
