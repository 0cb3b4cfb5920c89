"""Critical velocity: bisection and scan on made-up outcomes and on a panel, the same with any number of workers."""

import threading
from bisect import bisect_left
from dataclasses import replace
from math import inf

import numpy as np
import pytest

from fabrics.base.errors import InputError, UndecidedError, UnstableError
from fabrics.yarn import striking_velocity
from shellfabric import guards
from shellfabric.impact.attempts import shorter_step
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.numerics import Numerics
from shellfabric.plies.model import Pack
from tests.shellfabric.panels import make_panel
from validation.models.cable.smith import smith
from weavecell.studies import ballistic_limit, limit_scan
from weavecell.studies.ballistic_limit import Shot
from weavecell.studies.limit_scan import ScanRange, scan

# [s] for what another thread does, on a machine that does other things too
PATIENCE = 3000
# stops below 208.5 m/s, then perforates and stops by turns; like S-745 on a coarse mesh
MIXED = (208.5, 222.0, 226.0, 258.0, 262.0)


def made_up(velocity, outcome):
    perforated = outcome == "perforated"
    return Shot(velocity, 50.0 if perforated else 0.0, outcome, 1e-4, 0, (1.0, 1.0), 0.0, 0.0)


@pytest.fixture
def small():
    """Make a small panel, 24 x 24 crossovers as a whole."""
    return make_panel


@pytest.fixture
def pretend(monkeypatch):
    """Let the outcome change at each of the given velocities, from a stop at first; returns the velocities begun."""

    def make(*changes):
        begun = []

        def fire(_, velocity, __):
            begun.append(velocity)
            return made_up(
                velocity, "perforated" if bisect_left(changes, velocity) % 2 == 1 else "stopped"
            )

        monkeypatch.setattr(ballistic_limit, "_fire", fire)
        return begun

    return make


@pytest.mark.parametrize("truth", [3.0, 99.9, 100.0, 140.0, 777.7])
@pytest.mark.parametrize("tolerance", [1.0, 0.01])
def test_bisection_finds_the_limit(pretend, truth, tolerance):
    begun = pretend(truth)
    found = ballistic_limit.critical_velocity(None, tolerance=tolerance, guess=100.0)
    assert found.low <= truth <= found.high
    assert 0 < found.high - found.low <= tolerance
    assert found.velocity == pytest.approx(truth, abs=tolerance / 2)
    assert found.half_width <= tolerance / 2
    assert found.single
    # one worker begins nothing in vain
    assert [shot.strike_velocity for shot in found.shots] == begun
    # steps to bracket it grow, then every shot halves the bracket
    assert len(begun) <= 8 + np.log2(max(truth, 100.0) / tolerance)


def test_number_of_workers_does_not_matter(pretend, small):
    results = []
    panel = small()
    for workers in (1, 2, 3, 7):
        begun = pretend(*MIXED)
        results.append(
            scan(
                panel,
                ballistic_limit.critical_velocity(panel, guess=200.0, jobs=workers),
                jobs=workers,
            )
        )
        assert len(begun) >= len(results[-1].shots)
    assert all(result == results[0] for result in results)


def test_shots_in_vain_are_given_up(pretend, monkeypatch, small):
    """A shot that turns out not to be needed ends at its next audit, and its errors do not matter."""
    given_up = []
    begun = threading.Event()

    def fire(_, velocity, give_up):
        if velocity > 100.0:  # would follow a stop at 100 m/s, which perforates
            begun.set()
            assert give_up.wait(PATIENCE)
            given_up.append(velocity)
            raise UnstableError("of no interest")
        assert begun.wait(PATIENCE)
        return made_up(velocity, "perforated" if velocity > 90.0 else "stopped")

    monkeypatch.setattr(ballistic_limit, "_fire", fire)
    found = ballistic_limit.critical_velocity(small(), guess=100.0, jobs=2)
    assert found.low <= 90.0 <= found.high
    assert given_up == [120.0]


def test_no_limit(pretend):
    pretend(inf)
    with pytest.raises(InputError, match="stops the projectile at any"):
        ballistic_limit.critical_velocity(None, guess=100.0)
    pretend(0.0)
    with pytest.raises(InputError, match="lets the projectile through at any"):
        ballistic_limit.critical_velocity(None, guess=100.0)


def test_first_guess_is_a_share_of_smiths_and_rises_with_the_plies(small):
    panel = small()
    yarn = panel.weave.warp
    at_once = striking_velocity(yarn.wave_speed, yarn.failure_strain)
    assert smith(yarn, at_once).strain == pytest.approx(yarn.failure_strain, rel=1e-9)
    one = ballistic_limit.first_guess(panel)
    eight = ballistic_limit.first_guess(Pack.stacked(panel, 8, gap=1e-4))
    assert 0 < one < at_once
    assert one < eight < 4 * one


@pytest.fixture(scope="module", params=[1, 2], ids=["one ply", "two plies"])
def searched(request):
    """Search the limit of a small panel or pack, then shoot at both ends of the bracket and at 1.8 and 2 times its
    upper end, with another number of workers: (plies, target, Limit, [(share, shot)] of the progress, shots)."""
    plies = request.param
    target = Pack.stacked(make_panel(), plies, stacking="alternating", gap=1e-4)
    seen = []
    found = ballistic_limit.critical_velocity(
        target, tolerance=4.0, jobs=plies, report=lambda share, shot: seen.append((share, shot))
    )
    velocities = [found.low, found.high, 1.8 * found.high, 2 * found.high]
    return plies, target, found, seen, ballistic_limit.shoot(target, velocities, jobs=3 - plies)


def test_the_bracket_is_as_narrow_as_the_tolerance(searched):
    _, _, found, _, _ = searched
    assert found.high - found.low <= 4.0


def test_two_plies_stop_more_than_one(searched):
    plies, _, found, _, _ = searched
    if plies == 2:
        assert found.low > ballistic_limit.critical_velocity(make_panel(), tolerance=4.0).high


def test_progress_reports_each_shot_of_a_search_once_and_ends_at_all_of_it(searched):
    _, _, found, seen, _ = searched
    shares = [share for share, _ in seen]
    assert [shot for _, shot in seen] == list(found.shots)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_residual_velocities_rise_from_0_at_the_lower_end_of_the_bracket(searched):
    _, _, found, _, shots = searched
    assert [shot.outcome for shot in shots] == ["stopped", *["perforated"] * 3]
    residuals = [shot.residual_velocity for shot in shots]
    assert residuals[0] == 0.0
    assert 0 < residuals[1] < residuals[2] < residuals[3] < 2 * found.high


def test_the_ends_of_the_bracket_are_what_single_shots_come_to(searched):
    _, _, found, _, shots = searched
    known = {shot.strike_velocity: replace(shot, wall_time=0.0) for shot in found.shots}
    for shot in shots[:2]:
        assert replace(shot, wall_time=0.0) == known[shot.strike_velocity]


def test_a_shot_of_a_search_is_what_the_solver_computes(searched):
    plies, target, found, _, shots = searched
    solver = PackSolver(target, found.high, 5e-3, interval=10e-6).run()
    if solver.step_loss > guards.MOST_STEP_LOSS:  # then a shot is made again, as this one
        shorter = target.at_shorter_step(shorter_step(solver.step_loss))
        solver = PackSolver(shorter, found.high, 5e-3, interval=10e-6).run()
    assert shots[1].residual_velocity == solver.residual_velocity
    assert shots[1].peak_tension == tuple(solver.peak_tensions[..., 0].max(axis=0))
    assert shots[1].cut_yarns == solver.sample("cut_yarns")[-1] > 0
    # springs that a tear had compressed gave back up to 1.4 % of the strike energy more than the plies had put in
    assert plies == 1 or solver.sample("ply_contact").min() >= -1e-9 * solver.strike_energy


def test_cloth_that_nothing_holds_has_no_limit(small):
    """With free edges the projectile carries the fabric along: neither stop nor perforation."""
    with pytest.raises(UndecidedError, match="no critical velocity") as caught:
        ballistic_limit.shoot(small(boundary="free"), [5.0])
    assert caught.value.shots == ()


def test_a_shot_gone_wrong(small):
    panel = small(numerics=Numerics(contact_damping=20.0))
    with pytest.raises(UnstableError, match="of the shot at 100 m/s") as caught:
        ballistic_limit.critical_velocity(panel, guess=100.0)
    assert caught.value.shots == ()
    assert threading.active_count() < 20


# scan about a limit


@pytest.mark.parametrize("guess", [180.0, 205.0, 224.0, 250.0, 260.0, 300.0])
def test_zone_does_not_depend_on_the_bracket(pretend, guess):
    """Bisections from other guesses end at other changes of the outcome; the zone that the scan encloses is the same,
    within its step. A bisection alone cannot see it."""
    pretend(*MIXED)
    bracket = ballistic_limit.critical_velocity(None, guess=guess)
    found = scan(None, bracket, ScanRange(above=0.3, below=0.2, step=0.01))
    low, high = found.mixed_zone
    assert (low, high) == pytest.approx((208.5, 262.0), abs=0.01 * bracket.high)
    assert found.low == bracket.low
    assert found.high == bracket.high
    assert limit_scan.indicator(found).value == high - low


def test_stop_far_above_extends_the_scan(pretend):
    """Shots go on until the whole range above the highest stop perforates."""
    fired = pretend(100.0, 120.0, 121.5, 145.0, 147.0)
    bracket = ballistic_limit.critical_velocity(None, guess=100.0)
    found = scan(None, bracket, ScanRange(above=0.22, below=0.0, step=0.01))
    # beyond 1.22 times the bracket, within 1.22 x 121
    assert found.highest_stop == pytest.approx(146.0, abs=1.0)
    assert max(fired) == pytest.approx(1.22 * found.highest_stop, abs=0.01 * bracket.high)
    assert len(fired) == len(set(fired)) == len(found.shots)


def test_perforation_below_the_bracket(pretend):
    pretend(90.0, 92.0, 100.0)
    bracket = ballistic_limit.critical_velocity(None, guess=99.0, step=1.02)
    found = scan(None, bracket, ScanRange(above=0.0, below=0.12, step=0.01))
    assert bracket.low > 99.0
    assert found.mixed_zone == (found.lowest_perforation, bracket.low)
    assert found.lowest_perforation == pytest.approx(91.0, abs=1.0)
    assert min(shot.strike_velocity for shot in found.shots) < 0.9 * 91.0


def test_single_limit(pretend):
    fired = pretend(100.0)
    bracket = ballistic_limit.critical_velocity(None, guess=100.0, tolerance=0.5)
    before = len(fired)
    found = scan(None, bracket)
    assert found.single
    assert found.mixed_zone is None
    assert limit_scan.indicator(found).ok
    assert found.shots[: len(bracket.shots)] == bracket.shots
    above = sorted(v for v in fired[before:] if v > 100.0)
    below = sorted(v for v in fired[before:] if v < 100.0)
    # 25 and 10 % in steps of 2 %
    assert len(above) + len(below) == len(fired) - before == pytest.approx(17, abs=1)
    assert above[0] - bracket.high == pytest.approx(0.02 * bracket.high)
    assert above[-1] == pytest.approx(1.25 * bracket.low, abs=2.1)
    assert below[0] == pytest.approx(0.9 * bracket.high, abs=2.1)


def test_no_range_fires_nothing(pretend):
    fired = pretend(*MIXED)
    bracket = ballistic_limit.critical_velocity(None, guess=200.0)
    before = len(fired)
    assert scan(None, bracket, ScanRange(above=0.0, below=0.0)) == bracket
    assert len(fired) == before
