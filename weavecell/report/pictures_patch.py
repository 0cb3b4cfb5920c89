"""A picture of a woven patch, drawn off screen: smooth yarns in two colours, lit from above one
corner."""

from __future__ import annotations

import sys

import numpy as np
import pyvista

from fabrics.base.checks import FilePath
from meshing.inputs import YARNS
from meshing.patch import Patch
from weavecell.report.pictures_mesh import COLOURS, INK, aim, plotter, save

WINDOW = (1600, 900)
# direction from the patch to the camera
TOWARD = (-0.8, -1.0, 0.72)
# share of the window's height
MARGIN = 0.03
# [deg] an edge sharper than this is drawn sharp
SHARP = 40.0
# with more hexahedra mesh lines only darken the picture
EDGES_UP_TO = 20_000


def picture(patch: Patch, path: FilePath) -> None:
    """Draw the patch as a PNG, 1600 x 900.

    Parameters
    ----------
    patch : Patch
    path : of the .png file, written whole or not at all
    """
    scene = plotter(WINDOW, lights="none")
    for family, name in enumerate(YARNS):
        skin = _skin(patch, family)
        scene.add_mesh(
            skin,
            color=COLOURS[name],
            smooth_shading=True,
            split_sharp_edges=True,
            feature_angle=SHARP,
            show_edges=len(patch.hexes) <= EDGES_UP_TO,
            edge_color=INK,
            edge_opacity=0.28,
            line_width=1.2,
            ambient=0.12,
            diffuse=0.95,
            specular=0.3,
            specular_power=18,
        )
    _light(scene)
    aim(scene, patch.points * 1e3, TOWARD, WINDOW, foot=0.0, margin=MARGIN)
    # VTK's shading in passes aborts a process that has loaded dolfinx 0.5.2
    if "dolfinx" not in sys.modules:
        # The bias grows with the depth of the scene: below its steps the shadows turn into bands.
        bias = 0.006 * scene.camera.parallel_scale
        scene.enable_ssao(radius=0.35, bias=bias, kernel_size=32, blur=True)
    save(scene, path)


def _skin(patch, family):
    """Outer faces of all yarns of a family, in millimetres; yarns share no nodes, so each is a body
    of its own."""
    yarns = [name for name, of in zip(patch.names, patch.families) if of == family]
    quads = np.concatenate(
        [q for name, q in patch.faces.items() if name.rsplit("_", 1)[0] in yarns]
    )
    cells = np.insert(quads, 0, 4, axis=1)
    return pyvista.PolyData(patch.points * 1e3, faces=cells.ravel()).clean()


def _light(scene):
    """A warm, low key light from the left: every arch has a bright and a dark flank. A cool fill
    from the right."""
    for position, colour, strength in (
        ((-4.0, 0.6, 2.2), "#fff1dd", 1.05),
        ((2.5, -4.0, 1.4), "#dce8ff", 0.62),
        ((0.0, 0.0, 5.0), "#ffffff", 0.16),
    ):
        scene.add_light(
            pyvista.Light(
                position=position, focal_point=(0, 0, 0), color=colour, intensity=strength
            )
        )
