"""The solid fitted to a plate curve: identifiability in closed form, and a twin experiment."""

import json
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import numpy as np
import pytest

from fabrics.plate_curve import PlateCurve
from meshing import crossover as mesher
from unitcell3d.cases import biaxial_and_platens
from unitcell3d.identify import solid_fit
from unitcell3d.identify.platen_misfit import closures
from unitcell3d.identify.solid_fit import LOOSE, NAMES, fit_solid, identify, with_solid_laws


def test_identify_is_the_linear_least_squares_theory():
    """Intervals of a straight line with a known answer; a column that is nothing, and one that repeats another."""
    x = np.linspace(-1, 1, 21)
    J = np.stack([np.ones_like(x), x], axis=1)
    half, correlation, singular, directions = identify(J, 0.1, len(x))
    from scipy.stats import t

    spread = t.ppf(0.975, 18)
    assert half == pytest.approx(spread * 0.1 / np.sqrt([21, np.sum(x**2)]), rel=1e-12)
    assert correlation == pytest.approx(np.eye(2), abs=1e-12)
    assert singular[0] >= singular[1]
    assert np.abs(directions) == pytest.approx(np.eye(2), abs=1e-12)
    half, correlation, singular, directions = identify(np.stack([x, x + 1e-6 * x**2], axis=1), 0.1, len(x))
    assert half.min() > 1e3
    assert correlation[0, 1] == pytest.approx(-1, abs=1e-6)
    assert np.abs(directions[1]) == pytest.approx(np.sqrt([0.5, 0.5]), rel=1e-3)


def test_a_fit_is_written_as_json(s720, tmp_path, monkeypatch):
    """From a curve to the file, with a closed form in place of the compressions: 0.2 mm V_c P / (P + K_r E_c)."""

    def press(fabric, size, pressure):
        solid, P = fabric.solid_laws[0], np.geomspace(1e3, pressure, 50)
        history = SimpleNamespace(failed="")
        history.F_plate = np.stack([P, P], axis=1) * fabric.weave.cell_area
        history.plates = 1e-3 - 1e-4 * solid.V_c * P / (P + solid.K_r * solid.E_c)
        return history

    monkeypatch.setattr(solid_fit, "press", press)
    pressure = np.geomspace(3e4, 5e6, 30)
    curve = PlateCurve(pressure, 2e-4 * pressure / (pressure + 2e7), "closed form")
    with ThreadPoolExecutor(1) as executor:
        found = fit_solid(s720, curve, check_size=(4, 3, 2), executor=executor)
    found.write(tmp_path / "fit.json")
    written = json.loads((tmp_path / "fit.json").read_text())
    assert set(written["determined"]) == {*NAMES, LOOSE}
    assert all(isinstance(known, bool) for known in written["determined"].values())
    assert written["rms_m"] == found.rms


@pytest.mark.slow(50)
def test_a_twin_is_found_again(s720):
    """A curve computed with other solids: the fit goes below its resolution, 1 um, and finds what it determines."""
    size = (4, 3, 2)
    mesh = mesher.build(s720, size=size)
    twin = with_solid_laws(s720, np.log([0.8e9, 0.25, 0.03]), max(mesh.Vf0))
    pressure = np.geomspace(3e4, 5e6, 60)
    history = biaxial_and_platens.plate_compression(mesh, twin, pressure=pressure[-1])
    curve = PlateCurve(pressure, closures(history, s720.weave.cell_area, pressure, np.linspace(0, 1e-9, 60)), "a twin")
    found = fit_solid(s720, curve, size=size)
    assert found.rms < 1e-6
    assert found.rms < 0.5 * found.summary()["rms_before_m"]
    truth = dict(zip(NAMES, (0.8e9, max(mesh.Vf0) + 0.25, 0.03))) | {LOOSE: 0.03 * 0.8e9}
    assert found.determined[LOOSE]
    for name, known in found.determined.items():
        if known:
            assert found.intervals[name][0] <= truth[name] <= found.intervals[name][1], name
    assert found.fabric.sources["solid.warp.E_c"]["status"] == "fitted"
