"""Look at a mesh or a panel: in a window, or as a picture where there is no screen."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fabrics.errors import InputError
from fabrics.files import replace_whole
from meshing.pictures_style import INK, WARP, WEFT, tension_map
from weavecell.report.pictures3d import new_plotter
from weavecell.results.paraview import read_series

_ALLOWED = "a folder that holds panel.pvd or crossover.vtu, or a .pvd or .vtu file"


def view(path: Path, screenshot: Path | None = None) -> None:
    """Open a window on `path`, or write a PNG to `screenshot`.

    Raises
    ------
    InputError : there is nothing at `path` that can be shown, or the picture is not named .png
    """
    if screenshot is not None and screenshot.suffix != ".png":
        raise InputError(key="--screenshot", value=str(screenshot), allowed="a file named *.png")
    file = find(path)
    plotter = new_plotter(off_screen=screenshot is not None, size=(1400, 900))
    _add(plotter, file)
    if screenshot is None:
        plotter.show(title=f"weavecell: {file}")
        return
    with replace_whole(screenshot) as beside:
        plotter.screenshot(beside)
    plotter.close()


def find(path: Path) -> Path:
    """The .vtu file to show for a path: of a series the last one."""
    path = Path(path)
    if path.is_dir():
        for name in ("panel.pvd", "crossover.vtu"):
            if (path / name).exists():
                return find(path / name)
    elif path.suffix == ".pvd" and path.exists():
        series = read_series(path)
        if series:
            return series[-1][0]
    elif path.suffix == ".vtu" and path.exists():
        return path
    raise InputError(key="PATH", value=str(path), allowed=_ALLOWED)


def _add(plotter, file):
    import pyvista

    grid = pyvista.read(file)
    grid.points *= 1e3
    text = f"{file.name}, lengths in mm"
    if "tension_warp_N" in grid.cell_data:
        tension = np.maximum(grid.cell_data["tension_warp_N"], grid.cell_data["tension_weft_N"])
        grid.cell_data["tension"] = tension
        part = grid.extract_cells(np.flatnonzero(np.asarray(grid.cell_data["failed_yarns"]) < 2))
        plotter.add_mesh(part, scalars="tension", cmap=tension_map(), clim=(0, tension.max()), show_scalar_bar=False)
        # in words: VTK's own scale of colours ends a process that has loaded dolfinx 0.5.2 too (std::bad_alloc)
        text += f"\nyarn tension, the higher of warp and weft: 0 (light) to {tension.max():.0f} N (dark)"
    else:
        plotter.add_mesh(
            grid, scalars="yarn" if "yarn" in grid.cell_data else None, cmap=[WARP, WEFT], show_edges=True,
            edge_color=INK, show_scalar_bar=False,
        )  # fmt: skip
    plotter.camera_position = "iso"
    plotter.add_axes(color=INK)
    plotter.add_text(text, position="upper_left", font_size=11, color=INK)
