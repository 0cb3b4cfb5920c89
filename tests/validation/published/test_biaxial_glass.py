"""Biaxial curves of two glass weaves, what the options of the cell change in them, and one weave in three models."""

import numpy as np
import pytest

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from validation.published.biaxial_glass import model_comparison, options
from validation.published.biaxial_glass.curves import at_ratio, curves, free_edge

BALANCED, UNBALANCED = (catalogue.load(name) for name in ("glass-balanced", "glass-unbalanced"))
BALANCED_CELL, UNBALANCED_CELL = (CellModel(fabric, form="equilibrium") for fabric in (BALANCED, UNBALANCED))


def of(rows, variant, test, yarn):
    return next(row for row in rows if (row.variant, row.test, row.yarn) == (variant, test, yarn))


@pytest.fixture(scope="module")
def same():
    return options.differences(UNBALANCED, options.same_constants(UNBALANCED))


def test_profile_does_nothing_to_a_free_edge(same):
    """A yarn that crosses nothing is straight, whatever its profile was; its toe it keeps."""
    for test, yarn in (("free weft", "warp"), ("free warp", "weft")):
        assert of(same, "straight segments", test, yarn).rms == 0
        assert of(same, "both", test, yarn).rms == of(same, "toe", test, yarn).rms > 0
        EA = dict(zip(("warp", "weft"), UNBALANCED.weave.yarns))[yarn].EA
        assert of(same, "toe", test, yarn).largest == pytest.approx(-EA * options.TOE, rel=0.01), "its asymptote"


def test_toe_softens_and_straight_segments_stiffen(same):
    for row in same:
        if "free" not in row.test and row.variant in ("toe", "straight segments"):
            assert (row.largest > 0) == (row.variant == "straight segments"), row


@pytest.mark.parametrize("fabric", [BALANCED, UNBALANCED], ids=["balanced", "unbalanced"])
def test_another_profile_is_only_another_a_and_b(fabric):
    """To first order in the crimp straight segments scale the heights by pi / sqrt(8) and the forces by 1 / sqrt(2)."""
    found, laws, residuals = options.fitted_anew(fabric)
    assert residuals["straight segments"] < 1e-4
    for row in options.differences(fabric, found):
        if row.variant == "straight segments":
            assert row.share < 2e-4
    law, source = laws["straight segments"], fabric.laws[0]
    assert law.a / source.a == pytest.approx(np.pi / np.sqrt(8), rel=0.003)
    assert law.b / source.b == pytest.approx(np.pi / np.sqrt(8) * 0.5 ** (1 / 6), rel=0.003)


def test_free_edge_of_a_yarn_with_a_toe_ends_at_its_strength():
    curve = free_edge(CellModel(UNBALANCED, form="equilibrium", toe=(1e-3, 2e-3)), "weft")
    assert curve.tension[-1, 1] == pytest.approx(UNBALANCED.weave.weft.strength, rel=1e-9)
    linear = free_edge(CellModel(UNBALANCED, form="equilibrium"), "weft")
    assert curve.strain[-1, 1] - linear.strain[-1, 1] == pytest.approx(2e-3, rel=0.02)


def test_specimen_whose_middle_is_stretched_alike(monkeypatch):
    """The grips make up for the arms, so that the middle follows k = 1 and the load is the cell's."""
    monkeypatch.setattr(model_comparison, "STEPS", 3)
    strain, load = model_comparison.middle_alike(UNBALANCED)
    assert strain[:, 0] == pytest.approx(strain[:, 1], abs=2e-5)
    cell = CellModel(UNBALANCED).solve(*(1 + strain.T))
    assert load[:, 0] == pytest.approx(cell["N1"], rel=0.01)
    assert load[:, 1] == pytest.approx(cell["N2"], rel=0.01)


def test_balanced_weave_is_symmetric():
    slow, fast = at_ratio(BALANCED_CELL, 0.5), at_ratio(BALANCED_CELL, 2.0)
    assert np.allclose(slow.tension[:, 0], fast.tension[:, 1], rtol=1e-10, atol=1e-9)
    equal = at_ratio(BALANCED_CELL, 1.0)
    assert np.allclose(equal.tension[:, 0], equal.tension[:, 1], rtol=1e-10)


def test_every_curve_ends_at_a_strength():
    for model in (BALANCED_CELL, UNBALANCED_CELL):
        strengths = {name: yarn.strength for name, yarn in zip(("warp", "weft"), model.fabric.weave.yarns)}
        for curve in curves(model.fabric):
            end = curve.tension[-1][("warp", "weft").index(curve.failed)]
            assert end == pytest.approx(strengths[curve.failed], rel=1e-5)
