"""Metals by name."""

import pytest

from fabrics import metals
from fabrics.base.errors import InputError
from fabrics.metals import Metal


def test_an_unknown_metal_is_refused_with_the_names():
    with pytest.raises(InputError, match=r"core.*lead"):
        metals.load("leed")


@pytest.mark.parametrize("key, value", [("poisson", 0.5), ("hardening", -1.0), ("modulus", 0.0)])
def test_constants_out_of_range_are_refused(key, value):
    given = {"density": 8000.0, "modulus": 2e11, "poisson": 0.3} | {key: value}
    with pytest.raises(InputError, match=key):
        Metal(**given)
