"""Shots for other codes: a card's law in place of the cell."""

import numpy as np
import pytest

from validation.verification import bench_decks
from weavecell.analysis.material_card.cloth import Cloth
from weavecell.analysis.material_card.laws import CrimpExchange, UncoupledCurves


def law_and_tables(name, law, match):
    setup = bench_decks.setup_of(name)
    cloth = Cloth(setup.cell())
    return cloth, law.of(cloth, match), bench_decks.card_table(setup, law.of(cloth, match)), setup.table()


def test_curves_of_uniaxial_tension_are_the_cell_where_yarns_never_touch():
    cloth, _, card, cell = law_and_tables("bench", UncoupledCurves, "uniaxial")
    for k, force in enumerate(("N1", "N2")):
        strength = cloth.model.fabric.weave.yarns[k].strength
        off = (card.values[force] - cell.values[force])[cell.values[f"T{k + 1}"] < strength]
        assert np.abs(off).max() < 2e-3 * strength


@pytest.mark.parametrize("law", [UncoupledCurves, CrimpExchange])
def test_the_potential_has_the_forces_of_the_law(law):
    cloth, of, card, _ = law_and_tables("S-726", law, "plane")
    stress = np.maximum(of.stress(*np.meshgrid(card.stretch1, card.stretch2, indexing="ij")), 0.0)
    for k, force in enumerate(("N1", "N2")):
        off = card.values[force] - stress[k] / cloth.smear[k]
        below = card.values[f"T{k + 1}"] < cloth.model.fabric.weave.yarns[k].strength
        assert np.abs(off[below]).max() < 0.02 * cloth.model.fabric.weave.yarns[k].strength
    assert card.residual < 0.02
