"""No number of a fabric is wrong by a factor of ten, in percent, in degrees or in its neighbour's
place without a word (`fabrics/plausible.toml`)."""

import tomllib
from copy import deepcopy
from itertools import pairwise
from math import degrees
from pathlib import Path

import pytest

from fabrics import catalogue, plausible
from fabrics.base.errors import InputError
from fabrics.base.units import in_one_of
from tests.scene_text import scale_quantity, toml

ROOT = Path(__file__).parents[2]
FILES = {name: ROOT / "fabrics" / "catalogue" / f"{name}.toml" for name in catalogue.list_names()}
OF_USERS = [
    *ROOT.glob("examples/fabrics/*.toml"),
    *ROOT.glob("tests/weavecell/own_fabrics/*.toml"),
    *ROOT.glob("validation/measured/inputs/fabrics/*.toml"),
]
# a mass remembered of no sheet: its warp would be crimped more than any of the catalogue
NOTED = {
    "K29-735": (
        "areal_density: crimp that the areal density gives is 10 %, plausible is 0.15 to 9 %",
    )
}
# a weave whose weft is twelve times lighter than its warp; ten times as heavy it is a balanced one
BALANCED = {("glass-unbalanced", "weft.axial_stiffness", 10.0)}


def numbers_of(table, prefix=""):
    """{dotted key: entry} of the numbers of a fabric file."""
    found = {}
    for key, entry in table.items():
        if isinstance(entry, dict) and "value" in entry:
            found[prefix + key] = entry
        elif isinstance(entry, dict):
            found |= numbers_of(entry, f"{prefix}{key}.")
    return found


def is_silent(table, values):
    """Whether the fabric file with these values of keys is read without a word."""
    changed = deepcopy(table)
    entries = numbers_of(changed)
    for key, value in values.items():
        entries[key]["value"] = value
    try:
        return not catalogue.read("changed.toml", toml(changed)).notes
    except InputError:
        return False


@pytest.mark.parametrize("path", [*FILES.values(), *OF_USERS], ids=lambda path: path.stem)
def test_fabrics_as_they_are_are_plausible(path):
    fabric = catalogue.read(path)
    assert plausible.judge(plausible.of_fabric(fabric)) == NOTED.get(path.stem, ())


@pytest.mark.parametrize("name", FILES)
def test_a_number_that_is_ten_times_too_large_or_too_small_is_not_silent(name):
    table = tomllib.loads(FILES[name].read_text())
    silent = []
    for key, entry in numbers_of(table).items():
        for factor in (10.0, 100.0, 1000.0, 0.1, 0.01, 0.001):
            if is_silent(table, {key: scale_quantity(entry["value"], factor)}):
                silent.append((name, key, factor))
    assert set(silent) <= BALANCED


@pytest.mark.parametrize("name", FILES)
def test_percent_for_a_fraction_and_degrees_for_radians_are_not_silent(name):
    table = tomllib.loads(FILES[name].read_text())
    silent = []
    for key, entry in numbers_of(table).items():
        text = entry["value"]
        slips = []
        if text.endswith("%"):
            slips = [text.rstrip("% "), scale_quantity(text, 0.01)]
        elif "gamma" in key:
            slips = [f"{text} deg", f"{degrees(float(text)):g}"]
        silent += [(key, slip) for slip in slips if is_silent(table, {key: slip})]
    assert silent == []


@pytest.mark.parametrize("name", FILES)
def test_neighbours_in_each_others_place_are_not_silent(name):
    """Two numbers of one unit, one below the other in the file, whose values differ by more than
    five times: closer ones fit each other's range, as a failure strain of 3 % and a crimp of 2 %."""
    table = tomllib.loads(FILES[name].read_text())
    silent = []
    for (first, one), (second, other) in pairwise(numbers_of(table).items()):
        if first.rpartition(".")[0] != second.rpartition(".")[0]:
            continue
        values = [in_one_of(entry["value"], UNITS)[0] for entry in (one, other)]
        if max(values) > 5 * min(values):
            swapped = {first: other["value"], second: one["value"]}
            silent += [swapped] * is_silent(table, swapped)
    assert silent == []


UNITS = ("m", "Pa", "kg/m", "1/m", "kg/m^3", "kg/m^2", "N", "m * N**(1/3)", "N/(kg/m)", "")


def test_every_number_of_a_fabric_file_is_judged():
    """Each key that holds a number decides a row, or a check of `data_sheet` compares it."""
    compared = {"areal_density", "areal_density_measured", "thickness", "count"}
    judged = set()
    for path in FILES.values():
        judged |= {number.key for number in plausible.of_fabric(catalogue.read(path))}
    names = {key.rpartition(".")[2] for key in judged}
    for path in FILES.values():
        of_file = {key.rpartition(".")[2] for key in numbers_of(tomllib.loads(path.read_text()))}
        assert of_file <= names | compared
