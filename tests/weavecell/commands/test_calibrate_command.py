"""`weavecell calibrate`, and the catalogue side by side: what is printed, going on, and errors."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("dolfinx")

from fabrics import catalogue
from fabrics.compression import CompressionLaw
from unitcell3d.identify import calibrate as solver
from unitcell3d.identify import chain, solid_fit
from unitcell3d.identify.solid_record import SolidFit
from validation.commands import calibration

SMALL = {"plates_size": (2, 2, 2), "paths": {"warp only": (1, 0), "equibiaxial": (1, 1)}}


@pytest.fixture
def small(monkeypatch):
    """Two fabrics on the least of meshes."""
    run = solver.calibrate_all
    monkeypatch.setattr(catalogue, "list_names", lambda: ["S-720", "S-726"])
    monkeypatch.setattr(
        solver, "calibrate_all", lambda fabrics, size, **more: run(fabrics, size=(2, 2, 2), **SMALL, **more)
    )


def test_the_catalogue_side_by_side(capsys, tmp_path, small):
    calibration.main(mesh="coarse", jobs=2, out=tmp_path / "all")
    out = capsys.readouterr().out
    folder = tmp_path / "all"
    assert {"S-720", "S-726", "report.html", "summary.csv", "summary.png"} <= {path.name for path in folder.iterdir()}
    assert {"law.json", "law-warp.json", "law-weft.json", "calibration.json", "plates.h5", "warp-only.h5"} <= {
        path.name for path in (folder / "S-726").iterdir()
    }
    header, *rows = csv.reader((folder / "summary.csv").open())
    assert [row[0] for row in rows] == ["S-720", "S-726"]
    assert {len(row) for row in rows} == {len(header)}
    ratio = float(rows[0][header.index("a / published")])
    assert ratio == pytest.approx(float(rows[0][1]) / 0.045, abs=0.01)
    low, high = map(float, rows[0][2].split(" .. "))
    assert low < float(rows[0][1]) < high
    assert out.splitlines()[0].startswith("S-720             a ")
    assert "<table" in (folder / "report.html").read_text()
    # again: nothing is solved, the laws are the same to the last bit
    law = (folder / "S-720" / "law.json").read_bytes()
    (folder / "S-720" / "law.json").unlink()
    calibration.main(mesh="coarse", jobs=1, resume=True, out=tmp_path / "all")
    assert capsys.readouterr().out == out
    assert (folder / "S-720" / "law.json").read_bytes() == law


def test_one_fabric_is_written_and_reported(command, tmp_path, monkeypatch):
    run = solver.calibrate
    monkeypatch.setattr(solver, "calibrate", lambda fabric, size, **more: run(fabric, size=(2, 2, 2), **SMALL, **more))
    code, out, _ = command("calibrate", "S-720", "--mesh", "coarse", "--out", "calibration")
    folder = tmp_path / "calibration"
    assert code == 0
    assert {path.name for path in folder.iterdir()} == {
        "law.json", "law-warp.json", "law-weft.json", "calibration.json", "provenance.json", "mesh.json", "report.html",
        "plates.h5", "equibiaxial.h5", "warp-only.h5", "crossover.msh", "crossover.vtu", "crossover.png", "quality.png",
    }  # fmt: skip
    law = CompressionLaw.from_json(folder / "law.json")
    assert f"fitted      a = {1e3 * law.a:.4f} mm" in out
    page = (folder / "report.html").read_text("utf-8")
    places = [page.index(f'id="{chapter}"') for chapter in ("fit", "cell", "mesh", "sources", "making")]
    assert places == sorted(places)


@pytest.fixture
def fitted(monkeypatch):
    """Fits of the solid that give that of the file a tenth softer at once, whatever the fabric."""
    monkeypatch.setattr(solid_fit, "fit_solid", a_fit)
    monkeypatch.setattr(chain, "fit_solid", a_fit)
    paths = solver.path_jobs
    monkeypatch.setattr(chain, "path_jobs", lambda *chosen: paths(*chosen, SMALL["paths"]))
    monkeypatch.setattr(chain, "SIZE", (2, 2, 2))
    monkeypatch.setattr(chain.run_cache, "results", here)


def here(function, arguments, *, report=None, **_):
    return [function(*one) for one in arguments]


def a_fit(fabric, curve, *_, **__):
    pressure = np.geomspace(curve.pressure[0], curve.pressure[-1], 16)
    measured = curve.at(pressure)
    softer, stiffer = (
        replace(fabric, solid_laws=tuple(replace(law, E_c=factor * law.E_c) for law in fabric.solid_laws))
        for factor in (0.9, 1.1)
    )
    values = {"E_c": 1.8e9, "V_c": 1.0, "K_r": 0.02, "K_r E_c": 3.6e7}
    return SolidFit(
        fabric=softer, started=fabric, curve=curve, pressure=pressure, measured=measured,
        computed=measured + 1e-6 * np.cos(np.arange(16)), before=0.8 * measured, checked=None, values=values,
        intervals={name: (0.5 * value, 2 * value) for name, value in values.items()},
        determined=dict.fromkeys(values, True), correlation=np.eye(3), singular_values=np.ones(3), directions=np.eye(3),
        limits=((softer, stiffer),), met=True, work={}, sizes=("coarse", "None"),
    )  # fmt: skip


def test_the_chain_of_the_catalogue(capsys, tmp_path, monkeypatch, small, fitted):
    """Both laws of each fabric side by side, and on a page; a fabric without a platen law is named with the reason."""
    monkeypatch.setattr(catalogue, "list_names", lambda: ["S-720", "S-726", "glass-balanced"])
    page = tmp_path / "page.md"
    page.write_text("before\n<!-- chain -->old<!-- end of chain -->\nafter\n")
    (tmp_path / "figures").mkdir()
    calibration.main(fit_solid=True, mesh="coarse", jobs=2, out=tmp_path / "c", page=page)
    left_out = "glass-balanced: left out, since fabric glass-balanced has no areal_density_measured"
    assert left_out in capsys.readouterr().out
    header, *rows = csv.reader((tmp_path / "c" / "laws.csv").open())
    assert [row[0] for row in rows] == ["S-720", "S-726"]
    assert {len(row) for row in rows} == {len(header)}
    for row in rows:
        low, high = map(float, row[6].split(" .. "))
        assert low <= float(row[5]) <= high
        assert (row[9], row[10]) != (row[3], row[4])  # another solid, another law
    header, *rows = csv.reader((tmp_path / "c" / "solids.csv").open())
    assert float(rows[0][header.index("misfit before [µm]")]) > float(rows[0][header.index("fitted [µm]")])
    text = page.read_text()
    assert text.startswith("before\n")
    assert text.endswith("after\n")
    assert "old" not in text
    assert text.count("| S-720 |") == 2
    assert (tmp_path / "figures" / "calibration-chain-laws.png").exists()
    assert {"solid.json", "law-interval.json", "law.json"} <= {p.name for p in (tmp_path / "c" / "S-726").iterdir()}
    assert (tmp_path / "c" / "S-726" / "solid-of-the-file" / "law.json").exists()


def test_one_fabric_from_its_platen_curve(command, tmp_path, monkeypatch, fitted):
    run = solver.calibrate
    monkeypatch.setattr(solver, "calibrate", lambda fabric, size, **more: run(fabric, size=(2, 2, 2), **SMALL, **more))
    code, out, err = command("calibrate", "S-720", "--fit-solid", "--mesh", "coarse", "--jobs", "1", "--out", "c")
    assert code == 0, err
    told = {line[:12].strip(): line[12:] for line in out.splitlines()}
    assert told["E_c"] == "1.8e+09 (9e+08 .. 3.6e+09, 95 %); from 2e+09"
    assert told["misfit"].startswith("0.7 um and ")
    assert told["of the solid"].count("..") == 2
    solid = json.loads((tmp_path / "c" / "solid.json").read_text())
    assert solid["rms_relative_pressure_before"] > solid["rms_relative_pressure"]
    assert "What it leaves open makes a of the law" in (tmp_path / "c" / "report.html").read_text()


def test_one_fabric_is_reported_with_intervals_and_spread(command, tmp_path, monkeypatch):
    def run(fabric, size, calibrate=solver.calibrate, **more):
        found = calibrate(fabric, size=(2, 2, 2), **SMALL, **more)
        a, b = found.law.a, found.law.b  # ends that the law is outside of at all forces
        return replace(found, law=replace(found.law, assumed_range=((0.5 * a, b), (2 * a, b))))

    monkeypatch.setattr(solver, "calibrate", run)
    code, out, err = command("calibrate", "S-720", "--mesh", "coarse", "--jobs", "1", "--out", "c")
    assert code == 0, err
    note = "stiff end softer than the law from "
    assert note in out
    assert note in (tmp_path / "c" / "report.html").read_text()
    told = {line[:12].strip(): line[12:] for line in out.splitlines()}
    names = {"fitted", "published", "residual", "each path", "warp alone", "weft alone", "alternative", "impacts use"}
    assert names <= set(told)
    assert told["fitted"].count("..") == told["each path"].count("..") == 2
    assert told["published"] == "a = 0.0450 mm, b = 0.0580 mm N^(1/3)"
    assert (tmp_path / "c" / "report.html").exists()
