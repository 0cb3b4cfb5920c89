"""Draws of yarn strength: statistics by hand, what is drawn, the shot without scatter, resuming, and the command."""

import shutil
from dataclasses import replace
from math import inf, sqrt

import numpy as np
import pytest

import weavecell as wc
from fabrics import catalogue
from shellfabric.impact import simulation
from shellfabric.impact.simulation import ImpactSetup
from weavecell.studies import draws, inputs, strengths

ALIKE = replace(inputs.published(), shape=inf)
ALIKE_BUT_STRENGTH = replace(inputs.published(), modulus=0.0, crimp=0.0)


@pytest.fixture(scope="module")
def setup():
    fabric = catalogue.load("S-720").with_effective_density()
    return ImpactSetup(fabric, 90.0, opening=0.03048, end_time=60e-6, table_size=51)


def made(number, outcome, residual):
    return draws.Draw(number, outcome, residual, 10.0 + number, 100.0, 200.0, 3, 1e-4, 0.8, 1e-4)


def test_statistics_are_those_of_textbooks():
    """Mean, s / sqrt(n), Wilson's interval by its formula; an unstable draw counts in none."""
    outcomes = ("stopped", "perforated", "perforated", "in flight", "unstable")
    given = [
        made(k, name, value)
        for k, (name, value) in enumerate(zip(outcomes, (0.0, 30.0, 36.0, 2.0, 1e9)))
    ]
    found = draws.Draws(tuple(given), inputs.published(), 1)
    estimate = found.estimate("residual_velocity")
    assert estimate.mean == pytest.approx(17.0)
    assert estimate.deviation == pytest.approx(np.std([0, 30, 36, 2], ddof=1))
    assert estimate.error == pytest.approx(estimate.deviation / 2)
    n, z, p = 4, 1.959964, 0.5
    half = z * sqrt(p * (1 - p) / n + z**2 / (4 * n**2)) / (1 + z**2 / n)
    assert found.probability() == pytest.approx((p, 0.5 - half, 0.5 + half), rel=1e-6)
    summary = found.summary()
    assert (summary["draws"], summary["unstable"], summary["in_flight"]) == (5, 1, 1)
    assert summary["residual_velocity_error_m_s"] == estimate.error


def test_every_yarn_of_every_ply_is_drawn(setup):
    """Ply p of draw k has the strengths of number k N + p: no two are alike, and none depends on the others."""
    given = replace(setup, elements_per_crossover=1, plies=2, stacking="alternating", ply_gap=1e-4)
    drawn = strengths.drawn(given, ALIKE_BUT_STRENGTH, 7, 3)
    first, second = drawn.pack.plies
    for p, ply in enumerate((first, second)):
        lengths = [n * d for n, d in zip(ply.counts, ply.spacing)]
        _, wanted = strengths.draw(ALIKE_BUT_STRENGTH, 7, 6 + p, ply.yarn_counts, lengths)
        np.testing.assert_array_equal(ply.strength_factors[0], wanted[0])
    assert drawn.weakest[0] == min(ply.strength_factors[0].min() for ply in (first, second))
    assert not np.isin(second.strength_factors[0], first.strength_factors[0]).any()
    assert drawn.factors == {"modulus": 1.0, "crimp_warp": 1.0, "crimp_weft": 1.0}


def test_plies_of_a_draw_are_of_one_roll(setup):
    """Modulus and crimp are one value for all plies of a draw, and scale the laws that a set-up names as well."""
    given = replace(setup, elements_per_crossover=1, plies=2, ply_gap=1e-4)
    drawn = strengths.drawn(given, inputs.published(), 7, 3)
    one, other = drawn.pack.plies
    assert one.fabric == other.fabric
    assert one.fabric.weave.warp.E == pytest.approx(
        setup.fabric.weave.warp.E * drawn.factors["modulus"]
    )
    assert drawn.factors["modulus"] != 1
    laws = inputs.changed_setup(replace(setup, laws=setup.fabric.laws), compression_a=2.0).laws
    assert laws[0].a == 2 * setup.fabric.laws[0].a


@pytest.mark.parametrize("plies", [1, 2])
def test_without_scatter_every_draw_is_the_shot_at_the_whole_panel(setup, tmp_path, plies):
    given = replace(setup, plies=plies)
    whole = inputs.alone(given, symmetry="whole")
    assert whole.symmetry == "whole"
    plain = simulation.run(whole)
    found = draws.study(given, ALIKE, 2, folder=tmp_path)
    for one in found.draws:
        assert (one.outcome, one.residual_velocity) == (plain.outcome, plain.residual_velocity)
        assert one.peak_tension_warp == np.max(np.atleast_2d(plain.peak_tension)[:, 0])
    assert found.estimate("residual_velocity").error == 0


def test_another_seed_gives_other_draws(setup):
    few, other = wc.draws(setup, 3), wc.draws(setup, 2, seed=2)
    assert len(set(few.to_dataframe()["weakest"])) == 3
    assert other.study.draws[0].weakest != few.study.draws[0].weakest
    assert other.summary()["seed"] == 2
    assert "DrawsResult" in repr(other)


def test_resume_goes_on_to_more_draws(command, results, tmp_path):
    folder = shutil.copytree(results("draws").folder, tmp_path / "r")
    rows, before = (folder / "draws.csv").read_text().splitlines(), set((folder / "runs").iterdir())
    words = ("--count", 4, "--seed", 4, "--jobs", 2, "--resume", "--out", "r")
    assert command("draws", folder / "scene.toml", *words)[0] == 0
    assert before < set((folder / "runs").iterdir())
    assert (folder / "draws.csv").read_text().splitlines()[:4] == rows
