"""Rows of the constants of isotropic solids, as kernels take them: those of a block, and of metals."""

from __future__ import annotations

from typing import Any, TypeVar

from fabrics.materials import Isotropic
from fabrics.metals import Metal
from shellfabric.jit.table import Row

Law = TypeVar("Law", bound=Row)


def make_law(table: type[Law], material: Isotropic | Metal, **given: Any) -> Law:
    """Make a row of a material's constants: its elastic moduli, what is `given`, and of the rest the
    attributes of the same names.

    Parameters
    ----------
    table : `block.state.BlockLaw` or `metal.state.MetalLaw`
    """
    known = {"bulk_modulus": material.bulk, "shear_modulus": material.shear} | given
    rest = table.fields.keys() - known.keys()
    return table(**known, **{name: getattr(material, name) for name in rest})
