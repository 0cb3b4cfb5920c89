"""Rows of numbers that a dataclass declares: their types have the names of the numbers, and not their words."""

from dataclasses import dataclass, replace
from math import isnan
from typing import Annotated

import pytest

from fabrics.base.errors import InputError
from fabrics.base.schema import Table, flag, key, number, quantity, refuse_unread, validated
from fabrics.base.units import FACTORS
from shellfabric.jit.declared import row_of


def numbers_of(meaning, read_by="near far", name="drag"):
    """A dataclass of numbers of every kind, with words and a name of its own for one of them."""
    body = {
        "acts": True,
        "width": None,
        name: 0.25,
        "__annotations__": {
            "acts": Annotated[bool, key(flag("whether it acts"), "near")],
            "width": Annotated[float | None, key(quantity("a width", "m", "3 mm"), "far")],
            name: Annotated[float, key(number(meaning, 0.5, ge=0.0), read_by)],
        },
    }
    return dataclass(frozen=True, kw_only=True)(type("Numbers", (), body))


def test_a_row_has_the_numbers_by_their_names():
    Numbers = numbers_of("a drag")
    row = row_of(Numbers).of(Numbers(width=3e-3, acts=False))
    assert (row.acts, row.width, row.drag) == (False, 3e-3, 0.25)
    assert isnan(row_of(Numbers).of(Numbers()).width)


def test_the_type_of_a_row_follows_its_names_and_not_its_words():
    types = [
        row_of(numbers_of(*said)).types[0].name
        for said in (("a drag",), ("drag of the air", "far"), ("a drag", "near far", "air_drag"))
    ]
    assert types[0] == types[1] != types[2]


def test_a_number_that_a_model_does_not_read_is_refused_by_its_name():
    Numbers = numbers_of("a drag", read_by="near")
    given = Numbers(drag=0.75, width=3e-3)
    refuse_unread(Numbers, replace(given, drag=0.25), "far", "far things")
    with pytest.raises(InputError, match=r"drag = 0\.75: must be left out with far things"):
        refuse_unread(Numbers, given, "far", "far things")
    with pytest.raises(InputError, match=r"width = 0\.003: must be left out with near things"):
        refuse_unread(Numbers, given, "near", "near things")


def test_who_reads_a_number_has_to_be_said():
    with pytest.raises(TypeError):
        key(flag("whether it acts"))


@pytest.mark.parametrize("unit", [*FACTORS, "J/m", "N s/m"])
def test_a_quantity_may_have_a_unit_that_no_other_one_has(unit):
    class Given(Table):
        stretch: quantity("an invented quantity", unit, f"3 {unit}")

    with pytest.raises(InputError, match="above 0, such as") as refused:
        validated(Given, {"stretch": "seven"}, "scene.toml")
    assert "stretch = 'seven': must be a" in str(refused.value)
