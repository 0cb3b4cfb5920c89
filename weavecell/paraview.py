"""A panel in motion as a ParaView series: one .vtu a snapshot, and a .pvd that lists them with their times."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fabrics.files import replace_whole, write_whole


def write_panel(path, nodes, quads, cell_data, point_data=None):
    """Write one snapshot.

    Parameters
    ----------
    path : .vtu
    nodes : (n, 3) [m]
    quads : (m, 4) node numbers, in order round the cell
    cell_data, point_data : {name: (m,) or (n,) or (n, 3)}, units in the names
    """
    grid = panel_grid(nodes, quads)
    for name, values in cell_data.items():
        grid.cell_data[name] = np.asarray(values)
    for name, values in (point_data or {}).items():
        grid.point_data[name] = np.asarray(values)
    with replace_whole(path) as beside:
        grid.save(beside)


def panel_grid(nodes, quads):
    """The panel as a pyvista grid of quadrilaterals."""
    import pyvista

    return pyvista.UnstructuredGrid({pyvista.CellType.QUAD: np.asarray(quads)}, np.asarray(nodes, float))


def write_series(path, times):
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


def read_series(path):
    """The files of a .pvd with their times, as [(path, time [s])]."""
    from xml.etree import ElementTree

    path = Path(path)
    return [
        (path.parent / entry.get("file"), float(entry.get("timestep")))
        for entry in ElementTree.parse(path).iter("DataSet")
    ]
