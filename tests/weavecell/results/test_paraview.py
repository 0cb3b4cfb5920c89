"""The .vtu files that are written here are read by VTK: the very numbers, types and cells."""

import numpy as np
import pytest

from weavecell.results import paraview

pyvista = pytest.importorskip("pyvista")


def test_vtk_reads_what_was_written(tmp_path):
    random = np.random.default_rng(1)
    nodes, quads = random.normal(size=(12, 3)), np.array([[0, 1, 4, 3], [1, 2, 5, 4], [6, 7, 10, 9]])
    tension, failed = random.normal(size=(3, 2)), np.array([[0, 0, 0], [1, 0, 0], [1, 1, 1]], bool)
    values = paraview.cell_values(tension, failed) | {"ply": np.array([1, 1, 2], np.int8)}
    pressure, segments = random.normal(size=(12, 4)).astype(np.float32), random.normal(size=(12, 2))
    at_nodes = paraview.node_values(pressure, random.normal(size=12), segments, np.empty((12, 0)))
    paraview.write_grid(tmp_path / "a.vtu", nodes, paraview.topology(quads), values, at_nodes, 0.25)
    grid = pyvista.read(tmp_path / "a.vtu")
    assert np.array_equal(grid.points, nodes)
    assert grid.points.dtype == float
    assert np.array_equal(grid.cells.reshape(-1, 5)[:, 1:], quads)
    assert set(grid.celltypes) == {pyvista.CellType.QUAD}
    assert np.array_equal(grid.cell_data["tension_weft_N"], tension[:, 1])
    assert grid.cell_data["failed_yarns"].tolist() == [0, 1, 2]
    assert grid.cell_data["failed_warp"].tolist() == [0, 1, 1]
    assert np.array_equal(grid.point_data["rear_pressure_Pa"], pressure[:, 2])
    assert grid.point_data["rear_pressure_Pa"].dtype == np.float32
    assert np.array_equal(grid.point_data["failed_segments_weft"], segments[:, 1])
    assert "slip_warp_m" not in grid.point_data
    assert grid.cell_data["ply"].tolist() == [1, 1, 2]
    assert grid.field_data["projectile_z_m"].tolist() == [0.25]
