"""The cross-shaped specimen against the curves of the crossover."""

import numpy as np
import pytest

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from validation.published.biaxial_glass.specimen import pull_specimen
from weavecell.analysis.biaxial_test.curves import at_ratio


def test_specimen_measures_its_crossover():
    """Balanced weave, k = 1: within 0.5 % of the variational cell, 3 % of the source's form of it."""
    fabric = catalogue.load("glass-balanced")
    # five steps: the first of six is at 1e-4 of the strength, where yarns are slack and relaxation may not settle
    done = pull_specimen(fabric, "k = 1", steps=5)
    strength = [yarn.strength for yarn in fabric.weave.yarns]
    assert done.strain[:, 0] == pytest.approx(done.strain[:, 1], abs=1e-5)
    assert done.difference(done.cell, strength) < 0.005
    assert done.difference(done.tension, strength) < 0.03
    for form, error in (("variational", 0.01), ("equilibrium", 0.03)):
        curve = at_ratio(CellModel(fabric, form=form), 1.0)
        expected = np.interp(done.strain[-2, 0], curve.strain[:, 0], curve.tension[:, 0])
        assert done.load[-2, 0] == pytest.approx(expected, rel=error)
