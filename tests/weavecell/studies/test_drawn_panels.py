"""What studies draw: numbers of shots, panels that are all different, and the moments of many draws."""

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest

from fabrics import catalogue
from shellfabric.impact.setup import ImpactSetup
from shellfabric.projectile.projectile import Projectile
from shellfabric.yarns.model import YarnZone
from weavecell.runs import table, v50
from weavecell.studies import inputs, strengths, unknown
from weavecell.studies.inputs import Scatter

# no two spreads are alike
SCATTER = Scatter(shape=12.0, modulus=0.05, crimp=0.2)
MANY = 5_000


def draw_factors(setup, seed, panel):
    """Draw modulus and crimps of a panel: {field of a shot: factor}."""
    values = {
        row.name: row.find(setup, SCATTER).at(row.share(seed, 0, panel))
        for row in unknown.ROWS
        if row.panel is not None
    }
    return {key: values[name] for key, name in strengths.FACTORS.items()}


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

    def fire(setup, velocity, draw):
        factors = draw_factors(setup, draw.seed, draw.number * setup.plies)
        shot = (velocity, 0.4 * velocity, velocity > 95.0, draw.number)
        return table.Shot(*shot, drawn=factors, balance=0.0)

    monkeypatch.setattr(table, "fire", fire)
    told = lambda inputs, *_: f"{inputs[1][1]} {inputs[1][2].number}"  # noqa: E731
    monkeypatch.setattr(table.run_cache, "key", told)
    study = v50.study(setup, SCATTER, shots=11, batch=batch, seed=3, folder=tmp_path)
    assert [shot.number for shot in study.shots] == list(range(11))
    for name in ("modulus", "crimp_warp", "crimp_weft"):
        assert len({shot.drawn[name] for shot in study.shots}) == 11
    drawn = [draw_factors(setup, 3, 2 * number) for number in range(11)]
    assert [shot.drawn["crimp_weft"] for shot in study.shots] == [
        each["crimp_weft"] for each in drawn
    ]


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


def test_moments_of_many_draws(setup):
    """Mean 1, the spread of each number, and no number that goes with another: 5 standard errors."""
    drawn = np.array([list(draw_factors(setup, 1, n).values()) for n in range(MANY)])
    wanted = np.array([SCATTER.modulus, SCATTER.crimp, SCATTER.crimp])
    assert drawn.mean(axis=0) == pytest.approx(np.ones(3), abs=5 * wanted.max() / sqrt(MANY))
    assert drawn.std(axis=0) == pytest.approx(wanted, rel=0.05)
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


@pytest.fixture(scope="module")
def struck(setup):
    """Resolved yarns of two unlike spacings, aimed at beside a crossover, by a chisel that is turned."""
    radius = 2e-3
    flats = {"flat_width": 0.94 * radius, "flat_angle": 0.61}
    chisel = Projectile(1e-3, radius, edge_radius=1e-4, shape="chisel", roll=6.0, **flats)
    w1, w2 = setup.fabric.weave.w
    given = {"impact_point": (2 * w1 * 1.3, 2 * w2 * -1.8), "crossovers": YarnZone(8e-3)}
    return replace(setup, plies=1, opening=0.06, projectile=chisel, **given)


def draw(setup, number):
    return unknown.draw(setup, SCATTER, 5, number, number)[0]


def test_impact_points_fill_what_symmetry_leaves_of_a_repeat(struck):
    """Half a spacing along the warp, a whole one along the weft, from the crossover next to the given point."""
    points = np.array([draw(struck, number).impact_point for number in range(256)])
    shares = points / (2 * np.array(struck.fabric.weave.w)) - [1.0, -2.0]
    assert shares.min(axis=0) == pytest.approx([0.0, 0.0], abs=0.01)
    assert shares.max(axis=0) == pytest.approx([0.5, 1.0], abs=0.01)
    assert shares.mean(axis=0) == pytest.approx([0.25, 0.5], abs=0.005)
    # independent ones have this standard deviation of it
    assert abs(np.corrcoef(shares.T)[0, 1]) < 1 / sqrt(len(points))


@pytest.mark.parametrize("seed", [2, 9])
def test_few_shots_are_spread_over_places_and_rolls(struck, seed):
    """Of eight shots one has each eighth of the places along warp and weft and of the rolls; the seed shifts them."""
    spread = np.array([unknown._spread(seed, number)[:3] for number in range(8)])
    shift = np.random.default_rng(seed).uniform(size=3)
    eighths = np.floor(8 * ((spread - shift) % 1.0) + 1e-9).astype(int)
    for column in eighths.T:
        assert sorted(column) == list(range(8))


def test_the_roll_of_a_chisel_is_drawn_and_that_of_a_sphere_is_not(struck):
    rolls = []
    for number in range(64):
        nose = draw(struck, number).projectile
        assert replace(nose, roll=6.0, friction=0.0) == struck.projectile
        rolls.append((nose.roll - 6.0) % (2 * pi))
    assert 0.0 <= min(rolls) < 0.1
    assert pi - 0.1 < max(rolls) < pi
    sphere = Projectile(1e-3, 2e-3, shape="sphere")
    assert draw(replace(struck, projectile=sphere), 3).projectile == sphere


def test_a_drawn_panel_of_resolved_yarns_has_its_place_and_roll_and_one_of_pinned_yarns_not(struck):
    ply = strengths.draw_panel(struck, SCATTER, 5, 3).pack.plies[0]
    drawn = draw(struck, 3)
    assert ply.impact_point == drawn.impact_point != struck.impact_point
    assert ply.projectile.roll == drawn.projectile.roll != 6.0
    pinned = replace(struck, crossovers=None)
    ply = strengths.draw_panel(pinned, SCATTER, 5, 3).pack.plies[0]
    assert (ply.impact_point, ply.projectile.roll) == (struck.impact_point, 6.0)
