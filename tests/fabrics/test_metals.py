"""Metals by name: every constant has a source, a status and a range that holds it."""

import pytest

from fabrics import metals
from fabrics.base.errors import InputError
from fabrics.metals import Metal


@pytest.mark.parametrize("name", metals.list_names())
def test_every_constant_has_a_source_and_a_range_that_holds_it(name):
    found = metals.load(name)
    for constant, row in metals.entry(name).items():
        low, high = metals.bounds(name, constant)
        assert low <= getattr(found, constant) <= high
        assert row["source"].strip()
        assert row["status"] in metals.STATUSES


def test_an_unknown_metal_is_refused_with_the_names():
    with pytest.raises(InputError, match=r"core.*lead"):
        metals.load("leed")


@pytest.mark.parametrize("key, value", [("poisson", 0.5), ("hardening", -1.0), ("modulus", 0.0)])
def test_constants_out_of_range_are_refused(key, value):
    given = {"density": 8000.0, "modulus": 2e11, "poisson": 0.3} | {key: value}
    with pytest.raises(InputError, match=key):
        Metal(**given)
