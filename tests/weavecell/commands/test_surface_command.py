"""`weavecell surface`: its folder, its numbers, an interrupted run, and its errors."""

import json

import numpy as np
import pytest

pytest.importorskip("dolfinx")

from fabrics.surface import ResponseSurface

OPTIONS = ("--mesh", "coarse", "--points", "5", "--d1", "0 mm .. 0.01 mm", "--d2", "0 um .. 8 um", "--jobs", "1")


def test_surface_is_sampled_and_reported(command, tmp_path):
    code, out, err = command("surface", "S-720", *OPTIONS, "--out", "s")
    assert code == 0, err
    folder = tmp_path / "s"
    assert sorted(path.name for path in folder.iterdir()) == ["pictures", "report.html", "surface.h5", "surface.json"]
    assert sorted(path.stem for path in (folder / "pictures").iterdir()) == ["contours", "missed", "slices", "surfaces"]
    surface = ResponseSurface.read(folder / "surface.h5")
    assert np.allclose(surface.d1, np.linspace(0, 1e-5, 5))
    assert np.allclose(surface.d2, np.linspace(0, 8e-6, 5))
    assert "commit" in surface.provenance
    told = json.loads((folder / "surface.json").read_text())
    assert told["equilibria"] == 30
    assert f"{told['error_of_left_out_lines']['T1']['rms']:.3g} N rms" in out
    # the shell's cell is another model of the same crossover: near, and not the same
    assert 0 < told["rms_from_the_shells_cell_N"]["T1"] < 10
    page = (folder / "report.html").read_text()
    assert page.count("<img") + page.count("<svg") >= 4


@pytest.mark.parametrize(
    ("option", "value", "line"),
    [
        ("--d1", "1 mm", "error: --d1 = '1 mm': must be two lengths"),
        ("--d2", "3 um .. 1 um", "error: d2 = '3e-06 to 1e-06 m': must be a range that rises"),
        ("--d1", "0 .. 1", "error: --d1 = '0': must be a text with a unit"),
        ("--points", "2", "error: points = 2: must be 5 to 65"),
        ("--tolerance", "2", "error: tolerance = 2.0: must be above 0 and below 1"),
    ],
)
def test_bad_options_write_nothing(command, tmp_path, option, value, line):
    code, _, err = command("surface", "S-720", option, value, "--out", "s")
    assert code == 2
    assert err.splitlines()[-1].startswith(line)
    assert not (tmp_path / "s").exists()
