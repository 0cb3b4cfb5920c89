"""Biaxial curves of two glass weaves."""

import pytest
from numpy.testing import assert_allclose

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from validation.published.biaxial_glass import free_edge
from weavecell.studies.biaxial_path import to_strength

BALANCED, UNBALANCED = (catalogue.load(name) for name in ("glass-balanced", "glass-unbalanced"))
BALANCED_CELL, UNBALANCED_CELL = (
    CellModel(fabric, cell_formulation="equilibrium") for fabric in (BALANCED, UNBALANCED)
)


def test_balanced_weave_is_symmetric():
    slow = to_strength(BALANCED_CELL, (0.5, 1.0))
    fast = to_strength(BALANCED_CELL, (2.0, 1.0))
    assert_allclose(slow.tension[:, 0], fast.tension[:, 1], rtol=1e-10, atol=1e-9)
    equal = to_strength(BALANCED_CELL, (1.0, 1.0))
    assert_allclose(equal.tension[:, 0], equal.tension[:, 1], rtol=1e-10)


def test_every_curve_ends_at_a_strength():
    for model in (BALANCED_CELL, UNBALANCED_CELL):
        strengths = {
            name: yarn.strength for name, yarn in zip(("warp", "weft"), model.fabric.weave.yarns)
        }
        paths = [to_strength(model, (k, 1.0)) for k in (0.5, 1.0, 2.0)] + [
            free_edge(model, name) for name in strengths
        ]
        for path in paths:
            end = path.tension[-1][("warp", "weft").index(path.failed)]
            assert end == pytest.approx(strengths[path.failed], rel=1e-5)
