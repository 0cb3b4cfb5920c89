"""Strength and modulus against the strain rate: the table, its limits, families, and what they leave unchanged."""

import numpy as np
import pytest

from fabrics import assumed, catalogue
from fabrics.errors import InputError
from fabrics.families.strain_rate import RateLaw

LAW = RateLaw((10.0, 1000.0), (1.0, 1.4), (1.0, 1.2))
TABLE = '[strain_rate]\nrates = ["10 / s", "1000 / s"]\nstrength = [1.0, 1.4]\nsource = "made up"\n'


def test_linear_in_the_logarithm_and_constant_outside():
    rates = [1e-9, 10.0, 100.0, 1000.0, 1e9]
    np.testing.assert_allclose([LAW.strength_at(rate) for rate in rates], [1.0, 1.0, 1.2, 1.4, 1.4])
    assert LAW.dynamic_modulus == 1.2
    assert RateLaw((10.0,), (1.0,)).dynamic_modulus == 1.0


@pytest.mark.parametrize("rate", [10.0, 30.0, 500.0, 1000.0])
def test_damage_at_a_steady_rate_is_one_at_the_strength(rate):
    """The integral of the table's rates of damage, from the onset to the strength at the rate."""
    loads, damage, growth = LAW.table(0.03)
    assert loads[0] == 0.99 * LAW.strength[0]
    x = np.linspace(loads[0], LAW.strength_at(rate), 200001)[1:]
    m = np.minimum(np.searchsorted(loads, x) - 1, loads.size - 2)
    total = np.mean(damage[m] * np.exp(growth[m] * (x - loads[m]))) * (x[-1] - loads[0]) * 0.03 / rate
    assert total == pytest.approx(1, rel=1e-3)


def test_one_strength_at_all_rates_has_no_damage():
    np.testing.assert_array_equal(RateLaw((1.0, 10.0), (0.9, 0.9)).table(0.03), [[0.9], [0.0], [0.0]])


def test_the_modulus_rises_and_the_strength_stays():
    fabric = assumed.with_strain_rate(catalogue.load("S-726"))
    fast = fabric.at_high_rate()
    for before, after in zip(fabric.weave.yarns, fast.weave.yarns):
        assert after.E == pytest.approx(1.225 * before.E)
        assert after.strength == pytest.approx(before.strength)
    plain = catalogue.load("S-726")
    assert plain.at_high_rate() is plain


def test_families_give_it_with_their_source():
    fabric = assumed.with_strain_rate(catalogue.load("S-726"))
    assert fabric.strain_rate.strength_at(170.0) == pytest.approx(2340 / 1489, rel=1e-3)
    assert "Kevlar 49" in fabric.sources["strain_rate"]["source"]
    assert "assumed: [strain_rate] of para-aramid yarns, because S-726 gives none" in assumed.lines(fabric)
    assert assumed.with_strain_rate(fabric) is fabric
    with pytest.raises(InputError, match=r"glass-balanced has no \[strain_rate\] table.*E-glass yarns no numbers"):
        assumed.with_strain_rate(catalogue.load("glass-balanced"))
    with pytest.raises(InputError, match=r"S-726 has no \[strain_rate\].*in the range of .*para-aramid"):
        assumed.with_strain_rate(catalogue.load("S-726").with_yarns(E=1e9))


def test_a_fabric_file_has_its_own(tmp_path):
    text = (catalogue._FOLDER / "S-726.toml").read_text()
    path = tmp_path / "own.toml"
    path.write_text(text + TABLE)
    fabric = catalogue.read(path)
    assert fabric.strain_rate == RateLaw((10.0, 1000.0), (1.0, 1.4), source="made up")
    assert fabric.sources["strain_rate"]["value"] == "strength 1 / 1.4 at 10 / 1000 1/s"


@pytest.mark.parametrize(
    ("right", "wrong", "said"),
    [
        ('"10 / s"', '"2000 / s"', "strain_rate.rates = .2000.0, 1000.0.: must be one rate above 0 or more, rising"),
        ('"10 / s"', '"10 m"', "strain_rate.rates = '10 m': must be"),
        ("1.4]", "-1.4]", "strain_rate.strength = .1.0, -1.4.: must be 2 numbers above 0"),
        ("1.4]", "0.9]", "strength = .1.0, 0.9.: must be rising, or all alike"),
        (", 1.4]", "]", "strain_rate.strength = .1.0.: must be 2 numbers above 0"),
        ("[1.0, 1.4]", "1.4", "strain_rate.strength = 1.4: must be a list"),
        ("source", "origin", "strain_rate = 'rates, strength, origin': must be a table of rates, strength, modulus"),
        ('source = "made up"', 'status = "likely"', "strain_rate.status = 'likely': must be one of measured"),
    ],
)
def test_a_wrong_table_is_one_line(tmp_path, right, wrong, said):
    path = tmp_path / "own.toml"
    path.write_text((catalogue._FOLDER / "S-726.toml").read_text() + TABLE.replace(right, wrong))
    with pytest.raises(InputError, match=said) as found:
        catalogue.read(path)
    assert len(str(found.value).splitlines()) == 1
