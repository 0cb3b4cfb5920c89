"""Tables of constants by name: each number has a source, a status and a value within its range."""

import re
import tomllib
from math import inf

import pytest

from fabrics import backings, metals, projectiles
from fabrics.base.errors import InputError
from fabrics.base.sourced import STATUSES, SourcedTables, assumed_of, number_of
from fabrics.materials import read_table

TABLES = (metals.TABLES, backings.TABLES, projectiles.TABLES)
# words by which a source points to another line of its file
POINTS_ELSEWHERE = re.compile(
    r"\b(the same|as of|as quoted there|(that|this|these) (library|card|text|standard)s?)\b"
)


def every_row():
    for tables in TABLES:
        for name in tables.list_names():
            for key, row in tables.entry(name).items():
                if key != "shape":
                    yield tables, name, key, row
    for name in ("steel", "backing", "rcc"):
        yield from ((None, name, key, row) for key, row in read_table(name).items())


def test_every_number_has_a_status_and_a_source_that_stands_alone():
    rows = list(every_row())
    assert len(rows) > 200
    for _, name, key, row in rows:
        assert row["status"] in STATUSES, f"{name}: {key}"
        assert len(row["source"].strip()) > 3, f"{name}: {key}"
        assert not POINTS_ELSEWHERE.search(row["source"]), f"{name}: {key}: {row['source']}"


@pytest.mark.parametrize("text", ["the same", "as of lead", "as of ofhc", "that card has none"])
def test_a_source_that_points_to_another_line_is_found(text):
    assert POINTS_ELSEWHERE.search(text)


def test_a_value_lies_within_its_range():
    of_range = [found for found in every_row() if "range" in found[3]]
    assert len(of_range) >= 70
    for tables, name, key, _ in of_range:
        low, high = tables.bounds(name, key)
        assert low <= tables.values(name)[key] <= high


TEXT = """
[tin.soft]
density = { value = "7.3 g/cm^3", range = ["7.2 g/cm^3", "7.4 g/cm^3"], source = "a book", status = "published" }
strain = { value = "inf", source = "a guess", status = "assumed" }
ratio = { value = "0.3", source = "a sheet", status = "derived" }
"""


@pytest.fixture
def tin(tmp_path):
    path = tmp_path / "tin.toml"
    path.write_text(TEXT)
    return SourcedTables(path, "tin", {"density": "kg/m^3", "strain": "", "ratio": ""})


def test_numbers_are_read_in_si_units(tin):
    assert tin.list_names() == ("soft",)
    assert tin.values("soft") == {"density": pytest.approx(7300), "strain": inf, "ratio": 0.3}
    assert tin.bounds("soft", "density") == pytest.approx((7200, 7400))
    assert tin.bounds("soft", "ratio") == (0.3, 0.3)
    assert assumed_of(tin.entry("soft")) == ["strain"]
    assert tin.entry("soft") == tomllib.loads(TEXT)["tin"]["soft"]


def test_unknown_names_and_constants_are_refused(tin):
    with pytest.raises(InputError, match=r"unknown tin.*soft"):
        tin.entry("sofd", key="core")
    with pytest.raises(InputError, match="density or strain or ratio"):
        tin.bounds("soft", "colour")
    with pytest.raises(InputError, match="speed"):
        number_of("3 kg", "m/s", "a.toml", "speed")
