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
