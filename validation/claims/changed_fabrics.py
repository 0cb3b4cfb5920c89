"""The fabrics that the ledger reads: those of the catalogue, or all of them with an input changed by some percent.

An input is a field of `Yarn`, a pair of factors for warp and weft where these differ; "count", of both families; "a"
or "b" of the compression laws; "shear moduli" or "shear angles" of the trellis.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import replace
from typing import Any

import numpy as np

from fabrics import catalogue, variants
from fabrics.fabric import Fabric, pair

YARN = ("crimp", "E", "failure_strain", "linear_density")
OTHERS = ("count", "a", "b", "shear moduli", "shear angles")
_FACTORS: ContextVar[Mapping[str, Any]] = ContextVar("factors of inputs")


@contextmanager
def change_inputs(factors: Mapping[str, Any]) -> Iterator[None]:
    """Change inputs {name: factor [-]} of all fabrics that are loaded within."""
    token = _FACTORS.set(factors)
    try:
        yield
    finally:
        _FACTORS.reset(token)


def in_force() -> tuple[tuple[str, Any], ...]:
    """Return the changes that are in force, by which a cache of what rests on them is told apart."""
    return tuple((name, tuple(np.atleast_1d(factor))) for name, factor in _FACTORS.get({}).items())


def load(name: str) -> Fabric:
    """Load a fabric of the catalogue, with the changes that are in force."""
    factors = _FACTORS.get({})
    fabric = catalogue.load(name)
    if not factors:
        return fabric
    fabric = variants.scale_yarns(fabric, **{key: factors[key] for key in YARN if key in factors})
    if "linear_density" in factors and fabric.effective_linear_density is not None:
        both = np.multiply(fabric.effective_linear_density, pair(factors["linear_density"]))
        fabric = replace(fabric, effective_linear_density=tuple(both.tolist()))
    if "count" in factors:
        weave = fabric.weave
        counts = np.multiply((weave.warp_count, weave.weft_count), pair(factors["count"])).tolist()
        fabric = replace(fabric, weave=replace(weave, warp_count=counts[0], weft_count=counts[1]))
    fabric = variants.scale_laws(fabric, factors.get("a", 1.0), factors.get("b", 1.0))
    return variants.scale_shear(
        fabric, factors.get("shear moduli", 1.0), factors.get("shear angles", 1.0)
    )
