"""Look at a mesh or a panel: in a window, or as a picture where there is no screen."""

from __future__ import annotations

from pathlib import Path

from fabrics.errors import InputError
from fabrics.files import replace_whole
from weavecell.paraview import read_series
from weavecell.pictures3d import new_plotter
from weavecell.style import INK, WARP, WEFT, tension_map

_ALLOWED = "a folder that holds panel.pvd or crossover.vtu, or a .pvd or .vtu file"


def view(path, screenshot=None):
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


def find(path):
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
    bar = {"color": INK, "vertical": False, "title_font_size": 24, "label_font_size": 22, "fmt": "%.0f"}
    if "tension_warp_N" in grid.cell_data:
        grid.cell_data["yarn tension, the higher of warp and weft [N]"] = pyvista.pyvista_ndarray(
            grid.cell_data["tension_warp_N"]
        ).clip(min=grid.cell_data["tension_weft_N"])
        part = grid.threshold(1.5, scalars="failed_yarns", invert=True)
        plotter.add_mesh(
            part, scalars="yarn tension, the higher of warp and weft [N]", cmap=tension_map(), scalar_bar_args=bar
        )
        plotter.camera_position = "iso"
        plotter.camera.zoom(0.85)
    else:
        plotter.add_mesh(
            grid, scalars="yarn" if "yarn" in grid.cell_data else None, cmap=[WARP, WEFT], show_edges=True,
            edge_color=INK, show_scalar_bar=False,
        )  # fmt: skip
    plotter.add_axes(color=INK)
    plotter.add_text(f"{file.name} [mm]", position="upper_left", font_size=12, color=INK)
