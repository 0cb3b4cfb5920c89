"""Pictures of meshes and panels, drawn off screen by pyvista."""

from __future__ import annotations

import io
import os

import numpy as np

from weavecell.paraview import panel_grid
from weavecell.style import INK, RED

_MAP = "viridis"


def off_screen(size=(1500, 820)):
    """A plotter without a window, white, with even light."""
    if not os.environ.get("DISPLAY"):
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkOSOpenGLRenderWindow")
    import pyvista

    plotter = pyvista.Plotter(off_screen=True, window_size=size)
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    return plotter


def png(plotter):
    """The plotter's picture as PNG bytes, cropped to what is drawn."""
    from PIL import Image, ImageChops

    shot = Image.fromarray(plotter.screenshot(return_img=True))
    plotter.close()
    box = ImageChops.difference(shot, Image.new(shot.mode, shot.size, "white")).getbbox()
    if box:
        margin = 18
        shot = shot.crop((max(box[0] - margin, 0), max(box[1] - margin, 0), box[2] + margin, box[3] + margin))
    content = io.BytesIO()
    shot.save(content, format="PNG", optimize=True)
    return content.getvalue()


def add_panel(plotter, nodes, quads, share, failed, shot, quarter):
    """Draw a deformed panel: tension in colour, failed yarns in red, cells without any yarn left out.

    Parameters
    ----------
    nodes : (n, 3) [m]
    quads : (m, 4)
    share : (m,) the higher of the two yarn tensions over its strength [-]
    failed : (m,) how many of the two yarns have failed, 0 to 2
    shot : (radius, height, z of the face) of the projectile [m]
    quarter : whether the panel is the quarter x >= 0, y >= 0 of what is drawn
    """
    import pyvista

    grid = panel_grid(1e3 * nodes, quads)
    grid.cell_data["tension"] = np.asarray(share, float)
    grid.cell_data["failed"] = np.asarray(failed)
    parts = [grid]
    if quarter:
        parts += [grid.reflect((1, 0, 0)), grid.reflect((0, 1, 0)), grid.reflect((1, 0, 0)).reflect((0, 1, 0))]
    bar = {
        "title": "yarn tension / strength", "vertical": False, "position_x": 0.3, "position_y": 0.02, "width": 0.4,
        "height": 0.07, "title_font_size": 26, "label_font_size": 24, "color": INK, "fmt": "%.1f", "n_labels": 6,
    }  # fmt: skip
    for part in parts:
        whole = part.extract_cells(np.flatnonzero(part.cell_data["failed"] == 0))
        torn = part.extract_cells(np.flatnonzero(part.cell_data["failed"] == 1))
        plotter.add_mesh(
            whole, scalars="tension", cmap=_MAP, clim=(0, 1), show_edges=False, scalar_bar_args=bar, ambient=0.35,
            diffuse=0.75, specular=0.1,
        )  # fmt: skip
        if torn.n_cells:
            plotter.add_mesh(torn, color=RED, ambient=0.5)
    radius, height, face = (1e3 * value for value in shot)
    body = pyvista.Cylinder(
        center=(0, 0, face - height / 2), direction=(0, 0, 1), radius=radius, height=height, resolution=60
    )
    plotter.add_mesh(body, color="#7c8794", ambient=0.3, specular=0.4, smooth_shading=False)
