"""The picture of energies draws all that a run has, each with a name that the legend has room for."""

from weavecell.report.pictures import LONGEST_LABEL, NOT_DRAWN, list_bands
from weavecell.results.keys import TABLES

LONGEST_ROW = 34  # letters of the longest label of the table


def test_each_energy_has_a_band_with_a_short_name():
    names = [key.name for key in TABLES["energies"]]
    bands = {name: label for name, label, _ in list_bands([*names, "air_drag"])}
    assert set(names) - set(NOT_DRAWN) <= set(bands)
    assert bands["air_drag"] == "air drag"
    assert max(len(line) for label in bands.values() for line in label.split("\n")) <= LONGEST_ROW


def test_an_energy_without_a_colour_is_named_by_its_meaning_over_several_lines(monkeypatch):
    monkeypatch.setattr("weavecell.report.pictures.ENERGIES", ())
    bands = {name: label for name, label, _ in list_bands(["crossover_contact", "shear"])}
    assert bands["shear"] == "trellis shear"
    lines = bands["crossover_contact"].split("\n")
    assert " ".join(lines).startswith("resolved yarns: compression of yarns that cross")
    assert max(map(len, lines)) <= LONGEST_LABEL
