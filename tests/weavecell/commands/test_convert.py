"""`weavecell convert`: fields and times of panel.pvd in one VTKHDF file, histories with units as Parquet."""

import json
import shutil
import sys
from contextlib import redirect_stdout
from io import StringIO

import h5py
import numpy as np
import pytest
from test_impact import names

import weavecell as wc
from fabrics.files import write_hdf5
from tests.scene_text import every, impact_scene
from weavecell.cli import app
from weavecell.results import coupon
from weavecell.results.hdf5_file import put
from weavecell.results.impact import ImpactRecord
from weavecell.results.paraview import PRESSURES, read_series

pyvista = pytest.importorskip("pyvista")

RUN = every("8 us", "20 us") + 'outputs = ["paraview"]\n'
PLY = impact_scene("155 m/s", "45 mm", "30 us", run=RUN)
PACK = impact_scene("200 m/s", "45 mm", "24 us", fabric="S-728", panel="plies = 3", run=RUN)
SLIDING = impact_scene("130 m/s", "45 mm", "30 us", panel='crossovers = "sliding"\ncrossover_friction = 0.2', run=RUN)
SCENES = {"ply": PLY, "pack": PACK, "sliding": SLIDING}
SLIP = {"slip_warp_m", "slip_weft_m"}
OF_NODES = {"area_m2", "failed_segments_warp", "failed_segments_weft"}
OF_CELLS = {"tension_warp_N", "tension_weft_N", "failed_warp", "failed_weft", "failed_yarns", "ply"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The folder of a finished run of each scene."""
    made = {}

    def of(name):
        if name not in made:
            made[name] = tmp_path_factory.mktemp(name)
            (made[name] / f"{name}.toml").write_text(SCENES[name])
            with pytest.raises(SystemExit) as leaving, redirect_stdout(StringIO()):
                app.main(["impact", str(made[name] / f"{name}.toml"), "--out", str(made[name] / "run")])
            assert leaving.value.code == 0
        return made[name] / "run"

    return of


def instants(path):
    """(time, grid) of each instant of a VTKHDF file, read by VTK."""
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    key = reader.GetExecutive().TIME_STEPS()
    for time in reader.GetOutputInformation(0).Get(key):
        reader.UpdateTimeStep(time)
        yield time, pyvista.wrap(reader.GetOutput()).copy()


@pytest.mark.parametrize("name", SCENES)
def test_vtkhdf_and_pvd_have_equal_fields_and_times(command, folder, tmp_path, name):
    run = folder(name)
    assert command("convert", run, "--to", "vtkhdf", "--out", tmp_path / "a.vtkhdf")[:2] == (
        0, f"written to {tmp_path / 'a.vtkhdf'}\n",
    )  # fmt: skip
    series = pyvista.get_reader(run / "panel.pvd")
    found = list(instants(tmp_path / "a.vtkhdf"))
    assert [time for time, _ in found] == series.time_values
    assert len(found) >= 3
    for time, grid in found:
        assert grid.field_data.pop("Time").tolist() == [time]  # which the reader adds
        series.set_active_time_value(time)
        (expected,) = series.read()
        assert np.array_equal(grid.points, expected.points)
        assert np.array_equal(grid.cells, expected.cells)
        assert np.array_equal(grid.celltypes, expected.celltypes)
        for kind in ("point_data", "cell_data", "field_data"):
            one, other = getattr(grid, kind), getattr(expected, kind)
            assert set(one.keys()) == set(other.keys())
            for key in other:
                assert np.array_equal(one[key], other[key]), key
                assert one[key].dtype == other[key].dtype, key
    nodes = OF_NODES | set(PRESSURES[: 4 if name == "pack" else 1]) | (SLIP if name == "sliding" else set())
    assert set(grid.point_data.keys()) == nodes
    assert set(grid.cell_data.keys()) == OF_CELLS


@pytest.mark.parametrize("name", SCENES)
def test_fields_add_up_to_the_histories(folder, name):
    run = folder(name)
    record = ImpactRecord.read(run / "histories.h5")
    told = json.loads((run / "summary.json").read_text())
    whole = 2 ** (told["mirror_x"] + told["mirror_y"])
    for file, time in read_series(run / "panel.pvd"):
        grid = pyvista.read(file)
        (sample,) = np.flatnonzero(np.isclose(record.time, time, rtol=1e-9, atol=0))
        for ply in range(record.count):
            part = grid.extract_cells(grid.cell_data["ply"] == ply + 1)
            push = whole * np.dot(part["projectile_pressure_Pa"], part["area_m2"])
            assert push == pytest.approx(record.plies["push"][sample, ply], rel=1e-6, abs=1e-3)
            failed = whole * (part["failed_segments_warp"].sum() + part["failed_segments_weft"].sum())
            assert failed == pytest.approx(record.plies["failed_yarns"][sample, ply])
            assert np.any(part["failed_segments_warp"]) == np.any(part["failed_warp"])
    if name == "sliding":
        slip = max(np.abs(grid[key]).max() for key in SLIP)
        assert slip == told["pulled_out_length_m"] > 0


def test_elements_and_areas_are_stored_once(folder, tmp_path):
    path = wc.convert(folder("pack"), "vtkhdf", tmp_path / "a.vtkhdf")
    grid = pyvista.read(path)
    with h5py.File(path) as file:
        root = file["VTKHDF"]
        count = root["Steps"].attrs["NSteps"]
        assert root["Connectivity"].size == 4 * grid.n_cells
        assert len(root["PointData/area_m2"]) == grid.n_points
        assert len(root["CellData/ply"]) == grid.n_cells
        assert len(root["Points"]) == len(root["PointData/projectile_pressure_Pa"]) == count * grid.n_points


@pytest.mark.parametrize("name", ["ply", "pack"])
def test_parquet_has_the_histories_with_unit_and_meaning(folder, tmp_path, name):
    parquet = pytest.importorskip("pyarrow.parquet")
    record = ImpactRecord.read(folder(name) / "histories.h5")
    table = parquet.read_table(wc.convert(folder(name), "parquet", tmp_path / "a.parquet"))
    assert table.column_names[0] == "time_s"
    expected = {"time_s": record.time, "velocity_m_s": record.velocity, "contact_force_N": record.contact_force}
    expected |= {f"energy_{key}_J": values for key, values in record.energies.items()}
    expected |= {f"ply_{p + 1}_push_N": record.plies["push"][:, p] for p in range(record.count)}
    for key, values in expected.items():
        assert np.array_equal(table[key].to_numpy(), values), key
    for field in table.schema:
        unit, meaning = (field.metadata[key].decode() for key in (b"unit", b"meaning"))
        assert unit == "1" or field.name.endswith("_" + unit.replace("/", "_"))
        assert meaning
    assert table.schema.field("velocity_m_s").metadata[b"unit"] == b"m/s"
    assert table.schema.metadata[b"title"].decode() == record.title


def test_parquet_of_a_coupon_has_a_row_a_load_step(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    with write_hdf5(tmp_path / "histories.h5", coupon.FORMAT, title="a coupon") as file:
        put(file, "histories/shear angle", [0.0, 0.1], "rad")
        put(file, "histories/energy of the yarns", [0.0, 2.0], "J")
    table = parquet.read_table(wc.convert(tmp_path, "parquet"))
    assert table.to_pydict() == {"energy_of_the_yarns_J": [0.0, 2.0], "shear_angle_rad": [0.0, 0.1]}
    assert table.schema.field("shear_angle_rad").metadata[b"unit"] == b"rad"
    assert table.schema.field("energy_of_the_yarns_J").metadata[b"meaning"].startswith(b"strain energy")


def test_one_line_and_nothing_written_where_it_cannot_be(command, folder, tmp_path, monkeypatch):
    empty = tmp_path / "empty"
    empty.mkdir()
    for to, file in (("vtkhdf", "panel.pvd"), ("parquet", "histories.h5")):
        code, out, err = command("convert", empty, "--to", to)
        assert (code, out, err.count("\n")) == (2, "", 1)
        assert str(empty / file) in err
    code, _, err = command("convert", folder("ply"), "--to", "csv")
    assert code == 2
    assert "vtkhdf" in err
    code, _, err = command("convert", folder("ply"), "--to", "parquet", "--out", "a.csv")
    assert (code, err) == (2, "error: --out = 'a.csv': must be a file named *.parquet\n")
    (empty / "panel.pvd").write_text("not XML")
    code, _, err = command("convert", empty, "--to", "vtkhdf")
    assert (code, err.count("\n")) == (2, 1)
    assert f"{empty / 'panel.pvd'}: is not a readable ParaView series" in err
    (empty / "panel.pvd").write_text("<VTKFile/>")
    code, _, err = command("convert", empty, "--to", "vtkhdf")
    assert (code, err) == (2, f"error: {empty / 'panel.pvd'}: lists no files\n")
    (empty / "panel.pvd").unlink()
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    code, _, err = command("convert", folder("ply"), "--to", "parquet", "--out", tmp_path / "a.parquet")
    assert (code, err.count("\n")) == (2, 1)
    assert "pyarrow" in err
    assert names(tmp_path) == ["empty"]
    assert names(empty) == []


def test_a_series_that_lacks_a_file_leaves_nothing(folder, tmp_path):
    shutil.copytree(folder("ply"), tmp_path / "run")
    (lost, _), *_ = read_series(tmp_path / "run" / "panel.pvd")[1:]
    lost.unlink()
    before = names(tmp_path / "run")
    with pytest.raises(wc.InputError, match=f"{lost.name}.* is missing"):
        wc.convert(tmp_path / "run", "vtkhdf")
    assert names(tmp_path / "run") == before
