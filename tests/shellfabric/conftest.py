"""Fabrics, tables and small panels that several tests share."""

from dataclasses import replace

import pytest

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from shellfabric.panel.model import Panel


@pytest.fixture(scope="session")
def fabric():
    return catalogue.load("S-720").with_effective_density()


@pytest.fixture(scope="session")
def tables(fabric):
    """The S-720 table in both forms."""
    return {form: CellModel(fabric, form=form).table(121) for form in ("equilibrium", "variational")}


@pytest.fixture
def small(tables):
    """Make a small panel, 24 x 24 crossovers as a whole."""

    def make(**changes):
        table = changes.pop("table", tables["variational"])
        return Panel(table, (0.0306, 0.0306), **changes)

    return make


@pytest.fixture(scope="session")
def straight(fabric):
    """Make the fabric with straight yarns, the weft's mass being a share of the warp's."""

    def make(weft_mass):
        weave = fabric.weave
        warp = replace(weave.warp, crimp=0.0)
        weft = replace(warp, linear_density=warp.linear_density * weft_mass)
        return replace(fabric, weave=replace(weave, warp=warp, weft=weft), shear=None)

    return make
