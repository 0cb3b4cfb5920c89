"""V50 of a pack from residual velocities: repeated studies of one pack, stored shots, too few of them."""

import numpy as np
import pytest
from scipy.stats import t as student

from weavecell.studies import pack_limit
from weavecell.studies.bracket import Bracket

# eight plies of S-728, FSP of 1.10 g: strike and residual velocities [m/s] of computed shots
STRIKES = (285.0, 295.0, 300.0, 305.0, 310.0, 315.0, 330.0, 350.0, 370.0)
RESIDUALS = (0.0, 0.0, 0.0, 6.0, 46.0, 58.0, 152.0, 200.0, 222.0)


def study(random, V50, s, p, a):
    """(strikes, residuals) of a bracket and of the shots above it, each with a limit of its own, V50 (1 +- s), and the
    curve of Lambert and Jonas with a and p."""

    def fire(velocity):
        limit = V50 * (1 + s * random.standard_normal())
        return 0.0 if velocity <= limit else a * (velocity**p - limit**p) ** (1 / p)

    guess = V50 * random.uniform(0.8, 1.2)
    width = pack_limit.BRACKET * guess
    bracket = Bracket(guess, width, 1000.0)
    shots = []
    while bracket.width > width:
        shots.append((bracket.next(), fire(bracket.next())))
        bracket = bracket.update(shots[-1][1] > 0)
    above = bracket.high * np.geomspace(*pack_limit.ABOVE, pack_limit.SHOTS)
    return np.array([*shots, *((v, fire(v)) for v in above)]).T


@pytest.mark.slow(4)
@pytest.mark.parametrize(("s", "p", "a"), [(0.02, 3.59, 0.688), (0.02, 2.25, 1.0)])
def test_intervals_of_a_hundred_studies_of_one_pack_hold_v50(s, p, a):
    """Of 95 % intervals 89 or more of 100 hold the true V50: fewer have a chance of 1 %. The curves
    are those fitted to packs of four and eight plies of S-728."""
    random = np.random.default_rng(1)
    held = 0
    shots = []
    for _ in range(100):
        strikes, residuals = study(random, 300.0, s, p, a)
        found = pack_limit.estimate(strikes, residuals)
        held += found.low <= 300.0 <= found.high
        shots.append(strikes.size)
    assert held >= 89
    assert np.mean(shots) < 13


def test_stored_shots_of_eight_plies():
    found = pack_limit.estimate(STRIKES, RESIDUALS)
    assert found.low < 300.0 < found.velocity < 310.0 < found.high
    assert (found.shots, found.perforations) == (9, 6)
    assert f"V50 {found.velocity:.1f} m/s, {found.low:.1f} to" in found.words()


def test_with_one_curve_and_no_stops_it_is_students_t(monkeypatch):
    monkeypatch.setattr(pack_limit, "_SHAPES", (2.0, 2.0 + 1e-9))
    monkeypatch.setattr(pack_limit, "_SHARES", (1.0 - 1e-9, 1.0))
    monkeypatch.setattr(pack_limit, "_GRID", (201, 61, 2, 2))
    limits = np.array([291.0, 302.0, 299.0, 310.0, 305.0, 296.0])
    strikes = np.linspace(320.0, 345.0, 6)
    found = pack_limit.estimate(strikes, np.sqrt(strikes**2 - limits**2))
    half = student.ppf(0.975, 5) * limits.std(ddof=1) / np.sqrt(6)
    ends = limits.mean() - half, limits.mean() + half
    assert (found.low, found.high) == pytest.approx(ends, abs=0.15)
    assert found.velocity == pytest.approx(limits.mean(), abs=0.1)


@pytest.mark.parametrize(
    ("strikes", "residuals"), [((300.0,), (0.0,)), (STRIKES[:6], RESIDUALS[:6])]
)
def test_few_perforations_give_no_v50(strikes, residuals):
    assert pack_limit.estimate(strikes, residuals) is None


def test_shots_far_above_the_limit_do_not_count():
    far = pack_limit.estimate((*STRIKES, 600.0), (*RESIDUALS, 560.0))
    assert far == pack_limit.estimate(STRIKES, RESIDUALS)
