"""The regression of V50 against the tests it was made from, and a test it was not made from."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fabrics import catalogue
from shellfabric.impact.setup import ImpactSetup
from shellfabric.projectile.projectile import Projectile
from validation.measured.rows import read
from weavecell.api.target import resolve_target
from weavecell.studies import inputs, regression_line

SCENE = "validation/measured/inputs/CT612.toml"
AREAL_DENSITY = {21: 2.5, 38: 4.5, 42: 5.0, 48: 6.1, 62: 7.5}  # [kg/m2], Kosla et al. 2022


@pytest.fixture(scope="module")
def twaron():
    return resolve_target(SCENE, {}, "limit", function="critical_velocity").setup


def test_the_line_is_the_least_squares_fit_of_the_published_tests(twaron):
    tests = {row.id: float(row.value) for row in read() if row.quantity == "V50 of packs"}
    velocities = [tests[f"CT612, {plies} plies"] for plies in AREAL_DENSITY]
    per_mass = regression_line.mass_ratio(twaron) / twaron.areal_density
    ratios = per_mass * np.array(list(AREAL_DENSITY.values()))
    scaled = np.log(velocities / np.float64(regression_line.velocity_scale(twaron)))
    exponent, constant = np.polyfit(np.log(ratios), scaled, 1)
    line = inputs.table("regression_line")
    assert_allclose(line["exponent"].value, exponent, rtol=2e-3)
    assert_allclose(line["factor"].value, np.exp(constant), rtol=5e-3)
    assert_allclose((line["mass_ratio"].low, line["mass_ratio"].high), ratios[[0, -1]], rtol=0.01)


def test_another_fibre_at_a_thirtieth_of_the_mass_ratio():
    """S-726: 103 +- 6.4 m/s by the thesis (line 1501), which the line was not made from."""
    setup = ImpactSetup(catalogue.load("S-726"), 100.0)
    scatter = inputs.table("regression_line")["scatter"].value
    assert abs(regression_line.v50(setup) / 103 - 1) < scatter


def test_what_the_report_says(twaron):
    expected = regression_line.v50(twaron)
    (alike,) = regression_line.remarks(twaron, 1.2 * expected)
    assert f"{expected:.0f} m/s +- 15%" in alike
    assert "DISAGREES" not in alike
    (other,) = regression_line.remarks(twaron, 0.7 * expected)
    assert "DISAGREES with it by -30%" in other
    (thick,) = regression_line.remarks(replace(twaron, plies=90), expected)
    assert "extrapolated" in thick
    steep = replace(twaron, projectile=replace(twaron.projectile, obliquity=np.pi / 3))
    assert_allclose(regression_line.v50(steep) / expected, 2**0.428)


def test_none_for_one_ply_and_other_fibres(twaron):
    assert not regression_line.remarks(replace(twaron, plies=1), 100.0)
    glass = ImpactSetup(catalogue.load("glass-balanced"), 100.0, plies=4)
    assert not regression_line.remarks(replace(glass, projectile=Projectile()), 100.0)
