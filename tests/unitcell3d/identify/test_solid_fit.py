"""The solid fitted to a plate curve, to biaxial tests and both: identifiability in closed form, a twin."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from fabrics.plate_curve import PlateCurve
from meshing import crossover as mesher
from unitcell3d.cases import biaxial_and_platens
from unitcell3d.identify import least_squares, solid_fit
from unitcell3d.identify.biaxial_states import PulledTest
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
    return lambda: fit_solid(s720, curve, size=(2, 2, 2), check_size=(2, 2, 2))


def test_a_closed_form_is_found_again_and_written(closed_form, tmp_path):
    """K_r E_c and V_c are told, E_c and K_r alone are not; no limit goes further than is sought."""
    found = closed_form()
    assert found.met
    assert found.values["V_c"] == pytest.approx(2, rel=5e-3)
    assert found.values[LOOSE] == pytest.approx(2e7, rel=5e-3)
    assert not found.determined["E_c"]
    assert not found.determined["K_r"]
    platens = found.platens
    assert platens.misfit.closure < 1e-7
    assert platens.misfit.pressure < 0.01 < platens.misfit_before.pressure
    for low, high in found.limits:
        one, other = (np.log([c["E_c"], c["K_r"]]) for c in map(constants, (low, high)))
        assert abs(one - other).max() <= 2 * solid_fit.FARTHEST + 1e-9
    found.write(tmp_path / "fit.json")
    written = json.loads((tmp_path / "fit.json").read_text())
    assert written["determined"] == {name: bool(found.determined[name]) for name in (*NAMES, LOOSE)}
    assert written["rms_m"] == platens.misfit.closure
    assert written["rms_checked_m"] == pytest.approx(platens.misfit.closure, abs=1e-9)
    assert len(written["limits_95_on_directions"]) == 3


def test_limits_are_where_the_sum_of_squares_has_risen(closed_form, s720):
    """On the two directions that the curve tells: by t^2 s^2, s being the resolution of 1 um at the weights."""
    from scipy.stats import t

    found = closed_form()
    pressure, measured = found.platens.pressure, found.platens.measured
    slope = np.gradient(measured, np.log(pressure))
    weight = 1 / np.hypot(solid_fit.PRESSURE_ERROR * slope, 1e-6)
    for pair in found.limits[:2]:
        for fabric in pair:
            solid = fabric.solid_laws[0]
            at = 1e-4 * solid.V_c * pressure / (pressure + solid.K_r * solid.E_c)
            misfit = at - measured
            misfit = weight * (misfit - np.average(misfit, weights=weight**2))
            allowed = t.ppf(0.975, 12) ** 2 * np.mean((1e-6 * weight) ** 2)
            assert np.sum(misfit**2) == pytest.approx(allowed, rel=solid_fit.NEAR_LIMIT + 0.05)


STRAIN = np.linspace(0, 1e-2, 15)[:, None] * [1.0, 0.7]
TRUTH = np.log([1.3e9, 0.45, 0.03])


class ClosedLoads:
    """In place of the equilibria of a mesh: loads that depend on all three constants, each in its own way."""

    def __init__(self, mesh, fabric, with_constants, tests):
        self._test = tests[0]
        self.loaded = self.equilibria = self.tangents = 1

    def loads(self, x, from_rest=False):
        steps = 1e-6 * np.eye(3)
        slopes = [(self._at(x + s) - self._at(x - s)) / 2e-6 for s in steps]
        return [(self._at(x), np.stack(slopes, axis=2))]

    def _at(self, x):
        E_c, room, K_r = np.exp(x - TRUTH)
        s = 100 * self._test.along[:, None] * self._test.end
        stiff = s**2 / (s + 0.3 * room / (1 + s * E_c**0.4) / K_r**0.3)
        return [90.0, 40.0] * stiff

    def close(self):
        pass


def made_tests(rng, noise=0.02):
    tests = []
    for name, ratio in (("even", [1.0, 1.0]), ("warp", [1.0, 0.6])):
        strain = np.linspace(0, 1e-2, 40)[:, None] * ratio
        test = PulledTest(name, strain, np.zeros_like(strain))
        load = ClosedLoads(None, None, None, [test])._at(TRUTH)
        load = load + noise * load.max(axis=0) * rng.standard_normal(load.shape)
        tests.append(PulledTest(name, strain, load))
    return tests


@pytest.fixture
def of_tests(s720, monkeypatch):
    """The fit to tests of the closed form."""
    monkeypatch.setattr(solid_fit, "BiaxialSolver", ClosedLoads)
    return lambda tests, curve=None, **more: fit_solid(
        s720, curve, tests, size=(2, 2, 2), check_size=None, **more
    )


def test_what_made_the_tests_lies_in_the_intervals(of_tests, meshed):
    """In at least 9 of 10 noises of each constant; the other test is predicted as well as the noise lets."""
    room = max(0.7, *meshed(size=(2, 2, 2)).Vf0)
    truth = dict(zip(NAMES, np.exp(TRUTH)))
    truth["V_c"] += room
    held = []
    for seed in range(10):
        found = of_tests(made_tests(np.random.default_rng(seed)), fitted=["even"])
        held.append(
            [low <= truth[n] <= high for n, (low, high) in found.intervals.items() if n in truth]
        )
        even, warp = found.pulls
        assert (even.role, warp.role) == ("fitted", "predicted")
        assert found.shares(warp).max() < 0.03
    assert np.sum(held, axis=0).min() >= 9


def test_a_constant_that_is_kept_is_judged_too(of_tests):
    found = of_tests(made_tests(np.random.default_rng(3)), free=("E_c", "K_r"))
    assert found.values["V_c"] == found.started.solid_laws[0].V_c
    assert found.free == ("E_c", "K_r")
    low, high = found.intervals["V_c"]
    assert low < found.values["V_c"] < high
    assert "solid.warp.V_c" not in {
        key for key, entry in found.fabric.sources.items() if "biaxial" in str(entry.get("source"))
    }
    assert found.correlation.shape == (2, 2)


def test_platens_and_tests_together_tell_more_than_either(of_tests, closed_form, s720):
    """Each kind of evidence has its own error; the curve tells V_c and the product, the tests E_c too."""
    tests = made_tests(np.random.default_rng(5))
    pressure = np.geomspace(3e4, 5e7, 60)
    mesh = mesher.build(s720, size=(2, 2, 2))
    V_c = max(0.7, *mesh.Vf0) + np.exp(TRUTH[1])
    loose = np.exp(TRUTH[0] + TRUTH[2])
    curve = PlateCurve(pressure, 1e-4 * V_c * pressure / (pressure + loose), "closed form")
    alone = of_tests(tests)
    both = of_tests(tests, curve)
    assert both.platens is not None
    for name in (*NAMES, LOOSE):
        assert np.diff(both.intervals[name]) < np.diff(alone.intervals[name])
    assert both.values[LOOSE] == pytest.approx(loose, rel=0.06)
    told = both.summary()
    assert [one["role"] for one in told["tests"]] == ["fitted", "fitted"]
    assert told["rms_m"] < 1e-6


def test_states_off_a_straight_line_and_free_directions_are_refused():
    bent = STRAIN + [[0.0, 0.006]] * np.sin(np.linspace(0, 3, 15))[:, None]
    with pytest.raises(InputError, match=r"test bent = 'strains .* % off a straight line'"):
        PulledTest("bent", bent, np.zeros_like(bent))
    free = STRAIN * [1.0, np.nan]
    with pytest.raises(InputError, match="must be strains of both directions"):
        PulledTest("free", free, np.zeros_like(free))
    with pytest.raises(InputError, match="a strain above 0"):
        PulledTest("shorter", -STRAIN, np.zeros_like(STRAIN))


@pytest.mark.parametrize("deeper", [-1, 1])
def test_of_two_minima_the_lower_is_taken(deeper):
    """The square of the first misfit is 600 (y^2 - 0.04)^2 + 0.3 - 0.2 deeper y, y = x_0 + 0.3 x_1: wells at about 0.2
    and -0.2. The second misfit is steep across them. The higher well is left if the lower one is below it."""
    along, across = np.array([1.0, 0.3]), np.array([-0.3, 1.0])

    def evaluate(x):
        y = along @ x
        square = 600 * (y**2 - 0.04) ** 2 + 0.3 - 0.2 * deeper * y
        slope = (2400 * y * (y**2 - 0.04) - 0.2 * deeper) / (2 * square**0.5)
        return np.array([square**0.5, 9 * across @ x - 0.1]), np.stack([slope * along, 9 * across])

    bounds = np.full(2, -3.0), np.full(2, 3.0)
    above = least_squares.solve(evaluate, 0.2 * along / (along @ along), bounds)
    assert along @ above.x == pytest.approx(0.2, abs=0.01)
    found = solid_fit._look_below(above, evaluate, bounds)
    assert along @ found.x == pytest.approx(0.2 * deeper, abs=0.01)


@pytest.mark.slow(40)
def test_platens_that_the_law_does_not_follow_have_the_lowest_of_their_minima():
    """S-728 has one at E_c = 0.58 GPa, found first, whose sum of squares is a quarter higher."""
    fabric = wc.fabric("S-728")
    curve = PlateCurve.pressure_law(fabric.areal_density_measured)
    found = fit_solid(fabric, curve, size=(4, 3, 1), check_size=None)
    E_c = found.values["E_c"]
    assert E_c < 0.45e9


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
    found = fit_solid(s720, curve, size=size, check_size=None)
    assert found.platens.misfit.closure < 1e-6
    assert found.platens.misfit.closure < 0.5 * found.platens.misfit_before.closure
    truth = dict(zip(NAMES, (0.8e9, max(mesh.Vf0) + 0.25, 0.03))) | {LOOSE: 0.03 * 0.8e9}
    assert found.determined[LOOSE]
    for name, known in found.determined.items():
        if known:
            assert found.intervals[name][0] <= truth[name] <= found.intervals[name][1], name
            assert found.values[name] == pytest.approx(truth[name], rel=0.02), name
    assert found.fabric.sources["solid.warp.E_c"]["status"] == "fitted"
