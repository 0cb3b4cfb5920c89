"""Pictures of a calibration: made, not blank, and made in a process that has loaded dolfinx."""

import numpy as np
import pytest

pytest.importorskip("pyvista")
from matplotlib.image import imread

from unitcell3d.cases import biaxial_and_platens
from unitcell3d.identify.calibrate import calibrate
from unitcell3d.pictures import pictures3d, pictures_paths


def ink(path):
    """Share of the picture that is not white."""
    return float((imread(path)[..., :3] < 0.97).any(axis=-1).mean())


def test_plots_of_a_calibration(s720, tmp_path):
    found = calibrate(s720, size=(4, 3, 2), plates_size=(4, 3, 2), paths={"equibiaxial": (1, 1)})
    pictures_paths.tensions(found, s720, tmp_path / "tensions.png")
    pictures_paths.fit(found, tmp_path / "fit.png")
    assert ink(tmp_path / "tensions.png") > 0.01
    assert ink(tmp_path / "fit.png") > 0.01


def test_deformed_crossover(s720, tiny, tmp_path):
    """VTK's scalar bar would crash here: dolfinx is loaded."""
    history = biaxial_and_platens.biaxial(tiny, s720, (1, 1), max_displacement=6e-6)
    pictures3d.deformed(history, tiny, tmp_path / "deformed.png")
    image = imread(tmp_path / "deformed.png")[..., :3]
    assert ink(tmp_path / "deformed.png") > 0.3
    reds = (image[..., 0] > 0.8) & (image[..., 2] < 0.4)
    assert np.mean(reds) > 0.01  # the pressed spot
