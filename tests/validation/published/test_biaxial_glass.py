"""Biaxial curves of two glass weaves, what the options of the cell change in them, and one weave in three models."""

import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.errors import InputError
from shellfabric.cell.model import CellModel
from validation.published.biaxial_glass import model_comparison, options
from weavecell.analysis.biaxial_test.curves import at_ratio, curves, free_edge

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


def test_a_difference_is_what_it_says():
    found = options.same_constants(BALANCED)
    base, toe = (next(c for c in found[name] if c.label == "k = 1") for name in (options.BASE, "toe"))
    e = np.linspace(0, base.strain[-1, 0], 241)
    cells = [CellModel(BALANCED, form="equilibrium", toe=value).solve(1 + e, 1 + e)["T1"] for value in (0, options.TOE)]
    row = of(options.differences(BALANCED, found), "toe", "k = 1", "warp")
    assert toe.strain[-1, 0] > base.strain[-1, 0]
    assert row.rms == pytest.approx(np.sqrt(np.mean((cells[1] - cells[0]) ** 2)), rel=1e-3)
    assert row.share == pytest.approx(row.rms / BALANCED.weave.warp.strength)


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


def test_a_toe_taken_for_linear_makes_the_law_too_soft():
    """The source's own account of its misfit: constants that are no yarn's, and poor predictions at other ratios."""
    found, law, residual = options.mistaken(BALANCED)
    assert law.a > 1.5 * BALANCED.laws[0].a
    rows = options.differences(BALANCED, found, "the weave")
    fitted = of(rows, options.TAKEN, "k = 1", "warp").share
    assert residual < 0.003
    assert of(rows, options.TAKEN, "k = 0.5", "weft").share > 10 * fitted


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


def test_three_models_of_one_weave(tmp_path):
    pytest.importorskip("dolfinx")
    words = ["validation.published.biaxial_glass.model_comparison", "--out", str(tmp_path), "glass-balanced"]
    told = subprocess.run([sys.executable, "-m", *words], check=True, capture_output=True, text=True).stdout
    assert told.count("| warp, ") == 2
    assert (tmp_path / "glass-balanced-sides.png").stat().st_size > 20_000
    rows = (tmp_path / "glass-balanced-sides.csv").read_text().splitlines()
    assert {row.split(",")[-3] for row in rows[1:]} >= {"shell coupon", "3D crossover"}


def test_command_with_options(tmp_path):
    words = ["--options", "--toe", "0.05 %", "--out", str(tmp_path), "glass-balanced"]
    told = subprocess.run(
        [sys.executable, "-m", "validation.published.biaxial_glass", *words], check=True, capture_output=True, text=True
    ).stdout
    assert "| straight segments |" in told
    assert (tmp_path / "glass-balanced-options.png").stat().st_size > 20_000
    rows = (tmp_path / "glass-balanced-options.csv").read_text().splitlines()
    assert len(rows) == 1 + 3 * 8 + 3 * 6 + 6
    toe = CellModel(BALANCED, form="equilibrium", toe=5e-4)
    end = at_ratio(toe, 1.0).strain[-1, 0]
    curve = [row.split(",") for row in (tmp_path / "glass-balanced.csv").read_text().splitlines()]
    assert float([row for row in curve if row[0] == "k = 1"][-1][1]) == pytest.approx(end, rel=1e-5)


def load_at(curve, strain, index=0):
    return np.interp(strain, curve.strain[:, index], curve.tension[:, index])


def test_balanced_weave_is_symmetric():
    slow, fast = at_ratio(BALANCED_CELL, 0.5), at_ratio(BALANCED_CELL, 2.0)
    assert np.allclose(slow.tension[:, 0], fast.tension[:, 1], rtol=1e-10, atol=1e-9)
    equal = at_ratio(BALANCED_CELL, 1.0)
    assert np.allclose(equal.tension[:, 0], equal.tension[:, 1], rtol=1e-10)


@pytest.mark.parametrize("model", [BALANCED_CELL, UNBALANCED_CELL], ids=["balanced", "unbalanced"])
def test_more_cross_stretch_means_more_load(model):
    """Claim biaxial-order-k, at every strain that all curves reach under load."""
    tests = [at_ratio(model, k) for k in (0.5, 1.0, 2.0)] + [free_edge(model, "warp")]
    reach = min(curve.strain[-1, 0] for curve in tests)
    for strain in np.linspace(0.1, 1, 10) * reach:
        loads = [load_at(curve, strain) for curve in tests]
        assert all(more > less for more, less in pairwise(loads) if more > 0), (strain, loads)


def test_free_edge_is_shifted_by_the_crimp():
    """Claim biaxial-balanced-free: 0.40 % beyond the single yarn, at every load."""
    curve, yarn = free_edge(BALANCED_CELL, "warp"), BALANCED_CELL.fabric.weave.warp
    loaded = curve.tension[:, 0] > 1
    shift = curve.strain[loaded, 0] - curve.tension[loaded, 0] / yarn.EA
    assert shift == pytest.approx(0.0040, abs=0.0005)


def test_every_curve_ends_at_a_strength():
    for model in (BALANCED_CELL, UNBALANCED_CELL):
        strengths = {name: yarn.strength for name, yarn in zip(("warp", "weft"), model.fabric.weave.yarns)}
        for curve in curves(model.fabric):
            end = curve.tension[-1][("warp", "weft").index(curve.failed)]
            assert end == pytest.approx(strengths[curve.failed], rel=1e-5)


def test_unbalanced_constants_are_extreme():
    """Claim biaxial-unbalanced-large-a: 2 a is 0.86 of the sum of the heights."""
    assert 2 * UNBALANCED_CELL.fabric.laws[0].a / sum(UNBALANCED_CELL.fabric.weave.h0) == pytest.approx(0.86, abs=0.02)


def test_a_ratio_is_positive():
    with pytest.raises(InputError, match="a positive ratio"):
        at_ratio(BALANCED_CELL, 0.0)


def test_the_command_writes_table_and_picture(tmp_path):
    command = [sys.executable, "-m", "validation.published.biaxial_glass", "--out", str(tmp_path), "glass-balanced"]
    subprocess.run(command, check=True, capture_output=True)
    lines = (tmp_path / "glass-balanced.csv").read_text().splitlines()
    assert lines[0].startswith("test,warp strain")
    assert len(lines) == 1 + 5 * 241
    assert (tmp_path / "glass-balanced.png").stat().st_size > 20_000
