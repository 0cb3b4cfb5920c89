"""Scan about a ballistic limit, on made-up outcomes: single limits, zones of mixed outcomes, range and step."""

from bisect import bisect_right

import pytest

from shellfabric.impact import ballistic_limit, limit_scan
from shellfabric.impact.ballistic_limit import Shot
from shellfabric.impact.limit_scan import ScanRange, scan

# stops below 208.5 m/s, then perforates and stops by turns; like S-745 on a coarse mesh
MIXED = (208.5, 222.0, 226.0, 258.0, 262.0)


@pytest.fixture
def outcomes(monkeypatch):
    """Let the outcome change at each of the given velocities, from a stop at first; the velocities fired so far."""

    def make(*changes):
        fired = []

        def fire(_, velocity, __):
            fired.append(velocity)
            perforated = bisect_right(changes, velocity) % 2 == 1
            outcome = "perforated" if perforated else "stopped"
            return Shot(velocity, 50.0 if perforated else 0.0, outcome, 1e-4, 0, (1.0, 1.0), 0.0, 0.0)

        monkeypatch.setattr(ballistic_limit, "_fire", fire)
        return fired

    return make


def test_mixed_zone_is_found(outcomes):
    outcomes(*MIXED)
    bracket = ballistic_limit.critical_velocity(None, guess=205.0)
    assert bracket.single, "a bisection alone cannot see it"
    found = scan(None, bracket, ScanRange(step=0.01))
    assert not found.single
    low, high = found.mixed_zone
    assert low == found.lowest_perforation == pytest.approx(208.5, abs=0.01 * bracket.high)
    assert high == found.highest_stop == pytest.approx(262.0, abs=0.01 * bracket.high)
    assert (found.low, found.high) == (bracket.low, bracket.high)
    assert limit_scan.indicator(found).value == high - low
    assert not limit_scan.indicator(found).ok


@pytest.mark.parametrize("guess", [180.0, 224.0, 250.0, 260.0, 300.0])
def test_zone_does_not_depend_on_the_bracket(outcomes, guess):
    """Bisections from other guesses end at other changes of the outcome; the zone that the scan encloses is the same,
    within its step."""
    outcomes(*MIXED)
    bracket = ballistic_limit.critical_velocity(None, guess=guess)
    step = 0.01 * bracket.high
    found = scan(None, bracket, ScanRange(above=0.3, below=0.2, step=0.01))
    assert found.mixed_zone == pytest.approx((208.5, 262.0), abs=step)


def test_stop_far_above_extends_the_scan(outcomes):
    """Shots go on until the whole range above the highest stop perforates."""
    fired = outcomes(100.0, 120.0, 121.5, 145.0, 147.0)
    bracket = ballistic_limit.critical_velocity(None, guess=100.0)
    found = scan(None, bracket, ScanRange(above=0.22, below=0.0, step=0.01))
    assert found.highest_stop == pytest.approx(146.0, abs=1.0)  # beyond 1.22 times the bracket, within 1.22 x 121
    assert max(fired) == pytest.approx(1.22 * found.highest_stop, abs=0.01 * bracket.high)
    assert len(fired) == len(set(fired)) == len(found.shots)


def test_perforation_below_the_bracket(outcomes):
    outcomes(90.0, 92.0, 100.0)
    bracket = ballistic_limit.critical_velocity(None, guess=99.0, step=1.02)
    found = scan(None, bracket, ScanRange(above=0.0, below=0.12, step=0.01))
    assert bracket.low > 99.0
    assert found.mixed_zone == (found.lowest_perforation, bracket.low)
    assert found.lowest_perforation == pytest.approx(91.0, abs=1.0)
    assert min(shot.strike_velocity for shot in found.shots) < 0.9 * 91.0


def test_single_limit(outcomes):
    fired = outcomes(100.0)
    bracket = ballistic_limit.critical_velocity(None, guess=100.0, tolerance=0.5)
    before = len(fired)
    found = scan(None, bracket)
    assert found.single
    assert found.mixed_zone is None
    assert limit_scan.indicator(found).ok
    assert found.shots[: len(bracket.shots)] == bracket.shots
    above = sorted(v for v in fired[before:] if v > 100.0)
    below = sorted(v for v in fired[before:] if v < 100.0)
    assert len(above) + len(below) == len(fired) - before == pytest.approx(17, abs=1)  # 25 and 10 % in steps of 2 %
    assert above[0] - bracket.high == pytest.approx(0.02 * bracket.high)
    assert above[-1] == pytest.approx(1.25 * bracket.low, abs=2.1)
    assert below[0] == pytest.approx(0.9 * bracket.high, abs=2.1)


def test_no_range_fires_nothing(outcomes):
    fired = outcomes(*MIXED)
    bracket = ballistic_limit.critical_velocity(None, guess=200.0)
    before = len(fired)
    assert scan(None, bracket, ScanRange(above=0.0, below=0.0)) == bracket
    assert len(fired) == before
