"""A panel in motion as a ParaView series: one .vtu a snapshot, and a .pvd that lists them with their times."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from fabrics.checks import FilePath
from fabrics.files import replace_whole, write_whole

if TYPE_CHECKING:
    from weavecell.results.impact_base import Shape


def write_panel(out: Path, shapes: Iterable[Shape], quads: np.ndarray) -> None:
    """Write a panel's shapes as panel.pvd and panel/*.vtu in the folder `out`.

    Parameters
    ----------
    shapes : sequence of `results.impact_base.Shape`
    quads : (m, 4) node numbers, in order round the cell
    """
    times = {}
    for number, shape in enumerate(shapes):
        grid = panel_grid(shape.nodes, quads)
        grid.cell_data["tension_warp_N"], grid.cell_data["tension_weft_N"] = shape.tension[:, 0], shape.tension[:, 1]
        grid.cell_data["failed_yarns"] = failed_yarns(shape.failed)
        grid.field_data["projectile_z_m"] = [shape.nose_position]
        name = f"panel/panel-{number:04d}.vtu"
        with replace_whole(out / name) as beside:
            grid.save(beside)
        times[name] = shape.t
    write_series(out / "panel.pvd", times)


def failed_yarns(broken: np.ndarray) -> np.ndarray:
    """(m,) how many yarns of each element have failed, 0 to 2; an eroded element has lost both.

    Parameters
    ----------
    broken : (m, 3) bool: warp failed, weft failed, element eroded
    """
    return np.where(broken[:, 2], 2, broken[:, :2].sum(axis=1)).astype(np.int8)


def panel_grid(nodes: ArrayLike, quads: ArrayLike) -> Any:
    """The panel as a pyvista grid of quadrilaterals."""
    import pyvista

    return pyvista.UnstructuredGrid({pyvista.CellType.QUAD: np.asarray(quads)}, np.asarray(nodes, float))


def write_series(path: FilePath, times: Mapping[str, float]) -> None:
    """Write the .pvd.

    Parameters
    ----------
    times : {name of a file beside the .pvd: time [s]}
    """
    sets = "\n".join(f'    <DataSet timestep="{time:.9e}" file="{name}"/>' for name, time in times.items())
    with write_whole(path) as file:
        file.write(
            '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n'
            f"  <Collection>\n{sets}\n  </Collection>\n</VTKFile>\n"
        )


def read_series(path: FilePath) -> list[tuple[Path, float]]:
    """The files of a .pvd with their times, as [(path, time [s])]."""
    from xml.etree import ElementTree

    path = Path(path)
    return [
        (path.parent / entry.attrib["file"], float(entry.attrib["timestep"]))
        for entry in ElementTree.parse(path).iter("DataSet")
    ]
