"""Biaxial curves of two glass weaves, and what the options of the cell change in them."""

import numpy as np
import pytest

from fabrics import catalogue
from shellfabric.cell.biaxial_path import to_strength
from shellfabric.cell.model import CellModel
from validation.cases import cell
from validation.published.biaxial_glass import free_edge

BALANCED, UNBALANCED = (catalogue.load(name) for name in ("glass-balanced", "glass-unbalanced"))
BALANCED_CELL, UNBALANCED_CELL = (
    CellModel(fabric, cell_formulation="equilibrium") for fabric in (BALANCED, UNBALANCED)
)


def changed(test, yarn, **options):
    return cell.biaxial_options(fabric="glass-unbalanced", test=test, yarn=yarn, options=options)


def test_profile_does_nothing_to_a_free_edge():
    """A yarn that crosses nothing is straight, whatever its profile was; its slack it keeps."""
    for name, yarn in zip(("warp", "weft"), UNBALANCED.weave.yarns):
        slack = changed("free", name, fibre_slack=1e-3)
        assert changed("free", name, cell_profile="straight")["rms"] == 0
        assert changed("free", name, fibre_slack=1e-3, cell_profile="straight") == slack
        assert slack["largest"] == pytest.approx(-yarn.EA * 1e-3, rel=0.01), "its asymptote"


def test_slack_softens_and_straight_segments_stiffen():
    for test in ("k = 0.5", "k = 1", "k = 2"):
        assert (
            changed(test, "warp", fibre_slack=1e-3)["largest"]
            < 0
            < changed(test, "warp", cell_profile="straight")["largest"]
        )


def test_free_edge_of_a_yarn_with_a_toe_ends_at_its_strength():
    curve = free_edge(
        CellModel(UNBALANCED, cell_formulation="equilibrium", fibre_slack=(1e-3, 2e-3)), "weft"
    )
    assert curve.tension[-1, 1] == pytest.approx(UNBALANCED.weave.weft.strength, rel=1e-9)
    linear = free_edge(CellModel(UNBALANCED, cell_formulation="equilibrium"), "weft")
    assert curve.strain[-1, 1] - linear.strain[-1, 1] == pytest.approx(2e-3, rel=0.02)


def test_balanced_weave_is_symmetric():
    slow = to_strength(BALANCED_CELL, (0.5, 1.0))
    fast = to_strength(BALANCED_CELL, (2.0, 1.0))
    assert np.allclose(slow.tension[:, 0], fast.tension[:, 1], rtol=1e-10, atol=1e-9)
    equal = to_strength(BALANCED_CELL, (1.0, 1.0))
    assert np.allclose(equal.tension[:, 0], equal.tension[:, 1], rtol=1e-10)


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
