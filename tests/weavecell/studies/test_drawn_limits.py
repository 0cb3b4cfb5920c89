"""Limits over all that is drawn: a plane with a normal rest against drawn outcomes, the placing of shots, the share
that passes at one velocity, and the nominal values."""

import numpy as np
import pytest
from scipy.stats import beta

import weavecell as wc
from weavecell.results.finding import Answer
from weavecell.studies import drawn, passing, strengths, unknown, v50
from weavecell.studies.drawn import LimitPosterior, Outcomes
from weavecell.studies.mover import Mover
from weavecell.studies.places import ON_WARP, resolve, strike_at

NAMES = ("place", "friction on the nose")
PLANE = np.array([90.0, -6.0, 14.0])  # [m/s]
REST = 5.0


def limits_of(known, random):
    """Limits [m/s] of panels."""
    return PLANE[0] + known @ PLANE[1:] + REST * random.standard_normal(len(known))


def study_of(seed, shots, guess=130.0):
    """The Answer of shots in rounds of two, and its population."""
    random = np.random.default_rng(seed)
    known = random.uniform(-0.5, 0.5, (256, 2)) * [2.0, 1.0]
    limit = limits_of(known, random)
    outcomes = None
    velocity = np.empty(0)
    for begun in range(0, shots, 2):
        placed = drawn.place(outcomes, known[begun : begun + 2], guess)
        velocity = np.append(velocity, placed)
        fired = slice(0, begun + 2)
        outcomes = Outcomes(NAMES, known[fired], velocity, velocity > limit[fired])
    return LimitPosterior(drawn.fit(outcomes, guess), known)


def test_many_shots_find_the_plane():
    found = study_of(1, 300).limits
    assert found.of(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])) == pytest.approx(
        PLANE[0] + np.append(0.0, PLANE[1:]), abs=3.0
    )
    assert found.scatter() == pytest.approx(REST, rel=0.3)


def test_intervals_of_sixteen_shots_hold_v50():
    """Of 40 studies 90 %, less three deviations."""
    held = 0
    off = []
    for seed in range(40):
        span = study_of(seed, 16).velocities["V50"]
        held += span.low <= PLANE[0] <= span.high
        off.append(span.value - PLANE[0])
    assert held >= 30
    assert abs(np.mean(off)) < 1.5
    assert np.std(off) < 4.0


def test_shots_are_placed_below_and_above_the_limit_of_their_own_panels():
    answer = study_of(3, 60)
    known = np.array([[0.5, 0.4], [-0.5, -0.4]])
    placed = drawn.place(answer.limits.shots, known, 130.0)
    assert placed - answer.limits.of(known) == pytest.approx(
        np.array([-1, 1]) * drawn.BESIDE * answer.limits.scatter(), rel=0.2
    )


@pytest.mark.parametrize("perforated", [True, False])
def test_outcomes_that_are_alike_walk_on(perforated):
    shots = Outcomes(NAMES, np.zeros((2, 2)), np.array([60.0, 90.0]), np.full(2, perforated))
    placed = drawn.place(shots, np.zeros((2, 2)), 100.0)
    assert (placed < 60.0).all() if perforated else (placed > 90.0).all()


def test_what_moves_an_answer_most_is_named_first():
    unlike = Mover("mesh", "--uncertainty"), Mover("place", "", 3.0), Mover("roll", "give it", 8.0)
    found = Answer("what", "90 m/s", movers=unlike)
    assert [one.what for one in found.ranked] == ["roll", "place", "mesh"]
    rows = dict(found.rows)
    assert (rows["moved by"], rows["leaves out"]) == ("roll 8 m/s, place 3 m/s", "mesh")
    assert rows["next"] == "give it; uncertainty=True"


def test_one_study_less_itself_is_nothing():
    answer = study_of(5, 16)
    found = drawn.subtract(answer, answer)
    assert found.value == 0
    assert found.low < 0 < found.high


def test_the_share_that_passes_has_the_interval_of_jeffreys():
    def shot(number, through):
        left = 30.0 * number if through else 0.0
        told = {
            "modulus": 1.0,
            "crimp_warp": 1.0,
            "crimp_weft": 1.0,
            "weakest": (1.0, 1.0),
            "frictions": {},
        }
        return v50.Shot(
            number, 90.0, left, through, **told, impact_point=(0, 0), balance=0.0, deflection=0.01
        )

    found = passing.Passing(90.0, tuple(shot(number, number > 2) for number in range(8)), {})
    assert found.share == pytest.approx((0.625, *beta(5.5, 3.5).ppf([0.05, 0.95])))
    assert found.quantiles("residual")[1] == pytest.approx(105.0)


def test_nominal_values_are_the_middle_of_what_is_drawn():
    setup = resolve(wc.setup("S-728", "90 m/s", opening="50 mm", projectile="sphere 5.5 mm"))
    nominal = unknown.choose_nominal(setup, False)
    ranges = unknown.find_unknown(setup)
    assert nominal.crossovers.friction == np.mean(next(iter(ranges.values())))
    assert unknown.find_unknown(nominal) == ranges
    known = np.array([[*strengths.draw_known(setup, 1, number).values()] for number in range(256)])
    assert known.mean(axis=0) == pytest.approx(0.0, abs=0.02)
    assert nominal.impact_point == strike_at(setup, ON_WARP).impact_point
    assert unknown.choose_nominal(setup, True).impact_point == setup.impact_point
