"""One value, written as a text, as a cell of a table and as an entry of a summary."""

import re
from math import inf, nan
from pathlib import Path

import pytest

from weavecell.api import calibration
from weavecell.report import chapters_discretisation
from weavecell.results import display
from weavecell.results.named_value import NamedValue, tabulate


def test_a_length_is_shown_in_mm_and_kept_in_m():
    a = NamedValue("a", 4.47e-5, "m", form=".4f")
    assert a.line() == "a = 0.0447 mm"
    assert a.text() == "0.0447 mm"
    assert a.heading == "a [mm]"
    assert a.unit_shown == "mm"
    assert a.cell() == "0.0447"
    assert a.entries() == {"a_m": 4.47e-5}


def test_a_share_is_shown_in_per_cent_and_kept_as_a_number():
    share = NamedValue("misfit", 0.0527, "%", form=".1f")
    assert share.line() == "misfit = 5.3 %"
    assert share.heading == "misfit [%]"
    assert share.entries() == {"misfit_1": 0.0527}


def test_a_number_has_no_unit_behind_it():
    assert NamedValue("V_c", 0.873, "1").line() == "V_c = 0.873"
    assert NamedValue("V_c", 0.873, "1").heading == "V_c"


@pytest.mark.parametrize("missing", [None, nan])
def test_a_missing_value_is_a_dash(missing):
    assert NamedValue("rms", missing, "fine m").cell() == "–"
    assert NamedValue("mean", missing, "m/s", error=nan).text() == "– m/s"


def test_an_interval_stands_in_place_of_a_value():
    b = NamedValue("b", None, "m N^(1/3)", 5.42e-5, 6.03e-5, form=".4f")
    assert b.line() == "b = 0.0542 .. 0.0603 mm N^(1/3)"
    assert b.cell() == "0.0542 .. 0.0603"
    assert b.ends() == ("0.0542", "0.0603")
    assert b.entries() == {"b_interval_low": 5.42e-5, "b_interval_high": 6.03e-5}


def test_the_interval_of_a_value_has_a_format_of_its_own():
    modulus = NamedValue("E_c", 1.2345e9, "1", 9.876e8, 1.5432e9, margin=".2g")
    assert modulus.text() == "1.234e+09"
    assert modulus.interval() == "9.9e+08 .. 1.5e+09"


def test_an_error_stands_behind_its_value():
    velocity = NamedValue("residual velocity", 21.2345, "m/s", error=4.567, margin=".2g")
    assert velocity.text() == "21.23 +- 4.6 m/s"
    assert NamedValue("absorbed energy", 1.6, "J", error=inf).text() == "1.6 +- inf J"


def test_a_table_of_numbers_has_them_in_the_unit_of_its_heading():
    deflection = NamedValue("peak deflection", 9.25e-3, "m", error=0.5e-3)
    assert deflection.heading == "peak deflection [mm]"
    assert deflection.numbers() == pytest.approx((9.25, 0.5))
    assert NamedValue("rms", None, "m").numbers() == (None, None)


def test_an_entry_of_a_part_names_it():
    b = NamedValue("b", 1.44e-5, "m N^(1/3)")
    assert b.entries("soft") == {"b_soft_m_N^(1/3)": 1.44e-5}


@pytest.mark.parametrize("unit", [*display.SHOWN, "N", "m/s"])
def test_text_cell_and_summary_of_every_unit_are_one_number(unit):
    one = NamedValue("x", 0.0372, unit)
    mark, factor = display.choose_unit(unit)
    assert float(one.cell()) == pytest.approx(factor * 0.0372, rel=1e-3)
    assert one.text() == f"{one.cell()} {mark}".rstrip()
    assert list(one.entries().values()) == [0.0372]


def test_rows_are_tabulated_under_the_headings_of_the_first():
    rows = [
        ("fitted", (NamedValue("a", 3e-5, "m"), NamedValue("rms", 2e-6, "fine m"))),
        ("interval", (NamedValue("a", None, "m", 2e-5, 5e-5), NamedValue("rms", None, "fine m"))),
    ]
    table = tabulate("law", rows)
    assert list(table) == ["law", "a [mm]", "rms [µm]"]
    assert table.to_numpy().tolist() == [
        ["fitted", "0.03", "2"],
        ["interval", "0.02 .. 0.05", "–"],
    ]


@pytest.mark.parametrize("module", [calibration, chapters_discretisation])
def test_units_shown_come_from_the_one_table(module):
    """No factor of a unit stands in a file whose values are listed once."""
    assert not re.findall(r"\b(?:100|1e-?\d) \* ", Path(module.__file__).read_text())
