"""What the files of a run hold: documented keys alone, fronts of the histories, and a ParaView series of their sums."""

import json
from dataclasses import is_dataclass
from fnmatch import fnmatchcase

import h5py
import numpy as np
import pytest
import pyvista
from numpy.testing import assert_array_equal, assert_equal

import weavecell as wc
from fabrics.base.errors import InputError
from shellfabric.loop.histories import EDGES
from tests.weavecell.session_runs import SCENES, fired, set_up
from weavecell.results import keys, vtk
from weavecell.results.result_folder import open_folder, read_record
from weavecell.results.wave_fronts import fronts

OF_THE_RUN = {"title", "law_name", "wall_time", "ns_per_element_step"}
# attributes of HDF5 itself, of dimension scales
SCALES = {
    "CLASS",
    "DIMENSION_LIST",
    "NAME",
    "REFERENCE_LIST",
}


def find(path, table):
    """The first of the keys that a path, by / or by dots, is documented as; a * is one level. None if there is none."""
    parts = path.replace(".", "/").split("/")
    for key in table:
        pattern = key.name.replace(".", "/").split("/")
        if len(parts) == len(pattern) and all(map(fnmatchcase, parts, pattern)):
            return key
    return None


def leaves(value, table, path=""):
    """Paths of the entries of a summary; a documented table is an entry."""
    for name, inner in value.items():
        key = f"{path}.{name}" if path else name
        if isinstance(inner, dict) and find(key, table) is None:
            yield from leaves(inner, table, key)
        else:
            yield key


@pytest.mark.parametrize("name", ["impact", "pack", "coupon", "pull-out"])
def test_no_key_without_a_row_in_its_table_and_each_with_the_unit_of_that_row(results, name):
    folder = results(name).folder
    impact = name not in ("coupon", "pull-out")
    summary = open_folder(folder).read_json("summary.json")
    table = (*keys.SHARED, *(keys.IMPACT if impact else keys.TABLES["coupon"]))
    assert [key for key in leaves(summary, table) if find(key, table) is None] == []
    scalars = {key.name for key in table}
    attributes = []

    def see(name, item):
        attributes.extend(
            f"{name}/{key}" for key in item.attrs if not isinstance(item, h5py.Dataset)
        )
        if isinstance(item, h5py.Dataset):
            assert set(item.attrs) - SCALES == {"unit"}
            key = find(name, keys.DATASETS if impact else keys.COUPON_DATASETS)
            assert key is not None, name
            assert key.si_unit in ("", item.attrs["unit"]), name

    with h5py.File(folder / "histories.h5") as file:
        file.visititems(see)
        assert [
            key for key in file.attrs if key not in scalars and find(key, keys.ATTRIBUTES) is None
        ] == []
    assert [name for name in attributes if find(name, keys.ATTRIBUTES) is None] == []


def test_energies_of_the_solvers_are_documented_and_drawn():
    from shellfabric.loop.pack_solver import PackSolver
    from weavecell.report import pictures

    names = PackSolver(wc.setup("S-726", 100, plies=2).target(), 100.0, 1e-6).energy_names
    for name in names:
        assert find(name, keys.TABLES["energies"])
    drawn = {name for name, *_ in pictures.list_bands(names)}
    assert set(names) <= drawn | set(pictures.NOT_DRAWN)
    # the recoil is a part of the viscous energy, drawn by itself
    for name in drawn - {"recoil_of_cut_yarns"}:
        assert find(name, keys.TABLES["energies"]), name


def test_a_quantity_has_its_unit_at_the_end_of_its_key():
    units = {"m/s": "m_s", "kg": "kg", "s": "s", "m": "m", "N": "N", "J": "J", "rad": "rad"}
    for key in (*keys.SHARED, *keys.IMPACT):
        if key.si_unit in units and not key.name.endswith(".*"):
            assert key.name.endswith((f"_{units[key.si_unit]}", "_ns")), key.name


def test_another_format_is_refused(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.attrs["format"] = "weavecell impact 1"
    with pytest.raises(
        InputError, match="format = 'weavecell impact 1': must be 'weavecell impact 12'"
    ):
        read_record(tmp_path / "a.h5")
    (tmp_path / "summary.json").write_text('{"format": "weavecell summary 9"}')
    with pytest.raises(
        InputError, match="format = 'weavecell summary 9': must be 'weavecell summary 2'"
    ):
        wc.load(tmp_path)


def test_fronts_are_read_off_what_is_read_back(results):
    file = results("impact").folder / "histories.h5"
    (measured,) = read_record(file).measured
    again = {f"{front.family}-{front.kind}": front.speed for front in fronts(measured)}
    assert set(again) == {
        f"{f}-{k}" for f in ("warp", "weft") for k in ("longitudinal", "transverse")
    }
    # the weft has less crimp
    assert 800 < again["warp-longitudinal"] < again["weft-longitudinal"] < 4000
    with h5py.File(file) as content:
        group = content["measured/00"]
        assert sorted(group["edges"]) == sorted(EDGES)
        assert [name.split("-")[1] for name in sorted(group["yarns"])] == ["warp", "warp", "weft"]
        for inner in group["yarns"].values():
            assert_array_equal(inner["strain"][()], inner["tension"][()] / inner.attrs["EA"])
        for name, speed in again.items():
            assert_equal(speed, group["fronts"][name].attrs["speed"])


def assert_same(one, other, at):
    """That two records are equal, through objects, tables and tuples; of the other what the one has."""
    if is_dataclass(one):
        one, other = vars(one), {name: getattr(other, name) for name in vars(one)}
    if isinstance(one, dict):
        assert set(one) == set(other), at
        for key in set(one) - OF_THE_RUN:
            assert_same(one[key], other[key], f"{at}.{key}")
    elif isinstance(one, tuple):
        assert len(one) == len(other), at
        for number, (left, right) in enumerate(zip(one, other)):
            assert_same(left, right, f"{at}.{number}")
    else:
        assert_array_equal(one, other, at)


@pytest.mark.parametrize("name", ["impact", "pack"])
def test_the_record_in_a_file_is_that_of_the_python_interface(results, name):
    """Plies, cuts, histories, bar and block, to the last bit."""
    assert_same(read_record(results(name).folder / "histories.h5"), fired(name), "")


def test_measuring_changes_nothing_else():
    one = wc.impact(
        set_up({key: table for key, table in SCENES["ply"].items() if key != "history"})
    )
    other = fired("impact")
    assert one.outcome == other.outcome
    assert one.steps == other.steps
    assert one.measured == ()
    for name in ("nodes", "tension"):
        ours, theirs = (getattr(shot.final[0], name) for shot in (one, other))
        assert_array_equal(ours, theirs)


@pytest.mark.parametrize("name", ["impact", "pack"])
def test_fields_of_paraview_add_up_to_the_histories(results, name):
    folder = results(name).folder
    record = read_record(folder / "histories.h5")
    summary = json.loads((folder / "summary.json").read_text())
    whole = 2 ** (summary["mirror_x"] + summary["mirror_y"])
    series = vtk.read_series(folder / "panel.pvd")
    yarns = any(shape.resolved.any() for shape in record.final)
    assert yarns == (name == "impact")
    assert len(series) >= 3
    for file, time in series:
        grid = pyvista.read(file)
        (sample,) = np.flatnonzero(np.isclose(record.time, time, rtol=1e-9, atol=0))
        for ply in range(record.count):
            part = grid.extract_cells(grid.cell_data["ply"] == ply + 1)
            push = whole * np.dot(part["projectile_pressure_Pa"], part["area_m2"])
            # on surfaces of resolved yarns there is no pressure
            wanted = 0.0 if yarns else record.plies["push"][sample, ply]
            assert push == pytest.approx(wanted, rel=1e-6, abs=1e-3)
            failed = [
                bool(np.any(part[f"failed_segments_{family}"])) for family in ("warp", "weft")
            ]
            assert failed == [bool(np.any(part[f"failed_{family}"])) for family in ("warp", "weft")]
            assert any(failed) == (record.plies["cut_yarns"][sample, ply] > 0)
    for ply, shape in enumerate(record.final):
        of_shell = grid.cell_data["ply"] == ply + 1
        kept = slice(None)
        if yarns:
            of_shell &= grid.cell_data["resolved_yarn"] == 0
            kept = ~shape.resolved
        part = grid.extract_cells(of_shell)
        assert_array_equal(part["tension_warp_N"], shape.tension[kept, 0])
        assert_array_equal(part["tension_weft_N"], shape.tension[kept, 1])
        assert_array_equal(part["failed_yarns"], vtk.count_failed_yarns(shape.failed[kept]))
    assert grid.field_data["projectile_z_m"] == [record.final[0].nose_position]
    pressures = vtk.PRESSURES[: 3 if name == "pack" else 1]
    assert tuple(key for key in vtk.PRESSURES if key in grid.point_data) == pressures
