"""The solid fitted to a plate curve: identifiability in closed form, and a twin experiment."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from fabrics.plate_curve import PlateCurve
from meshing import crossover as mesher
from unitcell3d.cases import biaxial_and_platens
from unitcell3d.identify import solid_fit
from unitcell3d.identify.least_squares import identify
from unitcell3d.identify.platen_misfit import closures
from unitcell3d.identify.solid_fit import fit_solid
from unitcell3d.identify.solid_record import LOOSE, NAMES, constants, with_solid_laws
from unitcell3d.solver.load_stepping import Steps


def test_identify_is_the_linear_least_squares_theory():
    """Intervals of a straight line with a known answer; a column that is nothing, and one that repeats another."""
    x = np.linspace(-1, 1, 21)
    J = np.stack([np.ones_like(x), x], axis=1)
    half, correlation, singular, directions = identify(J, 0.1, len(x) - 3)
    from scipy.stats import t

    spread = t.ppf(0.975, 18)
    assert half == pytest.approx(spread * 0.1 / np.sqrt([21, np.sum(x**2)]), rel=1e-12)
    assert correlation == pytest.approx(np.eye(2), abs=1e-12)
    assert singular[0] >= singular[1]
    assert abs(directions) == pytest.approx(np.eye(2), abs=1e-12)
    half, correlation, singular, directions = identify(
        np.stack([x, x + 1e-6 * x**2], axis=1), 0.1, len(x) - 3
    )
    assert half.min() > 1e3
    assert correlation[0, 1] == pytest.approx(-1, abs=1e-6)
    assert abs(directions[1]) == pytest.approx(np.sqrt([0.5, 0.5]), rel=1e-3)


PRESSURE16 = np.geomspace(3e4, 5e7, 16)


class ClosedForm:
    """In place of the equilibria of a mesh: closures 0.1 mm V_c P / (P + K_r E_c)."""

    def __init__(self, mesh, fabric, with_constants, pressure):
        self._with = with_constants
        self.loaded = 0
        self.equilibria = 0
        self.tangents = 0

    def at(self, x):
        def closures(pressure, x=x):
            solid = self._with(x).solid_laws[0]
            return 1e-4 * solid.V_c * pressure / (pressure + solid.K_r * solid.E_c)

        def jacobian(pressure):
            steps = 1e-6 * np.eye(3)
            return np.stack(
                [(closures(pressure, x + s) - closures(pressure, x - s)) / 2e-6 for s in steps],
                axis=1,
            )

        return SimpleNamespace(closures=closures, jacobian=jacobian, failed="", pressure=PRESSURE16)

    def close(self):
        pass


@pytest.fixture
def closed_form(s720, monkeypatch):
    """The fit to a curve of the closed form with V_c = 2 and K_r E_c = 20 MPa."""
    monkeypatch.setattr(solid_fit, "PlatenSolver", ClosedForm)
    pressure = np.geomspace(3e4, 5e7, 60)
    curve = PlateCurve(pressure, 2e-4 * pressure / (pressure + 2e7), "closed form")
    return lambda: fit_solid(s720, curve, (2, 2, 2), (2, 2, 2))


def test_a_closed_form_is_found_again_and_written(closed_form, tmp_path):
    """K_r E_c and V_c are told, E_c and K_r alone are not; no limit goes further than is sought."""
    found = closed_form()
    assert found.met
    assert found.values["V_c"] == pytest.approx(2, rel=5e-3)
    assert found.values[LOOSE] == pytest.approx(2e7, rel=5e-3)
    assert not found.determined["E_c"]
    assert not found.determined["K_r"]
    assert found.rms < 1e-7
    assert found.misfit.pressure < 0.01 < found.misfit_before.pressure
    for low, high in found.limits:
        one, other = (np.log([c["E_c"], c["K_r"]]) for c in map(constants, (low, high)))
        assert abs(one - other).max() <= 2 * solid_fit.FARTHEST + 1e-9
    found.write(tmp_path / "fit.json")
    written = json.loads((tmp_path / "fit.json").read_text())
    assert written["determined"] == {name: bool(found.determined[name]) for name in (*NAMES, LOOSE)}
    assert written["rms_m"] == found.rms
    assert written["rms_checked_m"] == pytest.approx(found.rms, abs=1e-9)
    assert len(written["limits_95_on_directions"]) == 3


def test_limits_are_where_the_sum_of_squares_has_risen(closed_form, s720):
    """On the two directions that the curve tells: by t^2 s^2, s being the resolution of 1 um at the weights."""
    from scipy.stats import t

    found = closed_form()
    slope = np.gradient(found.measured, np.log(found.pressure))
    weight = 1 / np.hypot(solid_fit.PRESSURE_ERROR * slope, 1e-6)
    for pair in found.limits[:2]:
        for fabric in pair:
            solid = fabric.solid_laws[0]
            at = 1e-4 * solid.V_c * found.pressure / (found.pressure + solid.K_r * solid.E_c)
            misfit = at - found.measured
            misfit = weight * (misfit - np.average(misfit, weights=weight**2))
            allowed = t.ppf(0.975, 12) ** 2 * np.mean((1e-6 * weight) ** 2)
            assert np.sum(misfit**2) == pytest.approx(allowed, rel=solid_fit.NEAR_LIMIT + 0.05)


@pytest.mark.slow(50)
def test_a_twin_is_found_again(s720, tmp_path):
    """A curve computed with other solids, as a file of thicknesses: the fit goes below its resolution, 1 um, and finds
    what it determines."""
    size = (4, 3, 2)
    mesh = mesher.build(s720, size=size)
    twin = with_solid_laws(s720, np.log([0.8e9, 0.25, 0.03]), max(mesh.Vf0))
    pressure = np.geomspace(3e4, 5e6, 60)
    history = biaxial_and_platens.plate_compression(
        mesh, twin, pressure=pressure[-1], steps=Steps(largest=0.02)
    )
    closed = closures(history, s720.weave.cell_area, pressure, np.linspace(0, 1e-9, 60))
    rows = [f"{1e-3 * P:.10g}, {0.5 - 1e3 * d:.10g}" for P, d in zip(pressure, closed)]
    file = tmp_path / "platens.csv"
    file.write_text("\n".join(["pressure [kPa], thickness [mm]", *rows]) + "\n")
    curve = PlateCurve.read(file)
    found = fit_solid(s720, curve, size, None)
    assert found.rms < 1e-6
    assert found.rms < 0.5 * found.misfit_before.closure
    truth = dict(zip(NAMES, (0.8e9, max(mesh.Vf0) + 0.25, 0.03))) | {LOOSE: 0.03 * 0.8e9}
    assert found.determined[LOOSE]
    for name, known in found.determined.items():
        if known:
            assert found.intervals[name][0] <= truth[name] <= found.intervals[name][1], name
            assert found.values[name] == pytest.approx(truth[name], rel=0.02), name
    assert found.fabric.sources["solid.warp.E_c"]["status"] == "fitted"
