"""Fabrics, tables and small panels that several tests share."""

from dataclasses import replace

import numba
import pytest

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from tests.shellfabric.panels import SERIAL, make_panel, table

SHOT = {"opening": 0.0508, "table_size": 101, "end_time": 60e-6}


@pytest.fixture(autouse=True)
def one_thread():
    """Kernels of a block have one thread, which does not wait for another one; a test that is about threads sets
    more of them."""
    before = numba.get_num_threads()
    numba.set_num_threads(1)
    yield
    numba.set_num_threads(before)


@pytest.fixture(scope="session")
def tables():
    """The S-720 table in both forms."""
    return {form: table(form) for form in ("equilibrium", "variational")}


@pytest.fixture
def small():
    """Make a small panel, 24 x 24 crossovers as a whole."""
    return make_panel


@pytest.fixture(scope="session")
def ply():
    """S-726, whose warp and weft are far from alike, on 20 mm."""
    fabric = catalogue.load("S-726").with_effective_density()
    return make_panel(0.02, table=CellModel(fabric).table(81), numerics=SERIAL)


@pytest.fixture(scope="session")
def shoot(fabric):
    """Run S-720, 40 x 40 crossovers as a whole, briefly: one element per crossover, of packs two."""

    def make(strike_velocity=150.0, hooks=(), resume=None, **changes):
        elements = None if "grading" in changes else 1 + (changes.get("plies", 1) > 1)
        chosen = {
            "fabric": fabric,
            "strike_velocity": strike_velocity,
            "elements_per_crossover": elements,
            **SHOT,
        }
        setup = ImpactSetup(**chosen | changes)
        return run_impact(setup, hooks=hooks, resume=resume)

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
