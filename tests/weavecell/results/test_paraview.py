"""VTK reads the .vtu files: the very numbers, types and cells; their sums are those of histories.h5."""

import json

import numpy as np
import pytest

from tests.scene_text import every, impact_scene
from weavecell.results import paraview
from weavecell.results.impact import ImpactRecord

pyvista = pytest.importorskip("pyvista")

RUN = every("8 us", "20 us") + 'outputs = ["paraview"]\n'
SCENES = {
    "ply": impact_scene("155 m/s", "45 mm", "30 us", run=RUN),
    "pack": impact_scene("200 m/s", "45 mm", "24 us", fabric="S-728", panel="plies = 3", run=RUN),
    "sliding": impact_scene(
        "130 m/s", "45 mm", "30 us", panel='crossovers = "sliding"\ncrossover_friction = 0.2', run=RUN
    ),
}
SLIP = ("slip_warp_m", "slip_weft_m")


@pytest.mark.parametrize("name", SCENES)
def test_fields_add_up_to_the_histories(command, name, tmp_path):
    (tmp_path / "scene.toml").write_text(SCENES[name])
    assert command("impact", "scene.toml", "--out", "run")[0] == 0
    record = ImpactRecord.read(tmp_path / "run" / "histories.h5")
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    whole = 2 ** (summary["mirror_x"] + summary["mirror_y"])
    series = paraview.read_series(tmp_path / "run" / "panel.pvd")
    assert len(series) >= 3
    for file, time in series:
        grid = pyvista.read(file)
        (sample,) = np.flatnonzero(np.isclose(record.time, time, rtol=1e-9, atol=0))
        for ply in range(record.count):
            part = grid.extract_cells(grid.cell_data["ply"] == ply + 1)
            push = whole * np.dot(part["projectile_pressure_Pa"], part["area_m2"])
            assert push == pytest.approx(record.plies["push"][sample, ply], rel=1e-6, abs=1e-3)
            failed = whole * (part["failed_segments_warp"].sum() + part["failed_segments_weft"].sum())
            assert failed == pytest.approx(record.plies["failed_yarns"][sample, ply])
            assert np.any(part["failed_segments_warp"]) == np.any(part["failed_warp"])
    assert [key for key in paraview.PRESSURES if key in grid.point_data] == list(
        paraview.PRESSURES[: 4 if name == "pack" else 1]
    )
    assert [key in grid.point_data for key in SLIP] == 2 * [name == "sliding"]
    if name == "sliding":
        assert max(np.abs(grid[key]).max() for key in SLIP) == summary["pulled_out_length_m"] > 0


def test_what_is_no_series_is_one_line(command, tmp_path):
    (tmp_path / "panel.pvd").write_text("not XML")
    code, _, err = command("view", "panel.pvd", "--screenshot", "a.png")
    assert (code, err.count("\n")) == (2, 1)
    assert "panel.pvd: is not a readable ParaView series" in err


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
