"""Newton's method on force and heights fills the table that the nested iterations fill, but for rounding."""

import numpy as np
import pytest

from fabrics import catalogue, variants
from fabrics.errors import InputError
from shellfabric.cell.model import CellModel

ROUNDING = 2e-12  # of the largest value of a column: both solve the cell to about 1e-13 of it
FABRICS = ("S-720", "S-726", "S-727", "S-728", "S-731", "S-745")


def difference(model, n):
    """Largest difference of any column between the two methods, over the column's largest value."""
    one, two = model.table(n), model.table(n, method="newton")
    assert np.array_equal(one.stretch1, two.stretch1)
    size = {name: float(np.abs(array).max()) or 1.0 for name, array in one.values.items()}
    return max(float(np.abs(one.values[name] - two.values[name]).max()) / size[name] for name in size)


@pytest.mark.parametrize("name", FABRICS)
def test_fabrics_of_the_catalogue(name):
    assert difference(CellModel(catalogue.load(name).with_effective_density()), 101) < ROUNDING


@pytest.mark.parametrize(
    "options",
    [
        {"form": "equilibrium"}, {"profile": "straight"}, {"toe": 0.005}, {"gap": 2e-5}, {"model": "incompressible"},
        {"model": "decoupled"}, {"reach": 20.0}, {"form": "equilibrium", "profile": "straight", "toe": (0.0, 0.01)},
    ],
    ids=str,
)  # fmt: skip
def test_options_of_the_cell(options):
    assert difference(CellModel(catalogue.load("S-720").with_effective_density(), **options), 51) < ROUNDING


@pytest.mark.parametrize("seed", range(8))
def test_random_cells(seed):
    """Crimps from a third to three times, moduli from a half to twice: as studies draw them, and beyond."""
    random = np.random.default_rng(seed)
    crimp = tuple(float(3.0**x) for x in random.uniform(-1, 0.7, 2))
    fabric = catalogue.load(str(random.choice(FABRICS))).with_effective_density()
    fabric = variants.scale_yarns(fabric, E=float(2.0 ** random.uniform(-1, 1)), crimp=crimp)
    fabric = variants.scale_laws(fabric, float(random.uniform(0.5, 1.5)), float(random.uniform(0.5, 1.5)))
    assert difference(CellModel(fabric), 51) < ROUNDING


def test_an_unknown_method():
    with pytest.raises(InputError, match="nested or newton"):
        CellModel(catalogue.load("S-720")).table(21, method="bisection")
