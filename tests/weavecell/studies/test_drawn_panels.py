"""What studies draw: numbers of shots, panels that are all different, and the moments of many draws."""

from dataclasses import replace
from math import sqrt

import numpy as np
import pytest

from fabrics import catalogue
from shellfabric.impact.setup import ImpactSetup
from shellfabric.yarns.model import YarnZone
from weavecell.studies import inputs, strengths, v50
from weavecell.studies.ballistic_limit import Limit
from weavecell.studies.inputs import Scatter

# no two spreads are alike
SCATTER = Scatter(shape=12.0, gauge_length=0.15, modulus=0.05, crimp=0.2)
MANY = 20_000


@pytest.fixture(scope="module")
def setup():
    """S-726, whose warp and weft are unlike, two plies."""
    fabric = catalogue.load("S-726").with_effective_density()
    given = {"opening": 0.02, "elements_per_crossover": 1, "table_size": 21, "ply_gap": 1e-4}
    return ImpactSetup(fabric, 90.0, plies=2, **given)


@pytest.mark.parametrize("batch", [4, 5])
def test_shots_of_a_study_are_numbered_through_and_see_panels_of_their_own(
    setup, tmp_path, monkeypatch, batch
):
    """Three rounds, the last of them shorter: numbers 0 to n - 1, and no two draws share a number of theirs."""

    def fire(setup, scatter, seed, number, velocity):
        factors = strengths.draw_factors(scatter, seed, number * setup.plies)
        shot = (velocity, 0.4 * velocity, velocity > 95.0)
        return v50.Shot(
            number, *shot, **factors, weakest=(0.9, 0.8), impact_point=(0, 0), balance=0
        )

    monkeypatch.setattr(v50, "fire", fire)
    monkeypatch.setattr(v50, "deterministic", lambda *_: Limit(95.0, 96.0, ()))
    numbers = lambda inputs: [each for each in inputs[1] if isinstance(each, int | float)]  # noqa: E731
    monkeypatch.setattr(v50.run_cache, "key", lambda inputs, *_: str(numbers(inputs)))
    study = v50.study(setup, SCATTER, shots=11, batch=batch, seed=3, folder=tmp_path)
    assert [shot.number for shot in study.shots] == list(range(11))
    for name in ("modulus", "crimp_warp", "crimp_weft"):
        assert len({getattr(shot, name) for shot in study.shots}) == 11
    drawn = [strengths.draw_factors(SCATTER, 3, 2 * number) for number in range(11)]
    assert [shot.crimp_weft for shot in study.shots] == [each["crimp_weft"] for each in drawn]


def test_no_yarn_of_two_panels_is_alike(setup):
    """Warp and weft of each ply of each of three packs: all strengths differ."""
    packs = [strengths.draw_panel(setup, SCATTER, 3, number).pack for number in range(3)]
    drawn = [factors for pack in packs for ply in pack.plies for factors in ply.strength_factors]
    assert len(drawn) == 3 * 2 * 2
    together = np.concatenate(drawn)
    assert np.unique(together).size == together.size


def test_the_weakest_yarn_is_told_of_its_own_family(setup):
    drawn = strengths.draw_panel(setup, SCATTER, 3, 1)
    for family in (0, 1):
        least = min(ply.strength_factors[family].min() for ply in drawn.pack.plies)
        assert drawn.weakest[family] == least
    assert drawn.weakest[0] != drawn.weakest[1]


def test_moments_of_many_draws():
    """Mean 1, the spread of each number, and no number that goes with another: 5 standard errors."""
    rows = [list(strengths.draw_factors(SCATTER, 1, n).values()) for n in range(MANY)]
    drawn = np.array(rows)
    wanted = np.array([SCATTER.modulus, SCATTER.crimp, SCATTER.crimp])
    assert drawn.mean(axis=0) == pytest.approx(np.ones(3), abs=5 * wanted.max() / sqrt(MANY))
    assert drawn.std(axis=0) == pytest.approx(wanted, rel=0.03)
    together = np.corrcoef(drawn.T)
    assert abs(together - np.eye(3)).max() < 5 / sqrt(MANY)
    assert np.unique(drawn).size == drawn.size


def test_modulus_and_crimp_go_to_their_own_numbers(setup):
    """Each factor changes the number of its name of warp or weft, and no other."""
    factors = {"modulus": 1.1, "crimp_warp": 1.3, "crimp_weft": 0.8}
    scaled = inputs.scale_setup(setup, **factors).fabric.weave
    for name, family, factor in (
        ("E", "warp", 1.1),
        ("E", "weft", 1.1),
        ("crimp", "warp", 1.3),
        ("crimp", "weft", 0.8),
    ):
        before = getattr(getattr(setup.fabric.weave, family), name)
        assert getattr(getattr(scaled, family), name) == pytest.approx(factor * before)


def test_impact_points_fill_a_cell_of_the_weave(setup):
    """Uniform between two crossovers each way, along warp and weft by their own spacings, about the given point."""
    given = replace(
        setup, plies=1, opening=0.04, impact_point=(1e-3, 3e-3), crossovers=YarnZone(8e-3)
    )
    points = np.array([strengths.draw_aim(given, 5, number) for number in range(MANY // 4)])
    spacing = 2 * np.array(given.fabric.weave.w)
    assert points.mean(axis=0) == pytest.approx(given.impact_point, abs=0.05 * spacing.max())
    assert np.ptp(points, axis=0) == pytest.approx(2 * spacing, rel=0.01)
    assert points.std(axis=0) == pytest.approx(spacing / sqrt(3), rel=0.03)
    assert spacing[0] != spacing[1]
    assert abs(np.corrcoef(points.T)[0, 1]) < 5 / sqrt(len(points))
