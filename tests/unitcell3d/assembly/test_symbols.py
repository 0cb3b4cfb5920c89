"""dolfinx beside VTK in one process."""

import pytest

from tests.programs import printed

pytest.importorskip("pyvista")

# symbols of libraries that a process shows to all others are found without naming a library
CODE = """
import ctypes, sys
flags = sys.getdlopenflags()
from unitcell3d.assembly import compat
assert sys.getdlopenflags() == flags
assert not hasattr(ctypes.CDLL(None), "PetscInitialize")

import pyvista
scene, ball = pyvista.Plotter(off_screen=True, window_size=(300, 200)), pyvista.Sphere()
scene.add_mesh(ball, scalars=ball.points[:, 2], scalar_bar_args={"fmt": "%.2f"})
scene.enable_ssao()
scene.screenshot(sys.argv[1])
"""


def test_vtk_draws_a_scale_of_colours_and_shadows_in_a_process_that_has_loaded_dolfinx(tmp_path):
    picture = tmp_path / "a.png"
    printed(CODE, picture)
    assert picture.stat().st_size > 1000
