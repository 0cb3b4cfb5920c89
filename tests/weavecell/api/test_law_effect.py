"""What the range of a law does to a shot, with a closed form in place of the shots."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from fabrics import catalogue
from fabrics.base.errors import InputError
from weavecell.api import law_effect
from weavecell.studies import ballistic_limit
from weavecell.studies.ballistic_limit import Shot


@pytest.fixture(scope="module")
def s720():
    return catalogue.load("S-720")


@pytest.fixture
def fired(monkeypatch):
    """Shots that were fired, (velocity, a); one perforates above 70 m/s, and dents go with the root of a."""
    found = []
    monkeypatch.setattr(
        law_effect,
        "setup",
        lambda fabric, velocity, crossovers, opening=0.203: SimpleNamespace(
            target=lambda: SimpleNamespace(laws=fabric.laws, opening=opening)
        ),
    )

    def critical_velocity(target, tolerance, guess, step):
        if target.opening > 0.1:
            raise InputError("stops all")
        return SimpleNamespace(velocity=52 * (4e-5 / target.laws[0].a) ** 0.125)

    monkeypatch.setattr(ballistic_limit, "critical_velocity", critical_velocity)

    def shoot(target, velocities):
        (velocity,) = velocities
        found.append((velocity, target.laws[0].a))
        dent = 2e-4 * velocity * (target.laws[0].a / 4e-5) ** 0.5
        outcome = "perforated" if velocity > 70 else "stopped"
        return (Shot(velocity, 0.0, outcome, 1e-3, 0.0, (9.0, 7.0), 0.0, 0.1, (), dent),)

    monkeypatch.setattr(ballistic_limit, "shoot", shoot)
    return found


def test_the_dent_of_both_ends_is_told_at_a_velocity_that_all_laws_stop(fired, s720):
    law = replace(s720.laws[0], a=4e-5, F_range=(0.5, 90.0))
    wide = law.with_spread([[0.04, 0.03], [0.03, 0.09]])
    effect = law_effect.find_effect(s720, wide)
    assert [velocity for velocity, _ in fired] == [90.0, 60.0, 60.0, 60.0]
    soft, stiff = (end.a / law.a for end in wide.ends().values())
    assert effect.velocity == 60
    assert effect.dents == pytest.approx([0.012, 0.012 * soft**0.5, 0.012 * stiff**0.5])
    low, high = (100 * (ratio**0.5 - 1) for ratio in (stiff, soft))
    slow, fast = (100 * (ratio**-0.125 - 1) for ratio in (soft, stiff))
    assert effect.line() == (
        f"its range moves the dent of a pinned ply at 60 m/s by {low:+.2g} to {high:+.2g} % "
        f"and its critical velocity in 80 mm by {slow:+.2g} to {fast:+.2g} %"
    )
    assert law_effect.find_effect(s720, law) is None


def test_where_no_limit_is_found_the_dent_is_told_alone(fired, s720, monkeypatch):
    law = replace(s720.laws[0], F_range=(0.5, 90.0)).with_spread([[0.04, 0.03], [0.03, 0.09]])
    monkeypatch.setattr(law_effect, "SMALL_OPENING", 0.2)
    effect = law_effect.find_effect(s720, law)
    assert effect.limits == ()
    assert "critical" not in effect.line()


def test_where_every_velocity_perforates_nothing_is_told(fired, s720, monkeypatch):
    law = replace(s720.laws[0], F_range=(0.5, 90.0)).with_spread([[0.04, 0.03], [0.03, 0.09]])
    monkeypatch.setattr(law_effect, "VELOCITIES", (120.0, 90.0))
    assert law_effect.find_effect(s720, law) is None


@pytest.mark.slow(20)
def test_an_own_fabric_is_dented_more_with_the_soft_end(s720):
    """Real shots: a law three times as soft dents more, one as much stiffer less; limits are the other way round."""
    law = replace(s720.laws[0], F_range=(0.5, 90.0)).with_spread([[0.3, 0.3], [0.3, 0.32]])
    effect = law_effect.find_effect(s720, law)
    middle, soft, stiff = effect.dents
    assert 0.9 * middle < stiff < middle < soft < 1.3 * middle
    middle, soft, stiff = effect.limits
    assert 0.9 * middle < soft < stiff < 1.1 * middle
