"""How numbers are shown: their unit decides, and not their name."""

import doctest

import pytest

from weavecell.results import display, keys

# words such as "ratio" and "strength" stand in names of numbers that are no shares
NAMES = (
    "shear concentration",
    "iterations",
    "panel.strength.seed",
    "panel.strength.weibull_shape",
    "wall thickness",
    "generations",
    "share price",
    "terror",
    "duration",
    "strainer",
)


@pytest.mark.parametrize("name", NAMES)
def test_a_name_does_not_make_a_number_a_share(name):
    table = display.frame({keys.infer_key(name).meaning: (keys.infer_key(name).unit, [7.0])})
    assert table.iloc[0, 0] == 7.0
    assert "%" not in table.columns[0]


@pytest.mark.parametrize("unit", ["m", "s", "Pa", "m3", "rad", "1", "%", "wall s", "J", "m/s"])
def test_a_unit_shows_a_number_alike_under_every_name(unit):
    shown = {keys.Key(name, unit, "meaning").label for name in NAMES}
    assert len(shown) == 1


def test_a_share_is_a_number_in_files_and_shown_in_per_cent():
    key = next(key for key in keys.IMPACT if key.name == "energy_error_max")
    assert key.si_unit == "1"
    assert display.text(0.0123, key.unit) == "1.23 %"


def test_time_of_a_computer_is_shown_in_seconds_and_time_of_a_shot_in_microseconds():
    wall, stop = keys.infer_key("wall_time_s"), keys.infer_key("stop_time_s")
    assert wall.si_unit == stop.si_unit == "s"
    assert display.text(12.0, wall.unit) == "12 s"
    assert display.text(12e-6, stop.unit) == "12 µs"


def test_every_unit_of_a_file_is_an_si_unit():
    units = {key.si_unit for table in keys.TABLES.values() for key in table}
    assert not units & {"%", "wall s"}


@pytest.mark.parametrize("name", ["bias_extension", "picture_frame", "uniaxial", "biaxial"])
def test_what_a_coupon_test_prescribes_has_its_unit_in_keys_toml(name):
    from weavecell.results import coupon

    assert keys.COUPON_MEASURES[coupon.PRESCRIBED[name]].si_unit in ("m", "rad", "1")


@pytest.mark.parametrize("module", [display, keys], ids=lambda module: module.__name__)
def test_examples_of_docstrings_run(module):
    found = doctest.testmod(module)
    assert found.attempted > 0
    assert found.failed == 0


@pytest.mark.parametrize(
    "name, heading",
    [
        ("six_shot_spread_met_ft_s", "six shot spread met [ft/s]"),
        ("fastest_stop_m_s", "fastest stop [m/s]"),
        ("left_s", "left [µs]"),
    ],
)
def test_a_speed_in_feet_is_no_time(name, heading):
    """A spread of 60 ft/s was a time of 6e7 us."""
    key = keys.infer_key(name)
    table = display.frame({key.meaning: (key.unit, [60.0])})
    assert table.columns[0] == heading
    assert table.iloc[0, 0] == (60e6 if "µs" in heading else 60.0)
