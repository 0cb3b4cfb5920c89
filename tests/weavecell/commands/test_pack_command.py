"""Packs: the session's run of three plies at three angles before a block, and the view of its cut."""

import re
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
import pyvista
from PIL import Image
from scipy.integrate import trapezoid

from fabrics import catalogue
from shellfabric.projectile.dynamics import BarHistory
from tests.weavecell.written import table_of
from weavecell.report.shot import view
from weavecell.results import keys
from weavecell.results.result_folder import read_record

HALF = 22.5e-3 + 1e-9  # [m] of the opening


@pytest.fixture
def pack(results):
    run = results("pack")
    record = read_record(run.folder / "histories.h5")
    told = table_of(run.folder)
    return SimpleNamespace(folder=run.folder, out=run.out, told=told, record=record)


def test_a_block_that_still_moves_has_no_dent_anywhere(pack):
    """Screen, JSON, HDF5, DataFrame, xarray, report and Python: no number of the dent but how deep it has been so
    far, which nothing calls a signature, and the words that say so."""
    record = pack.record
    block = record.backing
    depth = 1e3 * block.gauge_depth
    assert record.block_moves
    assert block.back_face_signature is None
    known = {"block_motion_over_strike", "deepest_dent_mm", "deepest_dent_time_s"}
    dents = {key.name for key in keys.table("of_backing")} - known
    assert {"back_face_signature_mm", "springback"} <= dents
    assert record.facts()["deepest_dent_mm"] == pytest.approx(1e3 * block.dent.max())
    assert block.time[np.argmax(block.dent)] == record.facts()["deepest_dent_time_s"]
    page = re.sub("<[^>]*>", "", (pack.folder / "report.html").read_text())
    for places in (pack.told, record.facts(), record.to_xarray().attrs):
        assert {name: places[name] for name in dents} == dict.fromkeys(dents)
    with h5py.File(pack.folder / "histories.h5") as file:
        assert not dents & set(file.attrs)
    assert not any("signature" in name for name in record.histories.to_dataframe())
    for text in (pack.out, page):
        assert "o back-face signature yet: the block moves with " in text
        assert f"deepest so far {record.deepest_dent_mm:.3g} mm at " in text
        assert f"signature {depth:.3g}" not in text


def test_the_laws_of_all_fabrics_are_named(pack):
    for name in (pack.told["law_name"], pack.record.law_name):
        assert name.startswith("S-728: published")
        assert "; S-726: published" in name


TITLE = "1 x S-728 + 1 x S-726 at 30 deg + 1 x S-726 at -45 deg"


def test_a_pack_says_what_it_is_made_of(pack):
    assert f"{TITLE}, 200 m/s\nanswer      DOUBTFUL: not decided: " in pack.out


@pytest.mark.parametrize(
    "said",
    [
        f"3 plies: {TITLE}",
        "assumed: density 3.0e-3 g/mm^3, modulus 100 MPa, poisson 0.30, hardening 0 Pa, erosion_strain 0.95",
        "Data of the fabric S-726",
    ],
)
def test_what_a_pack_says_in_its_report(pack, said):
    assert said in (pack.folder / "report.html").read_text()


def test_the_summary_of_a_pack_lists_its_plies(pack):
    told = pack.told
    known = {
        "plies": 3,
        "stacking": "lay-up",
        "ply_fabrics": ["S-728", "S-726", "S-726"],
        "ply_angles_deg": [0.0, 30.0, -45.0],
        "cut_yarns": sum(told["ply_cut_yarns"]),
    }
    assert {key: told[key] for key in known} == known


def test_the_record_of_a_pack_has_the_strength_and_place_of_each_ply(pack):
    record = pack.record
    cloths = [catalogue.load(name).with_effective_density() for name in pack.told["ply_fabrics"]]
    assert record.count == 3
    for cloth, angle, strengths in zip(cloths, pack.told["ply_angles_deg"], record.strength):
        # the opening [m] across which a yarn is as strong as its weakest link
        slope = max(abs(np.cos(np.radians(angle))), abs(np.sin(np.radians(angle))))
        for yarn, strength in zip(cloth.weave.yarns, strengths):
            length = cloth.gauge_length * (yarn.strength / strength) ** cloth.weibull_shape
            side = slope * length / (1 + yarn.crimp)
            assert side == pytest.approx(45e-3, rel=1e-9)
    assert record.gaps[1] == pytest.approx(0.05e-3)
    middles = record.gaps + 0.5 * (record.thickness[1:] + record.thickness[:-1])
    assert np.diff(record.z_rest) == pytest.approx(middles)


def test_the_push_on_the_plies_is_what_the_projectile_has_lost(pack):
    impulse = trapezoid(pack.record.plies["push"].sum(axis=1), pack.record.time)
    assert impulse == pytest.approx(
        pack.record.mass * (200 - pack.told["residual_velocity_m_s"]), rel=0.02
    )
    with h5py.File(pack.folder / "histories.h5") as file:
        assert file["plies/histories/push"].shape == (len(pack.record.time), 3)
    for ply, found in enumerate(pack.record.measured):
        assert [yarn.family for yarn in found.yarns] == ["warp", "weft"]
        assert found.yarns[0].strength == pytest.approx(pack.record.strength[ply, 0])
        assert found.t[-1] == pytest.approx(pack.record.time[-1])
    deflections = [found.yarns[0].deflection.max() for found in pack.record.measured]
    # plies that give back half of what closed them do not fly ahead of the nose
    assert deflections[0] > deflections[1] > deflections[2]


def test_cuts_and_grids_of_turned_plies_lie_in_the_frame_of_all(pack):
    """Cuts go from edge to edge of the opening and through the deepest point of each ply."""
    record = pack.record
    assert not record.mirror_x
    assert not record.mirror_y
    assert record.backing.share == 1.0
    for cut in record.cuts:
        for line in cut.lines:
            assert -HALF <= np.nanmin(line[:, 0]) < -20e-3
            assert HALF >= np.nanmax(line[:, 0]) > 20e-3
    deepest = [
        (np.nanmax(line[:, 1]), shape.nodes[:, 2].max())
        for line, shape in zip(cut.lines, record.final)
    ]
    assert all(drawn == pytest.approx(found, rel=0.05) for drawn, found in deepest)
    grid = pyvista.read(view.find(pack.folder))
    for ply, angle in enumerate(pack.told["ply_angles_deg"], 1):
        cells = grid.extract_cells(grid.cell_data["ply"] == ply)
        assert abs(cells.points[:, :2]).max() <= HALF, "nothing is drawn beyond the opening"
        side = cells.extract_cells([cells.find_closest_cell((14e-3, 14e-3, 0.0))]).points
        along = np.degrees(np.arctan2(*(side[1] - side[0])[1::-1]))
        assert along == pytest.approx(angle, abs=0.5) or along == pytest.approx(angle + 90, abs=0.5)


def test_the_cut_of_a_pack_is_a_picture_and_a_movie(command, succeed, pack, tmp_path):
    line = f"view {pack.folder} --cut --movie cut.gif --screenshot cut.png"
    succeed(line)
    with Image.open(tmp_path / "cut.gif") as movie:
        assert movie.n_frames == len(pack.record.cuts)
        for number in range(movie.n_frames):
            movie.seek(number)
            assert np.ptp(np.asarray(movie.convert("L"))) > 150
    refused = "error: --cut: must be given with --screenshot or --movie, of a folder with panel.pvd and histories.h5\n"
    assert command(f"view {pack.folder} --cut")[::2] == (2, refused)
    assert command(f"view {view.find(pack.folder)} --cut")[::2] == (2, refused)


def test_the_period_of_a_swing_is_found():
    t = np.linspace(0, 100e-6, 201)
    wave = np.sin(2 * np.pi * t / 17e-6)
    bar = BarHistory(t, 100 * t, 100 * t, 100 * t, 100 + wave, 100 - wave, 0 * t + 100, 17e-6, 1e-6)
    assert bar.swing == pytest.approx(17e-6, rel=0.01)
    assert np.isnan(BarHistory(*(v[:50] for v in list(vars(bar).values())[:7]), 17e-6, 0.0).swing)
