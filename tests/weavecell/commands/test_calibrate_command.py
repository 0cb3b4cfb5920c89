"""`weavecell calibrate`: what it prints, the whole catalogue side by side, going on, and its errors."""

import csv

import pytest

pytest.importorskip("dolfinx")

from fabrics import catalogue
from unitcell3d.identify import calibrate as solver

SMALL = {"plates_size": (2, 2, 2), "paths": {"warp only": (1, 0), "equibiaxial": (1, 1)}}


@pytest.fixture
def small(monkeypatch):
    """Two fabrics on the least of meshes."""
    run = solver.calibrate_all
    monkeypatch.setattr(catalogue, "list_names", lambda: ["S-720", "S-726"])
    monkeypatch.setattr(
        solver, "calibrate_all", lambda fabrics, size, **more: run(fabrics, size=(2, 2, 2), **SMALL, **more)
    )


def test_the_catalogue_side_by_side(command, tmp_path, small):
    code, out, err = command("calibrate", "--all", "--mesh", "coarse", "--jobs", "2", "--out", "all")
    assert code == 0, err
    folder = tmp_path / "all"
    assert sorted(path.name for path in folder.iterdir()) == [
        "S-720",
        "S-726",
        "report.html",
        "summary.csv",
        "summary.png",
    ]
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
    code, again, _ = command("calibrate", "--all", "--mesh", "coarse", "--resume", "--out", "all")
    assert (code, again) == (0, out)
    assert (folder / "S-720" / "law.json").read_bytes() == law


@pytest.mark.parametrize(
    ("options", "line"),
    [
        ([], "give either a fabric or --all"),
        (["S-720", "--all"], "give either a fabric or --all"),
        (["--all", "--fit-solid"], "--platen-curve and --fit-solid go with one fabric"),
    ],
)
def test_bad_options_write_nothing(command, tmp_path, options, line):
    code, _, err = command("calibrate", *options, "--out", "c")
    assert (code, err) == (2, f"error: {line}\n")
    assert not (tmp_path / "c").exists()


def test_one_fabric_is_told_with_intervals_and_spread(command, tmp_path, monkeypatch):
    run = solver.calibrate
    monkeypatch.setattr(solver, "calibrate", lambda fabric, size, **more: run(fabric, size=(2, 2, 2), **SMALL, **more))
    code, out, err = command("calibrate", "S-720", "--mesh", "coarse", "--jobs", "1", "--out", "c")
    assert code == 0, err
    told = {line[:12].strip(): line[12:] for line in out.splitlines()}
    assert {"fitted", "published", "residual", "each path", "warp alone", "weft alone", "by tension", "chosen"} <= set(
        told
    )
    assert told["fitted"].count("..") == told["each path"].count("..") == 2
    assert told["published"] == "a = 0.0450 mm, b = 0.0580 mm N^(1/3)"
    assert (tmp_path / "c" / "report.html").exists()
