"""Velocities that shares of shots pass: populations whose limits are known, made ones and two of this code."""

import json
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import weavecell as wc
from weavecell.runs import difference, go_no_go, table, v50
from weavecell.runs.go_no_go import LEVELS, Outcomes
from weavecell.runs.measurement import Measurement
from weavecell.studies.inputs import Scatter

NAMES = ("place", "friction between yarns", "friction on the nose")
SLOPES = np.array([-0.05, 0.13, 0.08])
# 62 panels of 50 mm of S-728 before a sphere of 5.5 mm, 28 of 60 mm of S-726 before a fragment of 1.10 g: each
# drawn, and its limit bisected to 2 to 3 m/s with all yarns resolved
LIMITS = pd.read_csv(Path(__file__).with_name("drawn_limits.csv"))


def draw(seed, count, middle=90.0, slopes=SLOPES, scatter=0.06):
    """What is known of panels and their limits [m/s]."""
    random = np.random.default_rng(seed)
    spread = [random.uniform(-0.8, 0.8, count), *random.uniform(-0.5, 0.5, (2, count))]
    known = np.column_stack(spread)
    return known, middle * (1 + known @ slopes + scatter * random.standard_normal(count))


def shoot(known, limits, guess, names=NAMES):
    """Outcomes of shots at panels in rounds of two, each placed by those before."""
    shots = Outcomes(names, known[:0], np.zeros(0), np.zeros(0, bool))
    for begun in range(0, len(known), 2):
        coarse = go_no_go.fit(shots, guess, draws=go_no_go.COARSE)
        velocity = np.append(shots.velocity, go_no_go.place(coarse, known[begun : begun + 2]))
        fired = slice(0, begun + 2)
        shots = Outcomes(names, known[fired], velocity, velocity > limits[fired])
    return shots


@cache
def study(seed, count=16, **scene):
    """The LimitPosterior of a study, with its population."""
    known, limits = draw(seed, count, **scene)
    middle = scene.get("middle", 90.0)
    guess = middle * np.exp(np.random.default_rng(seed).uniform(np.log(0.7), np.log(1.5)))
    return go_no_go.fit(shoot(known, limits, guess), guess, draw(1, 64)[0])


def test_intervals_hold_the_truth():
    """Of 16 shots, from guesses 30 % low to 50 % high, at a plane like that of drawn panels."""
    true = np.quantile(draw(0, 100_000)[1], LEVELS)
    found = [[*study(seed).velocities.values()] for seed in range(10, 20)]
    inside = [[one.low <= value <= one.high for one, value in zip(row, true)] for row in found]
    assert np.mean(inside) >= 0.8
    off = [row[1].value / true[1] - 1 for row in found]
    assert np.sqrt(np.mean(np.square(off))) < 0.045


@pytest.mark.parametrize("scene, names", [("sphere", ()), ("fsp", NAMES[1:])])
def test_intervals_hold_limits_of_this_code(scene, names):
    table = LIMITS[LIMITS["scene"] == scene]
    limits = table["limit [m/s]"].to_numpy()
    known = table[list(names)].to_numpy()
    true = np.quantile(limits, LEVELS)
    inside, off = [], []
    for seed in range(5):
        order = np.random.default_rng(seed).permutation(limits.size)[:16]
        shots = shoot(known[order], limits[order], 130.0, names)
        spans = [*go_no_go.fit(shots, 130.0, known).velocities.values()]
        inside.append([one.low <= value <= one.high for one, value in zip(spans, true)])
        off.append(spans[1].value / true[1] - 1)
    assert np.mean(inside) >= 0.8
    assert np.sqrt(np.mean(np.square(off))) < 0.05


@pytest.mark.parametrize("guess", [60.0, 135.0])
def test_a_wrong_guess_is_left(guess):
    """Both outcomes are seen within six shots, and shots settle beside the limits."""
    known, limits = draw(3, 24)
    shots = shoot(known, limits, guess)
    assert 0 < shots.perforated[:6].sum() < 6
    assert np.abs(shots.velocity[12:] / limits[12:] - 1).max() < 0.35


def test_shots_of_a_round_lie_on_both_sides():
    none = Outcomes(NAMES, np.zeros((0, 3)), np.zeros(0), np.zeros(0, bool))
    velocity = go_no_go.place(go_no_go.fit(none, 100.0, draws=256), np.zeros((4, 3)))
    assert np.ptp(velocity) > 30


def test_as_many_as_asked_pass_at_each_level():
    posterior = study(11)
    levels = posterior.levels()
    for column, level in enumerate(LEVELS):
        for draw_ in range(0, 2048, 400):
            mean = posterior.middle[draw_] * (1 + posterior.population @ posterior.slopes[draw_])
            rest = posterior.middle[draw_] * posterior.scatter[draw_]
            drawn = np.random.default_rng(1).standard_normal((2000, 1))
            passed = levels[draw_, column] > mean + rest * drawn
            assert passed.mean() == pytest.approx(level, abs=0.02)


# {log10 of the dose: (beetles, of which died)} of Bliss (1935), the standard example of a probit
BEETLES = {
    1.6907: (59, 6),
    1.7242: (60, 13),
    1.7552: (62, 18),
    1.7842: (56, 28),
    1.8113: (63, 52),
    1.8369: (59, 53),
    1.8610: (62, 61),
    1.8839: (60, 60),
}


def test_many_tests_have_the_probit_of_bliss():
    """Median and deviation of 481 outcomes, as a generalised linear model finds them in public: priors weigh
    nothing beside so many."""
    dose = np.concatenate([np.full(count, 100 * at) for at, (count, _) in BEETLES.items()])
    died = np.concatenate([np.arange(count) < dead for count, dead in BEETLES.values()])
    found = go_no_go.fit(Outcomes.of_tests(dose, died), 150.0)
    assert np.median(found.middle) == pytest.approx(177.0852, rel=0.001)
    assert np.median(found.middle * found.scatter) == pytest.approx(5.069, rel=0.03)


def test_the_six_shots_of_the_standard():
    """The example of MIL-STD-662F, whose V50 is the mean of six."""
    velocity = 0.3048 * np.array([430.0, 445.0, 452.0, 455.0, 470.0, 480.0])
    perforated = np.array([False, False, True, False, True, True])
    v10, v50, v90 = go_no_go.fit(Outcomes.of_tests(velocity, perforated), 200.0).velocities.values()
    assert v50.low < velocity.mean() < v50.high
    assert v50.value == pytest.approx(velocity.mean(), rel=0.02)
    assert v10.value < v50.value < v90.value


def test_separated_shots_leave_what_a_public_answer_leaves():
    """R-help, 2003: by the profile likelihood of a logistic curve 9.10 to 10.42 is consistent with the data, of
    which no stop is faster than a perforation."""
    stops = [-5.8, -4.8, -2.8667, -1.6667, -0.8667, -0.7333]
    velocity = 10 + np.array([*stops, -0.1333, 1.2, 1.3333])
    found = go_no_go.fit(Outcomes.of_tests(velocity, velocity > 9.5), 12.0)
    v50 = found.velocities["V50"]
    assert 8.3 < v50.low < 9.10 < v50.value < 10.42 < v50.high < 11.3


def test_units_do_not_matter():
    known, limits = draw(5, 12)
    shots = shoot(known, limits, 100.0)
    other = Outcomes(NAMES, shots.known, 3.28 * shots.velocity, shots.perforated)
    metric, feet = (
        go_no_go.fit(one, guess, draws=256) for one, guess in ((shots, 100.0), (other, 328.0))
    )
    assert feet.middle / 3.28 == pytest.approx(metric.middle)


def test_v50_of_cloths_varies_less_than_limits_of_shots():
    """Frictions of a cloth are drawn once, its places and yarns are not; known frictions narrow it."""
    posterior = study(12, 24)
    v10, v50, v90 = posterior.velocities.values()
    cloth = posterior.cloths()
    assert v10.low < cloth.low < v50.value < cloth.high < v90.high
    narrowed = [posterior.narrow(name, 0.2).cloths().half for name in NAMES]
    # a place is another with each shot
    assert narrowed[0] == cloth.half
    assert max(narrowed[1:]) < cloth.half


def test_a_friction_that_is_known_narrows_as_foretold():
    """The spread of V50 over cloths with one friction drawn from a fifth of its range, by the plane itself."""
    posterior = study(13, 64)
    known, _ = draw(2, 4000)
    middle = 90 * (1 + np.where([False, True, True], known, 0) @ SLOPES)
    part = 90 * (1 + np.where([False, True, True], known * [1, 0.2, 1], 0) @ SLOPES)
    true = np.ptp(np.quantile(part, (0.05, 0.95))) / np.ptp(np.quantile(middle, (0.05, 0.95)))
    foretold = posterior.narrow(NAMES[1], 0.2).cloths().half / posterior.cloths().half
    assert foretold == pytest.approx(true, abs=0.2)


def test_a_study_says_what_narrows_it_most():
    """Of two frictions that of more weight first; a place narrows no cloth."""
    posterior = study(14, 32)
    ranges = {NAMES[1]: (0.1, 0.3), NAMES[2]: (0.05, 0.45)}
    found = v50.Study((), posterior, Scatter(), ranges).measurements
    widths = {name: posterior.widths[name] for name in NAMES[1:]}
    assert [one.quantity for one in found] == sorted(widths, key=widths.get, reverse=True)
    for one in found:
        assert one.then.half < one.now.half == posterior.cloths().half
        low, high = ranges[one.quantity]
        assert one.known == pytest.approx(0.1 * (high - low))
        assert Measurement.read(json.loads(json.dumps(one.entry()))) == one


def test_what_is_drawn_is_ranked():
    """A friction that moves the limit by 40 % of it stands before one that moves it by 2 %."""
    known, limits = draw(6, 48, slopes=np.array([0.0, 0.4, 0.02]), scatter=0.03)
    posterior = go_no_go.fit(shoot(known, limits, 100.0), 100.0, known)
    assert next(iter(posterior.widths)) == NAMES[1]
    assert next(iter(posterior.shares)) == NAMES[1]
    assert sum(share.value for share in posterior.shares.values()) == pytest.approx(1, abs=0.1)


def test_the_difference_of_two_studies():
    """Panels that are alike differ by nothing, those 15 % stronger are better; a study less itself is 0."""
    alike = difference.subtract(study(20).middles, study(21).middles)
    assert alike.low < 0 < alike.high
    stronger = study(22, 24, middle=103.5).middles
    found = difference.Difference(difference.subtract(stronger, study(21).middles), 16)
    assert found.verdict == difference.BETTER
    assert found.shots_to_decide() is None
    itself = difference.Difference(difference.subtract(study(21).middles, study(21).middles), 16)
    assert abs(itself.value) < 0.3 * itself.span.half
    assert itself.verdict == difference.UNDECIDED


@pytest.mark.parametrize(
    "value, half, needed", [(4.0, 8.0, 64), (-3.0, 3.0, 17), (1e-3, 8.0, None)]
)
def test_shots_that_would_decide(value, half, needed):
    span = difference.Span(value, value - half, value + half)
    assert difference.Difference(span, 16).shots_to_decide() == needed


def test_no_difference_without_an_answer():
    found = difference.Difference.missing(8, "all shots at A end alike")
    assert found.verdict == difference.UNDECIDED
    assert found.shots_to_decide() is None


@pytest.mark.parametrize("perforated", [False, True])
def test_a_study_whose_shots_end_alike_has_a_result(perforated, monkeypatch, tmp_path):
    def run(rows, **_):
        residual = 20.0 if perforated else 0.0
        return [table.Shot(row.velocity, residual, perforated, balance=0.0) for row in rows]

    monkeypatch.setattr(table, "run", run)
    found = wc.v50(
        "S-728", shots=6, opening="30 mm", projectile="sphere 5.5 mm", out=tmp_path / "r"
    )
    assert np.isnan(found.v50)
    assert found.velocities == {}
    assert found.summary()["v50_m_s"] is None
    assert len(found.to_dataframe()) == 6
    assert "not determined: all outcomes are alike" in str(found)
    assert (tmp_path / "r" / "report.html").is_file()
