"""A ParaView series as one temporal VTKHDF file (format 2.0 of VTK): all instants, the elements once.

An array that an instant has in common with the one before, such as the areas of the nodes, is stored once for both.
"""

from __future__ import annotations

from collections import defaultdict
from typing import Any

import numpy as np

from fabrics.checks import FilePath
from fabrics.errors import InputError
from fabrics.files import write_hdf5
from weavecell.results.hdf5_file import PACKED
from weavecell.results.paraview import QUAD, read_series

FORMAT = "weavecell vtkhdf 1"  # and version of what the files hold
_CHUNK = 1 << 16  # rows


def write(path: FilePath, source: FilePath) -> None:
    """Write the grids of a series, whole or not at all.

    Parameters
    ----------
    path : of the file, *.vtkhdf
    source : panel.pvd, as of `paraview.write_panel`

    Raises
    ------
    InputError : no series, a file of it that is missing, no quadrilaterals, or other elements than in the first file
    """
    import pyvista

    series = read_series(source)
    if not series:
        raise InputError("lists no files", file=source)
    with write_hdf5(path, FORMAT) as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"], root.attrs["Type"] = (2, 0), np.bytes_("UnstructuredGrid")
        columns, times, first = _Columns(root), [], None
        for name, time in series:
            if not name.is_file():
                raise InputError("is missing, which the series lists", file=name)
            grid: Any = pyvista.read(name)
            if first is None:
                if not grid.n_cells or np.any(grid.celltypes != QUAD):
                    raise InputError("holds no quadrilaterals, of which a panel is", file=name)
                first = grid
                _write_cells(root, grid)
            elif not np.array_equal(grid.cells, first.cells):
                raise InputError("has other elements than the first file of the series", file=name)
            columns.append("Points", grid.points)
            for group, arrays in (("Point", grid.point_data), ("Cell", grid.cell_data), ("Field", grid.field_data)):
                for key, values in arrays.items():
                    columns.append(f"{group}Data/{key}", np.asarray(values))
            times.append(time)
        _write_steps(root, times, columns.offsets)


class _Columns:
    """Arrays of a group that grow by the rows of each instant; `offsets`: {name: [first row of each instant]}."""

    def __init__(self, root):
        self.root, self.offsets, self.last = root, defaultdict(list), {}

    def append(self, name, values):
        """Add the rows of an instant, or refer to those of the instant before where they are the same."""
        if name not in self.last:
            rows = (None, *values.shape[1:])
            chunk = (min(max(len(values), 1), _CHUNK), *values.shape[1:])
            self.root.create_dataset(name, data=values, maxshape=rows, chunks=chunk, **PACKED)
            self.offsets[name].append(0)
        elif np.array_equal(values, self.last[name]):
            self.offsets[name].append(self.offsets[name][-1])
        else:
            data = self.root[name]
            self.offsets[name].append(len(data))
            data.resize(len(data) + len(values), axis=0)
            data[-len(values) :] = values
        self.last[name] = values.copy()


def _write_cells(root, grid):
    """The elements, quadrilaterals: one part, which all instants share."""
    quads = grid.cells.reshape(-1, 5)[:, 1:].astype(np.int64)
    for name, count in (("Points", grid.n_points), ("Cells", grid.n_cells), ("ConnectivityIds", quads.size)):
        root[f"NumberOf{name}"] = np.array([count], np.int64)
    root.create_dataset("Connectivity", data=quads.ravel(), **PACKED)
    root.create_dataset("Offsets", data=np.arange(0, quads.size + 1, 4), **PACKED)
    root.create_dataset("Types", data=grid.celltypes.astype(np.uint8), **PACKED)


def _write_steps(root, times, offsets):
    """The times, and where the arrays of each instant begin."""
    steps, none = root.create_group("Steps"), np.zeros(len(times), np.int64)
    steps.attrs["NSteps"] = len(times)
    steps["Values"], steps["NumberOfParts"] = np.array(times), none + 1
    steps["PartOffsets"], steps["CellOffsets"], steps["ConnectivityIdOffsets"] = none, none[:, None], none[:, None]
    for name, rows in offsets.items():
        group, _, key = name.rpartition("/")
        steps[f"{group}Offsets/{key}" if group else "PointOffsets"] = np.array(rows, np.int64)
