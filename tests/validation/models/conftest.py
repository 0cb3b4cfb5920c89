"""Fabrics of the solver's tests."""

from tests.shellfabric.conftest import straight

__all__ = ["straight"]
