"""Strength and modulus against the strain rate: the table, its limits, families, and what they leave unchanged."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from fabrics import assumed, catalogue
from fabrics.families.strain_rate import RateLaw

LAW = RateLaw((10.0, 1000.0), (1.0, 1.4), (1.0, 1.2))
TABLE = '[strain_rate]\nrates = ["10 / s", "1000 / s"]\nstrength = [1.0, 1.4]\nsource = "made up"\n'


def test_linear_in_the_logarithm_and_constant_outside():
    rates = [1e-9, 10.0, 100.0, 1000.0, 1e9]
    assert_allclose([LAW.strength_at(rate) for rate in rates], [1.0, 1.0, 1.2, 1.4, 1.4])
    assert LAW.dynamic_modulus == 1.2
    assert RateLaw((10.0,), (1.0,)).dynamic_modulus == 1.0


@pytest.mark.parametrize("rate", [10.0, 30.0, 500.0, 1000.0])
def test_damage_at_a_steady_rate_is_one_at_the_strength(rate):
    """The integral of the table's rates of damage, from the onset to the strength at the rate."""
    loads, damage, growth = LAW.table(0.03)
    assert loads[0] == 0.99 * LAW.strength[0]
    x = np.linspace(loads[0], LAW.strength_at(rate), 200001)[1:]
    m = np.minimum(np.searchsorted(loads, x) - 1, loads.size - 2)
    total = (
        np.mean(damage[m] * np.exp(growth[m] * (x - loads[m]))) * (x[-1] - loads[0]) * 0.03 / rate
    )
    assert total == pytest.approx(1, rel=1e-3)
    same_at_all_rates = RateLaw((1.0, 10.0), (0.9, 0.9))
    assert_array_equal(same_at_all_rates.table(0.03), [[0.9], [0.0], [0.0]])


def test_a_family_gives_it_with_its_source_and_the_strength_stays():
    plain = catalogue.load("S-726")
    fabric = assumed.with_strain_rate(plain)
    assert plain.at_high_rate() is plain
    for before, after in zip(fabric.weave.yarns, fabric.at_high_rate().weave.yarns):
        assert after.E == pytest.approx(1.225 * before.E)
        assert after.strength == pytest.approx(before.strength)
    assert fabric.strain_rate.strength_at(170.0) == pytest.approx(2340 / 1489, rel=1e-3)
    assert "Kevlar 49" in fabric.sources["strain_rate"]["source"]
    assert "assumed: [strain_rate] of para-aramid yarns, because S-726 gives none" in assumed.lines(
        fabric
    )
    assert assumed.with_strain_rate(fabric) is fabric


def test_a_fabric_file_has_its_own(tmp_path):
    text = (catalogue._FOLDER / "S-726.toml").read_text()
    path = tmp_path / "own.toml"
    path.write_text(text + TABLE)
    fabric = catalogue.read(path)
    assert fabric.strain_rate == RateLaw((10.0, 1000.0), (1.0, 1.4), source="made up")
    assert fabric.sources["strain_rate"]["value"] == "strength 1 / 1.4 at 10 / 1000 1/s"
