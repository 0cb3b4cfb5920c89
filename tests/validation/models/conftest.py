"""Fabrics of the solver's tests."""

from tests.shellfabric.conftest import fabric, straight

__all__ = ["fabric", "straight"]
