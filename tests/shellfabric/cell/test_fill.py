"""Newton's method on force and heights fills the table that the nested iterations fill, but for rounding."""

import itertools

import numpy as np
import pytest

from fabrics import catalogue, variants
from fabrics.base.errors import UnstableError
from fabrics.fabric import Fabric
from fabrics.weave import Weave
from fabrics.yarn import Yarn
from shellfabric.cell import fill_kernels
from shellfabric.cell.model import FORMS, MODELS, CellModel
from validation.models import variants as comparison

ROUNDING = 2e-12  # of the largest value of a column: both solve the cell to about 1e-13 of it
FABRICS = ("S-720", "S-726", "S-727", "S-728", "S-731", "S-745")


def difference(model, n):
    """Largest difference of any column from the nested iterations in each cell, over the column's largest value."""
    table = model.table(n)
    nested = model.solve(table.stretch1[:, None], table.stretch2)
    size = {name: float(abs(array).max()) or 1.0 for name, array in nested.items()}
    return max(float(abs(table.values[name] - nested[name]).max()) / size[name] for name in size)


@pytest.mark.parametrize(
    "options",
    [
        {"cell_formulation": "equilibrium"},
        {"crossover_gap": 2e-5},
        {"cell_model": "incompressible"},
        {"cell_model": "decoupled"},
        {"reach": 20.0},
    ],
    ids=str,
)
def test_options_of_the_cell(options):
    assert (
        difference(CellModel(catalogue.load("S-720").with_effective_density(), **options), 51)
        < ROUNDING
    )


@pytest.mark.parametrize("seed", range(8))
def test_random_cells(seed):
    """Crimps from a third to three times, moduli from a half to twice: as studies draw them, and beyond."""
    random = np.random.default_rng(seed)
    crimp = tuple(float(3.0**x) for x in random.uniform(-1, 0.7, 2))
    fabric = catalogue.load(str(random.choice(FABRICS))).with_effective_density()
    fabric = variants.scale_yarns(fabric, E=float(2.0 ** random.uniform(-1, 1)), crimp=crimp)
    fabric = variants.scale_laws(
        fabric, float(random.uniform(0.5, 1.5)), float(random.uniform(0.5, 1.5))
    )
    assert difference(CellModel(fabric), 51) < ROUNDING


@pytest.mark.parametrize("law", ["regularised", "printed"])
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", catalogue.list_names())
def test_every_fabric_file(name, model, law):
    fabric = comparison.with_law_form(catalogue.load(name), law)
    for form in FORMS:
        assert difference(CellModel(fabric, cell_model=model, cell_formulation=form), 21) < ROUNDING


CRIMPED = [
    ((0.15, 0.15), (1200, 1200)),
    ((0.15, 0.0005), (900, 1500)),
    ((0.13, 0.14), (750, 1500)),
    ((0.0005, 0.15), (750, 1500)),
]


@pytest.mark.parametrize("crimps, counts", CRIMPED)
def test_extreme_crimps(crimps, counts):
    """Up to 15 %, in uneven cells: folded yarns, which stay in contact at every stretch, among them."""
    laws = catalogue.load("S-728").laws
    fabric = Fabric(
        "crimped",
        Weave(*(Yarn(100e-6, 1440.0, 90e9, 0.03, crimp) for crimp in crimps), *counts),
        laws=laws,
    )
    for model, form in itertools.product(MODELS, FORMS):
        assert (
            difference(CellModel(fabric, laws, cell_model=model, cell_formulation=form), 31)
            < ROUNDING
        )


def test_steps_that_do_not_converge_are_reported_and_the_cell_is_solved_by_nested_iterations():
    """From a force ten decades off, Newton's steps leave the range; a table has such a cell where contact begins."""
    model = CellModel(catalogue.load("S-720"))
    crossover = model.crossover
    found = {key: float(array) for key, array in model.solve(1.005, 1.005).items()}
    w = tuple(1.005 * yarn.w for yarn in model.yarns)
    free = tuple(
        fill_kernels.slack_height(half, yarn, crossover) for half, yarn in zip(w, model.yarns)
    )
    cell = (w, free, crossover)
    near = fill_kernels.close_cell(*cell, (1.1 * found["F"], found["h1"], found["h2"]))
    assert near == pytest.approx((found["F"], found["h1"], found["h2"]), rel=1e-10)
    far = fill_kernels.close_cell(*cell, (1e10 * found["F"], 40 * found["h1"], found["h2"]))
    assert far[0] == -1
    # begins in the row, where the cell before has no force to start from
    contact = model.table(41).values["F"] > 0
    assert np.any(contact[:, 1:] & ~contact[:, :-1])


def test_a_cell_that_does_not_close_is_one_line(monkeypatch):
    monkeypatch.setattr(fill_kernels, "fill", lambda *_: False)
    with pytest.raises(UnstableError, match="the crossover did not close") as raised:
        CellModel(catalogue.load("S-720")).table(21)
    assert "\n" not in str(raised.value)
