"""`impact --check`: what it says a run takes is what the run takes, and nothing is written."""

from dataclasses import replace
from pathlib import Path

import pandas
import pytest

import weavecell as wc
from shellfabric.impact.run import run_impact_or_partial
from tests.scene_text import impact_scene
from weavecell.api import run_size
from weavecell.api.run_size import shots_of_a_search
from weavecell.studies.ballistic_limit import first_guess
from weavecell.studies.bracket import Bracket

DATA = Path(__file__).parents[3] / "docs" / "reports" / "data"
PACK = {"opening": "30 mm", "plies": 2, "ply_gap": "0.1 mm", "end_time": "10 us"}


@pytest.mark.parametrize(
    "panel", [{"opening": "30 mm", "end_time": "10 us"}, PACK], ids=["ply", "pack"]
)
def test_elements_and_steps_are_those_of_the_run(panel):
    size = wc.impact("S-720", "90 m/s", check=True, **panel)
    setup = wc.impact.plan("S-720", "90 m/s", **panel).target.setup
    result, _ = run_impact_or_partial(setup)
    assert size.elements == setup.target().elements
    assert size.steps == round(result.time[-1] / size.time_step)
    assert size.cpu_time[0] < size.cpu_time[1]
    assert "; 0.98 to 1,200 s of CPU time" in str(replace(size, cpu_time=(0.98, 1234.5)))


def test_the_command_writes_nothing(succeed, tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(impact_scene("90 m/s", "30 mm", "10 us"))
    out = succeed("impact", scene, "--check", "--out", "out")
    assert "nothing is run" in out
    assert out.count("\nmodel: ") == 1
    assert not (tmp_path / "out").exists()


def test_the_forecast_of_a_v50_counts_its_shots():
    plain = wc.v50("S-720", shots=20, opening="50 mm", check=True)
    assert (plain.shots, plain.searches) == (20, 0)
    more = wc.v50("S-720", shots=30, opening="50 mm", check=True)
    assert more.cpu_time == pytest.approx([1.5 * seconds for seconds in plain.cpu_time])


def test_the_forecast_of_a_shot_counts_the_drawn_shots_beside_it():
    size = wc.impact("S-728", "90 m/s", draws=7, opening="50 mm", check=True)
    assert size.beside.shots == 7
    assert "\nbeside it 7 drawn shots; " in str(size)
    assert wc.impact("S-728", "90 m/s", opening="50 mm", check=True).beside is None


def test_the_forecast_of_a_limit_counts_residual_shots_and_scan():
    of_a_search = shots_of_a_search(wc.setup("S-720", 100.0))
    limit = wc.critical_velocity("S-720", opening="50 mm", check=True)
    assert limit.shots == of_a_search + 2 + 2
    more = {"residual_shots": 8, "scan": True}
    limit = wc.critical_velocity("S-720", opening="50 mm", check=True, **more)
    assert limit.shots == of_a_search + 8 + 18
    assert 0 < limit.cpu_time[0] < limit.cpu_time[1]


@pytest.mark.parametrize("guess", [0.8, 0.97, 1.15, 1.4])
@pytest.mark.parametrize("tolerance", [0.7, 3.0, 11.0])
def test_the_forecast_of_a_search_is_within_two_shots_of_what_bisection_fires(guess, tolerance):
    """A limit beside the first guess, above and below it, is enclosed and halved."""
    setup = wc.setup("S-720", 100.0)
    first = first_guess(setup.target())
    limit = guess * first
    found = Bracket(first, 1.0, 1000.0)
    fired = 0
    while not found.width <= tolerance:
        found = found.update(found.next() > limit)
        fired += 1
    assert abs(fired - shots_of_a_search(setup, tolerance)) <= 2


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_the_forecast_of_a_limit_of_a_pack_counts_the_shots_of_its_v50():
    """The mean of four surrogates is 12.5 shots (docs/reports/packs.md)."""
    pack = wc.critical_velocity("S-720", plies=4, opening="50 mm", check=True)
    assert pack.shots == 8 + 5
    narrow = wc.critical_velocity("S-720", plies=4, opening="50 mm", check=True, tolerance="1 m/s")
    assert narrow.shots > pack.shots + 2


def test_the_forecast_of_a_sweep_is_the_sum_over_its_rows(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    # each row by itself: of a sum no part would be missed in another
    of_plies = {1: shots_of_a_search(wc.setup("S-720", 100.0)) + 2, 2: 8 + 5}
    for plies in ([1], [2], [1, 2]):
        over = {"panel.plies": plies}
        swept = wc.sweep("S-720", over=over, quantity="critical-velocity", check=True)
        assert swept.shots == sum(map(of_plies.get, plies))
        assert swept.searches == len(plies)
    one = wc.v50("S-720", shots=20, check=True)
    swept = wc.sweep("S-720", over={"panel.plies": [1]}, quantity="v50", shots=20, check=True)
    assert (swept.shots, swept.cpu_time) == (one.shots, pytest.approx(one.cpu_time))
    assert not list(tmp_path.iterdir())


def test_a_long_forecast_says_what_it_grows_with_and_what_spreads_it():
    """Twice the plies take twice the time, twice the memory but for what all share; short ones say nothing of it."""
    panel = {"opening": "0.2 m", "elements_per_crossover": 2, "ply_gap": "0.1 mm"}
    one, two = (wc.impact("S-720", "300 m/s", plies=n, check=True, **panel) for n in (20, 40))
    assert two.elements == 2 * one.elements
    assert two.cpu_time == pytest.approx([2 * seconds for seconds in one.cpu_time], rel=0.02)
    assert 1.6 * one.memory < two.memory < 2.02 * one.memory
    assert run_size.GROWTH in str(two)
    assert "executor" not in str(two)
    study = wc.v50("S-720", shots=60, plies=8, check=True, **panel)
    assert run_size.GROWTH in str(study)
    assert f"jobs and executor {run_size.SPREAD}" in str(study)
    short = wc.impact("S-720", "90 m/s", opening="20 mm", end_time="10 us", check=True)
    assert run_size.GROWTH not in str(short)


# of shots of a 9 mm bullet at S-728, to their end: {(plies, m/s, opening [mm], failure lengths of an
# element): (steps, CPU time [s])}
FLIGHTS = {
    (10, 400, 300, 2.0): (1485, 16.3),
    (4, 300, 200, 2.0): (1056, 4.3),
    (4, 300, 200, 1.0): (1122, 4.9),
    (4, 220, 200, 2.0): (1716, 5.6),
    (4, 220, 200, 1.0): (1584, 7.2),
    (4, 220, 200, 0.5): (1693, 13.5),
    (4, 145, 200, 1.0): (3197, 13.6),
    (4, 145, 200, 0.5): (3125, 23.2),
    (2, 100, 100, 0.5): (2458, 6.0),
    (2, 100, 100, 0.25): (4960, 28.9),
}


@pytest.mark.parametrize("shot", FLIGHTS)
def test_the_flight_of_a_bullet_takes_what_was_forecast_within_a_factor_of_two(shot):
    """Times of a machine that others shared: what is forecast are steps of the solver, too."""
    plies, velocity, side, resolved = shot
    steps, cpu_time = FLIGHTS[shot]
    bullet = {"projectile": "9 mm FMJ 8.0 g", "plies": plies, "opening": f"{side} mm"}
    setup = wc.setup("S-728", f"{velocity} m/s", **bullet).graded(resolved, 4)
    size = wc.impact(setup, check=True)
    flight = run_size.forecast_flight(setup)
    assert 0.5 < flight / size.time_step / steps < 2
    low, high = (float(word) for word in size.of_bullet[0].partition(" s ")[0].split(" to "))
    assert low < cpu_time < high


def test_a_bullet_is_told_its_mesh_and_what_the_one_that_is_found_costs():
    """Of a mesh that is given with the cost of the default over its own; FSPs are told nothing."""
    pack = {"plies": 2, "opening": "60 mm"}
    bullet = pack | {"projectile": "9 mm FMJ 8.0 g"}
    setup = wc.setup("S-728", "300 m/s", **bullet)
    found = "elements of 0.37 mm within 15 mm of the impact point, 0.5 of the failure length"
    assert found in str(wc.impact(setup, check=True).of_bullet)
    coarse = wc.impact(setup.graded(2.0, 4), check=True).of_bullet
    assert "mesh given: elements of 1.5 mm within 18 mm of the impact point, 2 of the" in coarse[1]
    assert coarse[2].endswith("0.083 of the projectile's radius")
    assert found in coarse[2]
    even = wc.impact(replace(setup, elements_per_crossover=1), check=True).of_bullet
    assert "mesh given: elements of 1.5 mm everywhere" in even[1]
    fragment = wc.setup("S-728", "300 m/s", **pack, projectile="FSP 1.10 g")
    assert wc.impact(fragment, check=True).of_bullet == ()


def test_the_error_that_is_told_of_a_found_mesh_is_the_larger_of_its_studies():
    """Of pinned yarns: the fragment's is above the tenth that was wanted, as the study says."""
    off = []
    for pack in ("fragment", "bullet"):
        rows = pandas.read_csv(DATA / f"cost-pack-{pack}.csv", skiprows=1, index_col="method")
        off.append(rows.loc["default", "error of absorbed energy [%]"])
    assert run_size.MOVED_BY_HALF == pytest.approx(max(off), abs=0.05)
